/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the alignment of added shapes by a search for the mask edges
   beside each of their sides. */
#include "align.h"

#include <eda/index.h>
#include <eda/memory.h>
#include <stdlib.h>

#include <correct/start.h>

/* Return the boxes of all edges of a layer, and their number. */
static eda_box *find_edges(const eda_shapes *s, size_t *count) {
  eda_box *edge = eda_alloc(s->count ? s->start[s->count] : 0, sizeof *edge);
  *count = 0;
  for (size_t k = 0; k < s->count; k++)
    for (uint32_t i = s->start[k]; i < s->start[k + 1]; i++) {
      eda_point ends[] = {
          s->points[i],
          s->points[i + 1 < s->start[k + 1] ? i + 1 : s->start[k]]};
      edge[(*count)++] = eda_bounds(ends, 2);
    }
  return edge;
}

/* Return the coordinate of a side of a box: one step outwards if a mask edge is
   there, and none at the side. `side`: box of the side; `upright`: 1: parallel
   to y; `out`: outward step, 1 or -1. */
static int32_t align_side(const eda_index *index, const eda_box *edge,
                          eda_box side, int upright, int32_t out) {
  int32_t at = upright ? side.x0 : side.y0, found = at;
  eda_finder f = eda_index_find(index, eda_box_grown(side, 1));
  for (uint32_t k; eda_index_next(&f, &k);) {
    eda_box e = edge[k];
    if (upright ? e.x0 != e.x1 : e.y0 != e.y1) continue;
    int32_t to = upright ? e.x0 : e.y0;
    if (to == at) return at;
    if (to == at + out) found = to;
  }
  return found;
}

static eda_box align_box(const eda_index *index, const eda_box *edge,
                         eda_box b) {
  const eda_box sides[] = {{b.x0, b.y0, b.x0, b.y1},
                           {b.x0, b.y0, b.x1, b.y0},
                           {b.x1, b.y0, b.x1, b.y1},
                           {b.x0, b.y1, b.x1, b.y1}};
  int32_t to[4];
  for (int k = 0; k < 4; k++)
    to[k] = align_side(index, edge, sides[k], k % 2 == 0, k < 2 ? -1 : 1);
  return (eda_box){to[0], to[1], to[2], to[3]};
}

static void align_layer(const eda_gates *g, size_t layer, eda_moved *m) {
  eda_box_list *const lists[] = {&m->added[layer], &m->cutouts[layer]};
  eda_shapes polygons;
  size_t n;
  if (!lists[0]->count && !lists[1]->count) return;
  correct_start_polygons(g, m, layer, &polygons);
  eda_box *edge = find_edges(&polygons, &n);
  eda_index *index = eda_index_new(edge, n, 0);
  for (int k = 0; k < 2; k++)
    for (size_t i = 0; i < lists[k]->count; i++)
      lists[k]->box[i] = align_box(index, edge, lists[k]->box[i]);
  eda_index_free(index);
  free(edge);
  eda_shapes_clear(&polygons);
}

void align_boxes(const eda_chip *c, const eda_gates *g, eda_moved *m) {
  for (size_t k = 0; c->placed && k < g->layers; k++)
    if (g->corrected[k]) align_layer(g, k, m);
}
