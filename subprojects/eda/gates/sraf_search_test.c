/* SPDX-License-Identifier: BSD-3-Clause */
/* Scatter bars on maps whose best rectangles are known, and on random maps, for
   which an exhaustive search must find the same first bar. */
#include <eda/memory.h>
#include <eda/srafs.h>
#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { NX = 60, NY = 50, STEP = 10 };

/* Nodes are at 5, 15, ... nm, cells between multiples of 10. */
static const eda_frame frame = {5, 5, NX *STEP, NY *STEP};
static float values[NX * NY];
static const eda_field map = {{5, 5, NX *STEP, NY *STEP}, NX, NY, values};

static const eda_sraf_limits rule = {.most = 20,
                                     .min_gain = 100,
                                     .least_width = 30,
                                     .most_width = 60,
                                     .least_length = 60,
                                     .most_length = 200,
                                     .distance = 70,
                                     .space = 40};

static void field_fill(eda_box b, float value) {
  for (int y = b.y0 / STEP; y < b.y1 / STEP; y++)
    for (int x = b.x0 / STEP; x < b.x1 / STEP; x++) values[y * NX + x] = value;
}

static eda_box_list bars_search(const eda_sraf_limits *by,
                                const eda_box *drawn) {
  const eda_box b = drawn ? *drawn : (eda_box){0};
  eda_point points[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  uint32_t start[] = {0, 4};
  const eda_shapes shapes = {
      .count = drawn != NULL, .start = start, .points = points};
  eda_box_list srafs = {0};
  opc_error error;
  g_assert_false(eda_srafs_search(&map, by, &shapes, 1, &srafs, &error));
  return srafs;
}

/* The scatter bars cover exactly the regions where the map is negative. */
static void test_known(void) {
  const eda_box want = {200, 80, 250, 220}, line = {300, 300, 340, 480};
  field_fill((eda_box){0, 0, NX * STEP, NY * STEP}, 1);
  field_fill(want, -2);
  field_fill((eda_box){280, 320, 300, 400}, -3); /* a region beside the line */
  eda_box_list srafs = bars_search(&rule, &line);
  g_assert_cmpuint(srafs.count, ==, 1);
  g_assert_cmpmem(&srafs.box[0], sizeof want, &want, sizeof want);
  g_assert_cmpfloat(eda_srafs_gain(&map, want, 1), ==, 2 * 50 * 140);
  free(srafs.box);
  /* Scatter bars below the smallest gain, or beyond the largest number, are not
     added. */
  eda_sraf_limits less = rule;
  less.min_gain = 2 * 50 * 140;
  srafs = bars_search(&less, &line);
  g_assert_cmpuint(srafs.count, ==, 0);
  less.min_gain = 100;
  less.most = 0;
  srafs = bars_search(&less, &line);
  g_assert_cmpuint(srafs.count, ==, 0);
  free(srafs.box);
}

static int box_off(eda_box a, eda_box b, int32_t by) {
  return a.x1 + by <= b.x0 || b.x1 + by <= a.x0 || a.y1 + by <= b.y0 ||
         b.y1 + by <= a.y0;
}

static double sum_of(eda_box b) {
  double sum = 0;
  for (int y = b.y0 / STEP; y < b.y1 / STEP; y++)
    for (int x = b.x0 / STEP; x < b.x1 / STEP; x++)
      sum -= STEP * STEP * (double)values[y * NX + x];
  return sum;
}

/* Return the largest gain of a rectangle of even size, by exhaustive search. */
static double best_of_all(eda_box drawn) {
  double best = 0;
  for (int w = 30; w <= 60; w += STEP)
    for (int l = 60; l <= 70; l += STEP)
      for (int upright = 0; upright < 2; upright++)
        for (int y = STEP; y < NY * STEP; y += STEP)
          for (int x = STEP; x < NX * STEP; x += STEP) {
            eda_box b = {x, y, x + (upright ? w : l), y + (upright ? l : w)};
            if (b.x1 > NX * STEP || b.y1 > NY * STEP ||
                !box_off(b, drawn, rule.distance))
              continue;
            double sum = sum_of(b);
            if (sum > best) best = sum;
          }
  return best;
}

static void test_random(void) {
  GRand *r = g_rand_new_with_seed(5);
  size_t all = 0;
  eda_sraf_limits by = rule;
  by.most_length = 70;
  for (int round = 0; round < 10; round++) {
    const eda_box drawn = {250, 200, 290, 330};
    for (int i = 0; i < NX * NY; i++)
      values[i] = (float)g_rand_double_range(r, -1, 1);
    eda_box_list srafs = bars_search(&by, &drawn);
    all += srafs.count;
    g_assert_cmpuint(srafs.count, >, 0);
    g_assert_cmpfloat(fabs(sum_of(srafs.box[0]) - best_of_all(drawn)), <, 1e-2);
    for (size_t i = 0; i < srafs.count; i++) {
      g_assert_cmpfloat(eda_srafs_gain(&map, srafs.box[i], 1), >,
                        rule.min_gain);
      g_assert_true(box_off(srafs.box[i], drawn, rule.distance));
      for (size_t k = 0; k < i; k++)
        g_assert_true(box_off(srafs.box[i], srafs.box[k], rule.space));
    }
    free(srafs.box);
  }
  g_assert_cmpuint(all, >, 50);
  g_rand_free(r);
}

/* A level set of -0.1 except at a point in the middle of one bar, which
   prints. */
static void test_narrow(void) {
  const eda_box start[] = {{50, 50, 90, 250}, {200, 50, 400, 80}};
  eda_field print = {frame, NX, NY, eda_alloc(NX * NY, sizeof(float))};
  for (int i = 0; i < NX * NY; i++) print.coefficients[i] = -0.1F;
  print.coefficients[6 * NX + 29] = 2; /* the coefficient of the node at (295,
                                          65) */
  eda_box_list srafs = {0};
  eda_box_list_add(&srafs, start[0]);
  eda_box_list_add(&srafs, start[1]);
  size_t dropped = 0;
  g_assert_cmpuint(
      eda_srafs_narrow(NULL, &srafs, &print, 1, 0.02, 3, 20, &dropped), ==, 1);
  const eda_box thin = {200, 53, 400, 77};
  g_assert_cmpmem(&srafs.box[0], sizeof thin, &start[0], sizeof thin);
  g_assert_cmpmem(&srafs.box[1], sizeof thin, &thin, sizeof thin);
  g_assert_cmpuint(dropped, ==, 0);
  g_assert_cmpuint(
      eda_srafs_narrow(NULL, &srafs, &print, 1, 0.02, 3, 20, &dropped), ==, 1);
  g_assert_cmpuint(srafs.count, ==, 1);
  g_assert_cmpuint(dropped, ==, 1);
  g_assert_cmpuint(
      eda_srafs_narrow(NULL, &srafs, &print, 1, 0.02, 3, 20, &dropped), ==, 0);
  eda_field_clear(&print);
  free(srafs.box);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/sraf_search/known", test_known);
  g_test_add_func("/sraf_search/random", test_random);
  g_test_add_func("/sraf_search/narrow", test_narrow);
  return g_test_run();
}
