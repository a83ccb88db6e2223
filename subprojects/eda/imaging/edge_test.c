/* SPDX-License-Identifier: BSD-3-Clause */
/* Sign changes along lines, compared with closed forms and with a linear search
   of sampled noise. */
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>

#include "imaging/edge.h"

enum { NX = 40, NY = 50 };
static const eda_frame frame = {-370, 210, 1000, 1250}; /* steps of 25 nm */

static eda_field blank(void) {
  eda_field f = {.frame = frame, .nx = NX, .ny = NY};
  f.coefficients = eda_alloc((size_t)NX * NY, sizeof(float));
  return f;
}

/* Return cos(2 pi k (s - s0) / period) - level along an axis. */
static eda_field wave(int axis, int k, double level) {
  eda_field f = blank();
  int n = axis ? NY : NX;
  double scale = eda_spline_sampled((double)k / n);
  for (int j = 0; j < NY; j++)
    for (int i = 0; i < NX; i++)
      f.coefficients[j * NX + i] =
          (float)(cos(2 * M_PI * k * (axis ? j : i) / n) / scale - level);
  return f;
}

static double edge(const eda_field *f, int axis, double x, double y,
                   double reach) {
  return eda_field_edge(f, axis, x, y, reach);
}

static double value_at(const eda_field *f, double x, double y) {
  double v;
  eda_field_sample(f, &x, &y, 1, &v);
  return v;
}

/* A level of cos(u), crossed at a known distance from the maximum. */
static void test_wave(void) {
  for (int axis = 0; axis < 2; axis++) {
    double period = (axis ? frame.height : frame.width) / 4;
    double half = 0.3 * period, origin = axis ? frame.y0 : frame.x0;
    eda_field f = wave(axis, 4, cos(2 * M_PI * half / period));
    for (int i = -300; i < 300; i++) {
      double s = origin + 7.3 * i, u = remainder(s - origin, period);
      double want = u > 0 ? half - u : -half - u;
      double x = axis ? 33 : s, y = axis ? s : -44;
      double got = edge(&f, axis, x, y, INFINITY);
      g_assert_cmpfloat(fabs(got - want), <, 2e-3);
      g_assert_cmpfloat(fabs(edge(&f, axis, x, y, fabs(got)) - got), <, 1e-12);
      g_assert_true(isnan(edge(&f, axis, x, y, fabs(got) * (1 - 1e-9))));
      /* No change in the other direction. */
      g_assert_true(isnan(edge(&f, !axis, x, y, 5000)));
    }
    eda_field_clear(&f);
  }
}

/* Return the nearest sign change of the samples, found in steps. */
static double search_samples(const eda_field *f, int axis, double x, double y,
                             double reach, double step) {
  gboolean inside = value_at(f, x, y) > 0;
  for (double d = step; d <= reach; d += step)
    for (int out = 1; out >= -1; out -= 2) {
      double s = out * d;
      if ((value_at(f, x + (axis ? 0 : s), y + (axis ? s : 0)) > 0) == inside)
        continue;
      double low = d - step, high = d;
      for (int i = 0; i < 50; i++) {
        double m = (low + high) / 2, t = out * m;
        if ((value_at(f, x + (axis ? 0 : t), y + (axis ? t : 0)) > 0) == inside)
          low = m;
        else
          high = m;
      }
      return out * high;
    }
  return NAN;
}

static void test_noise(void) {
  GRand *random = g_rand_new_with_seed(11);
  int nearer = 0, none = 0;
  for (int k = 0; k < 4; k++) {
    eda_field f = blank();
    for (int i = 0; i < NX * NY; i++)
      f.coefficients[i] =
          (float)(g_rand_double_range(random, -1, 1) - 0.15 * k);
    for (int i = 0; i < 500; i++) {
      double x = g_rand_double_range(random, -2000, 2000);
      double y = g_rand_double_range(random, -2000, 2000);
      int axis = i % 2;
      double reach = i % 3 ? 400 : 20;
      double got = edge(&f, axis, x, y, reach);
      double want = search_samples(&f, axis, x, y, reach, 0.5);
      none += isnan(got);
      if (isnan(got))
        g_assert_true(isnan(want));
      else if (fabs(fabs(got) - fabs(want)) > 1e-6) {
        /* The linear search missed a pair of sign changes, or two sign changes
           are equally near. In both cases, the sign must change at the returned
           position. */
        double d = 1e-4, a = axis ? 0 : 1, b = axis ? 1 : 0;
        nearer += fabs(fabs(got) - fabs(want)) > 0.5 || isnan(want);
        g_assert_false(fabs(got) > fabs(want) + 0.5);
        g_assert_true(
            (value_at(&f, x + a * (got - d), y + b * (got - d)) > 0) !=
            (value_at(&f, x + a * (got + d), y + b * (got + d)) > 0));
      } else
        g_assert_cmpfloat(fabs(got - want), <, 1e-6);
    }
    eda_field_clear(&f);
  }
  g_test_message(
      "%d of 2000 without a change, %d nearer than a search in "
      "steps of 0.5 nm finds",
      none, nearer);
  g_assert_cmpint(none, >, 100);
  g_rand_free(random);
}

/* Two changes 0.2 nm apart, and a wave that just touches the level. */
static void test_close(void) {
  double period = frame.width / 4, half = 0.1;
  double found = cos(2 * M_PI * half / period);
  eda_field f = wave(0, 4, found);
  double d = edge(&f, 0, frame.x0 + 2 * period + 100, 300, 200);
  g_assert_cmpfloat(fabs(d + 100 - half), <, 0.1);
  eda_field_clear(&f);
  f = wave(0, 4, 1.00001);
  g_assert_true(isnan(edge(&f, 0, frame.x0 + 100, 300, INFINITY)));
  eda_field_clear(&f);
}

/* A search finds successive sign changes up to its limit. */
static void test_search(void) {
  double period = frame.width / 4;
  eda_field f = wave(0, 4, cos(2 * M_PI * 0.3));
  eda_line line;
  eda_line_search search[2];
  eda_line_make(&f, 0, 300, &line);
  g_assert_cmpfloat(eda_line_start(&line, frame.x0 + 5, &search[0], &search[1]),
                    >, 0);
  for (int side = 0; side < 2; side++)
    for (int i = 0; i < 7; i++) {
      int whole = i / 2;
      double want = (whole + (i % 2 ? 0.7 : 0.3)) * period + (side ? -5 : 5);
      double got = eda_line_search_to(&search[side], 900);
      if (want < 900)
        g_assert_cmpfloat(fabs(got - want), <, 2e-3);
      else
        g_assert_true(isnan(got));
    }
  eda_field_clear(&f);
}

static void test_nothing(void) {
  eda_field f = wave(0, 4, 0);
  g_assert_true(isnan(edge(&f, 0, NAN, 0, 100)));
  g_assert_true(isnan(edge(&f, 0, 0, INFINITY, 100)));
  g_assert_true(isnan(edge(&f, 0, 0, 0, -1)));
  g_assert_true(isnan(edge(&f, 0, 0, 0, NAN)));
  g_assert_cmpfloat(fabs(edge(&f, 0, 1e12, -1e12, 500)), <=, 125);
  /* Exactly on the edge. */
  double on = frame.x0 + frame.width / 16;
  double d = edge(&f, 0, on, 0, 100);
  g_assert_cmpfloat(fabs(d), <, 1e-3);
  g_assert_cmpfloat(fabs(edge(&f, 0, on + d, 0, 100)), <, 1e-9);
  for (int i = 0; i < NX * NY; i++) f.coefficients[i] = 0;
  g_assert_true(isnan(edge(&f, 0, 0, 0, INFINITY)));
  eda_field_clear(&f);
}

/* NAN values and frames of zero size yield NAN or a position within reach. */
static void test_no_numbers(void) {
  static const double bad[] = {NAN, INFINITY, 0, 1e300, 1e-300};
  eda_field f = wave(0, 4, 0.1);
  for (size_t k = 0; k < G_N_ELEMENTS(bad); k++)
    for (int part = 0; part < 4; part++)
      for (int axis = 0; axis < 2; axis++) {
        eda_field odd = f;
        (&odd.frame.x0)[part] = bad[k];
        double d = edge(&odd, axis, 10, 20, INFINITY);
        g_assert_true(isnan(d) ||
                      fabs(d) <= fmax(odd.frame.width, odd.frame.height));
        eda_line line;
        eda_line_search search[2];
        eda_line_make(&odd, axis, 20, &line);
        eda_line_start(&line, 10, &search[0], &search[1]);
        for (int i = 0; i < 10; i++)
          eda_line_search_to(&search[i % 2], INFINITY);
      }
  for (int i = 0; i < NX * NY; i += 3)
    f.coefficients[i] = i % 2 ? NAN : INFINITY;
  for (int i = 0; i < 200; i++) {
    double d = edge(&f, i % 2, 5 * i, 7 * i, INFINITY);
    g_assert_true(isnan(d) || fabs(d) <= 1250);
  }
  eda_field_clear(&f);
}

/* Measure the time of a call near an edge and 60 nm away. */
static void test_time(void) {
  eda_field f = wave(0, 4, 0);
  for (int far = 0; far < 2; far++) {
    enum { CALLS = 200000 };
    double sum = 0;
    gint64 start = g_get_monotonic_time();
    for (int i = 0; i < CALLS; i++)
      sum += edge(&f, 0, frame.x0 + 62.5 + (far ? 60 : 0.01 * (i % 300)),
                  i % 1000, 100);
    double us = (double)(g_get_monotonic_time() - start) / CALLS;
    g_test_message("%s an edge: %.3f us a call (%g)",
                   far ? "60 nm from" : "near", us, sum);
    g_assert_cmpfloat(us, <, 20); /* also with sanitizers */
  }
  eda_field_clear(&f);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/edge/wave", test_wave);
  g_test_add_func("/edge/noise", test_noise);
  g_test_add_func("/edge/close", test_close);
  g_test_add_func("/edge/search", test_search);
  g_test_add_func("/edge/nothing", test_nothing);
  g_test_add_func("/edge/no-numbers", test_no_numbers);
  g_test_add_func("/edge/time", test_time);
  return g_test_run();
}
