/* SPDX-License-Identifier: BSD-3-Clause */
/* Coverage of the interval by simulation, and bounds known in closed form. */
#include <eda/median.h>

#include <glib.h>
#include <gsl/gsl_cdf.h>
#include <math.h>

/* Distributions with median 0: normal, log-normal with sigma 1, and the
   difference of two log-normal values (such as results of two methods). */
static double draw(GRand *rand, int kind) {
  double z = gsl_cdf_ugaussian_Pinv(g_rand_double_range(rand, 1e-9, 1 - 1e-9));
  return kind == 0   ? z
         : kind == 1 ? exp(z) - 1
                     : exp(z) - exp(gsl_cdf_ugaussian_Pinv(
                                    g_rand_double_range(rand, 1e-9, 1 - 1e-9)));
}

/* Between 93 and 97 % of the intervals contain the median; the standard
   deviation of the share is at most 0.24 %. */
static void test_coverage(void) {
  enum { TRIALS = 10000, MOST = 60 };
  static const size_t sizes[] = {5, 6, 7, 8, 10, 15, MOST};
  for (int kind = 0; kind < 3; kind++)
    for (size_t s = 0; s < G_N_ELEMENTS(sizes); s++) {
      g_autoptr(GRand) rand = g_rand_new_with_seed(11);
      int inside = 0;
      for (int t = 0; t < TRIALS; t++) {
        double v[MOST];
        for (size_t i = 0; i < sizes[s]; i++) v[i] = draw(rand, kind);
        eda_median got = eda_median_of(v, sizes[s]);
        inside += got.low <= 0 && 0 <= got.high;
      }
      g_test_message("distribution %d, n %zu: %.1f %%", kind, sizes[s],
                     100.0 * inside / TRIALS);
      g_assert_cmpint(inside, >=, TRIALS * 93 / 100);
      g_assert_cmpint(inside, <=, TRIALS * 97 / 100);
    }
}

/* The interval of five values is their range. For ten values, the bounds are
   0.6577 of the distance from the second to the third value. For 10,000 values,
   they are 0.98 sqrt(n) from the middle. */
static void test_bounds(void) {
  static double v[10000];
  for (int i = 0; i < 10000; i++) v[i] = (i * 617) % 10000;
  eda_median got = eda_median_of(v, 10000);
  g_assert_cmpfloat(got.value, ==, 4999.5);
  g_assert_cmpfloat_with_epsilon(got.high - got.low, 2 * 97.998, 0.5);
  static const double ten[] = {8, 3, 5, 0, 9, 4, 1, 2, 7, 6};
  got = eda_median_of(ten, 10);
  g_assert_cmpfloat_with_epsilon(got.low, 1.6577, 1e-4);
  g_assert_cmpfloat_with_epsilon(got.high, 9 - 1.6577, 1e-4);
  got = eda_median_of(ten, 5);
  g_assert_true(got.value == 5 && got.low == 0 && got.high == 9);
}

static void test_few(void) {
  static const double v[] = {1, 2, 2, 7};
  eda_median got = eda_median_of(v, 4);
  g_assert_true(got.value == 2 && isnan(got.low) && isnan(got.high));
  g_assert_true(eda_median_of(v, 1).value == 1);
  g_assert_true(isnan(eda_median_of(v, 0).value));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/median/coverage", test_coverage);
  g_test_add_func("/median/bounds", test_bounds);
  g_test_add_func("/median/few", test_few);
  return g_test_run();
}
