/* SPDX-License-Identifier: BSD-3-Clause */
/* Boolean operations on rectilinear polygons. A vertical sweep line passes over
   the vertical edges from left to right. For each interval of the line, the
   sweep stores the winding number of each operand. Where an edge changes
   whether an interval is inside the result, the result has a vertical edge
   ("wall"). Takes O((n + k) log n) for k crossings of edges. */
#include <eda/memory.h>
#include <glib.h>

#include "geometry/scan.h"

typedef struct sweep {
  int op;
  eda_event *events; /* ends of vertical edges; major: x; minor: y, replaced by
                        the rank of y before the sweep */
  size_t n, capacity;
  uint32_t *y;        /* y of each rank, as eda_bias */
  eda_rankset breaks; /* ranks at which an interval of the sweep line starts */
  int32_t (*wind)[2]; /* winding numbers of a and b in the interval above each
                         break */
  eda_wall *walls;
  size_t n_walls, walls_capacity;
} sweep;

/* Bits of an event's payload. OPERAND: the edge belongs to b, otherwise to a.
   MINUS: from this end upwards, the edge subtracts one from the winding number
   to the right of the edge; otherwise the edge adds one. */
enum { OPERAND = 1, MINUS = 2 };

/* A wall has two points, and points are numbered with 31 bits. */
enum { MOST_WALLS = 1 << 30 };

static int region_inside(int op, const int32_t *wind) {
  int a = wind[0] != 0, b = wind[1] != 0;
  switch (op) {
    case EDA_OR:
      return a | b;
    case EDA_AND:
      return a & b;
    case EDA_NOT:
      return a & !b;
    default:
      return a ^ b;
  }
}

static void sweep_clear(sweep *s) {
  g_free(s->events);
  g_free(s->y);
  g_free(s->wind);
  g_free(s->walls);
  eda_rankset_clear(&s->breaks);
}

/* ---- sweep line ---- */

static int add_wall(sweep *s, uint32_t x, uint32_t r0, uint32_t r1, int left,
                    opc_error *error) {
  eda_wall wall = {eda_unbias(x), eda_unbias(s->y[r0]), eda_unbias(s->y[r1]),
                   left};
  eda_wall *last = s->n_walls ? &s->walls[s->n_walls - 1] : NULL;
  if (last && last->x == wall.x && last->y1 == wall.y0 && last->left == left) {
    last->y1 = wall.y1;
    return OPC_OK;
  }
  if (s->n_walls == MOST_WALLS)
    return opc_fail(error, OPC_FAILED, NULL,
                    "the result has more than 2^31 edges");
  EDA_PUSH(s->walls, s->n_walls, s->walls_capacity, wall);
  return OPC_OK;
}

/* Return the winding numbers below rank r. */
static void wind_below(const sweep *s, uint32_t r, int32_t *wind) {
  uint32_t below = eda_rankset_before(&s->breaks, r);
  wind[0] = below == EDA_NO_RANK ? 0 : s->wind[below][0];
  wind[1] = below == EDA_NO_RANK ? 0 : s->wind[below][1];
}

static void sweep_split(sweep *s, uint32_t r) {
  if (eda_rankset_has(&s->breaks, r)) return;
  wind_below(s, r, s->wind[r]);
  eda_rankset_add(&s->breaks, r);
}

/* Remove the break at rank r if the winding numbers above r equal `below`.
   Otherwise set `below` to the winding numbers above r. */
static void sweep_join(sweep *s, uint32_t r, int32_t *below) {
  if (s->wind[r][0] == below[0] && s->wind[r][1] == below[1]) {
    eda_rankset_remove(&s->breaks, r);
  } else {
    below[0] = s->wind[r][0];
    below[1] = s->wind[r][1];
  }
}

/* Add `change` to the winding numbers between ranks r0 and r1. Add a wall where
   this changes the result. */
static int change_range(sweep *s, uint32_t x, uint32_t r0, uint32_t r1,
                        const int32_t *change, opc_error *error) {
  int32_t below[2];
  sweep_split(s, r0);
  sweep_split(s, r1);
  wind_below(s, r0, below);
  for (uint32_t r = r0, next; r < r1; r = next) {
    next = eda_rankset_after(&s->breaks, r);
    int before = region_inside(s->op, s->wind[r]);
    s->wind[r][0] += change[0];
    s->wind[r][1] += change[1];
    int after = region_inside(s->op, s->wind[r]);
    sweep_join(s, r, below);
    if (before == after) continue;
    int code = add_wall(s, x, r, next, after, error);
    if (code) return code;
  }
  sweep_join(s, r1, below);
  return OPC_OK;
}

static void sweep_prepare(sweep *s) {
  uint32_t ranks = 0;
  s->y = eda_rank_minor(s->events, s->n, &ranks);
  eda_sort(s->events, s->n, EDA_MAJOR);
  s->wind = g_malloc0_n((gsize)ranks + 1, sizeof *s->wind);
  eda_rankset_init(&s->breaks, ranks);
}

static int sweep_run(sweep *s, opc_error *error) {
  if (s->n == 0) return OPC_OK;
  int32_t change[2] = {0, 0};
  int code = OPC_OK;
  sweep_prepare(s);
  for (size_t i = 0; !code && i < s->n; i++) {
    const eda_event *e = &s->events[i];
    change[e->payload & OPERAND] += e->payload & MINUS ? -1 : 1;
    if (!change[0] && !change[1]) continue;
    /* The next event at this x has the same rank: sum the changes first. */
    if (e[1].minor == e->minor) continue;
    code = change_range(s, e->major, e->minor, e[1].minor, change, error);
  }
  return code;
}

/* ---- operands ---- */

/* Add the edge from y0 to y1; the operand is on the left of the edge. */
static void add_edge(sweep *s, int32_t x, int32_t y0, int32_t y1,
                     uint32_t operand) {
  if (y0 == y1) return;
  EDA_PUSH(s->events, s->n, s->capacity,
           (eda_event){eda_bias(x), eda_bias(y0), operand | MINUS});
  EDA_PUSH(s->events, s->n, s->capacity,
           (eda_event){eda_bias(x), eda_bias(y1), operand});
}

/* Add a contour in the orientation of an outline (`hole` 0) or of a hole. */
static void add_contour(sweep *s, const eda_point *points, uint32_t n, int hole,
                        uint32_t operand) {
  eda_shapes one = {1, (uint32_t[]){0, n}, (eda_point *)points, NULL};
  int reverse = (eda_area2(&one) < 0) != hole;
  for (uint32_t i = 0; i < n; i++) {
    eda_point a = points[i], b = points[i + 1 < n ? i + 1 : 0];
    if (reverse)
      add_edge(s, a.x, b.y, a.y, operand);
    else
      add_edge(s, a.x, a.y, b.y, operand);
  }
}

/* Add a polygon that may cross itself, and therefore may have negative winding
   numbers. Merge the polygon alone first, so that negative winding numbers do
   not cancel positive ones of other polygons. */
static int add_polygon(sweep *s, const eda_point *points, uint32_t n,
                       uint32_t operand, opc_error *error) {
  if (n <= 4) {
    add_contour(s, points, n, 0, operand);
    return OPC_OK;
  }
  sweep own = {.op = EDA_OR};
  add_contour(&own, points, n, 0, 0);
  int code = sweep_run(&own, error);
  for (size_t i = 0; !code && i < own.n_walls; i++) {
    const eda_wall *w = &own.walls[i];
    if (w->left)
      add_edge(s, w->x, w->y1, w->y0, operand);
    else
      add_edge(s, w->x, w->y0, w->y1, operand);
  }
  sweep_clear(&own);
  return code;
}

static int add_operand(sweep *s, const eda_shapes *shapes, uint32_t operand,
                       opc_error *error) {
  int code = eda_shapes_check(shapes, error);
  for (size_t p = 0; !code && shapes && p < shapes->count; p++) {
    const eda_point *points = shapes->points + shapes->start[p];
    uint32_t n = shapes->start[p + 1] - shapes->start[p];
    if (shapes->hole)
      add_contour(s, points, n, shapes->hole[p] != 0, operand);
    else
      code = add_polygon(s, points, n, operand, error);
  }
  return code;
}

int eda_boolean(int op, const eda_shapes *a, const eda_shapes *b,
                eda_shapes *out, opc_error *error) {
  *out = (eda_shapes){0};
  if (op < EDA_OR || op > EDA_XOR)
    return opc_fail(error, OPC_INVALID, NULL, "unknown boolean operation %d",
                    op);
  sweep s = {.op = op};
  int code = add_operand(&s, a, 0, error);
  if (!code) code = add_operand(&s, b, OPERAND, error);
  if (!code) code = sweep_run(&s, error);
  if (!code) eda_trace(s.walls, s.n_walls, out);
  sweep_clear(&s);
  return code;
}
