/* SPDX-License-Identifier: BSD-3-Clause */
/* Transforms of lanes, compared with the defining sums. */
#include <complex.h>
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>

#include "imaging/fft.h"
#include "imaging/lanes.h"

static double random_number(GRand *r) { return g_rand_double_range(r, -1, 1); }

/* Return or set number i of a line. */
static double complex number(const eda_lanes *a, int i, int lane) {
  return a[i].re[lane] + a[i].im[lane] * I;
}

static void test_sums(void) {
  /* Lengths up to 128, which are not factored, and longer lengths, which are
   factored; together with all radices. */
  static const int sizes[] = {16, 18,  20,  24,  30,  50,  64,
                              90, 128, 150, 256, 360, 486, 1000};
  GRand *random = g_rand_new_with_seed(11);
  for (size_t k = 0; k < G_N_ELEMENTS(sizes); k++) {
    int n = sizes[k];
    g_assert_cmpint(eda_lanes_size(n), ==, n);
    const eda_lanes_plan *plan = eda_lanes_plan_for(n);
    eda_lanes *a = eda_fft_alloc((size_t)n * sizeof *a);
    eda_lanes *b = eda_fft_alloc((size_t)n * sizeof *b);
    eda_lanes *work = eda_fft_alloc(eda_lanes_capacity(plan) * sizeof *work);
    for (int i = 0; i < n; i++)
      for (int lane = 0; lane < EDA_LANES; lane++) {
        a[i].re[lane] = (float)random_number(random);
        a[i].im[lane] = (float)random_number(random);
      }
    for (int i = 0; i < n; i++) b[i] = a[i];
    eda_lanes_backward(plan, b, work);
    double worst = 0;
    for (int lane = 0; lane < EDA_LANES; lane += 5)
      for (int x = 0; x < n; x += 1 + n / 40) {
        double complex sum = 0;
        for (int i = 0; i < n; i++)
          sum +=
              number(a, i, lane) * cexp(2 * M_PI * I * ((long)i * x % n) / n);
        worst = fmax(worst, cabs(sum - number(b, x, lane)));
      }
    g_assert_cmpfloat(worst, <, 1e-6 * sqrt(n) * log2(n));
    eda_fft_free(a);
    eda_fft_free(b);
    eda_fft_free(work);
  }
  g_rand_free(random);
}

static void test_turn(void) {
  eda_vector from[2 * EDA_LANES], to[3 * EDA_LANES];
  for (int i = 0; i < EDA_LANES; i++)
    for (int j = 0; j < EDA_LANES; j++) from[2 * i][j] = (float)(100 * i + j);
  eda_lanes_turn(from, 2, to, 3);
  for (int i = 0; i < EDA_LANES; i++)
    for (int j = 0; j < EDA_LANES; j++)
      g_assert_cmpfloat(to[3 * j][i], ==, (float)(100 * i + j));
}

static void test_size(void) {
  for (int least = 1; least < 3000; least += 7) {
    int n = eda_lanes_size(least - 0.5);
    g_assert_cmpint(n, >=, MAX(16, least));
    g_assert_cmpint(n, <=, MAX(18, least * 1.13));
    g_assert_cmpint(n % 2, ==, 0);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/lanes/sums", test_sums);
  g_test_add_func("/lanes/turn", test_turn);
  g_test_add_func("/lanes/size", test_size);
  return g_test_run();
}
