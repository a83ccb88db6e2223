/* SPDX-License-Identifier: BSD-3-Clause */
/* Interpolation, compared with closed forms: parabolas, planes, and the
   equation of the ramp. Delays of circuits that are refused. */
#include <eda/delays.h>
#include <eda/timing.h>
#include <glib.h>
#include <math.h>
#include <string.h>

static void near(double a, double b, double within) {
  if (!(fabs(a - b) <= within)) g_error("%.12g is not %.12g", a, b);
}

static double parabola(double x) { return 3 - 2 * x + 0.25 * x * x; }

/* Cubics reproduce parabolas for any grid, and extrapolate with the slopes at
   the ends. */
static void test_cubic(void) {
  const double x[] = {1, 2, 2.5, 7, 8};
  double y[5], c[16];
  for (int i = 0; i < 5; i++) y[i] = parabola(x[i]);
  eda_timing_cubic(x, y, 5, c);
  for (double at = 1; at <= 8; at += 0.13)
    near(eda_timing_cubic_at(x, c, 5, at), parabola(at), 1e-12);
  near(eda_timing_cubic_at(x, c, 5, 0), parabola(1) - (-1.5), 1e-12);
  near(eda_timing_cubic_at(x, c, 5, 10), parabola(8) + 2 * 2, 1e-12);
  /* Two points define a line. */
  eda_timing_cubic(x, y, 2, c);
  near(eda_timing_cubic_at(x, c, 2, 1.25), 0.75 * y[0] + 0.25 * y[1], 1e-12);
}

enum { SLEWS = 4, LOADS = 5, BUNDLES = 2 };
static double slews[SLEWS] = {1, 2, 5, 9}, loads[LOADS] = {0.5, 1, 2, 6, 8};

static double drawn(double s, double l) { return 5 + 2 * l + s - 0.1 * s * l; }

/* Return the shift for each unit of change k. */
static double moves(double s, double l, int k) {
  return (k + 1) * (2 + 3 * l - 0.5 * s);
}

static eda_timing *timing_make(void) {
  eda_timing *t = eda_timing_new(1);
  eda_timing_cell *c = &t->cell[0];
  *c = (eda_timing_cell){.name = "inv",
                         .inputs = 1,
                         .outputs = 1,
                         .bundles = BUNDLES,
                         .slews = SLEWS,
                         .loads = LOADS,
                         .at_slew = slews,
                         .at_load = loads,
                         .near_slew = {1, 2},
                         .near_load = {1, 3},
                         .arcs = 2};
  c->arc = eda_pool_alloc(&t->memory, 2, sizeof *c->arc);
  c->arc_of = eda_pool_alloc(&t->memory, 2, sizeof *c->arc_of);
  c->level = eda_pool_alloc(&t->memory, 2, 1);
  eda_timing_cell_figures(&t->memory, c);
  const eda_timing_arc *a = &c->arc[1];
  const double points[3][2] = {{2, 1}, {2, 6}, {5, 1}};
  for (int i = 0; i < SLEWS * LOADS; i++) {
    a->delay[i] = drawn(slews[i / LOADS], loads[i % LOADS]);
    a->slew[i] = 2 * a->delay[i];
  }
  const int n = BUNDLES * EDA_SIZES;
  for (int p = 0; p < 3; p++)
    for (int k = 0; k < n; k++) {
      a->delay_by[p * n + k] = moves(points[p][0], points[p][1], k);
      a->slew_by[p * n + k] = -moves(points[p][0], points[p][1], k);
    }
  for (int k = 0; k < 4; k++) {
    c->capacitance[k] = 1 + k;
    c->capacitance_by[k * n + 4] = 10 * (k + 1);
  }
  return t;
}

static void test_look_up(void) {
  eda_timing *t = timing_make();
  const eda_timing_cell *c = eda_timing_find(t, "INV");
  double delay[SLEWS], slew[SLEWS];
  const double change[BUNDLES * EDA_SIZES] = {0, 0.01, 0, 0, -0.02, 0};
  g_assert_nonnull(c);
  g_assert_null(eda_timing_find(t, "inv2"));
  eda_timing_at(c, &c->arc[1], 3, 1.5, change, delay, slew);
  for (int i = 0; i < SLEWS; i++) {
    double s = slews[i];
    near(delay[i], drawn(s, 3) + 0.01 * moves(s, 3, 1) - 0.02 * moves(s, 3, 4),
         1e-12);
    near(slew[i],
         2 * drawn(s, 1.5) - 0.01 * moves(s, 1.5, 1) + 0.02 * moves(s, 1.5, 4),
         1e-12);
  }
  eda_timing_at(c, &c->arc[1], 3, 1.5, NULL, delay, slew);
  near(delay[2], drawn(5, 3), 1e-12);
  near(eda_timing_capacitance(c, 0, 1, EDA_CAP_SLEW, change), 4 - 0.02 * 40,
       1e-12);
  near(eda_timing_capacitance(c, 0, 0, EDA_CAP_DELAY, NULL), 1, 0);
  eda_timing_free(t);
}

static void test_check(void) {
  opc_error error;
  eda_timing *t = timing_make();
  g_assert_cmpint(eda_timing_check(t, &error), ==, OPC_OK);
  t->cell[0].figure[7] = (double)NAN;
  g_assert_cmpint(eda_timing_check(t, &error), ==, OPC_FAILED);
  g_assert_nonnull(strstr(error.message, "figure 7 of cell 'inv'"));
  t->cell[0].trouble = "it has no arcs";
  g_assert_cmpint(eda_timing_check(t, &error), ==, OPC_OK);
  eda_timing_free(t);
}

/* The ramp crosses each level at the time given by integrating its derivative;
   the slope is continuous at the end of the linear part. */
static void test_ramp(void) {
  for (int rises = 0; rises < 2; rises++) {
    double v = 0, step = 1e-5, bend = rises ? 0.55 : 0.7;
    double points[EDA_TIMING_RAMP], level[EDA_TIMING_RAMP];
    for (double t = 0; v < 0.98; t += step) {
      near(eda_timing_ramp(rises, v), t, 1e-3);
      v += step * (v < bend ? 1 : (1 - v) / (1 - bend));
    }
    eda_timing_ramp_points(rises, points, level);
    near(level[0], 0, 0);
    near(level[EDA_TIMING_RAMP - 1], 1, 0);
    for (int i = 1; i < EDA_TIMING_RAMP; i++) {
      g_assert_cmpfloat(level[i], >, level[i - 1]);
      g_assert_cmpfloat(points[i], >, points[i - 1]);
      if (level[i] < 1)
        near(points[i], eda_timing_ramp(rises, level[i]), 1e-12);
    }
  }
}

/* Factors that are linear in each slew and a parabola in the gap are reproduced
   up to half a step beyond the simulated slews. Beyond the last gap, factors of
   parallel inputs are 1. */
static void test_pair(void) {
  double figure[6 + 10 * EDA_TIMING_GAPS] = {1, 3, 1.5, 2, 4, 3.5}, d, s;
  eda_timing_pair p = {.at = {figure, figure + 3},
                       .delay = figure + 6,
                       .slew = figure + 6 + 5 * EDA_TIMING_GAPS};
  for (int k = 0; k < 5; k++)
    for (int g = 0; g < EDA_TIMING_GAPS; g++) {
      double first = figure[k < 4 ? k / 2 : 2],
             second = figure[3 + (k < 4 ? k % 2 : 2)];
      p.delay[k * EDA_TIMING_GAPS + g] =
          first * second + parabola(eda_timing_gap[g]);
      p.slew[k * EDA_TIMING_GAPS + g] = first - second;
    }
  for (double gap = 0; gap < 1.3; gap += 0.19)
    for (double first = 0.1; first < 4; first += 0.7) {
      eda_timing_pair_at(&p, gap, first, 2.6, &d, &s);
      near(d, first * 2.6 + parabola(gap), 1e-12);
      near(s, first - 2.6, 1e-12);
    }
  eda_timing_pair_at(&p, 1.9, 2, 3, &d, &s);
  near(d, 6 + (parabola(1.3) + parabola(2.5)) / 2, 1e-12);
  eda_timing_pair_at(&p, 9, 2, 3, &d, &s);
  near(d, 6 + parabola(2.5), 1e-12);
  p.parallel = 1;
  eda_timing_pair_at(&p, 9, 2, 3, &d, &s);
  near(d, 1, 0);
  near(s, 1, 0);
  /* An excess at the inner point has full effect at this point and no effect on
     the border. */
  p.slew[4 * EDA_TIMING_GAPS] += 0.3;
  eda_timing_pair_at(&p, 0, 1.5, 3.5, &d, &s);
  near(s, 1.5 - 3.5 + 0.3, 1e-12);
  eda_timing_pair_at(&p, 0, 3, 3.5, &d, &s);
  near(s, 3 - 3.5, 1e-12);
  /* More than half a step beyond the simulated slews, values are constant. */
  eda_timing_pair_at(&p, 0, 99, 3, &d, &s);
  near(s, 4 - 3, 1e-12);
  near(eda_timing_blend(0, 2, 4), 3, 0);
  near(eda_timing_blend(0.5, 2, 4), 2.5, 1e-15);
  near(eda_timing_blend(1.5, 2, 4), 2, 0);
}

/* Each figure of each path and of each arc is checked. */
static void test_delays(void) {
  opc_error error;
  eda_delays *d = eda_delays_new(NULL);
  g_assert_null(d->size[0]);
  g_assert_cmpint(eda_delays_check(d, &error), ==, OPC_OK);
  eda_delays_free(d);
  eda_delays_free(NULL);
  const eda_gates *gates = eda_gates_sample();
  d = eda_delays_new(gates);
  for (int k = 0; k < EDA_SIZES; k++)
    for (size_t i = 0; i < gates->count; i++)
      g_assert_cmpfloat(d->size[k][i], ==, 0);
  eda_delay_term terms[3][2] = {{{0, {1, 2, 3}}, {1, {0}}},
                                {{1, {4, 5, 6}}},
                                {{0, {7, 8, 9}}, {1, {1, 1, 1}}}};
  eda_delay_path path[2] = {{.delay = {5, 2, terms[0]}},
                            {.delay = {-4, 1, terms[1]}}};
  eda_delay_arc arc[2] = {{.delay = {3, 0, NULL}}, {.delay = {2, 2, terms[2]}}};
  g_assert_cmpint(eda_delays_check(d, &error), ==, OPC_FAILED);
  g_assert_cmpstr(error.message, ==,
                  "delays have 0 paths, expected a named circuit with at least "
                  "one path");
  d->paths = 2;
  d->path = path;
  g_assert_cmpint(eda_delays_check(d, &error), ==, OPC_FAILED);
  d->name = "top";
  d->arcs = 2;
  d->arc = arc;
  g_assert_cmpint(eda_delays_check(d, &error), ==, OPC_OK);
  double *times[] = {&path[0].delay.time, &path[1].delay.time,
                     &arc[0].delay.time, &arc[1].delay.time};
  for (size_t i = 0; i < 4; i++) {
    double good = *times[i];
    *times[i] = (double)INFINITY;
    g_assert_cmpint(eda_delays_check(d, &error), ==, OPC_FAILED);
    g_autofree char *want = g_strdup_printf(
        "a derivative of %s %zu is not a number, or its "
        "transistor does not exist",
        i < 2 ? "path" : "arc", i % 2);
    g_assert_cmpstr(error.message, ==, want);
    *times[i] = good;
  }
  for (size_t i = 0; i < 2; i++)
    for (int k = 0; k < EDA_SIZES; k++) {
      float good = terms[2][i].by[k];
      terms[2][i].by[k] = NAN;
      g_assert_cmpint(eda_delays_check(d, &error), ==, OPC_FAILED);
      terms[2][i].by[k] = good;
    }
  terms[1][0].gate = 2;
  g_assert_cmpint(eda_delays_check(d, &error), ==, OPC_FAILED);
  g_assert_nonnull(strstr(error.message, "path 1"));
  eda_delays_free(d);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/timing/cubic", test_cubic);
  g_test_add_func("/timing/look-up", test_look_up);
  g_test_add_func("/timing/check", test_check);
  g_test_add_func("/timing/ramp", test_ramp);
  g_test_add_func("/timing/pair", test_pair);
  g_test_add_func("/timing/delays", test_delays);
  return g_test_run();
}
