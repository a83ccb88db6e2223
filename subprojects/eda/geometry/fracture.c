/* SPDX-License-Identifier: BSD-3-Clause */
/* Dissection of merged shapes into rectangles. A vertical sweep line passes
   over the shapes. Each interval of the line inside the shapes is a slab, which
   grows to the right until an edge touches the slab. The sweep runs for the
   shapes and for the transposed shapes. For each polygon with its holes, the
   sweep that yields fewer rectangles is used. Takes O(n log n). */
#include <eda/index.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>

#include "geometry/scan.h"

/* A vertical edge of a contour. In the transposed sweep, x and y are
   exchanged. */
typedef struct side {
  int32_t x;
  uint32_t r0, r1; /* ranks of the lower and upper end */
  uint32_t contour;
} side;

typedef struct slab {
  uint32_t r1; /* rank of the upper end; the rank of the lower end is the array
                  index */
  int32_t x0;
  uint32_t contour; /* any contour of the polygon that contains the slab */
} slab;

/* The ranks of both ends, and the contour, of a slab that was closed at the
   current x. */
typedef struct span {
  uint32_t r0, r1, contour;
} span;

typedef struct piece {
  eda_box box;
  uint32_t contour;
} piece;

typedef struct fracture {
  const eda_shapes *shapes;
  int transpose;
  side *sides; /* sorted by x, then r0 */
  size_t n_sides;
  int32_t *y; /* y of each rank */
  uint32_t ranks;
  eda_rankset open; /* ranks of the lower ends of open slabs */
  slab *slabs;
  span *closed;   /* slabs closed at the current x, by increasing y */
  uint32_t *ends; /* ranks of the ends of closed slabs and of edges at the
                     current x */
  size_t n_closed, n_ends;
  uint32_t
      *parent; /* union-find forest: contours of one polygon form one tree */
  piece *pieces[2]; /* rectangles of the sweep [0] and of the transposed sweep
                       [1] */
  size_t n_pieces[2], capacity[2];
} fracture;

/* ---- edges ---- */

static eda_point corner_point(const fracture *f, uint32_t i) {
  eda_point p = f->shapes->points[i];
  return f->transpose ? (eda_point){p.y, p.x} : p;
}

/* Write both ends of each vertical edge as events. The payload is 2 * (number
   of the edge), plus 1 for the upper end. Return the number of edges. */
static size_t edges_collect(fracture *f, eda_event *events) {
  size_t n = 0;
  for (size_t c = 0; c < f->shapes->count; c++) {
    uint32_t first = f->shapes->start[c], end = f->shapes->start[c + 1];
    for (uint32_t i = first; i < end; i++) {
      eda_point a = corner_point(f, i),
                b = corner_point(f, i + 1 < end ? i + 1 : first);
      if (a.y == b.y) continue;
      uint32_t x = eda_bias(a.x);
      f->sides[n] = (side){a.x, 0, 0, (uint32_t)c};
      events[2 * n] = (eda_event){x, eda_bias(MIN(a.y, b.y)), 2 * (uint32_t)n};
      events[2 * n + 1] =
          (eda_event){x, eda_bias(MAX(a.y, b.y)), 2 * (uint32_t)n + 1};
      n++;
    }
  }
  return n;
}

/* Set the ranks of the ends of all edges, then sort the edges by x and lower
   end. */
static void rank_sides(fracture *f, eda_event *events) {
  uint32_t *keys = eda_rank_minor(events, 2 * f->n_sides, &f->ranks);
  side *sorted = g_new(side, f->n_sides + 1);
  f->y = g_new(int32_t, (gsize)f->ranks + 1);
  for (uint32_t r = 0; r < f->ranks; r++) f->y[r] = eda_unbias(keys[r]);
  g_free(keys);
  for (size_t i = 0; i < 2 * f->n_sides; i++) {
    side *s = &f->sides[events[i].payload >> 1];
    *(events[i].payload & 1 ? &s->r1 : &s->r0) = events[i].minor;
  }
  eda_sort(events, 2 * f->n_sides, EDA_MAJOR);
  size_t n = 0;
  for (size_t i = 0; i < 2 * f->n_sides; i++)
    if (!(events[i].payload & 1))
      sorted[n++] = f->sides[events[i].payload >> 1];
  g_free(f->sides);
  f->sides = sorted;
}

static void forget_sweep(fracture *f) {
  g_free(f->sides);
  g_free(f->y);
  g_free(f->slabs);
  g_free(f->closed);
  g_free(f->ends);
  eda_rankset_clear(&f->open);
}

static void prepare_sweep(fracture *f) {
  size_t most = f->shapes->start[f->shapes->count];
  eda_event *events = g_new(eda_event, 2 * most + 1);
  f->sides = g_new(side, most + 1);
  f->n_sides = edges_collect(f, events);
  rank_sides(f, events);
  g_free(events);
  f->slabs = g_new(slab, (gsize)f->ranks + 1);
  f->closed = g_new(span, (gsize)f->ranks + 1);
  f->ends = g_new(uint32_t, 2 * ((gsize)f->ranks + f->n_sides) + 1);
  eda_rankset_init(&f->open, f->ranks);
}

/* ---- sweep line ---- */

static void add_piece(fracture *f, const span *s, int32_t x0, int32_t x1) {
  int orientation = f->transpose;
  int32_t y0 = f->y[s->r0], y1 = f->y[s->r1];
  eda_box box =
      orientation ? (eda_box){y0, x0, y1, x1} : (eda_box){x0, y0, x1, y1};
  EDA_PUSH(f->pieces[orientation], f->n_pieces[orientation],
           f->capacity[orientation], (piece){box, s->contour});
}

/* Close all open slabs that overlap or touch [r0, r1]. */
static void close_slabs(fracture *f, uint32_t r0, uint32_t r1, int32_t x) {
  uint32_t r = eda_rankset_before(&f->open, r0);
  if (r == EDA_NO_RANK || f->slabs[r].r1 < r0)
    r = eda_rankset_has(&f->open, r0) ? r0 : eda_rankset_after(&f->open, r0);
  while (r != EDA_NO_RANK && r <= r1) {
    span s = {r, f->slabs[r].r1, f->slabs[r].contour};
    eda_rankset_remove(&f->open, r);
    f->closed[f->n_closed++] = s;
    f->ends[f->n_ends++] = s.r0;
    f->ends[f->n_ends++] = s.r1;
    add_piece(f, &s, f->slabs[r].x0, x);
    r = eda_rankset_after(&f->open, r);
  }
}

/* Unite the contour of each edge with the contour of the slab that the edge
   closes. This joins each hole to its outline: the leftmost edge of a hole
   closes a slab of the outline. */
static void unite_edges(fracture *f, const side *sides, size_t n) {
  for (size_t i = 0, j = 0; i < n && j < f->n_closed;) {
    const span *c = &f->closed[j];
    if (sides[i].r0 < c->r1 && c->r0 < sides[i].r1)
      eda_sets_join(f->parent, sides[i].contour, c->contour);
    if (sides[i].r1 <= c->r1)
      i++;
    else
      j++;
  }
}

/* Open a slab from r0 to r1. The slab belongs to the polygon of an edge that
   overlaps the slab, or else to the polygon of the closed slab that the new
   slab continues. Calls have increasing r0. *edge and *old, indices of an edge
   and of a closed slab, skip those below r0. */
static void open_slab(fracture *f, const side *sides, size_t n, uint32_t r0,
                      uint32_t r1, size_t *edge, size_t *old) {
  while (*edge < n && sides[*edge].r1 <= r0) ++*edge;
  while (*old < f->n_closed && f->closed[*old].r1 <= r0) ++*old;
  uint32_t contour = *edge < n && sides[*edge].r0 < r1
                         ? sides[*edge].contour
                         : f->closed[*old].contour;
  f->slabs[r0] = (slab){r1, sides->x, contour};
  eda_rankset_add(&f->open, r0);
}

/* Process all edges at one x. The new slabs to the right of x are the symmetric
   difference (XOR) of the closed slabs and the edges. */
static void fracture_step(fracture *f, const side *sides, size_t n) {
  f->n_closed = f->n_ends = 0;
  for (size_t i = 0; i < n; i++) {
    close_slabs(f, sides[i].r0, sides[i].r1, sides->x);
    f->ends[f->n_ends++] = sides[i].r0;
    f->ends[f->n_ends++] = sides[i].r1;
  }
  unite_edges(f, sides, n);
  qsort(f->ends, f->n_ends, sizeof *f->ends, eda_uint32s_rise);
  size_t kept = 0, edge = 0, old = 0;
  for (size_t i = 0; i < f->n_ends; i++) {
    if (kept && f->ends[kept - 1] == f->ends[i])
      kept--;
    else
      f->ends[kept++] = f->ends[i];
  }
  for (size_t i = 0; i + 1 < kept; i += 2)
    open_slab(f, sides, n, f->ends[i], f->ends[i + 1], &edge, &old);
}

static void sweep_chords(fracture *f, int transpose) {
  f->transpose = transpose;
  prepare_sweep(f);
  for (size_t i = 0, n; i < f->n_sides; i += n) {
    n = 1;
    while (i + n < f->n_sides && f->sides[i + n].x == f->sides[i].x) n++;
    fracture_step(f, &f->sides[i], n);
  }
  forget_sweep(f);
}

/* ---- choice of the sweep for each polygon ---- */

EDA_COMPARE_RISING(by_corner, eda_box, y0, x0);

static void fracture_choose(fracture *f, eda_box **boxes, size_t *count) {
  uint32_t *pieces = g_malloc0_n(f->shapes->count, 2 * sizeof *pieces);
  for (int orientation = 0; orientation < 2; orientation++)
    for (size_t i = 0; i < f->n_pieces[orientation]; i++)
      pieces[2 * (size_t)eda_set_root(f->parent,
                                      f->pieces[orientation][i].contour) +
             (size_t)orientation]++;
  size_t total = 0;
  for (size_t c = 0; c < f->shapes->count; c++)
    total += MIN(pieces[2 * c], pieces[2 * c + 1]);
  *boxes = eda_alloc(total, sizeof **boxes);
  for (int orientation = 0; orientation < 2; orientation++)
    for (size_t i = 0; i < f->n_pieces[orientation]; i++) {
      const uint32_t *n =
          &pieces[2 * (size_t)eda_set_root(f->parent,
                                           f->pieces[orientation][i].contour)];
      if ((n[1] <= n[0]) == orientation)
        (*boxes)[(*count)++] = f->pieces[orientation][i].box;
    }
  g_free(pieces);
  qsort(*boxes, *count, sizeof **boxes, by_corner);
}

int eda_fracture(const eda_shapes *shapes, eda_box **boxes, size_t *count,
                 opc_error *error) {
  *boxes = NULL;
  *count = 0;
  int code = eda_shapes_check(shapes, error);
  if (code || shapes->count == 0) return code;
  fracture f = {.shapes = shapes};
  f.parent = g_new(uint32_t, shapes->count);
  for (size_t c = 0; c < shapes->count; c++) f.parent[c] = (uint32_t)c;
  sweep_chords(&f, 0);
  sweep_chords(&f, 1);
  fracture_choose(&f, boxes, count);
  g_free(f.parent);
  g_free(f.pieces[0]);
  g_free(f.pieces[1]);
  return OPC_OK;
}
