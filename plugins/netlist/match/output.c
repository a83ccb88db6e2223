/* SPDX-License-Identifier: BSD-3-Clause */
#include "output.h"

#include <stdio.h>
#include <string.h>

typedef struct owned_circuit {
  opc_circuit circuit; /* the first member */
  const opc_host *host;
  char *names;
  uint32_t *fingers; /* of all devices */
} owned_circuit;

void output_release(void *object) {
  owned_circuit *o = object;
  if (!o) return;
  const opc_host *host = o->host;
  host->free(host, o->circuit.net);
  host->free(host, o->circuit.port);
  host->free(host, o->circuit.role);
  host->free(host, o->circuit.device);
  host->free(host, o->fingers);
  host->free(host, o->names);
  host->free(host, o);
}

/* ---- the circuit ---- */

static int allocate(const job *j, const char *name, owned_circuit *o) {
  const opc_host *host = j->host;
  const flat_netlist *f = &j->flat;
  opc_circuit *c = &o->circuit;
  size_t bytes = strlen(name) + 1;
  for (size_t i = 0; i < f->nets; i++) bytes += strlen(f->net[i]) + 1;
  for (size_t i = 0; i < f->devices; i++)
    bytes += strlen(f->device[i].name) + 1;
  c->nets = f->nets;
  c->ports = f->ports;
  c->count = f->devices;
  o->names = host->alloc(host, bytes, 1);
  o->fingers = host->alloc(host, j->gates->count, sizeof *o->fingers);
  c->net = host->alloc(host, c->nets, sizeof *c->net);
  c->port = host->alloc(host, c->ports, sizeof *c->port);
  c->role = host->alloc(host, c->ports, 1);
  c->device = host->alloc(host, c->count, sizeof *c->device);
  return o->names && o->fingers && c->net && c->port && c->role && c->device;
}

static const char *put_name(char **at, const char *name) {
  size_t n = strlen(name) + 1;
  char *put = memcpy(*at, name, n);
  *at += n;
  return put;
}

static void put_devices(const job *j, owned_circuit *o, char **at) {
  const flat_netlist *f = &j->flat;
  opc_device *device = o->circuit.device;
  for (size_t i = 0; i < f->devices; i++) {
    const struct transistor *d = &f->device[i];
    device[i] = (opc_device){.name = put_name(at, d->name),
                             .drain = d->drain,
                             .gate = d->gate,
                             .source = d->source,
                             .bulk = d->bulk,
                             .length = d->length,
                             .width = d->width,
                             .type = d->from->type};
  }
  for (size_t g = 0; g < j->gates->count; g++) device[j->owner[g]].fingers++;
  uint32_t *next = o->fingers;
  for (size_t i = 0; i < f->devices; i++) {
    device[i].finger = next;
    next += device[i].fingers;
    device[i].fingers = 0;
  }
  for (size_t g = 0; g < j->gates->count; g++) {
    opc_device *d = &device[j->owner[g]];
    o->fingers[(size_t)(d->finger - o->fingers) + d->fingers++] = (uint32_t)g;
  }
}

static void put_roles(opc_circuit *c, const char *supply, const char *ground) {
  for (size_t i = 0; i < c->ports; i++) {
    const char *name = c->net[c->port[i]];
    c->role[i] = OPC_PORT_INPUT;
    if (in_list(supply, name)) c->role[i] = OPC_PORT_SUPPLY;
    if (in_list(ground, name)) c->role[i] = OPC_PORT_GROUND;
    for (size_t k = 0; k < c->count && c->role[i] == OPC_PORT_INPUT; k++)
      if (c->device[k].drain == c->port[i] || c->device[k].source == c->port[i])
        c->role[i] = OPC_PORT_OUTPUT;
  }
}

opc_circuit *output_circuit(const job *j, const char *name, const char *supply,
                            const char *ground) {
  owned_circuit *o = j->host->alloc(j->host, 1, sizeof *o);
  if (o) o->host = j->host;
  if (!o || !allocate(j, name, o)) {
    output_release(o);
    j->host->fail(j->host, j->error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  opc_circuit *c = &o->circuit;
  char *at = o->names;
  c->size = sizeof *c;
  c->name = put_name(&at, name);
  c->gates = j->gates;
  for (size_t i = 0; i < c->nets; i++)
    c->net[i] = put_name(&at, j->flat.net[i]);
  memcpy(c->port, j->flat.port, c->ports * sizeof *c->port);
  put_devices(j, o, &at);
  put_roles(c, supply, ground);
  return c;
}

/* ---- what the run tells ---- */

static const char *gate_names(job *j, const opc_device *d) {
  char name[256];
  size_t bytes = 1, used = 0;
  for (uint32_t i = 0; i < d->fingers; i++)
    bytes += strlen(match_gate_name(j, d->finger[i], name, sizeof name)) + 1;
  char *text = pool_alloc(&j->pool, bytes, 1);
  for (uint32_t i = 0; text && i < d->fingers; i++)
    used +=
        (size_t)snprintf(text + used, bytes - used, "%s%s", i ? " " : "",
                         match_gate_name(j, d->finger[i], name, sizeof name));
  return text;
}

typedef struct device_table {
  const char **device, **type, **drain, **gate, **source, **gates;
  double *length, *width;
} device_table;

static int fill(job *j, const opc_circuit *c, device_table *t) {
  pool *p = &j->pool;
  const char ***texts[] = {&t->device, &t->type,   &t->drain,
                           &t->gate,   &t->source, &t->gates};
  for (size_t k = 0; k < sizeof texts / sizeof *texts; k++)
    if (!(*texts[k] = pool_alloc(p, c->count, sizeof(char *))))
      return match_no_memory(j);
  t->length = pool_alloc(p, c->count, sizeof(double));
  t->width = pool_alloc(p, c->count, sizeof(double));
  if (!t->length || !t->width) return match_no_memory(j);
  for (size_t i = 0; i < c->count; i++) {
    const opc_device *d = &c->device[i];
    t->device[i] = d->name;
    t->type[i] = d->type == OPC_PMOS ? "p" : "n";
    t->drain[i] = c->net[d->drain];
    t->gate[i] = c->net[d->gate];
    t->source[i] = c->net[d->source];
    t->length[i] = d->length;
    t->width[i] = d->width;
    if (!(t->gates[i] = gate_names(j, d))) return match_no_memory(j);
  }
  return OPC_OK;
}

int output_publish(job *j, const opc_circuit *c) {
  device_table t;
  if (fill(j, c, &t)) return j->error->code;
  const opc_column columns[] = {
      {"device", NULL, OPC_TEXT, 0, t.device},
      {"type", NULL, OPC_TEXT, 0, t.type},
      {"drain", NULL, OPC_TEXT, 0, t.drain},
      {"gate", NULL, OPC_TEXT, 0, t.gate},
      {"source", NULL, OPC_TEXT, 0, t.source},
      {"L", "nm", OPC_REAL, -1, t.length},
      {"W", "nm", OPC_REAL, -1, t.width},
      {"gates", NULL, OPC_TEXT, 0, t.gates},
  };
  const opc_host *host = j->host;
  int code = host->table(host, "netlist", 0, c->count, columns,
                         sizeof columns / sizeof *columns, j->error);
  if (!code) code = host->metric(host, "devices", (double)c->count, j->error);
  if (!code)
    code = host->metric(host, "gates", (double)j->gates->count, j->error);
  if (!code) code = host->metric(host, "nets", (double)c->nets, j->error);
  if (!code)
    code = host->metric(host, "by_order", (double)j->by_order, j->error);
  return code;
}
