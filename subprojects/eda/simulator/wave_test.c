/* SPDX-License-Identifier: BSD-3-Clause */
/* Edges of waves, compared with closed forms: an exponential, and a wave that
   reverses. */
#include <eda/wave.h>
#include <glib.h>
#include <math.h>

enum { N = 101 };

/* 1 - exp(-t) of a rising or a falling output of 1.1 V. */
static void test_exponential(void) {
  double t[N], v[N], h[N];
  for (int rises = 0; rises < 2; rises++) {
    for (int i = 0; i < N; i++) {
      t[i] = 0.1 * i;
      v[i] = 1.1 * (rises ? 1 - exp(-t[i]) : exp(-t[i]));
    }
    eda_wave_heights(v, N, 1.1, rises, h);
    eda_wave_edge e;
    g_assert_true(eda_wave_find(h, N, 0.1, 0.9, &e));
    g_assert_cmpfloat_with_epsilon(eda_wave_smooth_time(t, h, N, e.half, 0.5),
                                   log(2), 2e-6);
    g_assert_cmpfloat_with_epsilon(eda_wave_smooth_time(t, h, N, e.high, 0.9),
                                   log(10), 2e-6);
    g_assert_cmpfloat_with_epsilon(eda_wave_time(t, h, e.low, 0.1), -log(0.9),
                                   2e-3);
  }
}

/* The last crossing of the middle level is used; an incomplete edge is not
   accepted. */
static void test_turns_back(void) {
  const double h[] = {0, 0.6, 1, 0.4, 0.05, 0.3, 0.7, 0.8, 0.95};
  eda_wave_edge e;
  g_assert_true(eda_wave_find(h, 9, 0.1, 0.9, &e));
  g_assert_cmpuint(e.low, ==, 4);
  g_assert_cmpuint(e.half, ==, 5);
  g_assert_cmpuint(e.high, ==, 7);
  g_assert_false(eda_wave_find(h, 8, 0.1, 0.9, &e));
  g_assert_false(eda_wave_find(h + 5, 4, 0.1, 0.9, &e));
  g_assert_false(eda_wave_find(h, 1, 0.1, 0.9, &e));
  g_assert_cmpuint(eda_wave_last_rise(h, 4, 0.5, 99), ==, 0);
  g_assert_cmpuint(eda_wave_last_rise(h + 2, 2, 0.5, 99), ==, 99);
}

/* The cubic t^3 through the last four points; the fifth point is outside the
   wave. */
static void test_last_points(void) {
  const double t[] = {0, 1, 2, 3, 4}, h[] = {0, 1, 8, 27, 1e9};
  g_assert_cmpfloat_with_epsilon(eda_wave_smooth_time(t, h, 4, 2, 15.625), 2.5,
                                 1e-12);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/wave/exponential", test_exponential);
  g_test_add_func("/wave/turns-back", test_turns_back);
  g_test_add_func("/wave/last-points", test_last_points);
  return g_test_run();
}
