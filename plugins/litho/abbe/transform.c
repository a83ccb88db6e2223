/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the closed form of a mask spectrum, in double precision, by
   Green's theorem. The Fourier transform of shapes at f = (fx, fy) is a sum
   over edges of integrals of exp(-2 pi i f r) dy / (-2 pi i fx). At fx = 0 the
   integrand is x exp(-2 pi i fy y) dy. The integral over an edge, for fx
   other than 0, is

     dy exp(-2 pi i f m) sinc(f d),

   with m the midpoint, d the vector from begin to end, and dy the rise of the
   edge. Horizontal edges contribute nothing. The integral over a vertical edge
   is a function of fx times a function of fy, so the sum is a product of
   matrices. (S.-W. Lee, R. Mittra, IEEE Trans. Antennas Propag. 31, 99, 1983,
   for polygons.) */
#include "transform.h"

#include <complex.h>
#include <eda/memory.h>
#include <eda/simd.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

enum { CHUNK = 512 }; /* edges per chunk, whose table fits into the cache */

/* An edge, relative to the frame's corner, in units of the frame's period. */
typedef struct edge {
  double x, y;   /* midpoint */
  double dx, dy; /* from begin to end */
} edge;

typedef struct transformation {
  const opc_context *context;
  eda_spectrum *out;
  edge *upright, *slanted;
  size_t n_upright, n_slanted;
  size_t first, n; /* vertical edges of this chunk */
  size_t columns;
  double complex *across; /* exp(-2 pi i k x): [edge of the chunk][k] */
  /* Sums over vertical edges of the real and the imaginary part of their
     factors along y: [l >= 0][k]. Rows l and -l follow from both sums. */
  double complex *even, *odd;
  /* Sums over slanted edges, [row][k] as in the result; NULL if no edge is
     slanted. */
  double complex *rest;
} transformation;

/* ---- work: edges ---- */

static void take_edges(transformation *j, const eda_shapes *s, double grid,
                       const eda_frame *f) {
  size_t n = s->count ? s->start[s->count] : 0;
  j->upright = eda_alloc(n, sizeof *j->upright);
  j->slanted = eda_alloc(n, sizeof *j->slanted);
  for (size_t i = 0; i < s->count; i++)
    for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++) {
      uint32_t next = k + 1 < s->start[i + 1] ? k + 1 : s->start[i];
      eda_point a = s->points[k], b = s->points[next];
      if (a.y == b.y) continue;
      double ax = (a.x * grid - f->x0) / f->width;
      double ay = (a.y * grid - f->y0) / f->height;
      double bx = (b.x * grid - f->x0) / f->width;
      double by = (b.y * grid - f->y0) / f->height;
      edge e = {(ax + bx) / 2, (ay + by) / 2, bx - ax, by - ay};
      if (a.x == b.x)
        j->upright[j->n_upright++] = e;
      else
        j->slanted[j->n_slanted++] = e;
    }
}

/* Return sin(pi u) / (pi u). A series is used near 0, where the closed form
   cancels. */
static double sinc(double u) {
  double p = M_PI * u;
  return fabs(u) < 1e-4 ? 1 - p * p / 6 : sin(p) / p;
}

/* Return the derivative of sinc. */
static double sinc_slope(double u) {
  return fabs(u) < 1e-3 ? -M_PI * M_PI * u / 3 : (cos(M_PI * u) - sinc(u)) / u;
}

/* Return the contribution of an edge at fx = 0. */
static double complex edge_at_zero(const edge *e, int l) {
  double u = l * e->dy;
  double complex along =
      e->x * sinc(u) + I / (2 * M_PI) * e->dx * sinc_slope(u);
  return e->dy * cexp(-2 * M_PI * I * l * e->y) * along;
}

/* ---- work: upright edges ---- */

static void fill_across(void *data, size_t i) {
  transformation *j = data;
  double complex *row = j->across + i * j->columns;
  double x = j->upright[j->first + i].x;
  for (size_t k = 0; k < j->columns; k++)
    row[k] = cexp(-2 * M_PI * I * ((double)k * x));
}

EDA_WIDE static void add_times(const double *restrict x, double re, double im,
                               size_t n, double *restrict even,
                               double *restrict odd) {
  for (size_t i = 0; i < n; i++) {
    even[i] += re * x[i];
    odd[i] += im * x[i];
  }
}

static void add_row(void *data, size_t l) {
  transformation *j = data;
  if (opc_cancelled(j->context)) return;
  double complex *even = j->even + l * j->columns,
                 *odd = j->odd + l * j->columns;
  for (size_t i = 0; i < j->n; i++) {
    const edge *e = &j->upright[j->first + i];
    double scale = e->dy * sinc((double)l * e->dy);
    double angle = -2 * M_PI * (double)l * e->y;
    double re = scale * cos(angle), im = scale * sin(angle);
    add_times((const double *)(j->across + i * j->columns), re, im,
              2 * j->columns, (double *)even, (double *)odd);
    /* Column 0 has the factor x instead of 1. */
    even[0] += re * (e->x - 1);
    odd[0] += im * (e->x - 1);
  }
}

static void add_upright(transformation *j, size_t rows) {
  j->across = eda_alloc(CHUNK * j->columns, sizeof *j->across);
  for (; j->first < j->n_upright; j->first += CHUNK) {
    size_t left = j->n_upright - j->first;
    j->n = left < CHUNK ? left : CHUNK;
    opc_parallel(j->context, j->n, fill_across, j);
    opc_parallel(j->context, rows, add_row, j);
  }
  free(j->across);
}

/* ---- work: slanted edges ---- */

/* Compute row `row` of the slanted sum. sinc(f d) follows from the phases of
   both ends, each of which is a power of one number along the row. */
static void add_slanted_row(void *data, size_t row) {
  transformation *j = data;
  const eda_spectrum *s = j->out;
  if (opc_cancelled(j->context)) return;
  int l = (int)row <= (s->rows - 1) / 2 ? (int)row : (int)row - s->rows;
  double complex *to = j->rest + row * j->columns;
  for (size_t i = 0; i < j->n_slanted; i++) {
    const edge *e = &j->slanted[i];
    double complex middle = cexp(-2 * M_PI * I * (l * e->y)) * e->dy;
    double complex step = cexp(-2 * M_PI * I * e->x);
    double complex half = cexp(M_PI * I * (l * e->dy));
    double complex by = cexp(M_PI * I * e->dx);
    to[0] += edge_at_zero(e, l);
    for (size_t k = 1; k < j->columns; k++) {
      middle *= step;
      half *= by;
      double u = (double)k * e->dx + l * e->dy;
      to[k] += middle * (fabs(u) < 1e-4 ? sinc(u) : cimag(half) / (M_PI * u));
    }
  }
}

/* ---- work: all ---- */

/* Write rows l and -l of the result, l >= 0. */
static void write_row(const transformation *j, int l) {
  eda_spectrum *s = j->out;
  double fy = l / s->frame.height, left = s->band * s->band - fy * fy;
  int last = left < 0 ? -1 : (int)floor(s->frame.width * sqrt(left));
  for (int side = 0; side < (l ? 2 : 1); side++) {
    size_t row = (size_t)(side ? s->rows - l : l);
    float *to = s->data + 2 * row * j->columns;
    for (size_t k = 0; k < j->columns && (int)k <= last; k++) {
      size_t at = (size_t)l * j->columns + k;
      double complex sum = j->even[at] + (side ? -I : I) * j->odd[at];
      if (j->rest) sum += j->rest[row * j->columns + k];
      if (k) sum /= -2 * M_PI * I * (double)k;
      to[2 * k] = (float)(!k && !l ? 1 - creal(sum) : -creal(sum));
      to[2 * k + 1] = (float)-cimag(sum);
    }
  }
}

int transform_mask(const opc_context *context, const eda_shapes *shapes,
                   double grid, eda_frame frame, double band, eda_spectrum *out,
                   opc_error *error) {
  static const double most = 1 << 26; /* largest number of coefficients: 3 GB
                                         for the sums */
  *out = (eda_spectrum){.frame = frame, .band = band};
  if (!(frame.width > 0 && frame.height > 0 && band > 0 && grid > 0))
    return opc_fail(error, OPC_INVALID, NULL,
                    "a frame of %g x %g nm has no area", frame.width,
                    frame.height);
  if (!(2 * frame.width * frame.height * band * band < most))
    return opc_fail(error, OPC_INVALID, NULL,
                    "a frame of %g x %g um is too large for one field",
                    frame.width / 1e3, frame.height / 1e3);
  int half = (int)floor(frame.height * band);
  out->columns = (int)floor(frame.width * band) + 1;
  out->rows = 2 * half + 1;
  transformation j = {
      .context = context, .out = out, .columns = (size_t)out->columns};
  size_t rows = (size_t)half + 1, all = (size_t)out->rows * j.columns;
  out->data = eda_alloc(all, 2 * sizeof *out->data);
  j.even = eda_alloc(rows * j.columns, sizeof *j.even);
  j.odd = eda_alloc(rows * j.columns, sizeof *j.odd);
  take_edges(&j, shapes, grid, &frame);
  add_upright(&j, rows);
  if (j.n_slanted) {
    j.rest = eda_alloc(all, sizeof *j.rest);
    opc_parallel(context, (size_t)out->rows, add_slanted_row, &j);
  }
  for (int l = 0; l <= half; l++) write_row(&j, l);
  free(j.even);
  free(j.odd);
  free(j.rest);
  free(j.upright);
  free(j.slanted);
  if (!opc_cancelled(context)) return OPC_OK;
  eda_spectrum_clear(out);
  return opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
}
