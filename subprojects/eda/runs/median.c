/* SPDX-License-Identifier: BSD-3-Clause */
/* Median and its confidence interval. */
#include <eda/median.h>

#include <eda/memory.h>
#include <glib.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double confidence = 0.95;

/* Return the probability that the interval between the order statistics `depth`
   and n + 1 - depth contains the median. */
static double coverage(size_t depth, size_t n) {
  return 1 - 2 * gsl_cdf_binomial_P((unsigned)(depth - 1), 0.5, (unsigned)n);
}

/* Return the largest depth (at least 1) whose coverage is at least the
   confidence. The search starts below the value of the normal approximation. */
static size_t depth_of(size_t n) {
  double start = (double)n / 2 - sqrt((double)n) - 2;
  size_t depth = start > 1 ? (size_t)start : 1;
  while (2 * (depth + 1) <= n && coverage(depth + 1, n) >= confidence) depth++;
  return depth;
}

eda_median eda_median_of(const double *values, size_t n) {
  eda_median out = {NAN, NAN, NAN, (int64_t)n};
  if (!n) return out;
  g_autofree double *x = g_new(double, n);
  memcpy(x, values, n * sizeof *x);
  qsort(x, n, sizeof *x, eda_doubles_rise);
  out.value = (x[(n - 1) / 2] + x[n / 2]) / 2;
  if (n < EDA_MEDIAN_FEWEST) return out;
  size_t d = depth_of(n);
  double wide = coverage(d, n), narrow = coverage(d + 1, n), size = (double)n;
  double share = fmax(wide - confidence, 0) / (wide - narrow);
  double inner =
      (size - (double)d) * share / ((double)d + (size - 2 * (double)d) * share);
  out.low = x[d - 1] + inner * (x[d] - x[d - 1]);
  out.high = x[n - d] - inner * (x[n - d] - x[n - d - 1]);
  return out;
}
