/* SPDX-License-Identifier: BSD-3-Clause */
/* Intervals compared with closed forms and with results of scipy. */
#include "bootstrap.h"

#include <glib.h>
#include <gsl/gsl_cdf.h>
#include <math.h>

static void mean_spread(const double *v, size_t n, double *mean,
                        double *error) {
  double sum = 0, square = 0;
  for (size_t i = 0; i < n; i++) sum += v[i];
  *mean = sum / (double)n;
  for (size_t i = 0; i < n; i++) square += (v[i] - *mean) * (v[i] - *mean);
  *error = sqrt(square / (double)(n - 1) / (double)n);
}

/* Normal values: the mean +- 1.96 s / sqrt(n). */
static void test_normal(void) {
  enum { N = 1000 };
  static double v[N];
  for (int i = 0; i < N; i++)
    v[i] = 3 + 2 * gsl_cdf_ugaussian_Pinv(((i * 617) % N + 0.5) / N);
  double mean, error;
  mean_spread(v, N, &mean, &error);
  interval got = bootstrap_mean(v, N, NULL);
  g_assert_cmpfloat_with_epsilon(got.mean, 3, 1e-9);
  g_assert_cmpfloat_with_epsilon(got.low, mean - 1.96 * error, 0.12 * error);
  g_assert_cmpfloat_with_epsilon(got.high, mean + 1.96 * error, 0.12 * error);
}

/* Skewed values, the quantiles of an exponential distribution, of skewness g:
   the bounds are mean + s / sqrt(n) (z + g (2 z^2 + 1) / (6 sqrt(n))) (P. Hall,
   Ann. Statist. 16 (1988) 927). Plain percentile bounds have z^2 - 1 in place
   of 2 z^2 + 1, and fail here. */
static void test_skewed(void) {
  enum { N = 100 };
  double v[N], mean, error, cube = 0;
  for (int i = 0; i < N; i++) v[i] = -log(1 - (i + 0.5) / N);
  mean_spread(v, N, &mean, &error);
  for (int i = 0; i < N; i++) cube += pow(v[i] - mean, 3);
  double skewness = cube / N / pow(error * sqrt(N), 3);
  double shift = skewness * (2 * 1.96 * 1.96 + 1) / (6 * sqrt(N)) * error;
  interval got = bootstrap_mean(v, N, NULL);
  g_test_message("%g %g, shift %g", (got.low - mean) / error,
                 (got.high - mean) / error, shift / error);
  g_assert_cmpfloat_with_epsilon(got.low, mean - 1.96 * error + shift,
                                 0.045 * error);
  g_assert_cmpfloat_with_epsilon(got.high, mean + 1.96 * error + shift,
                                 0.045 * error);
}

/* Coverage: the number of intervals that contain the true mean. 300 trials of
   95 % give 285 +- 3.8; allow four standard deviations. */
static void test_coverage(void) {
  enum { N = 60, TRIALS = 300 };
  g_autoptr(GRand) rand = g_rand_new_with_seed(7);
  int inside = 0;
  for (int t = 0; t < TRIALS; t++) {
    double v[N];
    for (int i = 0; i < N; i++)
      v[i] = gsl_cdf_ugaussian_Pinv(g_rand_double_range(rand, 1e-9, 1 - 1e-9));
    interval got = bootstrap_mean(v, N, NULL);
    inside += got.low <= 0 && 0 <= got.high;
  }
  g_test_message("%d of %d", inside, TRIALS);
  g_assert_cmpint(inside, >=, 270);
  g_assert_cmpint(inside, <=, 299);
}

static void test_few(void) {
  static const double v[] = {2, 2, 2};
  interval got = bootstrap_mean(v, 3, NULL);
  g_assert_true(got.mean == 2 && got.low == 2 && got.high == 2);
  got = bootstrap_mean(v, 1, NULL);
  g_assert_true(got.mean == 2 && isnan(got.low) && isnan(got.high));
  got = bootstrap_mean(v, 0, NULL);
  g_assert_true(isnan(got.mean));
}

/* A shift or change of sign of the values shifts or mirrors the interval. */
static void test_moved(void) {
  double v[30], w[30];
  for (int i = 0; i < 30; i++) {
    v[i] = (i * 7) % 30 * ((i * 7) % 30) / 64.0;
    w[i] = v[i] + 8;
  }
  interval a = bootstrap_mean(v, 30, NULL), b = bootstrap_mean(w, 30, NULL);
  g_assert_cmpfloat_with_epsilon(a.low + 8, b.low, 1e-9);
  g_assert_cmpfloat_with_epsilon(a.high + 8, b.high, 1e-9);
  g_assert_cmpfloat(a.low, <, a.mean);
  g_assert_cmpfloat(a.mean, <, a.high);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/bootstrap/normal", test_normal);
  g_test_add_func("/bootstrap/skewed", test_skewed);
  g_test_add_func("/bootstrap/coverage", test_coverage);
  g_test_add_func("/bootstrap/few", test_few);
  g_test_add_func("/bootstrap/moved", test_moved);
  return g_test_run();
}
