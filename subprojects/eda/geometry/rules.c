/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask rules. A search to the right or upwards from each edge finds the edges
   that face this edge. If the shape is on the searched side, the distance is a
   width; otherwise the distance is a space. Nearer edges hide farther edges. */
#include "eda/rules.h"

#include <math.h>
#include <stdlib.h>

#include "eda/index.h"
#include "eda/memory.h"

/* Sides of an edge. */
enum { LEFT, RIGHT, BELOW, ABOVE };

static int side_upright(int side) { return side == LEFT || side == RIGHT; }
static int side_opposite(int side) { return side ^ 1; }

/* A found edge: its distance from the start edge, and the part of the start
   edge that the found edge faces, from `low` to `high`. */
typedef struct facing {
  int32_t distance, low, high;
} facing;

typedef struct mask {
  const eda_shapes *shapes;
  eda_box
      *edge; /* degenerate box of the edge from each point to the next point */
  eda_index *edges, *points;
  uint8_t *inwards; /* side of each edge on which the shape is located */
  uint8_t *corner;  /* bits of each point, see corner_of */
  double grid;
  const double *limit;
  eda_rule_fault *fault;
  size_t faults, faults_capacity;

  /* The current search. */
  eda_box from; /* start edge */
  int side;     /* searched side of the start edge: RIGHT or ABOVE */
  int shape;    /* EDA_RULE_WIDTH (1): the search passes through the shape;
                   EDA_RULE_SPACE (0): through space */
  facing *found;
  size_t n, capacity;
} mask;

static void mask_report(mask *m, int rule, double x, double y, double value) {
  eda_grow(&m->fault, &m->faults_capacity, m->faults + 1, sizeof *m->fault);
  m->fault[m->faults++] =
      (eda_rule_fault){rule, x * m->grid, y * m->grid, value * m->grid};
}

/* ---- edges ---- */

/* Record edge i if it faces the start edge. A search through the shape ends at
   edges with the shape on the near side. A search through space ends at edges
   with the shape on the far side. */
static void edge_record(mask *m, uint32_t i) {
  eda_box e = m->edge[i], f = m->from;
  int flat = side_upright(m->side);
  if (m->inwards[i] != (m->shape ? side_opposite(m->side) : m->side)) return;
  int32_t distance = flat ? e.x0 - f.x0 : e.y0 - f.y0;
  int32_t low =
      flat ? (e.y0 > f.y0 ? e.y0 : f.y0) : (e.x0 > f.x0 ? e.x0 : f.x0);
  int32_t high =
      flat ? (e.y1 < f.y1 ? e.y1 : f.y1) : (e.x1 < f.x1 ? e.x1 : f.x1);
  if (distance <= 0 || low >= high) return;
  eda_grow(&m->found, &m->capacity, m->n + 1, sizeof *m->found);
  m->found[m->n++] = (facing){distance, low, high};
}

EDA_COMPARE_RISING(by_distance, facing, distance, low);

static void facing_report(mask *m, const facing *f) {
  double along = ((double)f->low + f->high) / 2;
  int flat = side_upright(m->side);
  double across = (flat ? m->from.x0 : m->from.y0) + f->distance / 2.0;
  mask_report(m, m->shape, flat ? across : along, flat ? along : across,
              f->distance);
}

/* Report the parts of found[i] that no nearer edge hides. */
static void visible_report(mask *m, size_t i) {
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
    if (!covered) facing_report(m, &part);
    at = stop;
  }
}

static void look_from(mask *m, size_t i) {
  int inwards = m->inwards[i];
  m->shape = inwards == RIGHT || inwards == ABOVE;
  m->side = m->shape ? inwards : side_opposite(inwards);
  m->from = m->edge[i];
  m->n = 0;
  /* Largest distance below the limit, in whole grid steps. */
  int32_t reach = (int32_t)ceil(m->limit[m->shape] / m->grid - 1e-9) - 1;
  if (reach < 1) return;
  eda_box window = m->from;
  if (m->side == RIGHT)
    window.x1 += reach;
  else
    window.y1 += reach;
  eda_finder f = eda_index_find(m->edges, window);
  for (uint32_t k; eda_index_next(&f, &k);) edge_record(m, k);
  if (m->n > 1) qsort(m->found, m->n, sizeof *m->found, by_distance);
  for (size_t k = 0; k < m->n; k++) visible_report(m, k);
}

/* ---- corners ---- */

enum { CONVEX = 1, QUADRANT_RIGHT = 2, QUADRANT_ABOVE = 4 };

/* Return the flags of the corner b between the points a and c: whether the
   corner is convex, and which of the four quadrants at b the two edges enclose.
   That quadrant is shape at a convex corner, and space at a concave corner.
   `in` and `out` are the sides on which the shape is, for both edges. */
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

/* Check the diagonal distance of corners n and i, which are both convex (space
   between them) or both concave (shape between them). The corners face each
   other if the quadrant of each points away from the other corner. */
static void try_corner(mask *m, size_t n, uint32_t i) {
  eda_point a = m->shapes->points[n], b = m->shapes->points[i];
  uint8_t p = m->corner[n], q = m->corner[i];
  if ((p & CONVEX) != (q & CONVEX) || i == n) return;
  /* `a` must be the left corner, or the lower corner if x is equal. */
  if (b.x < a.x || (b.x == a.x && b.y <= a.y)) return;
  int up = b.y >= a.y, down = b.y <= a.y;
  int away = !(p & QUADRANT_RIGHT) && (q & QUADRANT_RIGHT);
  int rises = up && !(p & QUADRANT_ABOVE) && (q & QUADRANT_ABOVE);
  int falls = down && (p & QUADRANT_ABOVE) && !(q & QUADRANT_ABOVE);
  /* If x is equal, the quadrants must be on different sides. */
  if (b.x == a.x) away = (p ^ q) & QUADRANT_RIGHT ? 1 : 0;
  int shape = !(p & CONVEX);
  double d = hypot((double)b.x - a.x, (double)b.y - a.y);
  if (!away || !(rises || falls) || d * m->grid >= m->limit[shape] - 1e-9)
    return;
  mask_report(m, shape, ((double)a.x + b.x) / 2, ((double)a.y + b.y) / 2, d);
}

static void look_from_corner(mask *m, size_t n) {
  double most = fmax(m->limit[EDA_RULE_SPACE], m->limit[EDA_RULE_WIDTH]);
  int32_t reach = (int32_t)ceil(most / m->grid);
  eda_point c = m->shapes->points[n];
  eda_finder f = eda_index_find(
      m->points, (eda_box){c.x, c.y - reach, c.x + reach, c.y + reach});
  for (uint32_t i; eda_index_next(&f, &i);) try_corner(m, n, i);
}

/* ---- short edges ---- */

static double edge_length(const mask *m, size_t i) {
  eda_box e = m->edge[i];
  return (double)e.x1 - e.x0 + ((double)e.y1 - e.y0);
}

/* Check edge i, located between the edges `before` and `next`. */
static void look_at_edge(mask *m, size_t before, size_t i, size_t next) {
  double own = edge_length(m, i), a = edge_length(m, before),
         b = edge_length(m, next);
  double x = ((double)m->edge[i].x0 + m->edge[i].x1) / 2;
  double y = ((double)m->edge[i].y0 + m->edge[i].y1) / 2;
  int is_jog = (m->corner[i] ^ m->corner[next]) & CONVEX && a > own && b > own;
  if (own * m->grid < m->limit[EDA_RULE_EDGE] - 1e-9 && fmin(a, b) <= own)
    mask_report(m, EDA_RULE_EDGE, x, y, own);
  if (own * m->grid < m->limit[EDA_RULE_JOG] - 1e-9 && is_jog)
    mask_report(m, EDA_RULE_JOG, x, y, own);
}

/* ---- complete check ---- */

static size_t vertex_around(const eda_shapes *s, size_t p, uint32_t i, int by) {
  uint32_t first = s->start[p], n = s->start[p + 1] - first;
  return first + (i - first + n + (uint32_t)by) % n;
}

static void find_edges(mask *m, size_t n) {
  const eda_shapes *s = m->shapes;
  double most = fmax(m->limit[EDA_RULE_SPACE], m->limit[EDA_RULE_WIDTH]);
  int32_t cell = (int32_t)(4 * most / m->grid) + 1;
  eda_box *points = eda_alloc(n, sizeof *points);
  m->edge = eda_alloc(n, sizeof *m->edge);
  m->inwards = eda_alloc(n, 1);
  m->corner = eda_alloc(n, 1);
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      eda_point a = s->points[i], b = s->points[vertex_around(s, p, i, 1)];
      points[i] = (eda_box){a.x, a.y, a.x, a.y};
      m->edge[i] = (eda_box){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                             a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
      m->inwards[i] = (uint8_t)(b.x > a.x   ? ABOVE
                                : b.x < a.x ? BELOW
                                : b.y > a.y ? LEFT
                                            : RIGHT);
    }
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      size_t before = vertex_around(s, p, i, -1),
             next = vertex_around(s, p, i, 1);
      m->corner[i] = corner_of(s->points[before], s->points[i], s->points[next],
                               m->inwards[before], m->inwards[i]);
    }
  m->edges = eda_index_new(m->edge, n, cell);
  m->points = eda_index_new(points, n, cell);
  free(points);
}

size_t eda_rules_check(const eda_shapes *shapes, double grid,
                       const double limit[EDA_RULES], eda_rule_fault **faults) {
  mask m = {.shapes = shapes, .grid = grid, .limit = limit};
  size_t n = shapes->count ? shapes->start[shapes->count] : 0;
  find_edges(&m, n);
  for (size_t i = 0; i < n; i++) look_from(&m, i);
  for (size_t i = 0; i < n; i++) look_from_corner(&m, i);
  for (size_t p = 0; p < shapes->count; p++)
    for (uint32_t i = shapes->start[p]; i < shapes->start[p + 1]; i++)
      look_at_edge(&m, vertex_around(shapes, p, i, -1), i,
                   vertex_around(shapes, p, i, 1));
  eda_index_free(m.edges);
  eda_index_free(m.points);
  free(m.edge);
  free(m.inwards);
  free(m.corner);
  free(m.found);
  *faults = m.fault;
  return m.faults;
}

const char *eda_rule_name(int rule) {
  static const char *const names[EDA_RULES] = {"space", "width", "edge", "jog"};
  return names[rule];
}
