/* SPDX-License-Identifier: BSD-3-Clause */
/* Simultaneous cuts, compared with a search along each cut. */
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>

#include "imaging/cuts.h"
#include "imaging/edge.h"

enum { NX = 40, NY = 50, CUTS = 37 };
static const eda_frame frame = {-370, 210, 1000, 1250}; /* steps of 25 nm */

/* Return the field of a line along the other axis, `half` to each side of
   `middle`, with noise. */
static eda_field line_field(GRand *random, int axis, double middle, double half,
                            double noise) {
  eda_field f = {.frame = frame, .nx = NX, .ny = NY};
  f.coefficients = eda_alloc((size_t)NX * NY, sizeof(float));
  for (int j = 0; j < NY; j++)
    for (int i = 0; i < NX; i++) {
      double at = axis ? frame.y0 + 25 * j : frame.x0 + 25 * i;
      double d = remainder(at - middle, axis ? frame.height : frame.width);
      f.coefficients[j * NX + i] =
          (float)((half * half - d * d) / (half * half + d * d) +
                  noise * g_rand_double_range(random, -1, 1));
    }
  return f;
}

/* Compute a result of eda_cut_many by searches. Return 0 if the cut is
   irregular, otherwise 1. */
static int cut_by_search(const eda_field *f, int axis, double middle,
                         double half, double at, double distance[2]) {
  eda_line line;
  eda_line_search w[2];
  eda_line_make(f, axis, at, &line);
  if (!(eda_line_start(&line, middle, &w[0], &w[1]) > 0)) return 0;
  for (int side = 0; side < 2; side++) {
    distance[side] = eda_line_search_to(&w[side], 10000);
    if (isnan(distance[side])) return 0;
    if (!isnan(eda_line_search_to(&w[side], half))) return 0;
  }
  return 1;
}

static void test_searches(void) {
  GRand *random = g_rand_new_with_seed(5);
  int found = 0, left = 0, none = 0;
  double worst = 0;
  for (int k = 0; k < 400; k++) {
    int axis = k % 2;
    double middle = g_rand_double_range(random, -3000, 3000);
    double half = g_rand_double_range(random, 20, k % 3 ? 60 : 380);
    eda_field f = line_field(random, axis, middle, half, k % 5 * 0.3);
    double at[CUTS], distance[CUTS][2], want[2] = {0};
    double first = g_rand_double_range(random, -3000, 3000);
    for (int j = 0; j < CUTS; j++)
      at[j] = first + g_rand_double_range(random, 0, 500);
    eda_cut_many(&f, axis, middle, half, CUTS, at, distance);
    for (int j = 0; j < CUTS; j++) {
      int good = cut_by_search(&f, axis, middle, half, at[j], want);
      if (isnan(distance[j][0])) {
        g_assert_true(isnan(distance[j][1]));
        left += good;
        none += !good;
        continue;
      }
      found++;
      g_assert_true(good);
      for (int side = 0; side < 2; side++)
        worst = fmax(worst, fabs(distance[j][side] - want[side]));
    }
    eda_field_clear(&f);
  }
  g_test_message(
      "%d found, within %.2g nm; %d left to a traversal, %d that are not "
      "simple",
      found, worst, left, none);
  g_assert_cmpfloat(worst, <, 1e-3);
  g_assert_cmpint(found, >, 10 * left);
  g_assert_cmpint(none, >, 500);
  g_rand_free(random);
}

/* Cuts without an edge yield NAN, and results do not depend on the number of
   simultaneous cuts. */
static void test_odd(void) {
  GRand *random = g_rand_new_with_seed(6);
  eda_field f = line_field(random, 0, 100, 32, 0.1);
  double at[CUTS], together[CUTS][2], one[1][2];
  for (int j = 0; j < CUTS; j++) at[j] = 13.7 * j;
  eda_cut_many(&f, 0, 100, 32, CUTS, at, together);
  for (int j = 0; j < CUTS; j++) {
    eda_cut_many(&f, 0, 100, 32, 1, at + j, one);
    g_assert_cmpfloat(one[0][0], ==, together[j][0]);
    g_assert_cmpfloat(one[0][1], ==, together[j][1]);
  }
  static const double bad[] = {NAN, INFINITY, 1e300};
  for (size_t k = 0; k < G_N_ELEMENTS(bad); k++) {
    eda_cut_many(&f, 0, bad[k], 32, 1, at, one);
    g_assert_true(isnan(one[0][0]) && isnan(one[0][1]));
    eda_cut_many(&f, 0, 100, bad[k], 1, at, one);
    g_assert_true(isnan(one[0][0]) && isnan(one[0][1]));
    eda_cut_many(&f, 0, 100, 32, 1, bad + k, one);
    g_assert_true(isnan(one[0][0]) && isnan(one[0][1]));
  }
  for (int i = 0; i < NX * NY; i++) f.coefficients[i] = NAN;
  eda_cut_many(&f, 0, 100, 32, CUTS, at, together);
  for (int j = 0; j < CUTS; j++) g_assert_true(isnan(together[j][0]));
  eda_field_clear(&f);
  g_rand_free(random);
}

/* A gate length of 2.6 um, as in capacitors between cells. */
static void test_long(void) {
  enum { N = 200, HALF = 1300 };
  const eda_frame long_frame = {0, 0, 25.0 * N, 200};
  eda_field f = {.frame = long_frame, .nx = N, .ny = 8};
  f.coefficients = eda_alloc((size_t)N * 8, sizeof(float));
  for (int i = 0; i < N * 8; i++) {
    double d = fabs(25.0 * (i % N) - 2500) / HALF;
    f.coefficients[i] = (float)((1 - d) / (1 + d));
  }
  const double at[] = {31, 77, 150};
  double found[3][2], want[2] = {0};
  eda_cut_many(&f, 0, 2500, HALF, 3, at, found);
  for (int j = 0; j < 3; j++) {
    g_assert_true(cut_by_search(&f, 0, 2500, HALF, at[j], want));
    for (int side = 0; side < 2; side++)
      g_assert_cmpfloat(fabs(found[j][side] - want[side]), <, 1e-3);
  }
  eda_field_clear(&f);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/cuts/walks", test_searches);
  g_test_add_func("/cuts/odd", test_odd);
  g_test_add_func("/cuts/long", test_long);
  return g_test_run();
}
