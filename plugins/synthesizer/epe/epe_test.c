/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests correction of shapes with a synthetic printed image: convergence, mask
   rules (checked here edge by edge), and independence of the number of
   threads. */
#include <stdlib.h>

#include "core/plugin/host.h"
#include "trial_test.h"

/* ---- solved ---- */

/* Return an error of 8 nm plus 2 nm per nm of the mean shift of three adjacent
   fragments. */
static double coupled(const trial *t, size_t i) {
  return 8 + 2 *
                 (t->shift[fragment_before(t, i)] + t->shift[i] +
                  t->shift[fragment_after(t, i)]) /
                 3.0;
}

static void test_solved(void) {
  const eda_box line = {0, 0, 100, 2000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  trial t = trial_correct("{}", &s->gates, straight);
  g_assert_cmpuint(t.count, >, 60);
  for (size_t i = 0; i < t.count; i++) g_assert_cmpint(t.shift[i], ==, 6);
  trial_clear(&t);
  t = trial_correct("{ iterations: 40 }", &s->gates, coupled);
  for (size_t i = 0; i < t.count; i++) {
    g_assert_cmpfloat(fabs(t.epe[i]), <=, 1);
    g_assert_cmpint(abs(t.shift[i] + 4), <=, 1);
  }
  trial_clear(&t);
}

/* Corners do not print at any shift. Sites away from corners converge, and
   shifts at corners stay within max_shift. */
static double round_corners(const trial *t, size_t i) {
  int corner = t->cuts.from[i].y < 50 || t->cuts.from[i].y > 1950;
  return corner ? -30 : straight(t, i);
}

static void test_corners(void) {
  const eda_box line = {0, 0, 100, 2000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  trial t = trial_correct("{ max_shift: 25 nm, blur: 20 nm, iterations: 60 }",
                          &s->gates, round_corners);
  for (size_t i = 0; i < t.count; i++) {
    int far = t.cuts.from[i].y > 200 && t.cuts.from[i].y < 1800;
    g_assert_cmpint(abs(t.shift[i]), <=, 25);
    if (far) g_assert_cmpfloat(fabs(t.epe[i]), <=, 1.5);
  }
  trial_clear(&t);
}

/* Return NAN (no edge) at shifts below 10, where the line does not print, and
   above 25, where lines are merged; otherwise an error that is 0 at a shift of
   16. */
static double hidden(const trial *t, size_t i) {
  return t->shift[i] < 10   ? (double)NAN
         : t->shift[i] > 25 ? (double)NAN
                            : 14.0 - 20 + 1.0 * (t->shift[i] - 10);
}

static void test_lost(void) {
  const eda_box line = {0, 0, 60, 1000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  trial t = trial_correct("{}", &s->gates, hidden);
  for (size_t i = 0; i < t.count; i++) g_assert_cmpfloat(fabs(t.epe[i]), <=, 1);
  trial_clear(&t);
}

/* ---- fragments and sites ---- */

static void test_cut(void) {
  /* An L, concave at (200, 100). */
  const eda_box boxes[] = {{0, 0, 600, 100}, {0, 0, 200, 500}};
  g_autoptr(shapes) s = make_shapes(boxes, 2);
  trial t = trial_correct(
      "{ fragment: 50 nm, min_edge: 20 nm, corner_edge: 30 nm, concave_corner: "
      "20 "
      "nm, tangency: 45 nm, line_end: 100 nm, iterations: 0 }",
      &s->gates, straight);
  int ends = 0, convex = 0, concave = 0;
  for (size_t i = 0; i < t.count; i++) {
    eda_point a = t.cuts.from[i], b = t.cuts.from[fragment_after(&t, i)];
    int length = abs(a.x - b.x) + abs(a.y - b.y);
    ends += a.x == 600 && b.x == 600 && length == 100;
    convex += a.x == 0 && a.y == 0 && length == 30;
    concave += length == 20 &&
               ((a.x == 200 && a.y == 100) || (b.x == 200 && b.y == 100));
    g_assert_cmpint(length, >=, 20);
    const double *site = &t.cuts.site[2 * i];
    if (a.y == 0 && b.y == 0) {
      g_assert_cmpfloat(site[0], >=, 45);
      g_assert_cmpfloat(site[0], <=, 555);
      g_assert_cmpfloat(site[1], ==, 0);
    }
  }
  g_assert_cmpint(ends, ==, 1);
  g_assert_cmpint(convex, ==, 1);
  g_assert_cmpint(concave, ==, 2);
  trial_clear(&t);
}

/* An edge is cut at the projection of the end of another line. */
static void test_ripple(void) {
  const eda_box boxes[] = {{0, 0, 1000, 100}, {433, 200, 1500, 300}};
  g_autoptr(shapes) s = make_shapes(boxes, 2);
  for (int reach = 0; reach <= 150; reach += 150) {
    g_autofree char *p = g_strdup_printf(
        "{ ripple_reach: %d nm, ripple: 20 nm, iterations: 0 }", reach);
    trial t = trial_correct(p, &s->gates, straight);
    int found = 0;
    for (size_t i = 0; i < t.count; i++)
      found += t.cuts.from[i].y == 100 &&
               (t.cuts.from[i].x == 433 || t.cuts.from[i].x == 413 ||
                t.cuts.from[i].x == 453);
    g_assert_cmpint(found, ==, reach ? 3 : 0);
    trial_clear(&t);
  }
}

/* ---- the rules of the mask ---- */

/* An edge of the corrected mask; the inside is on the left. */
typedef struct side {
  int32_t at, low, high;
  int upright, out;
} side;

static GArray *sides_of(const trial *t, const eda_gates *gates) {
  eda_shapes merged = moved_of(t, gates);
  GArray *sides = g_array_new(FALSE, FALSE, sizeof(side));
  for (size_t p = 0; p < merged.count; p++)
    for (uint32_t i = merged.start[p]; i < merged.start[p + 1]; i++) {
      eda_point a = merged.points[i];
      eda_point b =
          merged.points[i + 1 < merged.start[p + 1] ? i + 1 : merged.start[p]];
      int upright = a.x == b.x, rises = upright ? b.y > a.y : b.x > a.x;
      side e = {upright ? a.x : a.y, upright ? MIN(a.y, b.y) : MIN(a.x, b.x),
                upright ? MAX(a.y, b.y) : MAX(a.x, b.x), upright,
                upright == rises ? 1 : -1};
      g_array_append_val(sides, e);
    }
  eda_shapes_clear(&merged);
  return sides;
}

/* Return the number of pairs that face each other at less than `limit`. Pairs
   through the inside overlap along the edges; pairs across a space include
   corners. */
static int too_near(GArray *sides, int inside, int32_t limit) {
  int found = 0;
  for (guint i = 0; i < sides->len; i++)
    for (guint k = 0; k < sides->len; k++) {
      side a = g_array_index(sides, side, i), b = g_array_index(sides, side, k);
      if (a.upright != b.upright || a.out == b.out) continue;
      if (a.out != (inside ? -1 : 1) || b.at <= a.at) continue;
      double along = MAX(a.low, b.low) - MIN(a.high, b.high);
      found += along < 0 ? b.at - a.at < limit
                         : !inside && hypot(b.at - a.at, along) < limit;
    }
  return found;
}

static int count_broken(const trial *t, const eda_gates *gates) {
  g_autoptr(GArray) sides = sides_of(t, gates);
  return too_near(sides, 0, 40) + too_near(sides, 1, 40);
}

/* Shapes drawn by the rules satisfy the rules after correction. */
static void test_rules(void) {
  int without = 0, tried = 0;
  for (uint32_t seed = 1; tried < 12; seed++) {
    g_assert_cmpuint(seed, <, 1000);
    g_autoptr(shapes) s = messy(seed);
    trial drawn = trial_correct("{ iterations: 0 }", &s->gates, nonsense);
    if (!count_broken(&drawn, &s->gates)) {
      tried++;
      trial loose =
          trial_correct("{ min_width: 0 nm, min_space: 0 nm, iterations: 8 }",
                        &s->gates, nonsense);
      trial t = trial_correct("{ iterations: 8, min_jog: 3 nm }", &s->gates,
                              nonsense);
      without += count_broken(&loose, &s->gates);
      g_assert_cmpint(count_broken(&t, &s->gates), ==, 0);
      int moved = 0;
      for (size_t i = 0; i < t.count; i++) moved += t.shift[i] != 0;
      g_assert_cmpint(moved, >, (int)t.count / 4);
      trial_clear(&loose);
      trial_clear(&t);
    }
    trial_clear(&drawn);
  }
  g_assert_cmpint(without, >, 100);
}

static size_t count_jogs(const trial *t) {
  size_t n = 0;
  for (size_t i = 0; i < t->count; i++)
    n += t->shift[i] != t->shift[fragment_after(t, i)];
  return n;
}

static double wavy(const trial *t, size_t i) {
  return 6 * sin(0.4 * (double)i) + t->shift[i];
}

static void test_jogs(void) {
  const eda_box line = {0, 0, 100, 8000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  size_t last = SIZE_MAX;
  for (int jog = 1; jog <= 5; jog += 2) {
    g_autofree char *p = g_strdup_printf("{ min_jog: %d nm }", jog);
    trial t = trial_correct(p, &s->gates, wavy);
    for (size_t i = 0; i < t.count; i++) {
      size_t k = fragment_after(&t, i);
      int corner = t.cuts.from[k].y % 8000 == 0;
      if (!corner && t.shift[i] != t.shift[k])
        g_assert_cmpint(abs(t.shift[i] - t.shift[k]), >=, jog);
    }
    g_assert_cmpuint(count_jogs(&t), <, last);
    last = count_jogs(&t);
    trial_clear(&t);
  }
}

static void test_threads(void) {
  g_autoptr(shapes) s = messy(5);
  opc_set_threads(1);
  trial one = trial_correct("{}", &s->gates, nonsense);
  opc_set_threads(7);
  trial seven = trial_correct("{}", &s->gates, nonsense);
  opc_set_threads(0);
  g_assert_cmpmem(one.shift, one.count * sizeof *one.shift, seven.shift,
                  seven.count * sizeof *seven.shift);
  trial_clear(&one);
  trial_clear(&seven);
}

static void test_refused(void) {
  opc_error error;
  g_assert_null(opc_test_module(
      "synthesizer.epe", "{ fragment: 20 nm, min_edge: 30 nm }", &error));
  g_assert_nonnull(strstr(error.message,
                          "'min_edge' is 30 nm, expected at most 'fragment'"));
  const eda_box line = {0, 0, 60, 1000};
  g_autoptr(shapes) s = make_shapes(&line, 1);
  g_autoptr(opc_module) m =
      opc_test_module("synthesizer.epe", "{ best: ion }", &error);
  const eda_synthesizer *y = m->functions;
  eda_feedback f = {.gates = &s->gates};
  g_assert_cmpint(y->begin(m->self, &f, &error), ==, OPC_INVALID);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/epe/solved", test_solved);
  g_test_add_func("/epe/corners", test_corners);
  g_test_add_func("/epe/lost", test_lost);
  g_test_add_func("/epe/cut", test_cut);
  g_test_add_func("/epe/ripple", test_ripple);
  g_test_add_func("/epe/rules", test_rules);
  g_test_add_func("/epe/jogs", test_jogs);
  g_test_add_func("/epe/threads", test_threads);
  g_test_add_func("/epe/refused", test_refused);
  return g_test_run();
}
