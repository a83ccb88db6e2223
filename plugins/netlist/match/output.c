/* SPDX-License-Identifier: BSD-3-Clause */
/* The circuit that netlist.match hands on, and what the run tells of it. */
#include <stdio.h>
#include <string.h>

#include "match.h"

/* ---- the circuit ---- */

static const char *own_text(eda_circuit *c, const char *text) {
  return eda_pool_text(&c->memory, text, strlen(text));
}

static void put_devices(const job *j, eda_circuit *c) {
  const eda_gates *g = j->gates;
  for (size_t i = 0; i < c->count; i++) {
    const eda_transistor *d = &j->flat.device[i];
    c->device[i] = (eda_device){.name = own_text(c, d->name),
                                .drain = d->drain,
                                .gate = d->gate,
                                .source = d->source,
                                .bulk = d->bulk,
                                .length = d->length,
                                .width = d->width,
                                .type = d->from->type};
  }
  for (size_t i = 0; i < g->count; i++) c->device[j->owner[i]].fingers++;
  uint32_t *fingers = eda_pool_alloc(&c->memory, g->count, sizeof *fingers);
  uint32_t *next = fingers;
  for (size_t i = 0; i < c->count; i++) {
    c->device[i].finger = next;
    next += c->device[i].fingers;
    c->device[i].fingers = 0;
  }
  for (size_t i = 0; i < g->count; i++) {
    eda_device *d = &c->device[j->owner[i]];
    fingers[(size_t)(d->finger - fingers) + d->fingers++] = (uint32_t)i;
  }
}

static void put_roles(eda_circuit *c, const char *supply, const char *ground) {
  for (size_t i = 0; i < c->ports; i++) {
    const char *name = c->net[c->port[i]];
    c->role[i] = EDA_PIN_INPUT;
    if (eda_in_list(supply, name)) c->role[i] = EDA_PIN_SUPPLY;
    if (eda_in_list(ground, name)) c->role[i] = EDA_PIN_GROUND;
    for (size_t k = 0; k < c->count && c->role[i] == EDA_PIN_INPUT; k++)
      if (c->device[k].drain == c->port[i] || c->device[k].source == c->port[i])
        c->role[i] = EDA_PIN_OUTPUT;
  }
}

eda_circuit *match_circuit(const job *j, const char *name, const char *supply,
                           const char *ground) {
  const eda_flat_netlist *f = &j->flat;
  eda_circuit *c =
      eda_circuit_new(j->gates, name, f->nets, f->ports, f->devices);
  for (size_t i = 0; i < c->nets; i++) c->net[i] = own_text(c, f->net[i]);
  for (size_t i = 0; i < c->ports; i++) c->port[i] = f->port[i];
  put_devices(j, c);
  put_roles(c, supply, ground);
  return c;
}

/* ---- what the run tells ---- */

static const char *gate_names(job *j, const eda_device *d) {
  char name[256];
  size_t bytes = 1, used = 0;
  for (uint32_t i = 0; i < d->fingers; i++)
    bytes += strlen(match_gate_name(j, d->finger[i], name, sizeof name)) + 1;
  char *text = eda_pool_alloc(&j->pool, bytes, 1);
  for (uint32_t i = 0; i < d->fingers; i++)
    used +=
        (size_t)snprintf(text + used, bytes - used, "%s%s", i ? " " : "",
                         match_gate_name(j, d->finger[i], name, sizeof name));
  return text;
}

static int publish_table(job *j, const eda_circuit *c) {
  enum { DEVICE, TYPE, DRAIN, GATE, SOURCE, GATES, TEXTS };
  const char **text[TEXTS];
  double *length = eda_pool_alloc(&j->pool, c->count, sizeof *length);
  double *width = eda_pool_alloc(&j->pool, c->count, sizeof *width);
  for (int k = 0; k < TEXTS; k++)
    text[k] = eda_pool_alloc(&j->pool, c->count, sizeof *text[k]);
  for (size_t i = 0; i < c->count; i++) {
    const eda_device *d = &c->device[i];
    text[DEVICE][i] = d->name;
    text[TYPE][i] = d->type == EDA_PMOS ? "p" : "n";
    text[DRAIN][i] = c->net[d->drain];
    text[GATE][i] = c->net[d->gate];
    text[SOURCE][i] = c->net[d->source];
    text[GATES][i] = gate_names(j, d);
    length[i] = d->length;
    width[i] = d->width;
  }
  const opc_column columns[] = {
      {"device", NULL, OPC_TEXT, 0, text[DEVICE]},
      {"type", NULL, OPC_TEXT, 0, text[TYPE]},
      {"drain", NULL, OPC_TEXT, 0, text[DRAIN]},
      {"gate", NULL, OPC_TEXT, 0, text[GATE]},
      {"source", NULL, OPC_TEXT, 0, text[SOURCE]},
      {"L", "nm", OPC_REAL, -1, length},
      {"W", "nm", OPC_REAL, -1, width},
      {"gates", NULL, OPC_TEXT, 0, text[GATES]},
  };
  return j->host->table(j->host, "netlist", 0, c->count, columns,
                        sizeof columns / sizeof *columns, j->error);
}

int match_publish(job *j, const eda_circuit *c) {
  const opc_host *host = j->host;
  const struct {
    const char *name;
    size_t value;
  } metrics[] = {{"devices", c->count},
                 {"gates", j->gates->count},
                 {"nets", c->nets},
                 {"by_order", j->by_order}};
  int code = publish_table(j, c);
  for (size_t i = 0; !code && i < sizeof metrics / sizeof *metrics; i++)
    code = host->metric(host, metrics[i].name, (double)metrics[i].value,
                        j->error);
  return code;
}
