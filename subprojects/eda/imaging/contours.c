/* SPDX-License-Identifier: BSD-3-Clause */
/* Contours of a field by marching squares, strip by strip (the two-dimensional
   case of Lorensen, Cline, "Marching cubes", 1987). A crossing is a zero of the
   field on a grid line, on which the field is a spline of one variable. */
#include "imaging/spline.h"

#include <eda/imaging.h>
#include <eda/memory.h>
#include <eda/simd.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

/* STRIP: number of rows of squares in a strip. Adjacent strips both evaluate
   their common row of nodes. */
enum { MAX_NODES = 1 << 26, STRIP = 64 };

/* Grid of squares on the window. A border of negative nodes around the window
   closes all contours at the window. */
typedef struct squares {
  const opc_context *context;
  const eda_field *field;
  eda_frame window;
  double dx, dy, field_dx, field_dy;
  int nx, ny;     /* numbers of nodes, including the border */
  int from, span; /* columns from .. from + span - 1 of the field are used
                     (modulo the period) */
  int *first;     /* for each node column: the first of the EDA_SPLINE_TAPS
                     columns of the field that contribute, minus `from` */
  double *weight; /* weights of these columns, [EDA_SPLINE_TAPS][nx] */
  struct strip *strip;
  size_t strips;
} squares;

/* Crossings of the squares between node rows j0 and j1, row by row: first the
   crossings on a row, then those on the vertical lines above the row. Numbers
   count .. all - 1 denote crossings on row j1, which belong to the next strip
   and have no position here. */
typedef struct strip {
  double *point; /* x, y of each crossing, nm */
  int32_t *next; /* number of the next crossing of the contour; -1: in another
                    strip */
  size_t count, all, points_capacity, next_capacity;
} strip;

/* A row of nodes. */
typedef struct row {
  double *spline;    /* coefficients of the splines along x on this row */
  double *value;     /* values at nodes */
  uint8_t *positive; /* 1: the value is positive; padded with zeros */
  int32_t *crossing; /* number of the crossing between each node and its right
                        neighbour */
} row;

/* ---- values ---- */

static double node_x(const squares *s, int i) {
  return s->window.x0 + (fmin(fmax(i, 1), s->nx - 2) - 1) * s->dx;
}

static double node_y(const squares *s, int j) {
  return s->window.y0 + (fmin(fmax(j, 1), s->ny - 2) - 1) * s->dy;
}

/* Return x of node column i, in field grid steps. */
static double field_x(const squares *s, int i) {
  return (node_x(s, i) - s->field->frame.x0) / s->field_dx;
}

static double field_y(const squares *s, int j) {
  return (node_y(s, j) - s->field->frame.y0) / s->field_dy;
}

EDA_WIDE static void nodes_weigh(const float *const c[EDA_SPLINE_TAPS],
                                 const double w[EDA_SPLINE_TAPS], int n,
                                 double *out) {
  for (int i = 0; i < n; i++)
    out[i] = w[0] * c[0][i] + w[1] * c[1][i] + w[2] * c[2][i] + w[3] * c[3][i] +
             w[4] * c[4][i] + w[5] * c[5][i];
}

/* Compute the coefficients of the splines along x at y (in field grid
   steps). */
static void weigh_rows(const squares *s, double y, double *out) {
  const eda_field *f = s->field;
  double w[EDA_SPLINE_TAPS];
  int first = eda_spline_weights(y, w);
  for (int done = 0, n; done < s->span; done += n) {
    const float *c[EDA_SPLINE_TAPS];
    int column = eda_wrap(s->from + done, f->nx);
    n = s->span - done < f->nx - column ? s->span - done : f->nx - column;
    for (int k = 0; k < EDA_SPLINE_TAPS; k++)
      c[k] =
          f->coefficients + (size_t)eda_wrap(first + k, f->ny) * f->nx + column;
    nodes_weigh(c, w, n, out + done);
  }
}

EDA_WIDE static void weigh_columns(const double *spline, const int *first,
                                   const double *w, int n, double *value,
                                   uint8_t *positive) {
  for (int i = 0; i < n; i++) {
    const double *c = spline + first[i];
    value[i] = w[i] * c[0] + w[i + n] * c[1] + w[i + 2 * n] * c[2] +
               w[i + 3 * n] * c[3] + w[i + 4 * n] * c[4] + w[i + 5 * n] * c[5];
  }
  for (int i = 0; i < n; i++) positive[i] = value[i] > 0;
}

/* Evaluate a row of nodes. Nodes of a row share the spline weights along y;
   nodes of a column share the weights along x. */
static void row_evaluate(const squares *s, int j, row *r) {
  int n = s->nx;
  if (j == 0 || j == s->ny - 1) {
    memset(r->positive, 0, (size_t)n);
    return;
  }
  weigh_rows(s, field_y(s, j), r->spline);
  weigh_columns(r->spline, s->first, s->weight, n, r->value, r->positive);
  r->positive[0] = r->positive[n - 1] = 0;
}

/* ---- crossings ---- */

/* Return the zero of a spline within one cell. c: coefficients of the cell; t0,
   t1: bracket as fractions of the cell; a, b: values of opposite sign at t0 and
   t1. Uses Newton's method, with bisection if a step leaves the bracket. */
static double zero_in_cell(const double *c, double t0, double t1, double a,
                           double b) {
  enum { STEPS = 20 };
  static const double near =
      1e-3; /* last step at termination, in cells; the error is about near^2 */
  double q[EDA_SPLINE_TAPS] = {0}, t = t0 + (t1 - t0) * (a / (a - b));
  for (int d = 0; d < EDA_SPLINE_TAPS; d++)
    for (int k = 0; k < EDA_SPLINE_TAPS; k++)
      q[d] += eda_spline_power[d][k] * c[k];
  for (int i = 0; i < STEPS; i++) {
    double v = q[EDA_SPLINE_TAPS - 1], slope = 0, before = t;
    for (int d = EDA_SPLINE_TAPS - 2; d >= 0; d--) {
      slope = v + t * slope;
      v = q[d] + t * v;
    }
    *((v > 0) == (a > 0) ? &t0 : &t1) = t;
    t -= v / slope;
    if (!(t >= t0 && t <= t1)) t = (t0 + t1) / 2;
    if (fabs(t - before) < near) break;
  }
  return t;
}

/* Return the zero between u0 and u1 (in cells) of a spline whose coefficients
   start at node `first`. a, b: values of opposite sign at u0 and u1. */
static double spline_zero(const double *spline, int first, double u0, double u1,
                          double a, double b) {
  int cell = (int)floor(u0);
  for (;; cell++) {
    const double *c = spline + cell - 2 - first;
    double end = fmin(u1, cell + 1), v = b;
    if (end < u1) v = (c[1] + c[5] + 26 * (c[2] + c[4]) + 66 * c[3]) / 120;
    if (end == u1 || (v > 0) != (a > 0))
      return cell + zero_in_cell(c, u0 - cell, end - cell, a, v);
    u0 = end, a = v;
  }
}

static void add_point(strip *p, double x, double y) {
  eda_grow(&p->point, &p->points_capacity, 2 * p->count + 2, sizeof *p->point);
  p->point[2 * p->count] = x;
  p->point[2 * p->count++ + 1] = y;
}

/* Add the crossing to the right of node i of row j. Next to the border, the
   crossing is on the edge of the window. */
static void cross_row(const squares *s, strip *p, int j, int i, const row *r) {
  double x = node_x(s, i);
  if (i > 0 && i < s->nx - 2)
    x = s->field->frame.x0 +
        s->field_dx * spline_zero(r->spline, s->from, field_x(s, i),
                                  field_x(s, i + 1), r->value[i],
                                  r->value[i + 1]);
  add_point(p, x, node_y(s, j));
}

/* Add the crossing above node i of row j. `column` is scratch memory for the
   spline coefficients along y. */
static void cross_column(const squares *s, strip *p, int j, int i,
                         const row *low, const row *high, double *column) {
  const eda_field *f = s->field;
  double y = node_y(s, j);
  if (j > 0 && j < s->ny - 2) {
    double u0 = field_y(s, j), u1 = field_y(s, j + 1);
    int first = (int)floor(u0) - 2, n = (int)floor(u1) - 2 - first;
    int x[EDA_SPLINE_TAPS];
    for (int k = 0; k < EDA_SPLINE_TAPS; k++)
      x[k] = eda_wrap(s->from + s->first[i] + k, f->nx);
    for (int m = 0; m < n + EDA_SPLINE_TAPS; m++) {
      const float *c =
          f->coefficients + (size_t)eda_wrap(first + m, f->ny) * f->nx;
      double sum = 0;
      for (int k = 0; k < EDA_SPLINE_TAPS; k++)
        sum += s->weight[k * s->nx + i] * c[x[k]];
      column[m] = sum;
    }
    y = f->frame.y0 + s->field_dy * spline_zero(column, first, u0, u1,
                                                low->value[i], high->value[i]);
  }
  add_point(p, node_x(s, i), y);
}

/* ---- strips ---- */

/* Connect the crossings of a square; the positive region is on the left of
   contours. edge[k]: crossings on the lower, right, upper and left edge. v[k]:
   value at the corner before edge k, counter-clockwise. Bit k of `set`: corner
   k is positive. A contour begins on an edge from a positive to a negative
   corner, and ends on an edge from a negative to a positive corner. */
static void strip_join(strip *p, const int32_t edge[4], const double v[4],
                       int set) {
  int centre = v[0] + v[1] + v[2] + v[3] > 0;
  for (int k = 0; k < 4; k++) {
    if (!(set >> k & 1) || set >> (k + 1) % 4 & 1) continue;
    /* At a saddle, the sign of the mean value selects the connection. */
    int turn = centre ? 1 : 3, to = (k + turn) % 4;
    while (set >> to & 1 || !(set >> (to + 1) % 4 & 1)) to = (to + turn) % 4;
    p->next[edge[k]] = edge[to];
  }
}

/* Scratch memory of a strip: two node rows and the crossings between the
   rows. */
typedef struct bench {
  row low, high;
  int *mixed;     /* columns of squares whose corners differ in sign */
  int32_t *above; /* number of the crossing above each node */
  double *column;
} bench;

static row new_row(const squares *s) {
  size_t n = (size_t)s->nx;
  return (row){.spline = eda_alloc((size_t)s->span, sizeof(double)),
               .value = eda_alloc(n, sizeof(double)),
               .positive = eda_alloc(n + 8, 1),
               .crossing = eda_alloc(n, sizeof(int32_t))};
}

static void free_row(row *r) {
  free(r->spline);
  free(r->value);
  free(r->positive);
  free(r->crossing);
}

/* Find the squares whose corners differ in sign. Return their number. Tests
   eight squares at a time, because most squares have corners of one sign. */
static int find_mixed(const squares *s, bench *b) {
  const uint8_t *low = b->low.positive, *high = b->high.positive;
  int n = 0;
  for (int i = 0; i + 1 < s->nx; i += 8) {
    uint64_t v[4];
    memcpy(&v[0], low + i, 8);
    memcpy(&v[1], low + i + 1, 8);
    memcpy(&v[2], high + i, 8);
    memcpy(&v[3], high + i + 1, 8);
    uint64_t differ = (v[0] ^ v[1]) | (v[0] ^ v[2]) | (v[0] ^ v[3]);
    for (; differ; differ &= differ - 1) {
      int k = i + __builtin_ctzll(differ) / 8;
      if (k + 1 < s->nx) b->mixed[n++] = k;
    }
  }
  return n;
}

/* Number the crossings between rows j and j + 1, then the crossings on row j +
   1. Crossings on row `end` belong to the next strip. */
static void row_cross(const squares *s, strip *p, bench *b, int j, int n,
                      int end) {
  for (int m = 0; m < n; m++) {
    int i = b->mixed[m];
    if (b->low.positive[i] == b->high.positive[i]) continue;
    b->above[i] = (int32_t)p->count;
    cross_column(s, p, j, i, &b->low, &b->high, b->column);
  }
  p->all = p->count;
  for (int m = 0; m < n; m++) {
    int i = b->mixed[m];
    if (b->high.positive[i] == b->high.positive[i + 1]) continue;
    b->high.crossing[i] = (int32_t)p->all++;
    if (j + 1 < end) cross_row(s, p, j + 1, i, &b->high);
  }
  size_t had = p->next_capacity;
  eda_grow(&p->next, &p->next_capacity, p->all, sizeof *p->next);
  if (p->next_capacity > had)
    memset(p->next + had, 0xff, (p->next_capacity - had) * sizeof *p->next);
}

static void join_row(strip *p, bench *b, int n) {
  const row *low = &b->low, *high = &b->high;
  for (int m = 0; m < n; m++) {
    int i = b->mixed[m];
    const int32_t edge[4] = {low->crossing[i], b->above[i + 1],
                             high->crossing[i], b->above[i]};
    const double v[4] = {low->value[i], low->value[i + 1], high->value[i + 1],
                         high->value[i]};
    int set = low->positive[i] | low->positive[i + 1] << 1 |
              high->positive[i + 1] << 2 | high->positive[i] << 3;
    strip_join(p, edge, v, set);
  }
}

/* Number the crossings on the first row of a strip. */
static void begin_strip(const squares *s, strip *p, bench *b, int j) {
  row_evaluate(s, j, &b->high);
  for (int i = 0; i + 1 < s->nx; i++)
    if (b->high.positive[i] != b->high.positive[i + 1]) {
      b->high.crossing[i] = (int32_t)p->count;
      cross_row(s, p, j, i, &b->high);
    }
}

static void make_strip(void *data, size_t k) {
  const squares *s = data;
  strip *p = &s->strip[k];
  int j = (int)k * STRIP, end = j + STRIP < s->ny - 1 ? j + STRIP : s->ny - 1;
  size_t n = (size_t)s->nx;
  if (opc_cancelled(s->context)) return;
  bench b = {new_row(s), new_row(s), eda_alloc(n, sizeof *b.mixed),
             eda_alloc(n, sizeof *b.above),
             eda_alloc((size_t)ceil(s->dy / s->field_dy) + 1 + EDA_SPLINE_TAPS,
                       sizeof *b.column)};
  begin_strip(s, p, &b, j);
  for (; j < end; j++) {
    row low = b.low;
    b.low = b.high;
    b.high = low;
    row_evaluate(s, j + 1, &b.high);
    int mixed = find_mixed(s, &b);
    row_cross(s, p, &b, j, mixed, end);
    join_row(p, &b, mixed);
  }
  free_row(&b.low);
  free_row(&b.high);
  free(b.mixed);
  free(b.above);
  free(b.column);
}

/* ---- tracing ---- */

/* All crossings and their successors. */
typedef struct lines {
  double *point;
  int32_t *next;
  size_t count;
} lines;

/* Copy the crossings of a strip, their successors, and the successors of the
   first crossings of the next strip. */
static void take_strip(lines *all, const strip *p, size_t base) {
  if (p->count)
    memcpy(all->point + 2 * base, p->point, 2 * p->count * sizeof *p->point);
  for (size_t i = 0; i < p->all; i++)
    if (p->next[i] >= 0) all->next[base + i] = (int32_t)base + p->next[i];
}

static lines strips_merge(squares *s) {
  lines all = {0};
  for (size_t k = 0; k < s->strips; k++) all.count += s->strip[k].count;
  all.point = eda_alloc(2 * all.count, sizeof *all.point);
  all.next = eda_alloc(all.count, sizeof *all.next);
  size_t base = 0;
  for (size_t k = 0; k < s->strips; k++) {
    strip *p = &s->strip[k];
    take_strip(&all, p, base);
    base += p->count;
    free(p->point);
    free(p->next);
  }
  return all;
}

/* Trace all contours. A visited crossing has successor -1. */
static void lines_trace(lines *all, double *points, uint32_t **start,
                        size_t *count) {
  size_t capacity = 0, length = 0;
  *count = 0;
  for (size_t i = 0; i < all->count; i++) {
    if (all->next[i] < 0) continue;
    EDA_PUSH(*start, *count, capacity, (uint32_t)length);
    for (int32_t k = (int32_t)i; all->next[k] >= 0;) {
      memcpy(points + 2 * length++, all->point + 2 * (size_t)k,
             2 * sizeof *points);
      int32_t from = k;
      k = all->next[k];
      all->next[from] = -1;
    }
  }
  eda_grow(start, &capacity, *count + 1, sizeof **start);
  (*start)[*count] = (uint32_t)length;
}

/* ---- setup ---- */

static int size_up(squares *s, double step, opc_error *error) {
  eda_frame w = s->window;
  double columns = ceil(w.width / step), rows = ceil(w.height / step);
  if (!(columns >= 1 && rows >= 1 && columns * rows < MAX_NODES))
    return opc_fail(error, OPC_INVALID, NULL,
                    "a window of %g x %g nm does not fit a step of %g nm",
                    w.width, w.height, step);
  s->dx = w.width / columns;
  s->dy = w.height / rows;
  s->field_dx = s->field->frame.width / s->field->nx;
  s->field_dy = s->field->frame.height / s->field->ny;
  s->nx = (int)columns + 3;
  s->ny = (int)rows + 3;
  s->strips = ((size_t)s->ny - 2) / STRIP + 1;
  return OPC_OK;
}

static void weigh_all(squares *s) {
  int n = s->nx;
  s->first = eda_alloc((size_t)n, sizeof *s->first);
  s->weight = eda_alloc(EDA_SPLINE_TAPS * (size_t)n, sizeof *s->weight);
  for (int i = 0; i < n; i++) {
    double w[EDA_SPLINE_TAPS];
    int first = eda_spline_weights(field_x(s, i), w);
    if (i == 0) s->from = first;
    s->first[i] = first - s->from;
    for (int k = 0; k < EDA_SPLINE_TAPS; k++) s->weight[k * n + i] = w[k];
  }
  s->span = s->first[n - 1] + EDA_SPLINE_TAPS;
}

int eda_contours(const opc_context *context, const eda_field *field,
                 eda_frame window, double step, double **points,
                 uint32_t **start, size_t *count, opc_error *error) {
  squares s = {.context = context, .field = field, .window = window};
  *points = NULL;
  *start = NULL;
  *count = 0;
  if (size_up(&s, step, error)) return error->code;
  weigh_all(&s);
  s.strip = eda_alloc(s.strips, sizeof *s.strip);
  opc_parallel(context, s.strips, make_strip, &s);
  lines all = strips_merge(&s);
  free(s.strip);
  free(s.first);
  free(s.weight);
  int code = OPC_OK;
  if (opc_cancelled(context)) {
    code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  } else {
    *points = eda_alloc(2 * all.count, sizeof **points);
    lines_trace(&all, *points, start, count);
  }
  free(all.point);
  free(all.next);
  return code;
}
