/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests shapes that flatten ripples of known cause: a Gaussian smooths the
   steps of the mask. The expected values are sums over the width. */
#include "shape.c"

#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "jog.c"

enum { WIDTH = 600, PART = 60, PAST = 80 };
static const double gain = 2.6, leak = -0.39;

static sides edges = {.from = {-PAST, -PAST},
                      .to = {WIDTH + PAST, WIDTH + PAST},
                      .high = WIDTH,
                      .blur = 60};

static parts parts_here(int32_t width, const sides *s) {
  eda_box box = {0, 0, 65, width};
  uint8_t axis = EDA_X;
  eda_gates g = {.grid = 1, .count = 1, .box = &box, .axis = &axis};
  return parts_of(&g, 0, s, 40);
}

/* Return the ripple of a mask that is by[k] longer in part k. */
static ripple printed_ripple(const parts *p, const int *by) {
  ripple r = {.count = SAMPLES * (p->last - p->first)};
  double mean = 0;
  for (int j = 0; j < r.count; j++) {
    int k = p->first + j / SAMPLES;
    double part = (p->edge[k + 1] - p->edge[k]) / SAMPLES;
    double at = p->edge[k] + part * (j % SAMPLES + 0.5), sum = 0, all = 0;
    for (double x = -400; x < WIDTH + 400; x += 0.25) {
      double z = (x - at) / tuned.smooth, weight = exp(-z * z / 2);
      for (int m = 0; m < p->count; m++)
        if (p->edge[m] <= x && x < p->edge[m + 1]) sum += by[m] * weight;
      all += weight;
    }
    r.off[j] = gain * sum / all;
    mean += r.off[j] / r.count;
  }
  for (int j = 0; j < r.count; j++) r.off[j] -= mean;
  return r;
}

static int jogs_of(const parts *p, const shape *s) {
  int n = 0;
  for (int k = 1; k < p->count; k++) n += s->by[k] != s->by[k - 1];
  return n;
}

static double ripple_rms(const ripple *r) {
  double sum = 0;
  for (int j = 0; j < r->count; j++) sum += r->off[j] * r->off[j];
  return sqrt(sum / r->count);
}

/* The computed effect of a step equals the sum over the width. */
static void test_effect(void) {
  parts p = parts_here(WIDTH, &edges);
  shape none = {{0}}, s = {{0}};
  int by[EDA_PARTS] = {0};
  s.by[0] = 5, s.by[3] = -2, s.by[p.count - 1] = 1;
  for (int k = 0; k < p.count; k++) by[k] = s.by[k];
  ripple flat = {.count = SAMPLES * (p.last - p.first)};
  ripple want = printed_ripple(&p, by),
         r = ripple_after(&p, &flat, &none, &s, gain, tuned.smooth);
  for (int j = 0; j < r.count; j++)
    g_assert_cmpfloat(fabs(r.off[j] - want.off[j]), <, 0.02);
}

/* Ten parts in the gate, and one on each side where the poly extends far
   enough. */
static void test_parts(void) {
  parts p = parts_here(WIDTH, &edges);
  g_assert_cmpint(p.count, ==, WIDTH / PART + 2);
  g_assert_cmpint(p.first, ==, 1);
  g_assert_cmpfloat(p.edge[0], ==, -PAST);
  g_assert_cmpfloat(p.edge[1], ==, 0);
  g_assert_cmpfloat(p.edge[p.last], ==, WIDTH);
  sides near = edges;
  near.from[0] = -20;
  near.from[1] = -20;
  sides_weigh(&near);
  p = parts_here(WIDTH, &near);
  g_assert_cmpint(p.first, ==, 0);
  g_assert_cmpint(p.last, ==, WIDTH / PART);
  near.to[0] = near.to[1] = 10000 + PAST;
  sides_weigh(&near);
  p = parts_here(10000, &near); /* one long part in the middle, or two */
  g_assert_cmpint(p.count, <=, EDA_PARTS);
  for (int k = 0; k < p.count; k++)
    g_assert_cmpfloat(p.edge[k + 1] - p.edge[k], >=, PART);
  int middle = (p.first + p.last) / 2; /* the parts are symmetric to it */
  for (int k = p.first; k <= p.last; k++)
    g_assert_cmpfloat(p.edge[k] + p.edge[p.first + p.last - k], ==, 10000);
  for (int k = p.first; k < middle - 1; k++)
    g_assert_cmpfloat(p.edge[k + 1] - p.edge[k], ==, PART);
  g_assert_cmpfloat(p.edge[middle], ==, 5000);
  g_assert_cmpint(parts_here(59, &edges).count, ==, 0);
}

/* No other step is within 40 of a jog, except at its position. */
static void test_beside(void) {
  parts p = parts_here(WIDTH, &edges);
  shape stepped = {{0}};
  for (int k = 0; k < p.count; k += 2) stepped.by[k] = 1;
  for (int at = 40; at < WIDTH - 40; at++) {
    parts q = parts_beside(&p, &edges, at, 40, &stepped);
    for (int k = 1; k < q.count; k++) {
      double off = fabs(q.edge[k] - at);
      g_assert_true(off == 0 || off >= 40);
      g_assert_cmpfloat(q.edge[k] - q.edge[k - 1], >=, 19);
      g_assert_cmpfloat(fabs(q.edge[k] - p.edge[k]), <=, 40);
    }
  }
}

/* Adjacent parts with equal steps become one part of the edge; the outer parts
   extend as far as the edge. */
static void test_write(void) {
  parts p = parts_here(WIDTH, &edges);
  shape s = {{0}};
  eda_part out[EDA_PARTS];
  s.by[0] = s.by[1] = 2, s.by[4] = -1;
  shape_write(&p, &s, out);
  g_assert_cmpint(out[0].from, ==, -EDA_PART_END);
  g_assert_cmpint(out[0].to, ==, 60);
  g_assert_cmpint(out[0].by, ==, 2);
  g_assert_cmpint(out[1].from, ==, 180);
  g_assert_cmpint(out[1].to, ==, 240);
  g_assert_cmpint(out[2].from, ==, out[2].to);
  /* Any shape is written exactly; compare each grid step of the edge. */
  uint32_t state = 8;
  for (int n = 0; n < 50; n++) {
    for (int k = 0; k < p.count; k++) {
      state = state * 1664525u + 1013904223u;
      s.by[k] = (int32_t)(state >> 30) - 1;
    }
    shape_write(&p, &s, out);
    for (int32_t x = -2 * PAST; x < WIDTH + 2 * PAST; x++) {
      int k = 0, by = 0, found = 0;
      while (k + 1 < p.count && p.edge[k + 1] <= x) k++;
      for (int m = 0; m < EDA_PARTS; m++)
        if (out[m].from <= x && x < out[m].to) by = out[m].by, found++;
      g_assert_cmpint(by, ==, s.by[k]);
      g_assert_cmpint(found, ==, by != 0);
    }
  }
  /* A step of all parts equals a step of L. */
  for (int k = 0; k < EDA_PARTS; k++) s.by[k] = 1;
  g_assert_cmpfloat(fabs(shape_value(&p, &s) - 1), <, 1e-9);
}

/* The value of a shape equals the mean over the width of the smoothed steps of
   the mask, computed by sums. */
static void test_value(void) {
  parts p = parts_here(WIDTH, &edges);
  uint32_t state = 3;
  for (int n = 0; n < 5; n++) {
    shape s = {{0}};
    double sum = 0, weights = 0;
    for (int k = 0; k < p.count; k++) {
      state = state * 1664525u + 1013904223u;
      s.by[k] = (int32_t)(state >> 28) - 8;
    }
    for (double at = 1; at < WIDTH; at += 2)
      for (double x = 1 - PAST; x < WIDTH + PAST; x += 2) {
        double z = (x - at) / edges.blur, weight = exp(-z * z / 2);
        int k = 0;
        while (k + 1 < p.count && p.edge[k + 1] <= x) k++;
        sum += weight * s.by[k];
        weights += weight;
      }
    g_assert_cmpfloat(fabs(shape_value(&p, &s) - sum / weights), <, 0.01);
  }
}

/* A shape corrects the ripple of a known mask, to less than a third if jogs
   have no price. A higher price results in fewer jogs and more ripple, the
   highest price in no jogs. With `blocked` no part becomes longer. */
static void test_flat(void) {
  parts p = parts_here(WIDTH, &edges);
  const int by[EDA_PARTS] = {-6, -4, -2, 0, 0, 0, 3, 3, 0, 0, 0, 2};
  ripple r = printed_ripple(&p, by);
  shape none = {{0}};
  int before = EDA_PARTS;
  double left = 0;
  static const double price[] = {0, 0.5, 2, 1e6};
  for (size_t k = 0; k < G_N_ELEMENTS(price); k++) {
    shape s = shape_flat(&p, &r, &none, leak, gain, tuned.smooth, price[k], 0);
    ripple after = ripple_after(&p, &r, &none, &s, gain, tuned.smooth);
    g_test_message("price %g: %d jogs, %.2f of %.2f nm", price[k],
                   jogs_of(&p, &s), ripple_rms(&after), ripple_rms(&r));
    g_assert_cmpint(jogs_of(&p, &s), <=, before);
    g_assert_cmpfloat(ripple_rms(&after), >=, left);
    before = jogs_of(&p, &s);
    left = ripple_rms(&after) - 0.3;
    if (k == 0) g_assert_cmpfloat(ripple_rms(&after), <, ripple_rms(&r) / 3);
  }
  g_assert_cmpint(before, ==, 0);
  shape s = shape_flat(&p, &r, &none, leak, gain, tuned.smooth, 0, 1);
  for (int k = 0; k < p.count; k++) g_assert_cmpint(s.by[k], <=, 0);
}

/* One half of the gate is 1 nm longer and the other 1 nm shorter: the currents
   increase by cosh(slope). The cost equals, to second order, the area of the L
   and W that compensate for both currents. */
static void test_excess(void) {
  ripple r = {.count = SAMPLES * 4};
  for (int j = 0; j < r.count; j++) r.off[j] = j < r.count / 2 ? 1 : -1;
  g_assert_cmpfloat(fabs(ripple_excess(&r, -0.3) - log(cosh(0.3))), <, 1e-12);
  const curve c = {{-0.05, -0.39, 0}};
  double ion = 0.05 * 0.05 / 2, ioff = 0.39 * 0.39 / 2;
  double l = (ioff - ion) / (0.39 - 0.05), w = 0.05 * l - ion;
  g_assert_cmpfloat(fabs(ripple_cost(65, &c) - (l / 65 + w)), <, 1e-12);
}

/* The length along y decreases by 0.5 nm per nm, starting 30 nm before the HIGH
   end of the width. Spline coefficients of linear functions equal the function
   values. */
static void test_thin_end(void) {
  enum { NX = 80, NY = 240, NODE = 2, LENGTH = 64, HIGH = 320 };
  eda_field print = {.frame = {0, 0, NX * NODE, NY * NODE}, .nx = NX, .ny = NY};
  print.coefficients = g_new(float, (size_t)NX *NY);
  for (int y = 0; y < NY; y++)
    for (int x = 0; x < NX; x++)
      print.coefficients[y * NX + x] =
          (float)(LENGTH / 2.0 - fmax(0, y * NODE - HIGH + 30) / 4 -
                  abs(x * NODE - 80));
  eda_box box = {48, 80, 112, HIGH};
  uint8_t axis = EDA_X;
  double l = LENGTH, w = HIGH - 80;
  eda_gates g = {.grid = 1,
                 .count = 1,
                 .box = &box,
                 .axis = &axis,
                 .length = &l,
                 .width = &w};
  eda_feedback f = {.gates = &g, .print = &print};
  static const struct {
    int high, from, most;
    double least, want;
  } cases[] = {{1, 0, 99, -5, 20},
               {1, 0, 99, -10, 10},
               {1, 15, 99, -5, 35},
               {1, -15, 99, -5, 5},
               {1, -25, 99, -5, 0},
               {1, 0, 8, -5, 8},
               {0, 0, 99, -5, 0},
               {0, 20, 99, -5, 0},
               /* position beyond which no poly prints */
               {1, 140, 200, -5, 160}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    int32_t k = width_thin_end(&f, 0, cases[i].high, cases[i].from,
                               cases[i].most, cases[i].least);
    g_assert_cmpfloat_with_epsilon(k, cases[i].want, 1.5);
  }
  f.print = NULL;
  g_assert_cmpint(width_thin_end(&f, 0, 1, 0, 99, -5), ==, 0);
  g_free(print.coefficients);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  sides_weigh(&edges);
  g_test_add_func("/shape/parts", test_parts);
  g_test_add_func("/shape/beside", test_beside);
  g_test_add_func("/shape/write", test_write);
  g_test_add_func("/shape/value", test_value);
  g_test_add_func("/shape/effect", test_effect);
  g_test_add_func("/shape/flat", test_flat);
  g_test_add_func("/shape/thin-end", test_thin_end);
  g_test_add_func("/shape/excess", test_excess);
  return g_test_run();
}
