/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the search for boxes and edges near a position. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "drc.h"

eda_box box_between(eda_point a, eda_point b) {
  return (eda_box){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                   a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
}

void places_init(places *p, eda_box *box, size_t n, double nm, double grid) {
  *p = (places){box, n, eda_index_new(box, n, (int32_t)(nm / grid) + 1)};
}

void places_clear(places *p) {
  eda_index_free(p->index);
  free(p->box);
  *p = (places){0};
}

eda_box *shapes_edges(const eda_shapes *s, size_t *n) {
  *n = s->count ? s->start[s->count] : 0;
  eda_box *out = eda_alloc(*n, sizeof *out);
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t next = i + 1 < s->start[p + 1] ? i + 1 : s->start[p];
      out[i] = box_between(s->points[i], s->points[next]);
    }
  return out;
}

eda_box box_window(eda_box w, int side, int32_t from, int32_t to,
                   int32_t beside) {
  if (side_upright(side)) {
    w.y0 -= beside;
    w.y1 += beside;
  } else {
    w.x0 -= beside;
    w.x1 += beside;
  }
  switch (side) {
    case LEFT:
      w.x1 = w.x0 - from, w.x0 -= to;
      break;
    case RIGHT:
      w.x0 = w.x1 + from, w.x1 += to;
      break;
    case BELOW:
      w.y1 = w.y0 - from, w.y0 -= to;
      break;
    default:
      w.y0 = w.y1 + from, w.y1 += to;
      break;
  }
  return w;
}

/* Return the distance of an edge from the side of a window that the search
   begins at. */
static int32_t edge_distance(eda_box w, eda_box e, int side) {
  return side == LEFT    ? w.x1 - e.x1
         : side == RIGHT ? e.x0 - w.x0
         : side == BELOW ? w.y1 - e.y1
                         : e.y0 - w.y0;
}

int32_t places_nearest(const places *p, eda_box w, int side, int32_t none,
                       eda_box *which) {
  int32_t found = none;
  eda_finder f = eda_index_find(p->index, w);
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box e = p->box[i];
    if (!eda_boxes_overlap(e, w)) continue;
    int32_t d = edge_distance(w, e, side);
    if (d < 0) d = 0;
    if (d >= found) continue;
    found = d;
    if (which) *which = e;
  }
  return found;
}

int32_t mask_spacing(drc *r, const eda_printed *p, eda_box edge, int side,
                     int32_t most) {
  int32_t space = (int32_t)ceil(r->min_space / r->grid - 1e-9);
  int32_t range = most + space;
  if (most < 1) return 0;
  if (!r->mask.index) {
    size_t n;
    eda_box *edges = shapes_edges(&p->shapes[EDA_POLY], &n);
    places_init(&r->mask, edges, n, 4 * r->min_space, r->grid);
  }
  eda_box window = box_window(edge, side, 1, range, space);
  int32_t left =
      places_nearest(&r->mask, window, side, range - 1, NULL) + 1 - space;
  return left < 0 ? 0 : left < most ? left : most;
}
