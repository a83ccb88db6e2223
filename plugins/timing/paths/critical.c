/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the paths that can be the longest of a circuit, by random variation of
   the delays of its gates. */
#include <eda/random.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "gradients.h"

/* Number of random circuits, and the largest number of paths, those that are
   most often the longest. */
enum { TRIALS = 4096, MOST_PATHS = 1024 };

/* Standard deviation of the delay of a gate: common to all rising or all
   falling outputs, and of each output alone. Both exceed the variation by the
   conditions of the process and by line edges (2 to 4 %), so that the random
   circuits include rare paths. */
static const double common_sigma = 0.05, own_sigma = 0.05;

typedef struct search {
  gradients *z;
  double *time;   /* [net * 2 + rises] */
  uint32_t *last; /* arc of the latest arrival */
  uint32_t *node; /* driver of each net + 1 */
  double *factor; /* [node * 2 + rises] */
  critical_path *path;
  size_t count, capacity;
  GHashTable *known; /* id to index + 1 */
} search;

/* Return a random factor of a delay, uniform with the mean 1. */
static double factor_draw(uint64_t *seed, double sigma) {
  return 1 + sigma * sqrt(12) * (eda_random_unit(seed) - 0.5);
}

static void search_times(search *s) {
  const graph *g = s->z->graph;
  for (size_t i = 0; i < 2 * g->nets; i++) s->time[i] = -INFINITY;
  for (size_t i = 0; i < 2 * g->inputs; i++)
    s->time[g->input[i / 2] * 2 + i % 2] = 0;
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    for (size_t k = 0; k < n->cell->arcs; k++) {
      size_t rises = n->cell->arc[k].rises, to = n->net * 2 + rises;
      if (n->cell->arc[k].output != n->output) continue;
      double at = s->time[arc_from(n, k)] +
                  s->z->node[i].arc[k].delay * s->factor[2 * i + rises];
      if (!(at > s->time[to])) continue;
      s->time[to] = at;
      s->last[to] = (uint32_t)k;
    }
  }
}

/* Add the latest path to a transition, or count the path if it is known. */
static void search_trace(search *s, uint32_t to) {
  const graph *g = s->z->graph;
  uint64_t id = path_on(0, to);
  size_t arcs = 0;
  for (uint32_t at = to; s->node[at / 2]; arcs++) {
    uint32_t i = s->node[at / 2] - 1;
    id = path_on(path_on(id, i), s->last[at]);
    at = arc_from(&g->node[i], s->last[at]);
  }
  size_t known = GPOINTER_TO_SIZE(g_hash_table_lookup(s->known, &id));
  if (known) {
    s->path[known - 1].count++;
    return;
  }
  critical_path one = {.id = id, .to = to, .count = 1, .arcs = arcs};
  one.arc = eda_pool_alloc(&s->z->memory, arcs, sizeof *one.arc);
  uint32_t at = to;
  for (size_t k = 0; k < arcs; k++) {
    uint32_t i = s->node[at / 2] - 1;
    one.arc[k] = (weighted_arc){i, s->last[at], 1};
    one.time += s->z->node[i].arc[s->last[at]].delay;
    at = arc_from(&g->node[i], s->last[at]);
  }
  eda_pool_grow(&s->z->memory, &s->path, &s->capacity, s->count + 1,
                sizeof *s->path);
  s->path[s->count++] = one;
  g_hash_table_insert(s->known, g_memdup2(&id, sizeof id),
                      GSIZE_TO_POINTER(s->count));
}

/* Return the latest transition of the outputs. */
static uint32_t search_latest(const search *s) {
  const graph *g = s->z->graph;
  uint32_t best = g->output[0] * 2;
  for (size_t o = 0; o < 2 * g->outputs; o++) {
    uint32_t to = g->output[o / 2] * 2 + (uint32_t)(o % 2);
    if (s->time[to] > s->time[best]) best = to;
  }
  return best;
}

EDA_COMPARE_FALLING(by_count, critical_path, count, id);
EDA_COMPARE_FALLING(by_time, critical_path, time, id);

critical_path *critical_find(gradients *z, uint64_t seed, size_t *count,
                             double *coverage) {
  const graph *g = z->graph;
  search s = {.z = z};
  s.time = eda_pool_alloc(&z->memory, 2 * g->nets, sizeof *s.time);
  s.last = eda_pool_alloc(&z->memory, 2 * g->nets, sizeof *s.last);
  s.node = eda_pool_alloc(&z->memory, g->nets, sizeof *s.node);
  s.factor = eda_pool_alloc(&z->memory, 2 * g->nodes, sizeof *s.factor);
  s.known = g_hash_table_new_full(g_int64_hash, g_int64_equal, g_free, NULL);
  for (size_t i = 0; i < g->nodes; i++)
    s.node[g->node[i].net] = (uint32_t)i + 1;
  for (size_t i = 0; i < 2 * g->nodes; i++) s.factor[i] = 1;
  search_times(&s);
  for (size_t o = 0; o < 2 * g->outputs; o++) {
    uint32_t to = g->output[o / 2] * 2 + (uint32_t)(o % 2);
    if (!isinf(s.time[to])) search_trace(&s, to);
  }
  size_t first = s.count;
  for (int trial = 0; trial < TRIALS; trial++) {
    double common[2] = {factor_draw(&seed, common_sigma),
                        factor_draw(&seed, common_sigma)};
    for (size_t i = 0; i < 2 * g->nodes; i++)
      s.factor[i] = common[i % 2] * factor_draw(&seed, own_sigma);
    search_times(&s);
    search_trace(&s, search_latest(&s));
  }
  g_hash_table_destroy(s.known);
  /* Keep the paths to all outputs, and those that are most often the
     longest. */
  size_t more = s.count - first, covered = 0;
  qsort(s.path + first, more, sizeof *s.path, by_count);
  *count = first + (more < MOST_PATHS ? more : MOST_PATHS);
  for (size_t i = 0; i < *count; i++) covered += s.path[i].count - (i < first);
  *coverage = (double)covered / TRIALS;
  qsort(s.path, *count, sizeof *s.path, by_time);
  return s.path;
}
