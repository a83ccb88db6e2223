/* SPDX-License-Identifier: BSD-3-Clause */
/* Effect of line-edge roughness on the currents of a gate. The current of a
   point of the width is a function of the length there. The edges change that
   length by a normally distributed amount. Expand the currents of two points in
   Hermite polynomials of the change, with the coefficients a[n] and b[n]. The
   mean is a[0]. The covariance is the sum of n! a[n] b[n] rho^n, where rho is
   the correlation of the lengths. Source: F. G. Mehler, J. reine angew. Math.
   66, 161 (1866). The integral over pairs of points is the variance of the
   current of the gate. The distribution is close to log-normal: L. F. Fenton,
   IRE Trans. Commun. Syst. 8, 57 (1960). */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

enum {
  PER_LENGTH = 6, /* strips per correlation length */
  MOST_STRIPS = 2048,
  NODES = 48, /* of the expectations, over `reach` each way */
  POINTS = 32 /* of the mean covariance within a strip */
};
static const double reach = 6; /* standard deviations */

/* Correlation below which points are independent. */
static const double negligible = 1e-4;

/* ---- moments of a point ---- */

/* Compute the coefficients at a length: expectations of the current times the
   polynomials, by the trapezoidal rule. */
static void moments_at(const roughness_moments *m, double sigma, size_t kind,
                       size_t at) {
  const curves *c = m->curves;
  double(*out)[ORDER + 1] = m->of[kind * c->count + at];
  double step = 2 * reach / NODES, factorial[ORDER + 1] = {1};
  size_t last = c->count - 1;
  for (int n = 1; n <= ORDER; n++) factorial[n] = factorial[n - 1] * n;
  for (int k = 0; k <= NODES; k++) {
    double x = -reach + k * step, he[ORDER + 1] = {1, x};
    double weight = exp(-x * x / 2) / sqrt(2 * M_PI) * step;
    for (int n = 1; n < ORDER; n++) he[n + 1] = x * he[n] - n * he[n - 1];
    double t =
        fmax(0, fmin((double)last - 1e-9, (double)at + x * sigma / c->step));
    size_t i = (size_t)t;
    for (int q = 0; q < CURRENTS; q++) {
      const float *v = c->value[q] + kind * c->count + i;
      double current =
          exp((double)v[0] + (t - (double)i) * ((double)v[1] - (double)v[0]));
      for (int n = 0; n <= ORDER; n++)
        out[q][n] += weight * current * he[n] / factorial[n];
    }
  }
}

typedef struct moments_task {
  const roughness_moments *m;
  double sigma;
} moments_task;

static void moments_of_kind(void *data, size_t kind) {
  const moments_task *task = data;
  for (size_t i = 0; i < task->m->curves->count; i++)
    moments_at(task->m, task->sigma, kind, i);
}

void roughness_moments_init(roughness_moments *m, const roughness *r,
                            const curves *of, const opc_context *context) {
  *m = (roughness_moments){of, eda_alloc(of->kinds * of->count, sizeof *m->of)};
  moments_task task = {m, sqrt(2) * r->sigma};
  opc_parallel(context, of->kinds, moments_of_kind, &task);
}

void roughness_moments_clear(roughness_moments *m) {
  free(m->of);
  *m = (roughness_moments){0};
}

/* ---- pairs of slices ---- */

static double correlation_at(const roughness *r, double distance) {
  return exp(-pow(distance / r->length, 2 * r->hurst));
}

/* Return the mean of correlation^n over pairs of points of a strip of the width
   h. */
static double within_strip(const roughness *r, double h, int n) {
  double sum = 0;
  for (int k = 0; k < POINTS; k++) {
    double t = (k + 0.5) / POINTS;
    sum += 2 * (1 - t) / POINTS * pow(correlation_at(r, t * h), n);
  }
  return sum;
}

typedef struct strip {
  size_t slice;
  double y, width;
} strip;

static size_t strips_of(size_t slices, const double *width, double widest,
                        strip *out) {
  size_t n = 0;
  double y = 0;
  for (size_t s = 0; s < slices; s++) {
    size_t parts = (size_t)ceil(width[s] / widest);
    for (size_t k = 0; k < parts; k++) {
      double h = width[s] / (double)parts;
      out[n++] = (strip){s, y + ((double)k + 0.5) * h, h};
    }
    y += width[s];
  }
  return n;
}

/* Compute the integrals of correlation^n over pairs of points of slices s and
   t, pair[(s * slices + t) * ORDER + n - 1], nm^2. */
static void pairs_of(const roughness *r, size_t slices, const double *width,
                     double *pair) {
  double all = 0, far = r->length * pow(-log(negligible), 0.5 / r->hurst);
  for (size_t s = 0; s < slices; s++) all += width[s];
  double widest = fmax(r->length / PER_LENGTH, all / MOST_STRIPS);
  strip *strips = eda_alloc(MOST_STRIPS + slices, sizeof *strips);
  size_t n = strips_of(slices, width, widest, strips);
  for (size_t i = 0; i < n; i++) {
    const strip *a = &strips[i];
    double *own = pair + (a->slice * slices + a->slice) * ORDER;
    for (int k = 0; k < ORDER; k++)
      own[k] += a->width * a->width * within_strip(r, a->width, k + 1);
    for (size_t j = i + 1; j < n && strips[j].y - a->y < far; j++) {
      const strip *b = &strips[j];
      double rho = correlation_at(r, b->y - a->y), power = 1;
      double *one = pair + (a->slice * slices + b->slice) * ORDER;
      for (int k = 0; k < ORDER; k++) {
        power *= rho;
        one[k] += 2 * a->width * b->width * power;
      }
    }
  }
  free(strips);
}

/* ---- a gate ---- */

/* Return the log-normal distribution with these means and covariances; `all`:
   currents without roughness. */
static roughness_effect effect_of(const double all[2], const double mean[2],
                                  const double sum[3]) {
  roughness_effect e = {{0}, {0}, 0};
  double sigma[2];
  for (int q = 0; q < CURRENTS; q++) {
    sigma[q] = sqrt(log1p(fmax(0, sum[q]) / (mean[q] * mean[q])));
    e.sigma[q] = (float)sigma[q];
    e.shift[q] = (float)(log(mean[q] / all[q]) - sigma[q] * sigma[q] / 2);
  }
  if (sigma[0] > 0 && sigma[1] > 0)
    e.correlation = (float)fmax(
        -1,
        fmin(1, log1p(sum[2] / (mean[0] * mean[1])) / (sigma[0] * sigma[1])));
  return e;
}

/* Interpolate the coefficients of a point at a length; coefficient ORDER + 1 is
   the current itself. */
static void point_at(const roughness_moments *m, size_t gate, double length,
                     double out[CURRENTS][ORDER + 2]) {
  const curves *c = m->curves;
  size_t kind = c->kind[gate];
  double t = (length - c->first) / c->step;
  t = fmax(0, fmin((double)(c->count - 1) - 1e-9, t));
  size_t i = (size_t)t, at = kind * c->count + i;
  t -= (double)i;
  for (int q = 0; q < CURRENTS; q++) {
    for (int n = 0; n <= ORDER; n++)
      out[q][n] = m->of[at][q][n] + t * (m->of[at + 1][q][n] - m->of[at][q][n]);
    out[q][ORDER + 1] = exp(curves_at(c, gate, q, length));
  }
}

static roughness_effect effect_at(const roughness_moments *m, size_t gate,
                                  size_t slices, const double *width,
                                  const double *length, double change,
                                  const double *pair,
                                  double (*point)[CURRENTS][ORDER + 2]) {
  double all[2] = {0}, mean[2] = {0}, sum[3] = {0}, factorial = 1;
  for (size_t s = 0; s < slices; s++) {
    point_at(m, gate, length[s] + change, point[s]);
    for (int q = 0; q < CURRENTS; q++) {
      all[q] += width[s] * point[s][q][ORDER + 1];
      mean[q] += width[s] * point[s][q][0];
    }
  }
  for (int n = 1; n <= ORDER; n++) {
    factorial *= n;
    for (size_t s = 0; s < slices; s++)
      for (size_t t = s; t < slices; t++) {
        double p = factorial * pair[(s * slices + t) * ORDER + (size_t)n - 1];
        for (int q = 0; q < CURRENTS; q++)
          sum[q] += p * point[s][q][n] * point[t][q][n];
        sum[2] += p / 2 *
                  (point[s][ION][n] * point[t][IOFF][n] +
                   point[t][ION][n] * point[s][IOFF][n]);
      }
  }
  return effect_of(all, mean, sum);
}

double mismatch_sigma(const mismatch *m, double area) {
  const double um2 = 1e6; /* nm^2 */
  return m->vt * sqrt(um2 / area);
}

void mismatch_add(const mismatch *m, double area, roughness_effect e[KNOTS]) {
  double volts = mismatch_sigma(m, area);
  const double by[CURRENTS] = {m->ion * volts, M_LN10 / m->swing * volts};
  if (m->vt == 0) return;
  for (int k = 0; k < KNOTS; k++) {
    double s[CURRENTS] = {(double)e[k].sigma[ION], (double)e[k].sigma[IOFF]};
    double both = (double)e[k].correlation * s[ION] * s[IOFF];
    for (int q = 0; q < CURRENTS; q++)
      e[k].sigma[q] = (float)(s[q] = hypot(s[q], by[q]));
    both += by[ION] * by[IOFF];
    e[k].correlation = both > 0 ? (float)(both / (s[ION] * s[IOFF])) : 0;
  }
}

void roughness_of_gate(const roughness *r, const roughness_moments *m,
                       size_t gate, size_t slices, const double *width,
                       const double *length, roughness_effect out[KNOTS]) {
  memset(out, 0, KNOTS * sizeof *out);
  if (r->sigma == 0) return;
  double *pair = eda_alloc(slices * slices * ORDER, sizeof *pair);
  double(*point)[CURRENTS][ORDER + 2] = eda_alloc(slices, sizeof *point);
  pairs_of(r, slices, width, pair);
  for (int k = 0; k < KNOTS; k++)
    out[k] = effect_at(m, gate, slices, width, length,
                       (k - KNOT_ZERO) * knot_step, pair, point);
  free(pair);
  free(point);
}
