/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the ports of a circuit and writes its netlist and sources. */
#include "bench.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

double bench_start(const bench *b) { return b->slew; }

/* ---- ports ---- */

int is_rail(int role) {
  return role == EDA_PIN_SUPPLY || role == EDA_PIN_GROUND;
}

const char *bench_node(const bench *b, uint32_t net, node_name out) {
  if (eda_circuit_role(b->circuit, net) == EDA_PIN_GROUND)
    strcpy(out, "0");
  else
    snprintf(out, sizeof(node_name), "n%u", net);
  return out;
}

/* Check that each name of the list is a port that may be driven. */
static int check_inputs(const bench *b, opc_error *error) {
  const eda_circuit *c = b->circuit;
  const char *at = b->inputs_list;
  for (at += strspn(at, " "); *at; at += strspn(at, " ")) {
    size_t n = strcspn(at, " "), i = 0;
    while (i < c->ports &&
           (strncasecmp(c->net[c->port[i]], at, n) || c->net[c->port[i]][n]))
      i++;
    if (i == c->ports || is_rail(c->role[i]))
      return opc_fail(error, OPC_INVALID, "inputs",
                      "'%.*s' is no port of '%s' that may be an input", (int)n,
                      at, c->name);
    at += n;
  }
  return OPC_OK;
}

int bench_ports(bench *b, opc_error *error) {
  const eda_circuit *c = b->circuit;
  int found[] = {[EDA_PIN_SUPPLY] = 0, [EDA_PIN_GROUND] = 0};
  if (b->inputs_list && check_inputs(b, error)) return error->code;
  b->input = eda_pool_alloc(&b->pool, c->ports, sizeof *b->input);
  b->output = eda_pool_alloc(&b->pool, c->ports, sizeof *b->output);
  b->inputs = b->outputs = 0;
  for (size_t i = 0; i < c->ports; i++) {
    uint32_t net = c->port[i];
    if (is_rail(c->role[i]))
      found[c->role[i]] = 1;
    else if (b->inputs_list ? eda_in_list(b->inputs_list, c->net[net])
                            : c->role[i] == EDA_PIN_INPUT)
      b->input[b->inputs++] = net;
    else
      b->output[b->outputs++] = net;
  }
  if (found[EDA_PIN_SUPPLY] && found[EDA_PIN_GROUND]) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "circuit",
                  "'%s' has no %s among its ports", c->name,
                  found[EDA_PIN_SUPPLY] ? "ground" : "supply");
}

int bench_drives(const bench *b, opc_error *error) {
  if (b->inputs && b->outputs) return OPC_OK;
  return opc_fail(error, OPC_INVALID, "circuit",
                  "'%s' has no %s among its ports", b->circuit->name,
                  b->inputs ? "output" : "input");
}

/* ---- netlists ---- */

char *bench_netlist(const bench *b, const eda_circuit *c, int state, int sizes,
                    opc_error *error) {
  eda_annotation a = {.circuit = c,
                      .mask = b->printed,
                      .state = state,
                      .subcircuits = b->subcircuits,
                      .unit = b->unit};
  eda_mask off;
  for (int type = 0; type < 2; type++) {
    a.model[type] = b->model[type];
    if (sizes == SIZE_TIMED && b->dlc) a.card[type] = &b->card[type];
  }
  if (a.mask && sizes == SIZE_OFF) {
    off = *a.mask;
    off.before.leq_ion = off.before.leq_ioff;
    off.after.leq_ion = off.after.leq_ioff;
    a.mask = &off;
  }
  return eda_annotate(&a, NULL, error);
}

int bench_forgive(bench *b, int state, int code, const opc_error *error) {
  if (code != OPC_FAILED || state != EDA_BEFORE) return code;
  if (b->has[state])
    b->host->log(b->host, OPC_LOG_WARNING,
                 "the circuit printed before the correction has no results: %s",
                 error->message);
  b->has[state] = 0;
  return OPC_OK;
}
