/* SPDX-License-Identifier: BSD-3-Clause */
/* Slices a printed gate so that few slices have the width, the area and both
   currents of its contour. The length is measured at some places, and a
   Chebyshev series of its square gives it everywhere: the square is smooth even
   where the line ends, as the line's edges meet there like the ends of a
   parabola. The slices lie at some of the measured places; each begins as the
   piece of the gate nearest to it, and its width is then changed by as little
   as gives all slices together the sums of the series. */
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
  NODES = 32, /* of a piece of the integrals */
  PIECES = 3,
  LANES = 8, /* of them in a vector */
  /* Width, area and both currents; where edges count, what share of each
     current's edges the slices have, which extraction brings to 1. */
  MOMENTS = 6,
  WIDE_MOMENTS = 4,
  PLACES = LARGEST + 2, /* those measured, and both ends that are gone */
  MORE = 2              /* larger sizes, if they do not fit */
};
static const int sizes[SIZES] = {12, 16, 20, 24, 32, 48, 64, 96, LARGEST};

/* What the last terms of a series may add to a length, nm, at most; on average
   they add far less. A drive current changes by 2 to 5 % for each nm. */
static const double enough = 0.02;
/* Rounded ends are followed more closely than this from each edge, nm. */
static const double rounding = 45;

struct contour {
  double *series[SIZES]; /* [value * size + coefficient] */
  double *place[SIZES];  /* of the values, -1 to 1 */
  double node[NODES], share[NODES];
};

/* A gate while it is sliced: lengths against x from -1 to 1, which is from
   `from` to `to` of its width. */
typedef struct shape {
  const eda_curves *table;
  contour_weight *weight;
  const void *self;
  const eda_printed_gate *gate;
  edges edges;
  int by_place; /* whether slices of one length differ by their places */
  int moments;  /* of MOMENTS */
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

/* The coefficients from the lengths that were measured. */
EDA_WIDE static void transform(const double *series, shape *h) {
  size_t n = (size_t)h->size;
  for (size_t k = 0; k < n; k++) h->coefficient[k] = 0;
  for (size_t j = 0; j < n; j++) {
    const double *row = series + j * n;
    double square = h->length[j] * h->length[j];
    for (size_t k = 0; k < n; k++) h->coefficient[k] += row[k] * square;
  }
}

typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));

/* The lengths at n places, a multiple of twice LANES (Clenshaw's recurrence,
   two vectors at a time). */
EDA_WIDE static void lengths_at(const shape *h, size_t n, const double *x,
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

/* Measure at the places of a size. Gives what its last terms still add to the
   length, nm, at most; NAN if a length is none. */
static double measure(const contour *c, int s, shape *h) {
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
  transform(c->series[s], h);
  double last = fabs(h->coefficient[n - 1]) + fabs(h->coefficient[n - 2]);
  return longest > 0 ? last / (2 * longest) : NAN;
}

/* ---- the integrals ---- */

static inline void functions(const shape *h, double place, double length,
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

/* Add what the functions are at n places, times their share. */
static void add_places(const shape *h, size_t n, const double *x,
                       const double *length, const double *share,
                       double sum[MOMENTS]) {
  double part[MOMENTS] = {0};
  for (size_t i = 0; i < n; i++) {
    double f[MOMENTS] = {0};
    functions(h, h->by_place ? place_of(h, x[i]) : 0, length[i], f);
    for (int k = 0; k < MOMENTS; k++) part[k] += share[i] * f[k];
  }
  for (int k = 0; k < MOMENTS; k++) sum[k] += part[k];
}

/* The integrals of the functions over the width. The currents are smooth where
   the length leaves the device table, too. */
static void integrate(const contour *c, const shape *h, double sum[MOMENTS]) {
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
  lengths_at(h, n, x, length);
  for (int k = 0; k < MOMENTS; k++) sum[k] = 0;
  add_places(h, n, x, length, share, sum);
  /* Where the line has ended already. */
  const double gone[2] = {h->from, 1 - h->to};
  for (int side = 0; side < 2; side++) {
    double f[MOMENTS] = {0}, place = side ? (1 + h->to) / 2 : h->from / 2;
    functions(h, place, 0, f);
    for (int k = 0; k < h->moments; k++) sum[k] += gone[side] * f[k];
  }
}

/* ---- the slices ---- */

/* Number i of n among m places: k of them are the outermost on each side, where
   the lengths change fast, the rest evenly between. */
static size_t pick(size_t i, size_t n, size_t m, size_t k) {
  if (i < k) return i;
  if (i >= n - k) return m - (n - i);
  size_t gaps = n - 2 * k + 1;
  return k - 1 + ((i - k + 1) * (m - 2 * k + 1) + gaps / 2) / gaps;
}

/* Places among those that were measured, one more for each end that is gone,
   and the widths that are nearest to each. */
static void choose(const contour *c, int s, const shape *h, size_t n,
                   size_t outer, double *place, double *width, double *length) {
  size_t first = h->from > 0, last = n - (h->to < 1), inner = last - first;
  if (first) place[0] = h->from / 2, length[0] = 0;
  if (last < n) place[last] = (1 + h->to) / 2, length[last] = 0;
  for (size_t i = 0; i < inner; i++) {
    size_t j = pick(i, inner, (size_t)h->size, outer);
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

/* Solve a symmetric positive system in place (Cholesky); 0 if it is none. */
static int solve(double a[MOMENTS][MOMENTS], double x[MOMENTS], int n) {
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

/* Slices, and what they should add up to: f of each over the sum that is
   wanted. */
typedef struct slices {
  size_t n;
  double f[PLACES][MOMENTS];
} slices;

/* Change the widths by the smallest factors (least squares) that give the first
   `moments` sums: 1. If one would come out below 0, the lowest becomes 0, for
   another try: 0. */
static int fit(const slices *s, int moments, double *width) {
  double a[MOMENTS][MOMENTS] = {{0}}, r[MOMENTS] = {1, 1, 1, 1, 1, 1};
  for (size_t i = 0; i < s->n; i++)
    for (int k = 0; k < moments; k++) {
      r[k] -= width[i] * s->f[i][k];
      for (int m = 0; m <= k; m++)
        a[k][m] += width[i] * s->f[i][k] * s->f[i][m];
    }
  /* A rectangle has one length only: all functions are the same. */
  for (int k = 0; k < moments; k++) a[k][k] *= 1 + 1e-12;
  if (!solve(a, r, moments)) return 1;
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

/* Do the slices add up? */
static int adds_up(const slices *s, int moments, const double *width) {
  for (int k = 0; k < moments; k++) {
    double sum = 0;
    for (size_t i = 0; i < s->n; i++) sum += width[i] * s->f[i][k];
    if (!(fabs(sum - 1) < 1e-7)) return 0;
  }
  return 1;
}

/* Fit the first `moments` sums: 1. 0 if no widths have them. */
static int settle(const slices *s, int moments, double *width) {
  for (size_t left = s->n; left > (size_t)moments; left--)
    if (fit(s, moments, width)) break;
  if (!adds_up(s, moments, width)) return 0;
  double total = 0;
  for (size_t i = 0; i < s->n; i++) total += width[i];
  for (size_t i = 0; i < s->n; i++) width[i] /= total;
  return 1;
}

/* Slices with the first `moments` sums: 1. 0 if there are none. */
static int try_slices(const contour *c, int s, const shape *h,
                      const double sum[MOMENTS], int moments, size_t n,
                      double *place, double *width) {
  slices all = {.n = n};
  double length[CONTOUR_MOST];
  for (size_t part = 4; part > 1; part--) {
    choose(c, s, h, n, n / part, place, width, length);
    for (size_t i = 0; i < n; i++) {
      functions(h, place[i], length[i], all.f[i]);
      for (int k = 0; k < h->moments; k++) all.f[i][k] /= sum[k];
    }
    if (settle(&all, moments, width)) return 1;
  }
  return 0;
}

static void swap(double *a, double *b) {
  double x = *a;
  *a = *b;
  *b = x;
}

/* Widths of n + 1 slices that add to none of n sums: a vector of the null
   space, by elimination with the largest pivots. */
static void find_idle(const slices *s, size_t n, const size_t *slice,
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
    /* Slices of one length: the functions are the same but for rounding. */
    if (fabs(a[row][at]) < 1e-13) break;
    for (size_t j = 0; j <= n; j++) swap(&a[row][j], &a[rank][j]);
    for (size_t k = 0; k < n; k++) swap(&a[k][at], &a[k][rank]);
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

/* Move the widths of the narrowest of `left` slices and of its neighbours, so
   that no sum changes, until one of them is 0: which. */
static size_t drop_one(const slices *s, size_t moments, const size_t *slice,
                       size_t left, double *width) {
  size_t least = 0, gone = 0;
  for (size_t i = 1; i < left; i++)
    if (width[slice[i]] < width[slice[least]]) least = i;
  size_t first = least < moments / 2 ? 0 : least - moments / 2;
  if (first + moments + 1 > left) first = left - moments - 1;
  double idle[MOMENTS + 1], step = INFINITY;
  find_idle(s, moments, slice + first, idle);
  double sign = idle[least - first] > 0 ? -1 : 1;
  for (size_t j = 0; j <= moments; j++) {
    double less = -sign * idle[j], w = width[slice[first + j]];
    if (less > 0 && w / less < step) step = w / less, gone = j;
  }
  for (size_t j = 0; j <= moments; j++)
    width[slice[first + j]] += sign * step * idle[j];
  return first + gone;
}

/* Slices with all sums from all places that were measured: these have widths
   with the sums, and no more of them are needed than there are sums, and one
   (Caratheodory's theorem). One by one they are given up until n are left: 1. 0
   if all together do not have the sums. */
static int reduce(const contour *c, int s, const shape *h,
                  const double sum[MOMENTS], size_t n, double *place,
                  double *width) {
  slices all = {.n = (size_t)h->size + (h->from > 0) + (h->to < 1)};
  double at[PLACES], length[PLACES], share[PLACES];
  size_t slice[PLACES] = {0}, left = all.n;
  if (left <= n) return 0;
  choose(c, s, h, all.n, all.n / 4, at, share, length);
  for (size_t i = 0; i < all.n; i++) {
    slice[i] = i;
    functions(h, at[i], length[i], all.f[i]);
    for (int k = 0; k < h->moments; k++) all.f[i][k] /= sum[k];
  }
  if (!settle(&all, h->moments, share)) return 0;
  for (; left > n; left--) {
    size_t gone = drop_one(&all, (size_t)h->moments, slice, left, share);
    share[slice[gone]] = 0;
    memmove(slice + gone, slice + gone + 1, (left - gone - 1) * sizeof *slice);
  }
  if (!adds_up(&all, h->moments, share)) return 0;
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
  /* Prints of 129 nm resolution (NA 0.75, 193 nm) want about as many as this;
     finer ones take another round. So do those to which no widths fit. */
  double want = fmax(10 + gate->width / 60, (double)n);
  int s = 0, more = MORE;
  while (s + 1 < SIZES && sizes[s] < want) s++;
  for (;; s++) {
    double rest = measure(c, s, &h);
    if (isnan(rest)) return 0;
    if (rest > enough && s + 1 < SIZES) continue;
    integrate(c, &h, sum);
    if (try_slices(c, s, &h, sum, h.moments, n, place, width)) return 1;
    if (s + 1 == SIZES || !more--) break;
  }
  if (reduce(c, s, &h, sum, n, place, width)) return 1;
  /* Without the last sums, those of the edges and then of Ioff first. */
  for (int moments = h.moments - 1; moments > 0; moments--)
    if (try_slices(c, s, &h, sum, moments, n, place, width)) return 1;
  return 0;
}
