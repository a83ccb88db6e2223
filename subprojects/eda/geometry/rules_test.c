/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask rules, compared with results computed by hand; spaces and widths of
   lines, compared with all pairs. regulator.drc compares spaces and widths of
   real masks with KLayout. */
#include "eda/rules.h"

#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "eda/memory.h"

enum { MOST = 64 };

typedef struct drawing {
  eda_point points[MOST];
  uint32_t start[16];
  eda_shapes shapes;
} drawing;

static void drawing_add(drawing *d, const int32_t (*xy)[2], size_t n) {
  size_t i = d->shapes.count++;
  g_assert_cmpuint(d->start[i] + n, <=, MOST);
  for (size_t k = 0; k < n; k++)
    d->points[d->start[i] + k] = (eda_point){xy[k][0], xy[k][1]};
  d->start[i + 1] = d->start[i] + (uint32_t)n;
  d->shapes.start = d->start;
  d->shapes.points = d->points;
}
#define ADD(d, ...)                               \
  do {                                            \
    static const int32_t xy[][2] = {__VA_ARGS__}; \
    drawing_add(d, xy, G_N_ELEMENTS(xy));         \
  } while (0)

/* Return the number of violations of a rule on a grid of 0.5 nm, and the last
   violation. */
static size_t count_violations(const drawing *d, int rule, double least,
                               eda_rule_fault *last) {
  double limit[EDA_RULES] = {0};
  eda_rule_fault *fault;
  limit[rule] = least;
  size_t n = eda_rules_check(&d->shapes, 0.5, limit, &fault);
  for (size_t i = 0; i < n; i++) {
    g_assert_cmpint(fault[i].rule, ==, rule);
    *last = fault[i];
  }
  free(fault);
  return n;
}

/* Draw a line of 100 x 1000 steps. Its right side has a bump of 30 x 4, its
   left side a jog of 6, its lower left corner a stair of 3 x 8 and 8 x 3. */
static void line(drawing *d) {
  ADD(d, {0, 0}, {100, 0}, {100, 400}, {104, 400}, {104, 430}, {100, 430},
      {100, 1000}, {-6, 1000}, {-6, 500}, {0, 500}, {0, 300}, {-3, 300},
      {-3, 292}, {-11, 292}, {-11, 289}, {0, 289});
}

/* The step of a jog is not a violation; a short edge between two jogs is a
   violation. */
static void test_edges(void) {
  drawing d = {0};
  eda_rule_fault f;
  line(&d);
  g_assert_cmpuint(count_violations(&d, EDA_RULE_EDGE, 15, &f), ==, 3);
  /* The bump is 15 nm long (30 steps of 0.5 nm). */
  g_assert_cmpuint(count_violations(&d, EDA_RULE_EDGE, 15.5, &f), ==, 4);
  g_assert_cmpuint(count_violations(&d, EDA_RULE_EDGE, 5.5, &f), ==, 2);
  g_assert_cmpuint(count_violations(&d, EDA_RULE_EDGE, 4, &f), ==, 0);
  drawing bump = {0};
  ADD(&bump, {0, 0}, {100, 0}, {100, 400}, {104, 400}, {104, 430}, {100, 430},
      {100, 1000}, {0, 1000});
  g_assert_cmpuint(count_violations(&bump, EDA_RULE_EDGE, 16, &f), ==, 1);
  g_assert_cmpfloat(f.x, ==, 52);
  g_assert_cmpfloat(f.y, ==, 207.5);
  g_assert_cmpfloat(f.value, ==, 15);
}

/* Two jogs: 3 nm on the left, 2 nm at the stair. The bump is not a jog, because
   its corners are both convex or both concave. */
static void test_jogs(void) {
  drawing d = {0};
  eda_rule_fault f;
  ADD(&d, {0, 0}, {100, 0}, {100, 400}, {104, 400}, {104, 1000}, {-6, 1000},
      {-6, 500}, {0, 500});
  g_assert_cmpuint(count_violations(&d, EDA_RULE_JOG, 2, &f), ==, 0);
  g_assert_cmpuint(count_violations(&d, EDA_RULE_JOG, 3, &f), ==, 1);
  g_assert_cmpfloat(f.value, ==, 2);
  g_assert_cmpfloat(f.x, ==, 51);
  g_assert_cmpfloat(f.y, ==, 200);
  g_assert_cmpuint(count_violations(&d, EDA_RULE_JOG, 3.5, &f), ==, 2);
  drawing box = {0};
  ADD(&box, {0, 0}, {4, 0}, {4, 400}, {0, 400});
  g_assert_cmpuint(count_violations(&box, EDA_RULE_JOG, 10, &f), ==, 0);
}

/* Random parallel lines: each space and each line is reported once; lines
   behind another line are not reported. */
static void test_bars(void) {
  guint32 seed = 3;
  for (int run = 0; run < 100; run++) {
    drawing d = {0};
    size_t narrow = 0, near = 0;
    int32_t x = 0;
    for (int i = 0; i < 12; i++) {
      seed = seed * 1664525u + 1013904223u;
      int32_t gap = 1 + (int32_t)(seed >> 28),
              w = 1 + (int32_t)(seed >> 24 & 15);
      near += i && gap < 8;
      narrow += w < 8;
      x += gap;
      const int32_t xy[4][2] = {{x, 0}, {x + w, 0}, {x + w, 90}, {x, 90}};
      drawing_add(&d, xy, 4);
      x += w;
    }
    eda_rule_fault f;
    g_assert_cmpuint(count_violations(&d, EDA_RULE_WIDTH, 4, &f), ==, narrow);
    g_assert_cmpuint(count_violations(&d, EDA_RULE_SPACE, 4, &f), ==, near);
  }
}

/* Corners that are 3 steps of 0.5 nm apart along x and 4 steps along y have a
   diagonal distance of 2.5 nm. */
static void test_corners(void) {
  drawing d = {0};
  eda_rule_fault f;
  ADD(&d, {0, 0}, {50, 0}, {50, 50}, {0, 50});
  ADD(&d, {53, 54}, {100, 54}, {100, 100}, {53, 100});
  g_assert_cmpuint(count_violations(&d, EDA_RULE_SPACE, 2.5, &f), ==, 0);
  g_assert_cmpuint(count_violations(&d, EDA_RULE_SPACE, 2.6, &f), ==, 1);
  g_assert_cmpfloat(f.value, ==, 2.5);
  g_assert_cmpfloat(f.x, ==, 51.5 / 2);
}

static void test_nothing(void) {
  drawing d = {0};
  double none[EDA_RULES] = {0}, all[EDA_RULES] = {1, 1, 1, 1};
  eda_rule_fault *fault;
  g_assert_cmpuint(eda_rules_check(&d.shapes, 1, all, &fault), ==, 0);
  free(fault);
  line(&d);
  g_assert_cmpuint(eda_rules_check(&d.shapes, 1, none, &fault), ==, 0);
  free(fault);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/rules/edges", test_edges);
  g_test_add_func("/rules/jogs", test_jogs);
  g_test_add_func("/rules/bars", test_bars);
  g_test_add_func("/rules/corners", test_corners);
  g_test_add_func("/rules/nothing", test_nothing);
  return g_test_run();
}
