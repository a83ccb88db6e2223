/* SPDX-License-Identifier: BSD-3-Clause */
/* Cut merged shapes into rectangles. A vertical line sweeps over the shapes;
   the pieces of it that lie inside are slabs that grow to the right until an
   edge touches them. Done for the shapes and for their transpose; each polygon
   with its holes takes what gave fewer. O(n log n). */
#include <glib.h>
#include <stdlib.h>

#include "core/geometry/scan.h"

/* A vertical edge, of a contour; x and y are swapped in the transpose. */
typedef struct side {
  int32_t x;
  uint32_t r0, r1; /* ranks of its ends */
  uint32_t contour;
} side;

typedef struct slab {
  uint32_t r1; /* where it ends; it begins at the rank it is kept at */
  int32_t x0;
  uint32_t contour; /* one that belongs to its polygon */
} slab;

/* A slab that an edge has closed, or one that opens. */
typedef struct span {
  uint32_t r0, r1, contour;
} span;

typedef struct piece {
  opc_box box;
  uint32_t contour;
} piece;

typedef struct fracture {
  const opc_shapes *shapes;
  int transpose;
  side *sides; /* sorted by x, then r0 */
  size_t n_sides;
  int32_t *y; /* of the ranks */
  uint32_t ranks;
  opc_rankset open; /* the ranks at which open slabs begin */
  slab *slabs;
  span *closed; /* at this x; from low to high */
  uint32_t *ends;
  size_t n_closed, n_ends;
  uint32_t *parent; /* contours of one polygon: a forest */
  piece *pieces[2]; /* of both ways */
  size_t n_pieces[2], room[2];
} fracture;

/* ---- polygons and their holes ---- */

static uint32_t root(fracture *f, uint32_t c) {
  while (f->parent[c] != c) {
    f->parent[c] = f->parent[f->parent[c]];
    c = f->parent[c];
  }
  return c;
}

static void unite(fracture *f, uint32_t a, uint32_t b) {
  a = root(f, a);
  b = root(f, b);
  if (a < b)
    f->parent[b] = a;
  else
    f->parent[a] = b;
}

/* ---- edges ---- */

static opc_point point(const fracture *f, uint32_t i) {
  opc_point p = f->shapes->points[i];
  return f->transpose ? (opc_point){p.y, p.x} : p;
}

/* Both ends of each vertical edge as events; the payload is the edge, and
   whether this is its upper end. */
static size_t collect(fracture *f, opc_event *events) {
  size_t n = 0;
  for (size_t c = 0; c < f->shapes->count; c++) {
    uint32_t first = f->shapes->start[c], end = f->shapes->start[c + 1];
    for (uint32_t i = first; i < end; i++) {
      opc_point a = point(f, i), b = point(f, i + 1 < end ? i + 1 : first);
      if (a.y == b.y) continue;
      uint32_t x = opc_bias(a.x);
      f->sides[n] = (side){a.x, 0, 0, (uint32_t)c};
      events[2 * n] = (opc_event){x, opc_bias(MIN(a.y, b.y)), 2 * (uint32_t)n};
      events[2 * n + 1] =
          (opc_event){x, opc_bias(MAX(a.y, b.y)), 2 * (uint32_t)n + 1};
      n++;
    }
  }
  return n;
}

/* Rank the ends, then sort the edges by x and lower end. */
static int rank_sides(fracture *f, opc_event *events, opc_event *scratch) {
  uint32_t *keys = opc_rank_minor(events, scratch, 2 * f->n_sides, &f->ranks);
  side *sorted = g_try_new(side, f->n_sides + 1);
  f->y = g_try_new(int32_t, (gsize)f->ranks + 1);
  if (!keys || !sorted || !f->y) {
    g_free(keys);
    g_free(sorted);
    return 0;
  }
  for (uint32_t r = 0; r < f->ranks; r++) f->y[r] = opc_unbias(keys[r]);
  g_free(keys);
  for (size_t i = 0; i < 2 * f->n_sides; i++) {
    side *s = &f->sides[events[i].payload >> 1];
    *(events[i].payload & 1 ? &s->r1 : &s->r0) = events[i].minor;
  }
  opc_sort_major(events, scratch, 2 * f->n_sides);
  size_t n = 0;
  for (size_t i = 0; i < 2 * f->n_sides; i++)
    if (!(events[i].payload & 1))
      sorted[n++] = f->sides[events[i].payload >> 1];
  g_free(f->sides);
  f->sides = sorted;
  return 1;
}

static void forget_sweep(fracture *f) {
  g_free(f->sides);
  g_free(f->y);
  g_free(f->slabs);
  g_free(f->closed);
  g_free(f->ends);
  opc_rankset_clear(&f->open);
  f->sides = NULL;
  f->y = NULL;
  f->slabs = NULL;
  f->closed = NULL;
  f->ends = NULL;
}

static int prepare_sweep(fracture *f, opc_error *error) {
  size_t most = f->shapes->start[f->shapes->count];
  opc_event *events = g_try_new(opc_event, 2 * most + 1);
  opc_event *scratch = g_try_new(opc_event, 2 * most + 1);
  f->sides = g_try_new(side, most + 1);
  int good = events && scratch && f->sides;
  if (good) {
    f->n_sides = collect(f, events);
    good = rank_sides(f, events, scratch);
  }
  g_free(events);
  g_free(scratch);
  if (good) {
    f->slabs = g_try_new(slab, (gsize)f->ranks + 1);
    f->closed = g_try_new(span, (gsize)f->ranks + 1);
    f->ends = g_try_new(uint32_t, 2 * ((gsize)f->ranks + f->n_sides) + 1);
    good = f->slabs && f->closed && f->ends &&
           opc_rankset_init(&f->open, f->ranks);
  }
  return good ? OPC_OK : opc_no_memory(error);
}

/* ---- the line ---- */

static int add_piece(fracture *f, const span *s, int32_t x0, int32_t x1,
                     opc_error *error) {
  int way = f->transpose;
  if (f->n_pieces[way] == f->room[way]) {
    size_t room = f->room[way] ? 2 * f->room[way] : 1024;
    piece *more = g_try_renew(piece, f->pieces[way], room);
    if (!more) return opc_no_memory(error);
    f->pieces[way] = more;
    f->room[way] = room;
  }
  int32_t y0 = f->y[s->r0], y1 = f->y[s->r1];
  f->pieces[way][f->n_pieces[way]++] = (piece){
      way ? (opc_box){y0, x0, y1, x1} : (opc_box){x0, y0, x1, y1}, s->contour};
  return OPC_OK;
}

/* End the open slabs that [r0, r1] touches. */
static int close_slabs(fracture *f, uint32_t r0, uint32_t r1, int32_t x,
                       opc_error *error) {
  uint32_t r = opc_rankset_before(&f->open, r0);
  if (r == OPC_NO_RANK || f->slabs[r].r1 < r0)
    r = opc_rankset_has(&f->open, r0) ? r0 : opc_rankset_after(&f->open, r0);
  while (r != OPC_NO_RANK && r <= r1) {
    span s = {r, f->slabs[r].r1, f->slabs[r].contour};
    opc_rankset_remove(&f->open, r);
    f->closed[f->n_closed++] = s;
    f->ends[f->n_ends++] = s.r0;
    f->ends[f->n_ends++] = s.r1;
    int code = add_piece(f, &s, f->slabs[r].x0, x, error);
    if (code) return code;
    r = opc_rankset_after(&f->open, r);
  }
  return OPC_OK;
}

static int by_rank(const void *a, const void *b) {
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  return (p > q) - (p < q);
}

/* An edge that closes a slab belongs to its polygon. That joins each hole to
   its outline, as the line meets a hole first where a slab ends. */
static void unite_edges(fracture *f, const side *sides, size_t n) {
  for (size_t i = 0, j = 0; i < n && j < f->n_closed;) {
    const span *c = &f->closed[j];
    if (sides[i].r0 < c->r1 && c->r0 < sides[i].r1)
      unite(f, sides[i].contour, c->contour);
    if (sides[i].r1 <= c->r1)
      i++;
    else
      j++;
  }
}

/* It belongs to the polygon of an edge in it, or of a slab that it goes on
   from. `edge` and `old` move on to the first of each that may be that. */
static void open_slab(fracture *f, const side *sides, size_t n, uint32_t r0,
                      uint32_t r1, size_t *edge, size_t *old) {
  while (*edge < n && sides[*edge].r1 <= r0) ++*edge;
  while (*old < f->n_closed && f->closed[*old].r1 <= r0) ++*old;
  uint32_t contour = *edge < n && sides[*edge].r0 < r1
                         ? sides[*edge].contour
                         : f->closed[*old].contour;
  f->slabs[r0] = (slab){r1, sides->x, contour};
  opc_rankset_add(&f->open, r0);
}

/* All edges at one x: inside to its right is what was inside to its left, but
   for the edges. */
static int step(fracture *f, const side *sides, size_t n, opc_error *error) {
  f->n_closed = f->n_ends = 0;
  for (size_t i = 0; i < n; i++) {
    int code = close_slabs(f, sides[i].r0, sides[i].r1, sides->x, error);
    if (code) return code;
    f->ends[f->n_ends++] = sides[i].r0;
    f->ends[f->n_ends++] = sides[i].r1;
  }
  unite_edges(f, sides, n);
  qsort(f->ends, f->n_ends, sizeof *f->ends, by_rank);
  size_t kept = 0, edge = 0, old = 0;
  for (size_t i = 0; i < f->n_ends; i++) {
    if (kept && f->ends[kept - 1] == f->ends[i])
      kept--;
    else
      f->ends[kept++] = f->ends[i];
  }
  for (size_t i = 0; i + 1 < kept; i += 2)
    open_slab(f, sides, n, f->ends[i], f->ends[i + 1], &edge, &old);
  return OPC_OK;
}

static int sweep(fracture *f, int transpose, opc_error *error) {
  f->transpose = transpose;
  int code = prepare_sweep(f, error);
  for (size_t i = 0, n; !code && i < f->n_sides; i += n) {
    n = 1;
    while (i + n < f->n_sides && f->sides[i + n].x == f->sides[i].x) n++;
    code = step(f, &f->sides[i], n, error);
  }
  forget_sweep(f);
  return code;
}

/* ---- the better way ---- */

static int by_corner(const void *a, const void *b) {
  const opc_box *p = a, *q = b;
  if (p->y0 != q->y0) return p->y0 < q->y0 ? -1 : 1;
  return (p->x0 > q->x0) - (p->x0 < q->x0);
}

static int choose(fracture *f, const opc_host *host, opc_box **boxes,
                  size_t *count, opc_error *error) {
  uint32_t *pieces = g_try_malloc0_n(f->shapes->count, 2 * sizeof *pieces);
  if (!pieces) return opc_no_memory(error);
  for (int way = 0; way < 2; way++)
    for (size_t i = 0; i < f->n_pieces[way]; i++)
      pieces[2 * (size_t)root(f, f->pieces[way][i].contour) + (size_t)way]++;
  size_t total = 0;
  for (size_t c = 0; c < f->shapes->count; c++)
    total += MIN(pieces[2 * c], pieces[2 * c + 1]);
  *boxes = host->alloc(host, total, sizeof **boxes);
  for (int way = 0; *boxes && way < 2; way++)
    for (size_t i = 0; i < f->n_pieces[way]; i++) {
      const uint32_t *n =
          &pieces[2 * (size_t)root(f, f->pieces[way][i].contour)];
      if ((n[1] <= n[0]) == way) (*boxes)[(*count)++] = f->pieces[way][i].box;
    }
  g_free(pieces);
  if (!*boxes) return opc_no_memory(error);
  qsort(*boxes, *count, sizeof **boxes, by_corner);
  return OPC_OK;
}

int opc_fracture(const opc_host *host, const opc_shapes *shapes,
                 opc_box **boxes, size_t *count, opc_error *error) {
  *boxes = NULL;
  *count = 0;
  int code = opc_shapes_check(shapes, error);
  if (code || shapes->count == 0) return code;
  fracture f = {.shapes = shapes};
  f.parent = g_try_new(uint32_t, shapes->count);
  if (!f.parent) return opc_no_memory(error);
  for (size_t c = 0; c < shapes->count; c++) f.parent[c] = (uint32_t)c;
  code = sweep(&f, 0, error);
  if (!code) code = sweep(&f, 1, error);
  if (!code) code = choose(&f, host, boxes, count, error);
  g_free(f.parent);
  g_free(f.pieces[0]);
  g_free(f.pieces[1]);
  return code;
}
