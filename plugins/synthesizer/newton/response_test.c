/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests responses of transistors with known laws, and their updates against the
   same estimate computed from information matrices. */
#include "response.c"

#include <eda/devices.h>
#include <glib.h>
#include <stdlib.h>

enum { GATES = 40 };

static double random_in(double low, double high) {
  static uint32_t state = 5;
  state = state * 1664525u + 1013904223u;
  return low + (high - low) * (state >> 8) / (1 << 24);
}

static void assert_near(double a, double b) {
  g_assert_cmpfloat(fabs(a - b), <, 1e-9 * (1 + fabs(b)));
}

/* Transistors whose log(I / W) falls along a line for each type. */
typedef struct drawn_and_printed {
  uint8_t type[GATES];
  uint32_t flags[GATES];
  double length[GATES], width[GATES];
  double of[2][6][GATES]; /* ion, ioff, leq_ion, leq_ioff, weq, area */
  eda_gates gates;
  eda_performance performance[2];
  eda_feedback feedback;
} drawn_and_printed;

static const double slope[2][2] = {{-0.02, -0.3}, {-0.03, -0.2}};

static void make_gates(drawn_and_printed *d) {
  memset(d, 0, sizeof *d);
  for (int i = 0; i < GATES; i++) {
    int t = i % 3 == 0;
    d->type[i] = t ? EDA_PMOS : EDA_NMOS;
    d->length[i] = t ? 60 : 50;
    d->width[i] = random_in(100, 900);
    for (int p = 0; p < 2; p++) {
      double(*o)[GATES] = d->of[p];
      for (int k = 0; k < 2; k++)
        o[2 + k][i] = d->length[i] + (p ? random_in(-8, 5) : 0);
      o[4][i] = d->width[i] * (p ? random_in(0.9, 1.05) : 1);
      o[5][i] = o[4][i] * random_in(48, 60);
      for (int k = 0; k < 2; k++)
        o[k][i] = 1e-6 * o[4][i] *
                  exp(slope[t][k] * (o[2 + k][i] - d->length[i]) - 9 * k);
    }
  }
  for (int p = 0; p < 2; p++) {
    double(*o)[GATES] = d->of[p];
    d->performance[p] = (eda_performance){.count = GATES,
                                          .ion = o[0],
                                          .ioff = o[1],
                                          .leq_ion = o[2],
                                          .leq_ioff = o[3],
                                          .weq = o[4],
                                          .area = o[5]};
  }
  d->gates = (eda_gates){.grid = 0.5,
                         .count = GATES,
                         .type = d->type,
                         .length = d->length,
                         .width = d->width};
  d->feedback = (eda_feedback){.gates = &d->gates,
                               .design = &d->performance[0],
                               .printed = &d->performance[1],
                               .flags = d->flags};
}

/* The slopes equal those of the lines. Flagged gates and gates without a
   current do not count; without any valid gate, the current is proportional to
   1 / L. */
static void test_curves(void) {
  drawn_and_printed d;
  curve c[2];
  make_gates(&d);
  d.flags[1] = EDA_PRINT_OPEN;
  d.of[1][0][1] *= 3;
  d.of[1][1][2] = 0;
  curves_measure(&d.feedback, c);
  for (int t = 0; t < 2; t++) {
    for (int k = 0; k < 2; k++) assert_near(c[t].slope[k], slope[t][k]);
    assert_near(c[t].slope[AREA], t ? 1 / 60.0 : 1 / 50.0);
  }
  memset(d.of[1][0], 0, sizeof d.of[1][0]);
  curves_measure(&d.feedback, c);
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < 2; k++)
      assert_near(c[t].slope[k], -1.0 / (t ? 60 : 50));
}

static void test_errors(void) {
  drawn_and_printed d;
  const double target[ERRORS] = {1.1, 0.8, 0.95};
  double e[ERRORS], more[ERRORS];
  make_gates(&d);
  g_assert_true(errors_of(&d.feedback, 7, target, e));
  double(*o)[GATES] = d.of[0], (*p)[GATES] = d.of[1];
  assert_near(exp(e[ION]), p[0][7] / o[0][7] / 1.1);
  assert_near(exp(e[IOFF]), p[1][7] / o[1][7] / 0.8);
  assert_near(exp(e[AREA]), p[5][7] / o[5][7] / 0.95);
  /* The correction is proportional to the difference between mean and
     equivalent lengths. */
  const curve c = {{-0.05, -0.39, 0}};
  memcpy(more, e, sizeof e);
  errors_with_line_ends(&d.feedback, 7, &c, more);
  double mean = p[5][7] / p[4][7];
  assert_near(more[ION], e[ION] - 0.05 * (mean - p[2][7]));
  assert_near(more[IOFF], e[IOFF] - 0.39 * (mean - p[3][7]));
  assert_near(more[AREA], e[AREA]);
  point at = point_of(&d.performance[1], 7);
  for (int k = 0; k < 2; k++) {
    assert_near(at.length[k], p[2 + k][7]);
    assert_near(exp(at.drive[k]), p[k][7] / p[4][7]);
  }
  static const uint32_t gone[] = {EDA_PRINT_OPEN, EDA_PRINT_MERGED,
                                  EDA_PRINT_ISLAND, EDA_PRINT_NO_ACTIVE};
  for (size_t k = 0; k < G_N_ELEMENTS(gone); k++) {
    d.flags[7] = gone[k];
    g_assert_false(errors_of(&d.feedback, 7, target, e));
    g_assert_cmpfloat(fabs(e[0]) + fabs(e[1]) + fabs(e[2]), ==, 0);
  }
  d.flags[7] = EDA_PRINT_NECK;
  g_assert_true(errors_of(&d.feedback, 7, target, e));
  for (int k = 0; k < 6; k++) {
    if (k == 2 || k == 3) continue;
    double kept = p[k][7];
    p[k][7] = 0;
    g_assert_false(errors_of(&d.feedback, 7, target, e));
    memset(more, 0, sizeof more);
    errors_with_line_ends(&d.feedback, 7, &c, more);
    g_assert_cmpfloat(fabs(more[ION]) + fabs(more[IOFF]), ==, 0);
    at = point_of(&d.performance[1], 7);
    g_assert_true(isnan(at.drive[ION]) && isnan(at.drive[IOFF]));
    p[k][7] = kept;
  }
}

/* A step of the grid of 0.5 nm, with gains of 2 and 0.7. */
static void test_first(void) {
  drawn_and_printed d;
  make_gates(&d);
  const curve c = {{-0.05, -0.39, 0}};
  const double gain[MOVES] = {2, 0.7};
  response r = response_first(&d.gates, 3, &c, gain);
  assert_near(r.by[ION][BY_L], -0.05);
  assert_near(r.by[IOFF][BY_L], -0.39);
  assert_near(r.by[AREA][BY_L], 1 / d.length[3]);
  for (int k = 0; k < ERRORS; k++)
    assert_near(r.by[k][BY_W], 0.35 / d.width[3]);
  assert_near(r.slope[ION], -0.05);
  assert_near(r.slope[IOFF], -0.39);
  for (int m = 0; m < MOVES; m++) assert_near(r.doubt[m], tuned.doubt[m]);
}

/* After any number of calls, the ratio of response and slope is the initial
   ratio; nothing else changes. */
static void test_bend(void) {
  response first = {.by = {{-0.1, 0.02}, {-0.8, 0.02}, {0.02, 0.02}},
                    .slope = {-0.05, -0.4}},
           r = first;
  r.by[ION][BY_L] = -0.12;
  r.by[IOFF][BY_L] = -0.9;
  const point from = {{60, 58}, {1, 2}};
  const point to[] = {
      {{64, 60}, {0.9, 1.5}}, {{50, 51}, {1.3, 7}}, {{62, 70}, {0.8, -3}}};
  for (int k = 0; k < 3; k++) {
    double ion = (to[k].drive[ION] - 1) / (to[k].length[ION] - 60);
    double ioff = (to[k].drive[IOFF] - 2) / (to[k].length[IOFF] - 58);
    response_bend(&r, &first, from, to[k], 1);
    assert_near(r.by[ION][BY_L], -0.12 * ion / -0.05);
    assert_near(first.by[ION][BY_L], -0.1 * ion / -0.05);
    assert_near(r.by[IOFF][BY_L], -0.9 * ioff / -0.4);
    assert_near(first.by[IOFF][BY_L], -0.8 * ioff / -0.4);
  }
  response before = r, first_before = first;
  const point none[] = {{{60.9, 57.1}, {0.5, 3}},
                        {{64, 62}, {1.1, 2.5}},
                        {{50, 48}, {0.9, 1}},
                        {{NAN, NAN}, {NAN, NAN}}};
  for (size_t k = 0; k < G_N_ELEMENTS(none); k++)
    response_bend(&r, &first, from, none[k], 1);
  g_assert_cmpmem(&r, sizeof r, &before, sizeof before);
  g_assert_cmpmem(&first, sizeof first, &first_before, sizeof first_before);
}

/* Compute the most likely response after a noisy measurement, by adding the
   information matrices of the previous estimate and of the measurement
   (Gauss-Markov theorem). */
static void most_likely_response(const response *r, const response *first,
                                 const double *dx, const double *de,
                                 double noise, response *out) {
  *out = *r;
  for (int k = 0; k < ERRORS; k++) {
    double of_noise = noise * first->by[k][BY_L] / first->by[ION][BY_L];
    double a[2][2], y = de[k], weight = 1 / (of_noise * of_noise);
    double square = of_noise * of_noise;
    for (int m = 0; m < MOVES; m++) {
      double spread = r->doubt[m] * r->by[k][m];
      for (int n = 0; n < MOVES; n++)
        a[m][n] = weight * dx[m] * dx[n] + (m == n ? 1 / (spread * spread) : 0);
      y -= r->by[k][m] * dx[m];
      square += spread * spread * dx[m] * dx[m];
    }
    /* An improbable change counts as one of odd_surprise standard deviations.
     */
    double most = tuned.odd_surprise * sqrt(square);
    y = CLAMP(y, -most, most);
    double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    for (int m = 0; m < MOVES; m++) {
      double step = weight * y * (dx[m] * a[!m][!m] - dx[!m] * a[m][!m]) / det;
      double low = first->by[k][m] / tuned.trust[m];
      double high = first->by[k][m] * tuned.trust[m];
      out->by[k][m] = CLAMP(r->by[k][m] + step, MIN(low, high), MAX(low, high));
      if (k == ION)
        out->doubt[m] = fmax(tuned.least_doubt,
                             sqrt(a[!m][!m] / det) / fabs(r->by[ION][m]));
    }
  }
}

static void test_learn(void) {
  const response first = {.by = {{-0.1, 0.02}, {-0.8, 0.02}, {0.02, 0.02}},
                          .doubt = {0.5, 0.3}};
  int bound = 0;
  for (int n = 0; n < 300; n++) {
    response r = first, want;
    double dx[MOVES] = {random_in(-5, 5), random_in(-20, 20)}, de[ERRORS];
    double noise = random_in(0.001, 0.2);
    for (int m = 0; m < MOVES; m++) r.doubt[m] = random_in(0.05, 0.8);
    for (int k = 0; k < ERRORS; k++) {
      for (int m = 0; m < MOVES; m++) r.by[k][m] *= random_in(0.8, 1.25);
      de[k] = random_in(0.3, 2.5) * first.by[k][0] * dx[0] +
              random_in(0.3, 2.5) * first.by[k][1] * dx[1];
    }
    most_likely_response(&r, &first, dx, de, noise, &want);
    response_learn(&r, &first, dx, de, noise);
    for (int m = 0; m < MOVES; m++) {
      for (int k = 0; k < ERRORS; k++) {
        g_assert_cmpfloat(fabs(r.by[k][m] / want.by[k][m] - 1), <, 1e-6);
        double part = r.by[k][m] / first.by[k][m];
        bound += part == tuned.trust[m] || part == 1 / tuned.trust[m];
      }
      g_assert_cmpfloat(fabs(r.doubt[m] - want.doubt[m]), <, 1e-6);
    }
  }
  g_assert_cmpint(bound, >, 10);
  g_assert_cmpint(bound, <, 900);
  /* Without a move the response does not change. */
  response r = first;
  const double none[MOVES] = {0, 0}, de[ERRORS] = {1, 1, 1};
  response_learn(&r, &first, none, de, 0);
  g_assert_cmpmem(r.by, sizeof r.by, first.by, sizeof first.by);
}

static double left_over(const response *r, const double *e, const double *w,
                        double l, double width) {
  double sum = 0;
  for (int k = 0; k < ERRORS; k++) {
    double off = e[k] + r->by[k][BY_L] * l + r->by[k][BY_W] * width;
    sum += w[k] * off * off;
  }
  return sum;
}

/* No small change of the solution along the free moves reduces the sum of
   squares. */
static void test_solve(void) {
  for (int n = 0; n < 300; n++) {
    response r;
    double e[ERRORS], w[ERRORS], dx[MOVES];
    const int is_free[MOVES] = {n % 4 != 1 && n % 4 != 3,
                                n % 4 != 2 && n % 4 != 3};
    for (int k = 0; k < ERRORS; k++) {
      e[k] = random_in(-1, 1);
      w[k] = random_in(0.1, 2);
      for (int m = 0; m < MOVES; m++) r.by[k][m] = random_in(-1, 1);
    }
    response_solve(&r, e, w, is_free, dx);
    double best = left_over(&r, e, w, dx[0], dx[1]);
    for (int m = 0; m < MOVES; m++) {
      if (!is_free[m]) g_assert_cmpfloat(dx[m], ==, 0);
      for (int s = -1; s <= 1 && is_free[m]; s += 2)
        g_assert_cmpfloat(left_over(&r, e, w, dx[0] + (m ? 0 : s * 1e-3),
                                    dx[1] + (m ? s * 1e-3 : 0)),
                          >, best);
    }
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/response/curves", test_curves);
  g_test_add_func("/response/errors", test_errors);
  g_test_add_func("/response/first", test_first);
  g_test_add_func("/response/bend", test_bend);
  g_test_add_func("/response/learn", test_learn);
  g_test_add_func("/response/solve", test_solve);
  return g_test_run();
}
