/* SPDX-License-Identifier: BSD-3-Clause */
/* Straightening restores rectilinear polygons whose points were displaced by
   one unit, within one unit, and leaves slanted edges unchanged. */
#include <eda/geometry.h>
#include <glib.h>
#include <stdlib.h>

/* A staircase with 2 * STEPS corners, closed by two more points. */
enum { STEPS = 12, POINTS = 2 * STEPS + 2 };

static eda_shapes one(uint32_t start[2], eda_point *points, uint32_t n) {
  start[0] = 0;
  start[1] = n;
  return (eda_shapes){.count = 1, .start = start, .points = points};
}

static int slanted(const eda_point *p, uint32_t n) {
  int found = 0;
  for (uint32_t i = 0; i < n; i++)
    found += p[i].x != p[(i + 1) % n].x && p[i].y != p[(i + 1) % n].y;
  return found;
}

static void test_shaken(void) {
  g_autoptr(GRand) rand = g_rand_new_with_seed(3);
  for (int run = 0; run < 200; run++) {
    eda_point drawn[POINTS], shaken[POINTS];
    uint32_t start[2];
    int32_t x = 0, y = 0;
    for (int i = 0; i < STEPS; i++) {
      x += g_rand_int_range(rand, 20, 90);
      drawn[2 * i] = (eda_point){x, y};
      y += g_rand_int_range(rand, 20, 90);
      drawn[2 * i + 1] = (eda_point){x, y};
    }
    drawn[2 * STEPS] = (eda_point){-50, y};
    drawn[2 * STEPS + 1] = (eda_point){-50, 0};
    for (int i = 0; i < POINTS; i++) {
      shaken[i] = drawn[i];
      if (g_rand_boolean(rand)) continue;
      shaken[i].x += g_rand_boolean(rand);
      shaken[i].y += g_rand_boolean(rand);
    }
    int before = slanted(shaken, POINTS);
    eda_shapes s = one(start, shaken, POINTS);
    g_assert_cmpuint(eda_shapes_straighten(&s, 1), ==, before);
    g_assert_cmpint(slanted(shaken, POINTS), ==, 0);
    for (int i = 0; i < POINTS; i++) {
      g_assert_cmpint(abs(shaken[i].x - drawn[i].x), <=, 1);
      g_assert_cmpint(abs(shaken[i].y - drawn[i].y), <=, 1);
    }
    g_assert_cmpuint(eda_shapes_straighten(&s, 1), ==, 0);
  }
}

/* Larger deviations, a slope in steps of one unit, and edges at 45 degrees are
   unchanged. */
static void test_stays(void) {
  static const eda_point all[][6] = {
      {{0, 0}, {100, 0}, {102, 80}, {0, 80}},
      {{0, 0}, {100, 0}, {101, 30}, {102, 60}, {102, 80}, {0, 80}},
      {{0, 0}, {100, 0}, {130, 30}, {0, 30}}};
  static const uint32_t count[] = {4, 6, 4};
  for (int k = 0; k < 3; k++) {
    eda_point p[6];
    uint32_t start[2];
    for (int i = 0; i < 6; i++) p[i] = all[k][i];
    eda_shapes s = one(start, p, count[k]);
    g_assert_cmpuint(eda_shapes_straighten(&s, 1), ==, 0);
    for (uint32_t i = 0; i < count[k]; i++) {
      g_assert_cmpint(p[i].x, ==, all[k][i].x);
      g_assert_cmpint(p[i].y, ==, all[k][i].y);
    }
  }
}

/* Two consecutive edges of one line that differ by at most one unit; a larger
   limit straightens more edges. */
static void test_in_a_row(void) {
  eda_point p[] = {{0, 0}, {100, 0}, {101, 30}, {100, 60}, {101, 80}, {0, 80}};
  uint32_t start[2];
  eda_shapes s = one(start, p, 6);
  g_assert_cmpuint(eda_shapes_straighten(&s, 1), ==, 3);
  for (int i = 1; i < 5; i++) g_assert_cmpint(p[i].x, ==, 100);
  eda_point q[] = {{0, 0}, {100, 0}, {104, 80}, {0, 80}};
  s = one(start, q, 4);
  g_assert_cmpuint(eda_shapes_straighten(&s, 4), ==, 1);
  g_assert_cmpint(q[1].x, ==, 102);
  g_assert_cmpint(q[2].x, ==, 102);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/straighten/shaken", test_shaken);
  g_test_add_func("/straighten/stays", test_stays);
  g_test_add_func("/straighten/in-a-row", test_in_a_row);
  return g_test_run();
}
