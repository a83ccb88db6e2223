/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds the output circuit of netlist.match and reports the result. */
#include <glib.h>
#include <opcflow/table.h>
#include <string.h>

#include "match.h"

/* ---- the circuit ---- */

static const char *own_text(eda_circuit *c, const char *text) {
  return eda_pool_text(&c->memory, text, strlen(text));
}

static void put_devices(const match_task *j, eda_circuit *c) {
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
                                .type = d->from->type,
                                .model = own_text(c, d->from->model)};
  }
  for (size_t i = 0; i < g->count; i++)
    if (j->owner[i] != UINT32_MAX) c->device[j->owner[i]].fingers++;
  uint32_t *fingers = eda_pool_alloc(&c->memory, g->count, sizeof *fingers);
  uint32_t *next = fingers;
  for (size_t i = 0; i < c->count; i++) {
    c->device[i].finger = next;
    next += c->device[i].fingers;
    c->device[i].fingers = 0;
  }
  for (size_t i = 0; i < g->count; i++) {
    if (j->owner[i] == UINT32_MAX) continue;
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

eda_circuit *match_circuit(const match_task *j, const char *name,
                           const char *supply, const char *ground) {
  const eda_flat_netlist *f = &j->flat;
  eda_circuit *c =
      eda_circuit_new(j->gates, name, f->nets, f->ports, f->devices);
  for (size_t i = 0; i < c->nets; i++) c->net[i] = own_text(c, f->net[i]);
  for (size_t i = 0; i < c->ports; i++) c->port[i] = f->port[i];
  put_devices(j, c);
  put_roles(c, supply, ground);
  return c;
}

/* ---- reports ---- */

static const char *gate_names(match_task *j, const eda_device *d) {
  g_autoptr(GString) text = g_string_new(NULL);
  for (uint32_t i = 0; i < d->fingers; i++) {
    char name[256];
    match_gate_name(j, d->finger[i], name, sizeof name);
    g_string_append_printf(text, "%s%s", i ? " " : "", name);
  }
  return eda_pool_text(&j->pool, text->str, text->len);
}

static int publish_table(match_task *j, const eda_circuit *c) {
  typedef struct row {
    const char *device, *type, *drain, *gate, *source, *gates;
    double length, width;
  } row;
  row *rows = eda_pool_alloc(&j->pool, c->count, sizeof *rows);
  for (size_t i = 0; i < c->count; i++) {
    const eda_device *d = &c->device[i];
    rows[i] = (row){.device = d->name,
                    .type = d->type == EDA_PMOS ? "p" : "n",
                    .drain = c->net[d->drain],
                    .gate = c->net[d->gate],
                    .source = c->net[d->source],
                    .gates = gate_names(j, d),
                    .length = d->length,
                    .width = d->width};
  }
  const opc_column columns[] = {
      {"device", NULL, OPC_TEXT, 0, &rows->device},
      {"type", NULL, OPC_TEXT, 0, &rows->type},
      {"drain", NULL, OPC_TEXT, 0, &rows->drain},
      {"gate", NULL, OPC_TEXT, 0, &rows->gate},
      {"source", NULL, OPC_TEXT, 0, &rows->source},
      {"L", "nm", OPC_REAL, -1, &rows->length},
      {"W", "nm", OPC_REAL, -1, &rows->width},
      {"gates", NULL, OPC_TEXT, 0, &rows->gates},
  };
  return opc_put_rows(j->host, "netlist", 0, c->count, sizeof *rows,
                      OPC_ARRAY(columns), j->error);
}

int match_publish(match_task *j, const eda_circuit *c) {
  const opc_metric_value values[] = {{"devices", (double)c->count},
                                     {"gates", (double)j->gates->count},
                                     {"nets", (double)c->nets},
                                     {"by_order", (double)j->by_order}};
  int code = publish_table(j, c);
  return code ? code : opc_put_metrics(j->host, OPC_ARRAY(values), j->error);
}
