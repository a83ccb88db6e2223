/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements partition refinement: splits classes whose nodes have different
   neighbours until no such class remains. Both sides are refined together, so
   that a class contains possible counterparts. */
#include <stdlib.h>
#include <string.h>

#include "graph.h"

void partition_make(const graph *g, partition *p) {
  eda_pool *m = &g->j->pool;
  size_t n = g->nodes;
  *p = (partition){.g = g, .classes = 1};
  p->class_of = eda_pool_alloc(m, n, sizeof *p->class_of);
  p->order = eda_pool_alloc(m, n, sizeof *p->order);
  p->begin = eda_pool_alloc(m, n + 1, sizeof *p->begin);
  p->end = eda_pool_alloc(m, n + 1, sizeof *p->end);
  p->parent = eda_pool_alloc(m, n + 1, sizeof *p->parent);
  p->touched = eda_pool_alloc(m, n + 1, 1);
  p->mark = eda_pool_alloc(m, n, sizeof *p->mark);
  p->list = eda_pool_alloc(m, n + 1, sizeof *p->list);
  p->changed = eda_pool_alloc(m, n + 1, sizeof *p->changed);
  p->spare = eda_pool_alloc(m, n + 1, sizeof *p->spare);
  for (uint32_t i = 0; i < n; i++) {
    p->order[i] = i;
    p->mark[i] = i < g->bundle0[NETLIST] ? 0 : 1 + graph_bundle(g, i)->type;
  }
  for (int s = 0; s < SIDES; s++)
    for (uint32_t i = 0; i < g->side[s].nets; i++)
      if (g->side[s].seed[i])
        p->mark[g->net0[s] + i] = graph_hash(g->side[s].seed[i]);
  p->end[0] = (uint32_t)n;
  partition_split(p, 0);
  /* At the start, all nodes count as changed. */
  for (uint32_t i = 0; i < n; i++) p->changed[i] = i;
  p->n_changed = (uint32_t)n;
}

static uint32_t run_end(const partition *p, const uint32_t *nodes, uint32_t i,
                        uint32_t n) {
  uint32_t k = i + 1;
  while (k < n && p->mark[nodes[k]] == p->mark[nodes[i]]) k++;
  return k;
}

static int nodes_balanced(const partition *p, const uint32_t *nodes,
                          uint32_t n) {
  uint32_t layout = 0;
  for (uint32_t i = 0; i < n; i++)
    layout += (uint32_t)graph_side(p->g, nodes[i]);
  return 2 * layout == n;
}

/* Make the last nodes of a class a new class. */
static void split_off(partition *p, uint32_t class, uint32_t from,
                      uint32_t to) {
  uint32_t made = p->classes++;
  p->begin[made] = from;
  p->end[made] = to;
  p->parent[made] = class;
  for (uint32_t i = from; i < to; i++) {
    p->class_of[p->order[i]] = made;
    p->changed[p->n_changed++] = p->order[i];
  }
  if (!nodes_balanced(p, p->order + from, to - from)) p->odd = 1;
}

void partition_split(partition *p, uint32_t class) {
  uint32_t b = p->begin[class], n = p->end[class] - b;
  uint32_t *nodes = p->order + b, big = 0, big_end = 0;
  if (!n) return;
  graph_sort(nodes, n, p->mark);
  for (uint32_t i = 0, k; i < n; i = k) {
    k = run_end(p, nodes, i, n);
    if (k - i > big_end - big) {
      big = i;
      big_end = k;
    }
  }
  uint32_t kept = big_end - big;
  if (kept < n) {
    /* The largest part keeps the class and moves to the front, so that its
       neighbours do not count as changed. */
    memcpy(p->spare, nodes + big, kept * sizeof *nodes);
    memmove(nodes + kept, nodes, big * sizeof *nodes);
    memcpy(nodes, p->spare, kept * sizeof *nodes);
    p->end[class] = b + kept;
    for (uint32_t i = kept, k; i < n; i = k) {
      k = run_end(p, nodes, i, n);
      split_off(p, class, b + i, b + k);
    }
  }
  if (!nodes_balanced(p, nodes, kept)) p->odd = 1;
}

static void mark_class(partition *p, uint32_t class) {
  const graph *g = p->g;
  for (uint32_t i = p->begin[class]; i < p->end[class]; i++) {
    uint32_t node = p->order[i];
    uint64_t sum = 0;
    for (uint32_t k = g->start[node]; k < g->start[node + 1]; k++)
      sum += graph_mix(p->class_of[g->links[k].node], g->links[k].role);
    p->mark[node] = sum;
  }
}

int partition_refine(partition *p) {
  const graph *g = p->g;
  while (p->n_changed && !p->odd) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < p->n_changed; i++) {
      uint32_t node = p->changed[i];
      for (uint32_t k = g->start[node]; k < g->start[node + 1]; k++) {
        uint32_t class = p->class_of[g->links[k].node];
        if (p->touched[class] || p->end[class] - p->begin[class] < 2) continue;
        p->touched[class] = 1;
        p->list[n++] = class;
      }
    }
    p->n_changed = 0;
    for (uint32_t i = 0; i < n; i++) {
      p->touched[p->list[i]] = 0;
      mark_class(p, p->list[i]);
      partition_split(p, p->list[i]);
    }
  }
  p->n_changed = 0;
  return !p->odd;
}

void partition_pick(partition *p, uint32_t a, uint32_t b) {
  uint32_t class = p->class_of[a], end = p->end[class];
  uint32_t picked[2] = {a, b};
  for (int k = 0; k < 2; k++) {
    uint32_t at = p->begin[class];
    while (p->order[at] != picked[k]) at++;
    end--;
    p->order[at] = p->order[end];
    p->order[end] = picked[k];
  }
  p->end[class] = end;
  split_off(p, class, end, end + 2);
}

void partition_undo(partition *p, uint32_t classes) {
  while (p->classes > classes) {
    uint32_t last = --p->classes, parent = p->parent[last];
    for (uint32_t i = p->begin[last]; i < p->end[last]; i++)
      p->class_of[p->order[i]] = parent;
    if (p->end[parent] < p->end[last]) p->end[parent] = p->end[last];
  }
  p->odd = 0;
  p->n_changed = 0;
}
