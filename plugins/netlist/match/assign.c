/* SPDX-License-Identifier: BSD-3-Clause */
/* Assigns the devices of a bundle to gates of its counterpart. All devices have
   the same nets, so the choice is by size, then by place, then by order. */
#include <math.h>
#include <stdio.h>

#include "graph.h"

double match_slack(const match_task *j, double nominal) {
  return fmax(j->tolerance * nominal, j->gates->grid) * (1 + 1e-9);
}

static int refuse_device(graph *g, const eda_transistor *d, const char *fault) {
  char where[256];
  return opc_fail(
      g->j->error, OPC_INVALID, "file",
      "netlist device '%.100s%s%.100s' (%s) %s", g->group->path,
      *g->group->path ? "/" : "", d->name,
      eda_netlist_where(&g->j->netlist, d->from, where, sizeof where), fault);
}

/* ---- sizes ---- */

static int check_length(graph *g, const eda_transistor *d, uint32_t gate) {
  const match_task *j = g->j;
  double drawn = j->gates->length[gate];
  char name[256], fault[400];
  if (fabs(drawn - d->length) <= match_slack(j, d->length)) return OPC_OK;
  snprintf(fault, sizeof fault, "has L %.6g nm, but the gate '%s' has %.6g nm",
           d->length, match_gate_name(j, gate, name, sizeof name), drawn);
  return refuse_device(g, d, fault);
}

static int check_width(graph *g, const eda_transistor *d, const uint32_t *gates,
                       uint32_t n) {
  const match_task *j = g->j;
  double drawn = 0;
  for (uint32_t i = 0; i < n; i++) drawn += j->gates->width[gates[i]];
  char name[256], fault[400];
  if (fabs(drawn - d->width) <=
      fmax(match_slack(j, d->width), n * j->gates->grid))
    return OPC_OK;
  match_gate_name(j, gates[0], name, sizeof name);
  if (n > 1)
    snprintf(fault, sizeof fault,
             "has W %.6g nm, but the %u gates ('%s' ...) have %.6g nm",
             d->width, n, name, drawn);
  else
    snprintf(fault, sizeof fault,
             "has W %.6g nm, but the gate '%s' has %.6g nm", d->width, name,
             drawn);
  return refuse_device(g, d, fault);
}

/* ---- choices ---- */

typedef struct choice {
  graph *g;
  const eda_transistor *device;
  const uint32_t *gate; /* gates of the bundle */
  uint8_t *taken;
  uint32_t gates, first_free, left;
} choice;

/* Return the free gate of matching size nearest to the device, or the first
   such gate if the device has no place. If no size matches, return the first
   free gate. */
static uint32_t best_gate(const choice *c, double width) {
  const match_task *j = c->g->j;
  const eda_gates *o = j->gates;
  const eda_transistor *d = c->device;
  nm_point stated = graph_place(c->g, d);
  uint32_t best = UINT32_MAX;
  double least = INFINITY;
  for (uint32_t i = c->first_free; i < c->gates && least > 0; i++) {
    uint32_t gate = c->gate[i];
    if (c->taken[i]) continue;
    int misfit =
        fabs(o->length[gate] - d->length) > match_slack(j, d->length) ||
        (width > 0 && fabs(o->width[gate] - width) > match_slack(j, width));
    double cost = graph_distance(stated, graph_middle(j, gate));
    if (misfit) cost += 1e30;
    if (cost < least) {
      least = cost;
      best = i;
    }
  }
  return best;
}

static void choice_take(choice *c, uint32_t at) {
  c->taken[at] = 1;
  c->left--;
  while (c->first_free < c->gates && c->taken[c->first_free]) c->first_free++;
}

/* Assign gates to a device: one gate if `one_each` is set, all gates if `alone`
   is set. Otherwise one gate for each finger or, if `fingers` is 0, gates up to
   the width of the device. */
static int take_gates(choice *c, uint32_t owner, int alone, int one_each) {
  graph *g = c->g;
  const eda_transistor *d = c->device;
  const eda_gates *o = g->j->gates;
  uint32_t *mine = eda_pool_alloc(&g->j->pool, c->left, sizeof *mine), n = 0;
  uint32_t stated = one_each ? 1 : d->fingers,
           most = one_each || !alone ? stated : 0;
  double width = stated ? d->width / stated : 0, sum = 0;
  double enough =
      stated || alone ? INFINITY : d->width - match_slack(g->j, d->width);
  while (c->left && (!most || n < most) && sum < enough) {
    uint32_t at = best_gate(c, width);
    choice_take(c, at);
    mine[n++] = c->gate[at];
    sum += o->width[c->gate[at]];
    g->j->owner[c->gate[at]] = owner;
    if (check_length(g, d, c->gate[at])) return g->j->error->code;
  }
  if (!n) return refuse_device(g, d, "has no gate in the layout");
  return check_width(g, d, mine, n);
}

int graph_assign(graph *g, const bundle *devices, const bundle *gates) {
  match_task *j = g->j;
  const side *n = &g->side[NETLIST], *l = &g->side[LAYOUT];
  choice c = {.g = g,
              .gate = l->member + gates->first,
              .gates = gates->count,
              .left = gates->count};
  c.taken = eda_pool_alloc(&j->pool, c.gates, 1);
  int one_each = devices->count == gates->count;
  if (isnan(devices->middle.x)) j->by_order += devices->count - 1;
  for (uint32_t i = 0; i < devices->count; i++) {
    uint32_t at = n->member[devices->first + i];
    c.device = &g->flat.device[at];
    uint32_t owner = (uint32_t)g->group->first_device + at;
    if (take_gates(&c, owner, devices->count == 1, one_each))
      return j->error->code;
  }
  if (!c.left) return OPC_OK;
  char name[256];
  return opc_fail(j->error, OPC_INVALID, "file",
                  "transistor '%s' is not in the netlist",
                  match_gate_name(j, c.gate[c.first_free], name, sizeof name));
}
