/* SPDX-License-Identifier: BSD-3-Clause */
/* Matches the devices and gates of a group, a subcircuit and its part of the
   layout. The criteria are connectivity, then size, labels of inner nets, and
   place, and finally order. */
#include <math.h>
#include <stdlib.h>

#include "graph.h"

/* ---- hints; contradictory hints are dropped ---- */

typedef struct sized {
  double value;
  uint32_t node;
} sized;

EDA_COMPARE_RISING(by_value, sized, value, node);

/* Mark the nodes of a class by length or width, equal within the tolerance. */
static void mark_sizes(partition *p, uint32_t class, int by_width,
                       sized *list) {
  const match_task *j = p->g->j;
  uint32_t n = 0;
  for (uint32_t i = p->begin[class]; i < p->end[class]; i++) {
    const bundle *b = graph_bundle(p->g, p->order[i]);
    list[n++] = (sized){by_width ? b->width : b->length, p->order[i]};
  }
  qsort(list, n, sizeof *list, by_value);
  uint64_t mark = 0;
  for (uint32_t i = 0; i < n; i++) {
    if (i && list[i].value - list[i - 1].value >
                 fmax(j->tolerance * list[i].value, j->gates->grid))
      mark++;
    p->mark[list[i].node] = mark;
  }
}

static void mark_names(partition *p, uint32_t class) {
  const graph *g = p->g;
  for (uint32_t i = p->begin[class]; i < p->end[class]; i++) {
    uint32_t node = p->order[i];
    int s = graph_side(g, node);
    p->mark[node] = graph_hash(g->side[s].name[node - g->net0[s]]);
  }
}

/* Split a class by its marks and refine. Undo the splits if netlist and layout
   then differ. */
static void try_marks(partition *p, uint32_t class) {
  uint32_t before = p->classes;
  partition_split(p, class);
  if (!partition_refine(p)) partition_undo(p, before);
}

/* Split classes of nets by labels, and classes of bundles by length, then by
   width. */
static void take_hints(partition *p) {
  const graph *g = p->g;
  sized *list = eda_pool_alloc(&g->j->pool, g->nodes, sizeof *list);
  for (uint32_t class = 0; class < p->classes; class ++) {
    int is_net = p->order[p->begin[class]] < g->bundle0[NETLIST];
    for (int k = 0; k < 2; k++) {
      if (p->end[class] - p->begin[class] <= 2) break;
      if (is_net)
        mark_names(p, class);
      else
        mark_sizes(p, class, k, list);
      try_marks(p, class);
    }
  }
}

/* ---- choices ---- */

/* List the layout bundles in the class of a netlist bundle, sorted by distance.
   Return their number. */
static uint32_t gate_candidates(const partition *p, uint32_t node,
                                sized *list) {
  const graph *g = p->g;
  const bundle *b = graph_bundle(g, node);
  uint32_t class = p->class_of[node], n = 0;
  for (uint32_t i = p->begin[class]; i < p->end[class]; i++) {
    uint32_t at = p->order[i];
    if (graph_side(g, at) != LAYOUT) continue;
    double far = graph_distance(graph_bundle(g, at)->middle, b->middle);
    list[n++] = (sized){far, at};
  }
  qsort(list, n, sizeof *list, by_value);
  return n;
}

/* Choose a counterpart, with backtracking. Nodes of a class have equal
   connectivity, so the first candidate is almost always valid. */
static int choose_counterpart(partition *p, uint32_t node, sized *list) {
  uint32_t n = gate_candidates(p, node, list);
  match_task *j = p->g->j;
  j->by_order += isnan(graph_bundle(p->g, node)->middle.x);
  for (uint32_t i = 0; i < n; i++) {
    uint32_t before = p->classes;
    partition_pick(p, node, list[i].node);
    if (partition_refine(p)) return 1;
    partition_undo(p, before);
  }
  return 0;
}

/* Refine until every bundle has one counterpart. Return 1 on success. */
static int partition_solve(partition *p) {
  const graph *g = p->g;
  if (p->odd || !partition_refine(p)) return 0;
  take_hints(p);
  sized *list = eda_pool_alloc(&g->j->pool, g->nodes, sizeof *list);
  for (uint32_t i = 0; i < g->side[NETLIST].bundles; i++) {
    uint32_t node = g->bundle0[NETLIST] + i, class = p->class_of[node];
    if (p->end[class] - p->begin[class] > 2 &&
        !choose_counterpart(p, node, list))
      return 0;
  }
  return 1;
}

/* ---- all groups ---- */

static uint32_t node_counterpart(const partition *p, uint32_t node) {
  uint32_t class = p->class_of[node];
  uint32_t a = p->order[p->begin[class]], b = p->order[p->begin[class] + 1];
  return a == node ? b : a;
}

/* Return 1 if the nets of a netlist bundle correspond to those of a layout
   bundle. Source and drain may be exchanged. */
static int bundle_corresponds(const partition *p, const bundle *a,
                              const bundle *b) {
  const graph *g = p->g;
  const uint32_t *of = p->class_of;
  uint32_t n = g->net0[NETLIST], l = g->net0[LAYOUT];
  if (of[n + a->gate] != of[l + b->gate] || a->type != b->type) return 0;
  return (of[n + a->a] == of[l + b->a] && of[n + a->b] == of[l + b->b]) ||
         (of[n + a->a] == of[l + b->b] && of[n + a->b] == of[l + b->a]);
}

static int solve_group(match_task *j, const region *group) {
  graph g;
  partition p;
  if (graph_make(j, group, &g)) return j->error->code;
  partition_make(&g, &p);
  if (!partition_solve(&p)) return graph_report(&g);
  for (uint32_t i = 0; i < g.side[NETLIST].bundles; i++) {
    const bundle *a = &g.side[NETLIST].bundle[i];
    const bundle *b =
        graph_bundle(&g, node_counterpart(&p, g.bundle0[NETLIST] + i));
    if (!bundle_corresponds(&p, a, b)) return graph_report(&g);
    if (graph_assign(&g, a, b)) return j->error->code;
  }
  return OPC_OK;
}

int match_solve(match_task *j) {
  j->owner = match_unknown(j, j->gates->count);
  j->known = match_unknown(j, j->nets);
  for (size_t k = 0; k < j->groups; k++) {
    if (solve_group(j, &j->group[k])) return j->error->code;
    if (opc_cancelled(j->host->context))
      return opc_fail(j->error, OPC_CANCELLED, NULL, "cancelled");
  }
  for (size_t i = 0; i < j->gates->count; i++)
    if (j->owner[i] == UINT32_MAX) {
      char name[256];
      return opc_fail(j->error, OPC_INVALID, "file",
                      "transistor '%s' is not in the netlist",
                      match_gate_name(j, i, name, sizeof name));
    }
  return OPC_OK;
}
