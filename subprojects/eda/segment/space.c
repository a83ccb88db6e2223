/* SPDX-License-Identifier: BSD-3-Clause */
/* Free space beside each gate: from the middle of its side, the distance along
   L to the next edge of poly and to the end of the active. A sweep line moves
   in that direction over the edges that face the gates. A tree contains the
   last passed edge at each position on the sweep line. Takes O(n log n). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "segment/segment.h"

/* A sweep across d, towards `side`, over the edges of one layer. */
typedef struct look {
  const edge *edges; /* edges that face the gates, sorted by at */
  size_t count;
  int64_t *places; /* ends of the edges, doubled, sorted, unique */
  size_t n_places, leaves;
  uint32_t *latest; /* tree over places: number of the edge, from 1 */
} look;

/* Return the number of places at or before `at`. */
static size_t place_rank(const look *l, int64_t at) {
  size_t from = 0, to = l->n_places;
  while (from < to) {
    size_t middle = from + (to - from) / 2;
    if (l->places[middle] <= at)
      from = middle + 1;
    else
      to = middle;
  }
  return from;
}

static void tree_prepare(look *l) {
  l->places = eda_alloc(2 * l->count, sizeof *l->places);
  for (size_t i = 0; i < l->count; i++) {
    l->places[2 * i] = 2 * (int64_t)l->edges[i].low;
    l->places[2 * i + 1] = 2 * (int64_t)l->edges[i].high;
  }
  qsort(l->places, 2 * l->count, sizeof *l->places, eda_int64s_rise);
  for (size_t i = 0; i < 2 * l->count; i++)
    if (i == 0 || l->places[i] != l->places[i - 1])
      l->places[l->n_places++] = l->places[i];
  l->leaves = l->n_places + 1;
  l->latest = eda_alloc(2 * l->leaves, sizeof *l->latest);
}

/* Enter an edge into the tree. Leaf k covers the interval between the places
   k-1 and k. Numbers grow in the order of the sweep, so the largest number over
   a place is the latest edge. */
static void tree_enter(look *l, const edge *e, uint32_t number) {
  size_t from = place_rank(l, 2 * (int64_t)e->low) + l->leaves;
  size_t to = place_rank(l, 2 * (int64_t)e->high) + l->leaves;
  for (; from < to; from /= 2, to /= 2) {
    if (from & 1) l->latest[from++] = number;
    if (to & 1) l->latest[--to] = number;
  }
}

static uint32_t tree_latest(const look *l, int64_t at) {
  uint32_t best = 0;
  for (size_t k = place_rank(l, at) + l->leaves; k; k /= 2)
    if (l->latest[k] > best) best = l->latest[k];
  return best;
}

/* A gate and the coordinate of its side. */
typedef struct key {
  int32_t at;
  uint32_t gate;
} key;

EDA_COMPARE_RISING(by_key, key, at, gate);

/* Compute the distance from each gate across d to the next edge of the layer on
   a side, nm, in distance[gate]; INFINITY without an edge. An edge on the side
   of the gate itself has the distance 0. */
static void run_look(const segment *s, int layer, int d, int side,
                     const key *keys, size_t n, double *distance) {
  const edge_index *x = &s->index[layer];
  /* Poly starts with the edge on its near side; active ends with the edge on
     its far side. */
  int facing = layer == EDA_POLY ? !side : side;
  size_t first = x->first[2 * d + facing];
  look l = {.edges = x->edges + first,
            .count = x->first[2 * d + facing + 1] - first};
  tree_prepare(&l);
  size_t done = 0;
  for (size_t i = 0; i < n; i++) {
    const key *k = &keys[side ? n - 1 - i : i];
    for (; done < l.count; done++) {
      const edge *e = &l.edges[side ? l.count - 1 - done : done];
      if (side ? e->at < k->at : e->at > k->at) break;
      tree_enter(&l, e, (uint32_t)done + 1);
    }
    const eda_box *b = &s->gates->box[k->gate];
    uint32_t found =
        tree_latest(&l, (int64_t)box_side(b, !d, LOW) + box_side(b, !d, HIGH));
    distance[k->gate] = INFINITY;
    if (!found) continue;
    const edge *e = &l.edges[side ? l.count - found : found - 1];
    distance[k->gate] = s->grid * fabs((double)e->at - k->at);
  }
  free(l.places);
  free(l.latest);
}

static void look_both(segment *s, int d, int side, key *keys, double *poly,
                      double *active) {
  eda_gates *g = s->gates;
  size_t n = 0;
  for (size_t i = 0; i < g->count; i++)
    if (g->axis[i] == d)
      keys[n++] = (key){box_side(&g->box[i], d, side), (uint32_t)i};
  qsort(keys, n, sizeof *keys, by_key);
  run_look(s, EDA_POLY, d, side, keys, n, poly);
  run_look(s, EDA_ACTIVE, d, side, keys, n, active);
  for (size_t k = 0; k < n; k++) {
    size_t i = keys[k].gate;
    double open = 2 * fmax(active[i], g->length[i]);
    g->space[2 * i + side] = fmin(fmin(poly[i], open), EDA_SEGMENT_REACH);
  }
}

void segment_space(segment *s) {
  size_t n = s->gates->count;
  key *keys = eda_alloc(n, sizeof *keys);
  double *poly = eda_alloc(n, sizeof *poly);
  double *active = eda_alloc(n, sizeof *active);
  for (int d = 0; d < 2; d++)
    for (int side = 0; side < 2; side++)
      look_both(s, d, side, keys, poly, active);
  free(keys);
  free(poly);
  free(active);
}
