/* SPDX-License-Identifier: BSD-3-Clause */
/* Line ends look outwards through a window; the drawn poly edges are kept in
   the squares of a grid, so that each window meets only what is near. */
#include "clearance.h"

#include <stdlib.h>

typedef struct bins {
  opc_box extent;
  int32_t side;           /* of a square */
  int32_t nx, ny;
  uint32_t *start;        /* nx * ny + 1 */
  opc_box *edge;          /* by square */
} bins;

static opc_box edge_box(opc_point a, opc_point b) {
  return (opc_box){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                   a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
}

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

/* Count (edge NULL) or place all edges of the shapes. */
static void scatter(bins *b, const opc_shapes *s, uint32_t *at) {
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t next = i + 1 < s->start[p + 1] ? i + 1 : s->start[p];
      opc_box e = edge_box(s->points[i], s->points[next]);
      opc_box q = squares(b, e);
      for (int32_t y = q.y0; y <= q.y1; y++)
        for (int32_t x = q.x0; x <= q.x1; x++) {
          size_t square = (size_t)y * (size_t)b->nx + (size_t)x;
          if (b->edge) b->edge[at[square]] = e;
          at[square]++;
        }
    }
}

static int fill(bins *b, const opc_shapes *s) {
  size_t n = (size_t)b->nx * (size_t)b->ny;
  uint32_t *at = calloc(n + 1, sizeof *at);
  b->start = calloc(n + 1, sizeof *b->start);
  if (at && b->start) {
    scatter(b, s, at);
    for (size_t i = 0; i < n; i++) b->start[i + 1] = b->start[i] + at[i];
    for (size_t i = 0; i < n; i++) at[i] = b->start[i];
    b->edge = malloc(sizeof *b->edge * (b->start[n] + 1));
    if (b->edge) scatter(b, s, at);
  }
  free(at);
  return b->edge != NULL;
}

/* The nearest edge in `window`, as a distance from its side `role` faces away
   from. */
static int32_t nearest(const bins *b, opc_box window, int horizontal, int high,
                       int32_t range) {
  opc_box q = squares(b, window);
  int32_t found = range;
  for (int32_t y = q.y0; y <= q.y1; y++)
    for (int32_t x = q.x0; x <= q.x1; x++) {
      size_t square = (size_t)y * (size_t)b->nx + (size_t)x;
      for (uint32_t i = b->start[square]; i < b->start[square + 1]; i++) {
        opc_box e = b->edge[i];
        if (e.x0 >= window.x1 || e.x1 <= window.x0 || e.y0 >= window.y1 ||
            e.y1 <= window.y0)
          continue;
        int32_t d = horizontal ? (high ? e.x0 - window.x0 : window.x1 - e.x1)
                               : (high ? e.y0 - window.y0 : window.y1 - e.y1);
        if (d < 0) d = 0;
        if (d < found) found = d;
      }
    }
  return found;
}

/* The window outwards from a line end fragment, without its own edge. */
static opc_box window_of(opc_box end, int horizontal, int high, int32_t range,
                         int32_t beside) {
  opc_box w = end;
  if (horizontal) {   /* looks along x */
    w.y0 -= beside, w.y1 += beside;
    if (high) w.x0 = end.x0 + 1, w.x1 = end.x0 + range;
    else w.x1 = end.x0 - 1, w.x0 = end.x0 - range;
  } else {
    w.x0 -= beside, w.x1 += beside;
    if (high) w.y0 = end.y0 + 1, w.y1 = end.y0 + range;
    else w.y1 = end.y0 - 1, w.y0 = end.y0 - range;
  }
  return w;
}

int opc_line_end_clearance(const opc_gates *g, int32_t range, int32_t beside,
                           int32_t *out) {
  for (size_t i = 0; i < 2 * g->count; i++) out[i] = range;
  bins b = {.extent = g->extent, .side = range > 64 ? range : 64};
  /* At most some 16 million squares. */
  while (((int64_t)g->extent.x1 - g->extent.x0) / b.side *
             (((int64_t)g->extent.y1 - g->extent.y0) / b.side) > 1 << 24)
    b.side *= 2;
  b.nx = (int32_t)(((int64_t)g->extent.x1 - g->extent.x0) / b.side) + 1;
  b.ny = (int32_t)(((int64_t)g->extent.y1 - g->extent.y0) / b.side) + 1;
  int ok = fill(&b, &g->drawn[OPC_POLY]);
  const opc_edges *e = &g->edges[OPC_POLY];
  for (size_t p = 0; p < e->polygons && ok; p++)
    for (uint32_t i = e->start[p]; i < e->start[p + 1]; i++) {
      const opc_fragment *f = &e->fragments[i];
      if (f->role != OPC_END_LOW && f->role != OPC_END_HIGH) continue;
      uint32_t next = i + 1 < e->start[p + 1] ? i + 1 : e->start[p];
      opc_box end = edge_box(f->from, e->fragments[next].from);
      int horizontal = g->axis[f->gate] == OPC_Y, high = f->role == OPC_END_HIGH;
      opc_box window = window_of(end, horizontal, high, range, beside);
      out[2 * f->gate + high] =
          nearest(&b, window, horizontal, high, range - 1) + 1;
    }
  free(b.start);
  free(b.edge);
  return ok;
}
