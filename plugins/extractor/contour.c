/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the slicing of a printed gate into few slices that preserve the
   width, the area and both currents of its contour. The length is measured at
   Chebyshev nodes along the width, and a Chebyshev series interpolates the
   squared length. The squared length is smooth even at a rounded line end,
   where the length decreases to 0 like a square root. Slices are located at
   some of the nodes. The initial width of a slice is the width of the part of
   the gate nearest to the slice. The widths are then scaled by factors as close
   to 1 as possible, so that the sums over slices equal the integrals of the
   series. */
#include "contour.h"

#include <eda/memory.h>
#include <eda/simd.h>
#include <gsl/gsl_integration.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "edges.h"

enum {
  SIZES = 9,
  LARGEST = 128,
  NODES = 32, /* nodes of a subinterval of the integrals */
  PIECES = 3,
  LANES = 8, /* nodes per vector instruction */
  /* Sums to preserve: width, area, Ion, Ioff; with edge currents (edges.h),
     also the sum of the shares of each edge current. */
  MOMENTS = 6,
  WIDE_MOMENTS = 4,
  PLACES = LARGEST + 2, /* nodes, and one slice for each unprinted end */
  MORE = 2              /* number of larger sizes that are tried if no widths
                           fit */
};
static const int sizes[SIZES] = {12, 16, 20, 24, 32, 48, 64, 96, LARGEST};

/* Largest contribution of the last two terms of a series to a length, nm; on
   average the contribution is far smaller. 1 nm changes Ion by 2 to 5 %. */
static const double enough = 0.02;
/* Width of the regions at both ends of the gate's width that have subintervals
   of their own in the integrals, because the length may change fast there, nm.
 */
static const double rounding = 45;

struct contour {
  double *series[SIZES]; /* matrix from squared lengths at the nodes to
                            coefficients: [node * size + coefficient] */
  double *place[SIZES];  /* [size], nodes, -1 to 1 */
  double node[NODES], share[NODES]; /* Gauss-Legendre rule on [0, 1] */
};

/* A gate during slicing. x from -1 to 1 corresponds to positions `from` to `to`
   along W, fractions of the gate's width. Outside, the line does not print. */
typedef struct shape {
  const eda_curves *table;
  contour_weight *weight;
  const void *self;
  const eda_printed_gate *gate;
  edges edges;
  int by_place; /* 1: currents also depend on the position */
  int moments;  /* number of sums to preserve */
  double from, to;
  int size;
  double coefficient[LARGEST], length[LARGEST];
} shape;

/* ---- the series ---- */

static void size_init(contour *c, int s) {
  size_t n = (size_t)sizes[s];
  double *series = c->series[s] = eda_alloc(n * n, sizeof *series);
  double *place = c->place[s] = eda_alloc(n, sizeof *place);
  for (size_t j = 0; j < n; j++) {
    double angle = M_PI * ((double)(n - 1 - j) + 0.5) / (double)n;
    place[j] = cos(angle);
    for (size_t k = 0; k < n; k++)
      series[j * n + k] = (k ? 2 : 1) * cos((double)k * angle) / (double)n;
  }
}

contour *contour_new(void) {
  contour *c = eda_alloc(1, sizeof *c);
  gsl_integration_glfixed_table *t = gsl_integration_glfixed_table_alloc(NODES);
  for (int s = 0; s < SIZES; s++) size_init(c, s);
  for (size_t i = 0; i < NODES; i++)
    gsl_integration_glfixed_point(0, 1, i, &c->node[i], &c->share[i], t);
  gsl_integration_glfixed_table_free(t);
  return c;
}

void contour_free(contour *c) {
  for (int s = 0; s < SIZES && c; s++) {
    free(c->series[s]);
    free(c->place[s]);
  }
  free(c);
}

static double place_of(const shape *h, double x) {
  return h->from + (h->to - h->from) * (x + 1) / 2;
}

/* Compute the coefficients of the series from the measured lengths. */
EDA_WIDE static void shape_transform(const double *series, shape *h) {
  size_t n = (size_t)h->size;
  for (size_t k = 0; k < n; k++) h->coefficient[k] = 0;
  for (size_t j = 0; j < n; j++) {
    const double *row = series + j * n;
    double square = h->length[j] * h->length[j];
    for (size_t k = 0; k < n; k++) h->coefficient[k] += row[k] * square;
  }
}

typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));

/* Evaluate the series at n positions, n a multiple of 2 LANES (Clenshaw's
   recurrence, two vectors at a time). */
EDA_WIDE static void shape_lengths(const shape *h, size_t n, const double *x,
                                   double *out) {
  for (size_t i = 0; i < n; i += 2 * LANES) {
    lanes x0, x1, b0 = {0}, b1 = {0}, before0 = {0}, before1 = {0};
    memcpy(&x0, x + i, sizeof x0);
    memcpy(&x1, x + i + LANES, sizeof x1);
    for (int k = h->size - 1; k > 0; k--) {
      double a = h->coefficient[k];
      lanes next0 = (a - before0) + 2 * x0 * b0;
      lanes next1 = (a - before1) + 2 * x1 * b1;
      before0 = b0;
      before1 = b1;
      b0 = next0;
      b1 = next1;
    }
    b0 = h->coefficient[0] - before0 + x0 * b0;
    b1 = h->coefficient[0] - before1 + x1 * b1;
    memcpy(out + i, &b0, sizeof b0);
    memcpy(out + i + LANES, &b1, sizeof b1);
  }
  for (size_t i = 0; i < n; i++) out[i] = sqrt(out[i] > 0 ? out[i] : 0);
}

/* Measure the lengths at the nodes of size s. Return an upper bound of the
   contribution of the last two terms to the longest length, nm; NAN if a length
   is not finite or all lengths are 0. */
static double shape_measure(const contour *c, int s, shape *h) {
  double longest = 0;
  h->size = sizes[s];
  size_t n = (size_t)h->size;
  double place[LARGEST];
  for (size_t j = 0; j < n; j++) place[j] = place_of(h, c->place[s][j]);
  h->gate->lengths(h->gate, n, place, h->length);
  for (size_t j = 0; j < n; j++) {
    double l = h->length[j];
    if (!isfinite(l)) return NAN;
    longest = fmax(longest, l);
  }
  shape_transform(c->series[s], h);
  double last = fabs(h->coefficient[n - 1]) + fabs(h->coefficient[n - 2]);
  return longest > 0 ? last / (2 * longest) : NAN;
}

/* ---- the integrals ---- */

/* Compute the functions whose integrals over the width are preserved, at a
   position with the given length. Order: as the sums (MOMENTS). */
static inline void shape_functions(const shape *h, double place, double length,
                                   double f[MOMENTS]) {
  f[0] = 1;
  f[1] = length;
  eda_curves_quick(h->table, h->gate->type, length, f + 2);
  if (!h->by_place) return;
  double edge = h->gate->width * fmin(place, 1 - place);
  if (!h->edges.width.is_wide) {
    double narrow[EDA_CURRENTS];
    eda_curves_narrow_quick(h->table, h->gate->type, length, &h->edges.width,
                            narrow);
    for (int k = 0; k < EDA_CURRENTS; k++) {
      f[WIDE_MOMENTS + k] = edges_share(&h->edges, k, edge);
      f[2 + k] += (narrow[k] - f[2 + k]) * f[WIDE_MOMENTS + k];
    }
  }
  for (int k = 0; k < EDA_CURRENTS && h->weight; k++)
    f[2 + k] *= h->weight(h->self, h->gate->type, k, edge, h->gate->width);
}

/* Add the functions at n positions, times `share`, to the sums. */
static void shape_add_places(const shape *h, size_t n, const double *x,
                             const double *length, const double *share,
                             double sum[MOMENTS]) {
  double part[MOMENTS] = {0};
  for (size_t i = 0; i < n; i++) {
    double f[MOMENTS] = {0};
    shape_functions(h, h->by_place ? place_of(h, x[i]) : 0, length[i], f);
    for (int k = 0; k < MOMENTS; k++) part[k] += share[i] * f[k];
  }
  for (int k = 0; k < MOMENTS; k++) sum[k] += part[k];
}

/* Compute the integrals of the functions over the width. The ends of the device
   table need no subinterval, because the extrapolation is smooth. */
static void shape_integrate(const contour *c, const shape *h,
                            double sum[MOMENTS]) {
  double part =
      fmin(2.0 / 3, 2 * rounding / (h->gate->width * (h->to - h->from)));
  const double border[PIECES + 1] = {-1, -1 + part, 1 - part, 1};
  double x[PIECES * NODES], share[PIECES * NODES], length[PIECES * NODES];
  size_t n = 0;
  for (int p = 0; p < PIECES; p++) {
    double span = border[p + 1] - border[p];
    for (int i = 0; i < NODES; i++) {
      x[n] = border[p] + span * c->node[i];
      share[n++] = c->share[i] * span / 2 * (h->to - h->from);
    }
  }
  shape_lengths(h, n, x, length);
  for (int k = 0; k < MOMENTS; k++) sum[k] = 0;
  shape_add_places(h, n, x, length, share, sum);
  /* Fractions of the width at both ends in which the line does not print. */
  const double gone[2] = {h->from, 1 - h->to};
  for (int side = 0; side < 2; side++) {
    double f[MOMENTS] = {0}, place = side ? (1 + h->to) / 2 : h->from / 2;
    shape_functions(h, place, 0, f);
    for (int k = 0; k < h->moments; k++) sum[k] += gone[side] * f[k];
  }
}

/* ---- the slices ---- */

/* Return the index, among m nodes, of slice i of n. On each side, the first k
   slices are at the k outermost nodes, where the length changes fast. All other
   slices are spread evenly over the nodes between. */
static size_t slice_pick(size_t i, size_t n, size_t m, size_t k) {
  if (i < k) return i;
  if (i >= n - k) return m - (n - i);
  size_t gaps = n - 2 * k + 1;
  return k - 1 + ((i - k + 1) * (m - 2 * k + 1) + gaps / 2) / gaps;
}

/* Choose the positions of n slices: one in each unprinted end, all others at
   nodes. Assign to each slice the part of the width nearest to the slice. */
static void slices_choose(const contour *c, int s, const shape *h, size_t n,
                          size_t outer, double *place, double *width,
                          double *length) {
  size_t first = h->from > 0, last = n - (h->to < 1), inner = last - first;
  if (first) place[0] = h->from / 2, length[0] = 0;
  if (last < n) place[last] = (1 + h->to) / 2, length[last] = 0;
  for (size_t i = 0; i < inner; i++) {
    size_t j = slice_pick(i, inner, (size_t)h->size, outer);
    place[first + i] = place_of(h, c->place[s][j]);
    length[first + i] = h->length[j];
  }
  double before = 0;
  for (size_t i = 0; i < n; i++) {
    double after = i + 1 == n ? 1 : (place[i] + place[i + 1]) / 2;
    if (first && i == 0) after = h->from;
    if (i + 1 == last && last < n) after = h->to;
    width[i] = after - before;
    before = after;
  }
}

/* Solve a symmetric positive definite system of equations in place (Cholesky).
   Return 0 if the matrix is not positive definite. */
static int cholesky_solve(double a[MOMENTS][MOMENTS], double x[MOMENTS],
                          int n) {
  for (int i = 0; i < n; i++) {
    for (int j = 0; j <= i; j++) {
      double sum = a[i][j];
      for (int k = 0; k < j; k++) sum -= a[i][k] * a[j][k];
      if (j < i)
        a[i][j] = sum / a[j][j];
      else if (!(sum > 0))
        return 0;
      else
        a[i][i] = sqrt(sum);
    }
    for (int k = 0; k < i; k++) x[i] -= a[i][k] * x[k];
    x[i] /= a[i][i];
  }
  for (int i = n - 1; i >= 0; i--) {
    for (int k = i + 1; k < n; k++) x[i] -= a[k][i] * x[k];
    x[i] /= a[i][i];
  }
  return 1;
}

/* Functions of n slices, each divided by the sum to preserve. */
typedef struct slices {
  size_t n;
  double f[PLACES][MOMENTS];
} slices;

/* Scale the widths by factors nearest to 1 (least squares) so that the first
   `moments` sums are 1. Return 1. If a factor is negative, set the width with
   the lowest factor to 0 and return 0: the caller tries again. If the equations
   have no solution, return 1 with unchanged widths, which slices_add_up
   detects. */
static int slices_fit(const slices *s, int moments, double *width) {
  double a[MOMENTS][MOMENTS] = {{0}}, r[MOMENTS] = {1, 1, 1, 1, 1, 1};
  for (size_t i = 0; i < s->n; i++)
    for (int k = 0; k < moments; k++) {
      r[k] -= width[i] * s->f[i][k];
      for (int m = 0; m <= k; m++)
        a[k][m] += width[i] * s->f[i][k] * s->f[i][m];
    }
  /* All slices of a rectangle have equal functions, so the matrix would be
     singular. */
  for (int k = 0; k < moments; k++) a[k][k] *= 1 + 1e-12;
  if (!cholesky_solve(a, r, moments)) return 1;
  double factor[PLACES] = {0}, least = 0;
  size_t lowest = s->n;
  for (size_t i = 0; i < s->n; i++) {
    factor[i] = 1;
    for (int k = 0; k < moments; k++) factor[i] += r[k] * s->f[i][k];
    if (width[i] > 0 && factor[i] < least) least = factor[lowest = i];
  }
  if (lowest < s->n) {
    width[lowest] = 0;
    return 0;
  }
  for (size_t i = 0; i < s->n; i++) width[i] *= factor[i];
  return 1;
}

/* Return 1 if the first `moments` sums are 1. */
static int slices_add_up(const slices *s, int moments, const double *width) {
  for (int k = 0; k < moments; k++) {
    double sum = 0;
    for (size_t i = 0; i < s->n; i++) sum += width[i] * s->f[i][k];
    if (!(fabs(sum - 1) < 1e-7)) return 0;
  }
  return 1;
}

/* Scale the widths so that the first `moments` sums and the total width are 1.
   Return 0 if no widths satisfy the sums. */
static int slices_settle(const slices *s, int moments, double *width) {
  for (size_t left = s->n; left > (size_t)moments; left--)
    if (slices_fit(s, moments, width)) break;
  if (!slices_add_up(s, moments, width)) return 0;
  double total = 0;
  for (size_t i = 0; i < s->n; i++) total += width[i];
  for (size_t i = 0; i < s->n; i++) width[i] /= total;
  return 1;
}

/* Find n slices that preserve the first `moments` sums. Return 0 on failure. */
static int slices_try(const contour *c, int s, const shape *h,
                      const double sum[MOMENTS], int moments, size_t n,
                      double *place, double *width) {
  slices all = {.n = n};
  double length[CONTOUR_MOST];
  for (size_t part = 4; part > 1; part--) {
    slices_choose(c, s, h, n, n / part, place, width, length);
    for (size_t i = 0; i < n; i++) {
      shape_functions(h, place[i], length[i], all.f[i]);
      for (int k = 0; k < h->moments; k++) all.f[i][k] /= sum[k];
    }
    if (slices_settle(&all, moments, width)) return 1;
  }
  return 0;
}

static void swap_numbers(double *a, double *b) {
  double x = *a;
  *a = *b;
  *b = x;
}

/* Find a change of the widths of n + 1 slices that preserves n sums: a vector
   of the null space, by elimination with complete pivoting. */
static void slices_null_vector(const slices *s, size_t n, const size_t *slice,
                               double idle[MOMENTS + 1]) {
  double a[MOMENTS][MOMENTS + 1];
  size_t column[MOMENTS + 1] = {0}, rank = 0;
  for (size_t j = 0; j <= n; j++) {
    column[j] = j;
    for (size_t k = 0; k < n; k++) a[k][j] = s->f[slice[j]][k];
  }
  for (; rank < n; rank++) {
    size_t row = rank, at = rank, was = column[rank];
    for (size_t k = rank; k < n; k++)
      for (size_t j = rank; j <= n; j++)
        if (fabs(a[k][j]) > fabs(a[row][at])) row = k, at = j;
    /* The functions of slices of equal length differ only by rounding. */
    if (fabs(a[row][at]) < 1e-13) break;
    for (size_t j = 0; j <= n; j++) swap_numbers(&a[row][j], &a[rank][j]);
    for (size_t k = 0; k < n; k++) swap_numbers(&a[k][at], &a[k][rank]);
    column[rank] = column[at];
    column[at] = was;
    for (size_t k = rank + 1; k < n; k++) {
      double by = a[k][rank] / a[rank][rank];
      for (size_t j = rank; j <= n; j++) a[k][j] -= by * a[rank][j];
    }
  }
  for (size_t j = 0; j <= n; j++) idle[j] = 0;
  idle[column[rank]] = 1;
  for (size_t k = rank; k-- > 0;) {
    double sum = a[k][rank];
    for (size_t j = k + 1; j < rank; j++) sum += a[k][j] * idle[column[j]];
    idle[column[k]] = -sum / a[k][k];
  }
}

/* Change the widths of the narrowest of `left` slices and of `moments` adjacent
   slices, with all sums constant, until one width is 0. Return the index in
   `slice` of the slice of width 0. */
static size_t slices_drop_one(const slices *s, size_t moments,
                              const size_t *slice, size_t left, double *width) {
  size_t least = 0, gone = 0;
  for (size_t i = 1; i < left; i++)
    if (width[slice[i]] < width[slice[least]]) least = i;
  size_t first = least < moments / 2 ? 0 : least - moments / 2;
  if (first + moments + 1 > left) first = left - moments - 1;
  double idle[MOMENTS + 1] = {0}, step = INFINITY;
  slices_null_vector(s, moments, slice + first, idle);
  double sign = idle[least - first] > 0 ? -1 : 1;
  for (size_t j = 0; j <= moments; j++) {
    double less = -sign * idle[j], w = width[slice[first + j]];
    if (less > 0 && w / less < step) step = w / less, gone = j;
  }
  for (size_t j = 0; j <= moments; j++)
    width[slice[first + j]] += sign * step * idle[j];
  return first + gone;
}

/* Find n slices that preserve all sums: fit the widths of slices at all nodes,
   then remove slices one by one with the sums preserved. The number of sums is
   a sufficient number of slices (Caratheodory's theorem). Return 0 if slices at
   all nodes do not satisfy the sums. */
static int slices_reduce(const contour *c, int s, const shape *h,
                         const double sum[MOMENTS], size_t n, double *place,
                         double *width) {
  slices all = {.n = (size_t)h->size + (h->from > 0) + (h->to < 1)};
  double at[PLACES], length[PLACES], share[PLACES] = {0};
  size_t slice[PLACES] = {0}, left = all.n;
  if (left <= n) return 0;
  slices_choose(c, s, h, all.n, all.n / 4, at, share, length);
  for (size_t i = 0; i < all.n; i++) {
    slice[i] = i;
    shape_functions(h, at[i], length[i], all.f[i]);
    for (int k = 0; k < h->moments; k++) all.f[i][k] /= sum[k];
  }
  if (!slices_settle(&all, h->moments, share)) return 0;
  for (; left > n; left--) {
    size_t gone = slices_drop_one(&all, (size_t)h->moments, slice, left, share);
    share[slice[gone]] = 0;
    memmove(slice + gone, slice + gone + 1, (left - gone - 1) * sizeof *slice);
  }
  if (!slices_add_up(&all, h->moments, share)) return 0;
  for (size_t i = 0; i < n; i++) {
    place[i] = at[slice[i]];
    width[i] = share[slice[i]];
  }
  return 1;
}

int contour_slice(const contour *c, const eda_curves *table, double reach,
                  contour_weight *weight, const void *self,
                  const eda_printed_gate *gate, size_t n, double *place,
                  double *width) {
  shape h = {.table = table, .weight = weight, .self = self, .gate = gate};
  double sum[MOMENTS];
  if (!(gate->width > 0)) return 0;
  h.edges = edges_of(table, gate->type, gate->width, reach);
  h.by_place = weight || !h.edges.width.is_wide;
  h.moments = h.edges.width.is_wide ? WIDE_MOMENTS : MOMENTS;
  h.from = fmax(0, -gate->extension[0] / gate->width);
  h.to = 1 - fmax(0, -gate->extension[1] / gate->width);
  if (!(h.to - h.from > 0.1)) return 0;
  /* Initial size, sufficient for a resolution of 129 nm (193 nm, NA 0.75).
     Finer images, and gates for which no widths fit, use the next sizes. */
  double want = fmax(10 + gate->width / 60, (double)n);
  int s = 0, more = MORE;
  while (s + 1 < SIZES && sizes[s] < want) s++;
  for (;; s++) {
    double rest = shape_measure(c, s, &h);
    if (isnan(rest)) return 0;
    if (rest > enough && s + 1 < SIZES) continue;
    shape_integrate(c, &h, sum);
    if (slices_try(c, s, &h, sum, h.moments, n, place, width)) return 1;
    if (s + 1 == SIZES || !more--) break;
  }
  if (slices_reduce(c, s, &h, sum, n, place, width)) return 1;
  /* Preserve fewer sums: omit first the edge currents, then Ioff, Ion, area. */
  for (int moments = h.moments - 1; moments > 0; moments--)
    if (slices_try(c, s, &h, sum, moments, n, place, width)) return 1;
  return 0;
}
