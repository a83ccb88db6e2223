/* SPDX-License-Identifier: BSD-3-Clause */
/* Contours by marching squares (Lorensen, Cline 1987, in the plane), each
   crossing then refined on the field itself. */
#include "imaging/spline.h"

#include <eda/imaging.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_NODES = 1 << 26, BITS = 64 };

/* Nodes of the grid with a ring of negative ones around the window, which
   closes every line along the border. Edge 2 * node goes from the node to its
   right, edge 2 * node + 1 upwards. */
typedef struct squares {
  const eda_field *field;
  eda_frame window;
  double dx, dy;
  int nx, ny; /* nodes with the ring */
  double *value;
  int32_t *next;    /* of each edge that a line leaves a square through */
  uint64_t *leaves; /* a bit of each edge: whether it is one of those */
} squares;

static double node_x(const squares *s, int i) {
  return s->window.x0 + (fmin(fmax(i, 1), s->nx - 2) - 1) * s->dx;
}

static double node_y(const squares *s, int j) {
  return s->window.y0 + (fmin(fmax(j, 1), s->ny - 2) - 1) * s->dy;
}

static double at(const squares *s, double x, double y) {
  double v;
  eda_field_sample(s->field, &x, &y, 1, &v);
  return v;
}

/* A place on an axis of the field: where its splines begin, and their values.
 */
typedef struct place {
  int first;
  double weight[EDA_SPLINE_TAPS];
} place;

static place place_of(double x, double x0, double step) {
  place p;
  p.first = eda_spline_weights((x - x0) / step, p.weight);
  return p;
}

/* One row of the field's columns `from` and on, `n` of them, at a place along
   y. */
static void weigh_rows(const eda_field *f, const place *y, int from, int n,
                       double *out) {
  memset(out, 0, (size_t)n * sizeof *out);
  for (int k = 0; k < EDA_SPLINE_TAPS; k++) {
    const float *c =
        f->coefficients + (size_t)eda_wrap(y->first + k, f->ny) * f->nx;
    int column = eda_wrap(from, f->nx);
    for (int i = 0; i < n; i++) {
      out[i] += y->weight[k] * c[column];
      column = column + 1 < f->nx ? column + 1 : 0;
    }
  }
}

/* The nodes of a row share their splines along y, those of a column along x:
   a tenth of the work of as many single places. */
static void evaluate(squares *s) {
  const eda_field *f = s->field;
  double dx = f->frame.width / f->nx, dy = f->frame.height / f->ny;
  place *x = eda_alloc((size_t)s->nx, sizeof *x);
  for (int i = 0; i < s->nx; i++)
    x[i] = place_of(node_x(s, i), f->frame.x0, dx);
  int from = x[0].first, n = x[s->nx - 1].first - from + EDA_SPLINE_TAPS;
  double *row = eda_alloc((size_t)n, sizeof *row);
  for (int j = 0; j < s->ny; j++) {
    place y = place_of(node_y(s, j), f->frame.y0, dy);
    double *value = s->value + (size_t)j * s->nx;
    weigh_rows(f, &y, from, n, row);
    for (int i = 0; i < s->nx; i++) {
      int ring = i == 0 || j == 0 || i == s->nx - 1 || j == s->ny - 1;
      double sum = 0;
      for (int k = 0; k < EDA_SPLINE_TAPS; k++)
        sum += x[i].weight[k] * row[x[i].first - from + k];
      value[i] = ring ? -1 : sum;
    }
  }
  free(row);
  free(x);
}

/* Join the crossings of a square: with the positive side on the left, a line
   goes from an edge that leads (counter-clockwise) out of the positive to one
   that leads into it. */
static void join(squares *s, int i, int j) {
  int32_t a = j * s->nx + i, up = a + s->nx;
  const int32_t edge[4] = {2 * a, 2 * (a + 1) + 1, 2 * up, 2 * a + 1};
  const double v[4] = {s->value[a], s->value[a + 1], s->value[up + 1],
                       s->value[up]};
  int centre = v[0] + v[1] + v[2] + v[3] > 0;
  for (int k = 0; k < 4; k++) {
    if (!(v[k] > 0) || v[(k + 1) % 4] > 0) continue;
    /* In a saddle the sign of the centre tells which corner is cut off. */
    int turn = centre ? 1 : 3, to = (k + turn) % 4;
    while (v[to] > 0 || !(v[(to + 1) % 4] > 0)) to = (to + turn) % 4;
    s->next[edge[k]] = edge[to];
    s->leaves[edge[k] / BITS] |= 1ULL << edge[k] % BITS;
  }
}

/* Where the line crosses an edge. */
static void crossing(const squares *s, int32_t edge, double *point) {
  int32_t n = edge / 2, m = edge % 2 ? n + s->nx : n + 1;
  double xa = node_x(s, n % s->nx), ya = node_y(s, n / s->nx);
  double xb = node_x(s, m % s->nx), yb = node_y(s, m / s->nx);
  double a = s->value[n], b = s->value[m], low = 0, high = 1, t = 0.5;
  for (int i = 0; i < 4 && (xa != xb || ya != yb); i++) {
    t = low + (high - low) * a / (a - b);
    double v = at(s, xa + t * (xb - xa), ya + t * (yb - ya));
    if ((v > 0) == (a > 0))
      low = t, a = v;
    else
      high = t, b = v;
    if (fabs(v) < 1e-9) break;
  }
  point[0] = xa + t * (xb - xa);
  point[1] = ya + t * (yb - ya);
}

/* Most squares are on one side. */
static void join_all(squares *s) {
  for (int j = 0; j + 1 < s->ny; j++) {
    const double *v = s->value + (size_t)j * s->nx, *up = v + s->nx;
    for (int i = 0; i + 1 < s->nx; i++) {
      int positive =
          (v[i] > 0) + (v[i + 1] > 0) + (up[i] > 0) + (up[i + 1] > 0);
      if (positive % 4) join(s, i, j);
    }
  }
}

static size_t words(const squares *s) {
  return 2 * (size_t)s->nx * (size_t)s->ny / BITS + 1;
}

/* Whether a line leaves through an edge that was not taken yet; takes it. */
static int take(uint64_t *left, int32_t edge) {
  uint64_t bit = 1ULL << edge % BITS, *word = &left[edge / BITS];
  if (!(*word & bit)) return 0;
  *word &= ~bit;
  return 1;
}

/* Walk all lines; with points NULL, only count. */
static void walk(const squares *s, double *points, uint32_t *start,
                 size_t *lines, size_t *length) {
  *lines = *length = 0;
  size_t n = words(s);
  uint64_t *left = eda_alloc(n, sizeof *left);
  memcpy(left, s->leaves, n * sizeof *left);
  for (size_t w = 0; w < n; w++)
    while (left[w]) {
      if (start) start[*lines] = (uint32_t)*length;
      int32_t k = (int32_t)(w * BITS) + __builtin_ctzll(left[w]);
      for (; take(left, k); k = s->next[k]) {
        if (points) crossing(s, k, points + 2 * *length);
        ++*length;
      }
      ++*lines;
    }
  if (start) start[*lines] = (uint32_t)*length;
  free(left);
}

int eda_contours(const eda_field *field, eda_frame window, double step,
                 double **points, uint32_t **start, size_t *count,
                 opc_error *error) {
  *points = NULL;
  *start = NULL;
  *count = 0;
  double columns = ceil(window.width / step), rows = ceil(window.height / step);
  if (!(columns >= 1 && rows >= 1 && columns * rows < MAX_NODES))
    return opc_fail(error, OPC_INVALID, NULL,
                    "a window of %g x %g nm does not fit a step of %g nm",
                    window.width, window.height, step);
  squares s = {.field = field,
               .window = window,
               .dx = window.width / columns,
               .dy = window.height / rows,
               .nx = (int)columns + 3,
               .ny = (int)rows + 3};
  size_t nodes = (size_t)s.nx * s.ny, length;
  s.value = eda_alloc(nodes, sizeof *s.value);
  s.next = eda_alloc(2 * nodes, sizeof *s.next);
  s.leaves = eda_alloc(words(&s), sizeof *s.leaves);
  evaluate(&s);
  join_all(&s);
  walk(&s, NULL, NULL, count, &length);
  *points = eda_alloc(2 * length, sizeof **points);
  *start = eda_alloc(*count + 1, sizeof **start);
  walk(&s, *points, *start, count, &length);
  free(s.value);
  free(s.next);
  free(s.leaves);
  return OPC_OK;
}
