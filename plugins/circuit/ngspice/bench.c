/* SPDX-License-Identifier: BSD-3-Clause */
/* A circuit on the bench: its ports, its netlist, and the sources around it. */
#include "bench.h"

#include <stdio.h>
#include <string.h>

int no_memory(const opc_host *host, opc_error *error) {
  return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
}

void *bench_alloc(bench *b, size_t count, size_t size, opc_error *error) {
  void *memory = pool_alloc(&b->pool, count, size);
  if (!memory) no_memory(b->host, error);
  return memory;
}

/* ---- ports ---- */

int bench_role(const opc_circuit *c, uint32_t net) {
  for (size_t i = 0; i < c->ports; i++)
    if (c->port[i] == net) return c->role[i];
  return -1;
}

const char *bench_node(const bench *b, uint32_t net, node_name out) {
  if (bench_role(b->circuit, net) == OPC_PORT_GROUND)
    strcpy(out, "0");
  else
    snprintf(out, sizeof(node_name), "n%u", net);
  return out;
}

/* Each name of the list is a port that may be driven. */
static int check_inputs(const bench *b, const char *list, opc_error *error) {
  const opc_circuit *c = b->circuit;
  for (const char *at = list + strspn(list, " "); *at; at += strspn(at, " ")) {
    size_t n = strcspn(at, " "), i = 0;
    while (i < c->ports &&
           (strncasecmp(c->net[c->port[i]], at, n) || c->net[c->port[i]][n]))
      i++;
    if (i == c->ports || c->role[i] == OPC_PORT_SUPPLY ||
        c->role[i] == OPC_PORT_GROUND)
      return b->host->fail(b->host, error, OPC_INVALID, "inputs",
                           "'%.*s' is no port of '%s' that may be an input",
                           (int)n, at, c->name);
    at += n;
  }
  return OPC_OK;
}

int bench_ports(bench *b, const char *inputs, opc_error *error) {
  const opc_circuit *c = b->circuit;
  int found[2] = {0, 0};
  if (inputs && check_inputs(b, inputs, error)) return error->code;
  b->input = bench_alloc(b, c->ports, sizeof *b->input, error);
  b->output = bench_alloc(b, c->ports, sizeof *b->output, error);
  if (!b->input || !b->output) return error->code;
  for (size_t i = 0; i < c->ports; i++) {
    uint32_t net = c->port[i];
    if (c->role[i] == OPC_PORT_SUPPLY || c->role[i] == OPC_PORT_GROUND)
      found[c->role[i] == OPC_PORT_GROUND] = 1;
    else if (inputs ? in_list(inputs, c->net[net])
                    : c->role[i] == OPC_PORT_INPUT)
      b->input[b->inputs++] = net;
    else
      b->output[b->outputs++] = net;
  }
  for (int i = 0; i < 2; i++)
    if (!found[i])
      return b->host->fail(b->host, error, OPC_INVALID, "circuit",
                           "'%s' has no %s among its ports", c->name,
                           i ? "ground" : "supply");
  return OPC_OK;
}

/* ---- netlists ---- */

char *bench_netlist(const bench *b, const opc_circuit *c, int state, int sizes,
                    opc_error *error) {
  netlist_counts counts;
  netlist_annotation a = {.circuit = c, .mask = b->mask, .state = state};
  opc_mask off;
  for (int type = 0; type < 2; type++) {
    a.model[type] = b->model[type];
    if (sizes == SIZE_TIMED && b->dlc) a.card[type] = &b->card[type];
  }
  if (b->mask && sizes == SIZE_OFF) {
    off = *b->mask;
    off.before.leq_ion = off.before.leq_ioff;
    off.after.leq_ion = off.after.leq_ioff;
    a.mask = &off;
  }
  return netlist_annotate(b->host, &a, &counts, error);
}

int bench_forgive(bench *b, int state, int code, const opc_error *error) {
  if (code != OPC_FAILED || state != NETLIST_BEFORE) return code;
  if (b->has[state])
    b->host->log(b->host, OPC_LOG_WARNING,
                 "no figures of the circuit before correction: %s",
                 error->message);
  b->has[state] = 0;
  return OPC_OK;
}
