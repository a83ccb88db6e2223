/* SPDX-License-Identifier: BSD-3-Clause */
/* Statistics of samples: moments, quantiles, probabilities, and shares of the
   variance. */
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>

#include "variation.h"

const double statistics_at[QUANTILES] = {0.001, 0.01, 0.05, 0.5,
                                         0.95,  0.99, 0.999};

/* Return x with the incomplete beta function I_x(a, b) = p, by bisection. The
   inverse of GSL fails for large a and b. */
static double beta_inverse(double p, double a, double b) {
  double low = 0, high = 1;
  for (int i = 0; i < 60; i++) {
    double x = (low + high) / 2;
    if (gsl_cdf_beta_P(x, a, b) < p)
      low = x;
    else
      high = x;
  }
  return (low + high) / 2;
}

interval interval_of(size_t k, size_t n) {
  static const double tail = 0.025;
  double a = (double)k, b = (double)(n - k);
  interval i = {n ? a / (double)n : NAN, 0, 1};
  if (!n) return i;
  if (k) i.low = beta_inverse(tail, a, b + 1);
  if (k < n) i.high = beta_inverse(1 - tail, a + 1, b);
  return i;
}

static int by_value(const void *a, const void *b) {
  float x = *(const float *)a, y = *(const float *)b;
  return (x > y) - (x < y);
}

statistics statistics_of(float *value, size_t n) {
  statistics s = {0};
  double m2 = 0, m3 = 0, count = (double)n;
  qsort(value, n, sizeof *value, by_value);
  for (size_t i = 0; i < n; i++) s.mean += (double)value[i] / count;
  for (size_t i = 0; i < n; i++) {
    double d = (double)value[i] - s.mean;
    m2 += d * d / count;
    m3 += d * d * d / count;
  }
  s.sigma = n > 1 ? sqrt(m2 * count / (count - 1)) : NAN;
  s.skewness = m2 > 0 ? m3 / pow(m2, 1.5) : 0;
  for (int q = 0; q < QUANTILES; q++) {
    double at = statistics_at[q] * (count - 1);
    size_t i = (size_t)at, next = i + 1 < n ? i + 1 : i;
    s.quantile[q] = (double)value[i] +
                    (at - (double)i) * ((double)value[next] - (double)value[i]);
  }
  return s;
}

/* Mean and standard error of a sum of products. */
typedef struct estimate {
  double sum, square;
} estimate;

static void estimate_add(estimate *e, double x) {
  e->sum += x;
  e->square += x * x;
}

static double estimate_error(const estimate *e, double n) {
  double mean = e->sum / n;
  return sqrt(fmax(0, e->square / n - mean * mean) / n);
}

share share_of(const double *a, const double *b, const double *ab, size_t n) {
  double mean = 0, variance = 0, count = (double)n;
  estimate first = {0, 0}, total = {0, 0};
  for (size_t i = 0; i < n; i++) mean += (a[i] + b[i]) / (2 * count);
  for (size_t i = 0; i < n; i++) {
    double x = a[i] - mean, y = b[i] - mean, z = ab[i] - mean;
    variance += (x * x + y * y) / (2 * count);
    estimate_add(&first, y * (z - x));
    estimate_add(&total, (x - z) * (x - z) / 2);
  }
  if (!(variance > 0)) return (share){0, 0, 0, 0};
  return (share){
      first.sum / count / variance, estimate_error(&first, count) / variance,
      total.sum / count / variance, estimate_error(&total, count) / variance};
}
