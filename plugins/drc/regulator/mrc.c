/* SPDX-License-Identifier: BSD-3-Clause */
/* From each edge the mask is looked at to the right or up, for the edges that
   face it: through the shape if it lies there, or else through the space. What
   is nearer covers what is behind it. */
#include "mrc.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct facing {
  int32_t distance, low, high;   /* where they overlap */
} facing;

typedef struct mask {
  const opc_shapes *shapes;
  bins edges, corners;
  uint8_t *inwards;     /* of each edge, the side its shape lies on */
  uint8_t *corner;      /* of each point: its first edge's inwards, its second's,
                           and whether it is convex; see corner_of */
  double grid, limit[2];   /* nm: of spaces, of shapes */
  violations *out;

  /* Of the edge that is looked from. */
  opc_box from;
  int side, shape;         /* whether through the shape */
  facing *found;
  size_t n, room;
  int failed;
} mask;

static const char *const rule_names[] = {"mask space", "mask width"};

/* ---- edges ---- */

static int vertical(int side) { return side == LEFT || side == RIGHT; }

static void face(void *data, uint32_t i) {
  mask *m = data;
  opc_box e = m->edges.box[i], f = m->from;
  int flat = vertical(m->side);
  /* The one that ends the shape faces back at it, the one that ends the space
     away from it. */
  if (m->inwards[i] != (m->shape ? (m->side ^ 1) : m->side)) return;
  int32_t distance = flat ? e.x0 - f.x0 : e.y0 - f.y0;
  int32_t low = flat ? (e.y0 > f.y0 ? e.y0 : f.y0) : (e.x0 > f.x0 ? e.x0 : f.x0);
  int32_t high = flat ? (e.y1 < f.y1 ? e.y1 : f.y1) : (e.x1 < f.x1 ? e.x1 : f.x1);
  if (distance <= 0 || low >= high) return;
  if (m->n == m->room) {
    size_t room = m->room ? 2 * m->room : 64;
    facing *more = realloc(m->found, room * sizeof *more);
    if (!more) {
      m->failed = 1;
      return;
    }
    m->found = more;
    m->room = room;
  }
  m->found[m->n++] = (facing){distance, low, high};
}

static int by_distance(const void *a, const void *b) {
  const facing *p = a, *q = b;
  if (p->distance != q->distance) return p->distance < q->distance ? -1 : 1;
  return (p->low > q->low) - (p->low < q->low);
}

static void tell(const mask *m, const facing *f) {
  double along = ((double)f->low + f->high) / 2 * m->grid;
  int flat = vertical(m->side);
  double across =
      ((flat ? m->from.x0 : m->from.y0) + f->distance / 2.0) * m->grid;
  violations_add(m->out, (opc_violation){.rule = rule_names[m->shape],
                                         .gate = -1,
                                         .x = flat ? across : along,
                                         .y = flat ? along : across,
                                         .value = f->distance * m->grid,
                                         .limit = m->limit[m->shape]});
}

/* Tell of the parts of found[i] that nothing nearer covers. */
static void tell_visible(const mask *m, size_t i) {
  int32_t at = m->found[i].low, end = m->found[i].high;
  while (at < end) {
    int32_t stop = end, covered = 0;
    for (size_t k = 0; k < i; k++) {
      const facing *f = &m->found[k];
      if (f->distance == m->found[i].distance) continue;
      if (f->low <= at && f->high > at) covered = 1, stop = f->high;
      if (covered) break;
      if (f->low > at && f->low < stop) stop = f->low;
    }
    if (stop > end) stop = end;
    facing part = {m->found[i].distance, at, stop};
    if (!covered) tell(m, &part);
    at = stop;
  }
}

static void look_from(mask *m, size_t i) {
  int inwards = m->inwards[i];
  m->shape = inwards == RIGHT || inwards == ABOVE;
  m->side = m->shape ? inwards : inwards ^ 1;
  m->from = m->edges.box[i];
  m->n = 0;
  /* Less than the limit, in whole steps. */
  int32_t reach = (int32_t)ceil(m->limit[m->shape] / m->grid - 1e-9) - 1;
  if (reach < 1) return;
  bins_visit(&m->edges, bins_window(m->from, m->side, 0, reach, 0), face, m);
  if (m->n > 1) qsort(m->found, m->n, sizeof *m->found, by_distance);
  for (size_t k = 0; k < m->n; k++) tell_visible(m, k);
}

/* ---- corners ---- */

enum { CONVEX = 1, QUADRANT_RIGHT = 2, QUADRANT_ABOVE = 4 };

/* Which quadrant of the corner the lesser part lies in: the shape at a convex
   corner, the space at the others. `in` and `out` are its edges' inwards. */
static uint8_t corner_of(opc_point a, opc_point b, opc_point c, int in,
                         int out) {
  int64_t turn = ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) -
                 ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x);
  int convex = turn > 0;
  int right = in == RIGHT || out == RIGHT, above = in == ABOVE || out == ABOVE;
  if (!convex) right = !right, above = !above;
  return (uint8_t)((convex ? CONVEX : 0) | (right ? QUADRANT_RIGHT : 0) |
                   (above ? QUADRANT_ABOVE : 0));
}

/* Two corners of a kind, each with its quadrant away from the other: between
   convex ones lies space, between the others the shape. */
static void try_corner(void *data, uint32_t i) {
  mask *m = data;
  opc_box a = m->from, b = m->corners.box[i];
  uint8_t p = m->corner[m->n], q = m->corner[i];
  if ((p & CONVEX) != (q & CONVEX) || i == m->n) return;
  /* `a` is the left one of the two, or the lower of two above each other. */
  if (b.x0 < a.x0 || (b.x0 == a.x0 && b.y0 <= a.y0)) return;
  int up = b.y0 >= a.y0, down = b.y0 <= a.y0;
  int away = !(p & QUADRANT_RIGHT) && (q & QUADRANT_RIGHT);
  int rises = up && !(p & QUADRANT_ABOVE) && (q & QUADRANT_ABOVE);
  int falls = down && (p & QUADRANT_ABOVE) && !(q & QUADRANT_ABOVE);
  /* Of two above each other the left one may lie on either side. */
  if (b.x0 == a.x0) away = (p ^ q) & QUADRANT_RIGHT ? 1 : 0;
  int shape = !(p & CONVEX);
  double d = hypot((double)b.x0 - a.x0, (double)b.y0 - a.y0) * m->grid;
  if (!away || !(rises || falls) || d >= m->limit[shape] - 1e-9) return;
  violations_add(m->out, (opc_violation){
                             .rule = rule_names[shape],
                             .gate = -1,
                             .x = ((double)a.x0 + b.x0) / 2 * m->grid,
                             .y = ((double)a.y0 + b.y0) / 2 * m->grid,
                             .value = d,
                             .limit = m->limit[shape]});
}

static void look_from_corner(mask *m, size_t i) {
  double limit = fmax(m->limit[0], m->limit[1]);
  int32_t reach = (int32_t)ceil(limit / m->grid);
  m->n = i;
  m->from = m->corners.box[i];
  opc_box c = m->from;
  bins_visit(&m->corners,
             (opc_box){c.x0, c.y0 - reach, c.x1 + reach, c.y1 + reach},
             try_corner, m);
}

/* ---- all ---- */

static int make(mask *m, double limit) {
  const opc_shapes *s = m->shapes;
  int32_t side = (int32_t)(4 * limit / m->grid) + 1;
  size_t n;
  opc_box *edges = bins_edges(s, &n), *points = malloc((n + 1) * sizeof *points);
  int good = bins_make(&m->edges, edges, n, side);
  for (size_t i = 0; points && i < n; i++) {
    opc_point p = s->points[i];
    points[i] = (opc_box){p.x, p.y, p.x, p.y};
  }
  good = bins_make(&m->corners, points, n, side) && good;
  m->inwards = calloc(n + 1, 1);
  m->corner = malloc(n + 1);
  if (!good || !m->inwards || !m->corner) return 0;
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      opc_point a = s->points[i];
      opc_point b = s->points[i + 1 < s->start[p + 1] ? i + 1 : s->start[p]];
      m->inwards[i] = (uint8_t)(b.x > a.x   ? ABOVE
                                : b.x < a.x ? BELOW
                                : b.y > a.y ? LEFT
                                            : RIGHT);
    }
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t before = i > s->start[p] ? i - 1 : s->start[p + 1] - 1;
      uint32_t next = i + 1 < s->start[p + 1] ? i + 1 : s->start[p];
      m->corner[i] = corner_of(s->points[before], s->points[i], s->points[next],
                               m->inwards[before], m->inwards[i]);
    }
  return 1;
}

int mrc_check(const opc_shapes *shapes, double grid, double width,
              double space, violations *out) {
  mask m = {.shapes = shapes, .grid = grid, .limit = {space, width}, .out = out};
  int good = make(&m, fmax(width, space));
  for (size_t i = 0; good && i < m.edges.n; i++) {
    look_from(&m, i);
    good = !m.failed;
  }
  for (size_t i = 0; good && i < m.corners.n; i++) look_from_corner(&m, i);
  bins_clear(&m.edges);
  bins_clear(&m.corners);
  free(m.inwards);
  free(m.corner);
  free(m.found);
  return good;
}
