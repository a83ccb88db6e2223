/* SPDX-License-Identifier: BSD-3-Clause */
#include "bins.h"

#include <stdlib.h>

enum { MOST_SQUARES = 1 << 22 };

static int32_t clamp(int64_t v, int32_t high) {
  return (int32_t)(v < 0 ? 0 : v > high ? high : v);
}

/* The squares a box touches, as columns x0 .. x1 and rows y0 .. y1. */
static opc_box squares(const bins *b, opc_box box) {
  return (opc_box){
      clamp(((int64_t)box.x0 - b->extent.x0) / b->side, b->nx - 1),
      clamp(((int64_t)box.y0 - b->extent.y0) / b->side, b->ny - 1),
      clamp(((int64_t)box.x1 - b->extent.x0) / b->side, b->nx - 1),
      clamp(((int64_t)box.y1 - b->extent.y0) / b->side, b->ny - 1)};
}

/* Count the boxes in each square or, where items are, place them. */
static void scatter(const bins *b, uint32_t *at) {
  for (size_t i = 0; i < b->n; i++) {
    opc_box q = squares(b, b->box[i]);
    for (int32_t y = q.y0; y <= q.y1; y++)
      for (int32_t x = q.x0; x <= q.x1; x++) {
        size_t square = (size_t)y * (size_t)b->nx + (size_t)x;
        if (b->item) b->item[at[square]] = (uint32_t)i;
        at[square]++;
      }
  }
}

static opc_box extent_of(const opc_box *box, size_t n) {
  opc_box e = n ? box[0] : (opc_box){0};
  for (size_t i = 1; i < n; i++) {
    if (box[i].x0 < e.x0) e.x0 = box[i].x0;
    if (box[i].y0 < e.y0) e.y0 = box[i].y0;
    if (box[i].x1 > e.x1) e.x1 = box[i].x1;
    if (box[i].y1 > e.y1) e.y1 = box[i].y1;
  }
  return e;
}

int bins_make(bins *b, opc_box *box, size_t n, int32_t side) {
  *b = (bins){0};
  if (!box) return 0;
  *b = (bins){.extent = extent_of(box, n), .side = side, .box = box, .n = n};
  int64_t width = (int64_t)b->extent.x1 - b->extent.x0;
  int64_t height = (int64_t)b->extent.y1 - b->extent.y0;
  while ((width / b->side + 1) * (height / b->side + 1) > MOST_SQUARES)
    b->side *= 2;
  b->nx = (int32_t)(width / b->side) + 1;
  b->ny = (int32_t)(height / b->side) + 1;
  size_t m = (size_t)b->nx * (size_t)b->ny;
  uint32_t *at = calloc(m + 1, sizeof *at);
  b->start = calloc(m + 1, sizeof *b->start);
  if (at && b->start) {
    scatter(b, at);
    for (size_t i = 0; i < m; i++) b->start[i + 1] = b->start[i] + at[i];
    for (size_t i = 0; i < m; i++) at[i] = b->start[i];
    b->item = malloc(sizeof *b->item * ((size_t)b->start[m] + 1));
    if (b->item) scatter(b, at);
  }
  free(at);
  if (!b->item) bins_clear(b);
  return b->item != NULL;
}

void bins_clear(bins *b) {
  free(b->start);
  free(b->item);
  free(b->box);
  *b = (bins){0};
}

void bins_visit(const bins *b, opc_box window,
                void (*visit)(void *data, uint32_t i), void *data) {
  opc_box q = squares(b, window);
  for (int32_t y = q.y0; y <= q.y1; y++)
    for (int32_t x = q.x0; x <= q.x1; x++) {
      size_t square = (size_t)y * (size_t)b->nx + (size_t)x;
      for (uint32_t k = b->start[square]; k < b->start[square + 1]; k++) {
        opc_box e = b->box[b->item[k]], s;
        if (e.x0 > window.x1 || e.x1 < window.x0 || e.y0 > window.y1 ||
            e.y1 < window.y0)
          continue;
        /* In the first of the squares that both have only. */
        s = squares(b, e);
        if (x == (s.x0 > q.x0 ? s.x0 : q.x0) &&
            y == (s.y0 > q.y0 ? s.y0 : q.y0))
          visit(data, b->item[k]);
      }
    }
}

opc_box *bins_edges(const opc_shapes *s, size_t *n) {
  *n = s->count ? s->start[s->count] : 0;
  opc_box *out = malloc((*n + 1) * sizeof *out);
  for (size_t p = 0; out && p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      opc_point a = s->points[i];
      opc_point b = s->points[i + 1 < s->start[p + 1] ? i + 1 : s->start[p]];
      out[i] = (opc_box){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                         a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
    }
  return out;
}

opc_box bins_window(opc_box w, int side, int32_t from, int32_t to,
                    int32_t beside) {
  if (side == LEFT || side == RIGHT) {
    w.y0 -= beside;
    w.y1 += beside;
  } else {
    w.x0 -= beside;
    w.x1 += beside;
  }
  switch (side) {
    case LEFT: w.x1 = w.x0 - from, w.x0 -= to; break;
    case RIGHT: w.x0 = w.x1 + from, w.x1 += to; break;
    case BELOW: w.y1 = w.y0 - from, w.y0 -= to; break;
    default: w.y0 = w.y1 + from, w.y1 += to; break;
  }
  return w;
}

typedef struct search {
  const bins *b;
  opc_box window;
  int side;
  int32_t found;
  opc_box which;
} search;

static void nearer(void *data, uint32_t i) {
  search *s = data;
  opc_box e = s->b->box[i], w = s->window;
  if (e.x0 >= w.x1 || e.x1 <= w.x0 || e.y0 >= w.y1 || e.y1 <= w.y0) return;
  int32_t d = s->side == LEFT    ? w.x1 - e.x1
              : s->side == RIGHT ? e.x0 - w.x0
              : s->side == BELOW ? w.y1 - e.y1
                                 : e.y0 - w.y0;
  if (d < 0) d = 0;
  if (d < s->found) s->found = d, s->which = e;
}

int32_t bins_nearest(const bins *b, opc_box window, int side, int32_t none,
                     opc_box *which) {
  search s = {b, window, side, none, {0}};
  bins_visit(b, window, nearer, &s);
  if (which && s.found < none) *which = s.which;
  return s.found;
}

typedef struct containing {
  const bins *b;
  opc_point p;
  int found;
} containing;

static void contains(void *data, uint32_t i) {
  containing *c = data;
  opc_box e = c->b->box[i];
  if (c->p.x > e.x0 && c->p.x < e.x1 && c->p.y > e.y0 && c->p.y < e.y1)
    c->found = 1;
}

int bins_inside(const bins *b, opc_point p) {
  containing c = {b, p, 0};
  bins_visit(b, (opc_box){p.x, p.y, p.x, p.y}, contains, &c);
  return c.found;
}
