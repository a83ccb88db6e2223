/* SPDX-License-Identifier: BSD-3-Clause */
/* The rules of the mask itself. From each edge the mask is looked at to the
   right or up, for the edges that face it: through the shape if it lies there,
   or else through the space. What is nearer covers what is behind it. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "drc.h"

typedef struct facing {
  int32_t distance, low, high; /* where they overlap */
} facing;

typedef struct mask {
  const eda_shapes *shapes;
  places edges, corners;
  uint8_t *inwards;      /* of each edge, the side its shape lies on */
  uint8_t *corner;       /* of each point, see corner_of */
  double grid, limit[2]; /* nm: of spaces, of shapes */
  violations *out;

  /* Of the edge that is looked from. */
  eda_box from;
  int side, shape; /* whether through the shape */
  facing *found;
  size_t n, room;
} mask;

static const char *const rule_names[] = {"mask space", "mask width"};

/* ---- edges ---- */

/* Note edge i if it ends what is looked through: the one that ends the shape
   faces back, the one that ends the space away. */
static void face(mask *m, uint32_t i) {
  eda_box e = m->edges.box[i], f = m->from;
  int flat = upright(m->side);
  if (m->inwards[i] != (m->shape ? opposite(m->side) : m->side)) return;
  int32_t distance = flat ? e.x0 - f.x0 : e.y0 - f.y0;
  int32_t low =
      flat ? (e.y0 > f.y0 ? e.y0 : f.y0) : (e.x0 > f.x0 ? e.x0 : f.x0);
  int32_t high =
      flat ? (e.y1 < f.y1 ? e.y1 : f.y1) : (e.x1 < f.x1 ? e.x1 : f.x1);
  if (distance <= 0 || low >= high) return;
  eda_grow(&m->found, &m->room, m->n + 1, sizeof *m->found);
  m->found[m->n++] = (facing){distance, low, high};
}

static int by_distance(const void *a, const void *b) {
  const facing *p = a, *q = b;
  if (p->distance != q->distance) return p->distance < q->distance ? -1 : 1;
  return (p->low > q->low) - (p->low < q->low);
}

static void tell(const mask *m, const facing *f) {
  double along = ((double)f->low + f->high) / 2 * m->grid;
  int flat = upright(m->side);
  double across =
      ((flat ? m->from.x0 : m->from.y0) + f->distance / 2.0) * m->grid;
  violations_add(m->out, (eda_violation){.rule = rule_names[m->shape],
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
  m->side = m->shape ? inwards : opposite(inwards);
  m->from = m->edges.box[i];
  m->n = 0;
  /* Less than the limit, in whole steps. */
  int32_t reach = (int32_t)ceil(m->limit[m->shape] / m->grid - 1e-9) - 1;
  if (reach < 1) return;
  eda_finder f =
      eda_index_find(m->edges.index, window_at(m->from, m->side, 0, reach, 0));
  for (uint32_t k; eda_index_next(&f, &k);) face(m, k);
  if (m->n > 1) qsort(m->found, m->n, sizeof *m->found, by_distance);
  for (size_t k = 0; k < m->n; k++) tell_visible(m, k);
}

/* ---- corners ---- */

enum { CONVEX = 1, QUADRANT_RIGHT = 2, QUADRANT_ABOVE = 4 };

/* Whether the corner is convex, and which quadrant of it the lesser part lies
   in: the shape at a convex corner, the space at the others. `in` and `out` are
   its edges' inwards. */
static uint8_t corner_of(eda_point a, eda_point b, eda_point c, int in,
                         int out) {
  int64_t turn = ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) -
                 ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x);
  int convex = turn > 0;
  int right = in == RIGHT || out == RIGHT, above = in == ABOVE || out == ABOVE;
  if (!convex) right = !right, above = !above;
  return (uint8_t)((convex ? CONVEX : 0) | (right ? QUADRANT_RIGHT : 0) |
                   (above ? QUADRANT_ABOVE : 0));
}

/* Look at corners n and i. Of two of a kind, each has its quadrant away from
   the other: between convex ones lies space, between the others the shape. */
static void try_corner(const mask *m, size_t n, uint32_t i) {
  eda_box a = m->corners.box[n], b = m->corners.box[i];
  uint8_t p = m->corner[n], q = m->corner[i];
  if ((p & CONVEX) != (q & CONVEX) || i == n) return;
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
  violations_add(m->out,
                 (eda_violation){.rule = rule_names[shape],
                                 .gate = -1,
                                 .x = ((double)a.x0 + b.x0) / 2 * m->grid,
                                 .y = ((double)a.y0 + b.y0) / 2 * m->grid,
                                 .value = d,
                                 .limit = m->limit[shape]});
}

static void look_from_corner(const mask *m, size_t n) {
  int32_t reach = (int32_t)ceil(fmax(m->limit[0], m->limit[1]) / m->grid);
  eda_box c = m->corners.box[n];
  eda_finder f =
      eda_index_find(m->corners.index,
                     (eda_box){c.x0, c.y0 - reach, c.x1 + reach, c.y1 + reach});
  for (uint32_t i; eda_index_next(&f, &i);) try_corner(m, n, i);
}

/* ---- all ---- */

static void find_edges(mask *m) {
  const eda_shapes *s = m->shapes;
  double nm = 4 * fmax(m->limit[0], m->limit[1]);
  size_t n;
  eda_box *edges = edges_of(s, &n), *points = eda_alloc(n, sizeof *points);
  for (size_t i = 0; i < n; i++)
    points[i] = box_between(s->points[i], s->points[i]);
  places_init(&m->edges, edges, n, nm, m->grid);
  places_init(&m->corners, points, n, nm, m->grid);
  m->inwards = eda_alloc(n, 1);
  m->corner = eda_alloc(n, 1);
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      eda_point a = s->points[i];
      eda_point b = s->points[i + 1 < s->start[p + 1] ? i + 1 : s->start[p]];
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
}

void mrc_check(const drc *r, const eda_shapes *shapes, violations *out) {
  mask m = {.shapes = shapes,
            .grid = r->grid,
            .limit = {r->min_space, r->min_mask_width},
            .out = out};
  find_edges(&m);
  for (size_t i = 0; i < m.edges.n; i++) look_from(&m, i);
  for (size_t i = 0; i < m.corners.n; i++) look_from_corner(&m, i);
  places_clear(&m.edges);
  places_clear(&m.corners);
  free(m.inwards);
  free(m.corner);
  free(m.found);
}
