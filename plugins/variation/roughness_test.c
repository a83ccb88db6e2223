/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the effect of line edges against closed forms, and against gates with
   explicit rough contours. */
#include <eda/memory.h>
#include <glib.h>
#include <math.h>

#include "variation.h"

enum { COUNT = 400 };
static const double first = 25, grid = 0.2;

/* Curves of ln Ion = -L / 30 and of ln Ioff, a quadratic function of L. */
static double ln_current(int q, double length) {
  double d = length - 65;
  return q == ION ? -d / 30 : -0.3 * d + 0.02 * d * d;
}

static void curves_make(curves *c) {
  curves_init(c, 1, first, first + COUNT * grid);
  c->first = first;
  for (size_t i = 0; i < c->count; i++)
    for (int q = 0; q < CURRENTS; q++)
      c->value[q][i] = (float)ln_current(q, first + (double)i * c->step);
}

static void effects(const roughness *r, size_t slices, const double *width,
                    const double *length, roughness_effect *out) {
  curves c;
  roughness_moments m;
  curves_make(&c);
  roughness_moments_init(&m, r, &c, NULL);
  roughness_of_gate(r, &m, 0, slices, width, length, out);
  roughness_moments_clear(&m);
  curves_clear(&c);
}

static void assert_near(double got, double want, double part) {
  if (!(fabs(got - want) <= part * fabs(want)))
    g_error("%.8g, expected %.8g", got, want);
}

/* With a correlation length far above W, all points change equally: ln Ion is
   normal with the standard deviation sqrt(2) sigma / 30. */
static void test_equal(void) {
  const roughness r = {1.5, 1e7, 0.5};
  const double width[] = {100, 200}, length[] = {65, 65};
  roughness_effect e[KNOTS];
  effects(&r, 2, width, length, e);
  for (int k = 0; k < KNOTS; k++) {
    assert_near((double)e[k].sigma[ION], sqrt(2) * 1.5 / 30, 1e-3);
    g_assert_cmpfloat(fabs((double)e[k].shift[ION]), <, 2e-5);
  }
  /* E exp(b x + c x^2), x normal, = exp(b^2 v / (2 (1 - 2 c v))) / sqrt(1 - 2 c
     v). */
  double v = 2 * 1.5 * 1.5, b = -0.3, c = 0.02;
  double mean = exp(b * b * v / (2 * (1 - 2 * c * v))) / sqrt(1 - 2 * c * v);
  double square =
      exp(4 * b * b * v / (2 * (1 - 4 * c * v))) / sqrt(1 - 4 * c * v);
  const roughness_effect *nominal = &e[KNOT_ZERO];
  double s = sqrt(log(square / mean / mean));
  assert_near((double)nominal->sigma[IOFF], s, 0.01);
  g_assert_cmpfloat(
      fabs((double)nominal->shift[IOFF] - (log(mean) - s * s / 2)), <,
      0.005 * s);
  double on = exp(v / 1800), d = b - 1 / 30.0;
  double product = exp(d * d * v / (2 * (1 - 2 * c * v))) / sqrt(1 - 2 * c * v);
  assert_near((double)nominal->correlation,
              log(product / on / mean) / (s * sqrt(v) / 30), 0.005);
}

/* With a short correlation length, the relative variance of Ion is 2 sigma^2 /
   30^2 times the mean of exp(-r / length) over pairs of points: 2 (x - 1 +
   exp(-x)) / x^2, x = W / length. */
static void test_short(void) {
  static const double lengths[] = {5, 25, 100};
  double width[12], length[12];
  for (int s = 0; s < 12; s++) {
    width[s] = 300.0 / 12;
    length[s] = 65;
  }
  for (size_t k = 0; k < G_N_ELEMENTS(lengths); k++) {
    const roughness r = {0.5, lengths[k], 0.5};
    roughness_effect e[KNOTS];
    effects(&r, 12, width, length, e);
    double x = 300 / lengths[k], mean = 2 * (x - 1 + exp(-x)) / (x * x);
    assert_near((double)e[KNOT_ZERO].sigma[ION], sqrt(2 * mean) * 0.5 / 30,
                0.01);
  }
}

/* Without roughness there is no effect. */
static void test_none(void) {
  const roughness r = {0, 25, 0.5};
  const double width[] = {300}, length[] = {65};
  roughness_effect e[KNOTS];
  effects(&r, 1, width, length, e);
  for (int k = 0; k < KNOTS; k++)
    g_assert_true(e[k].sigma[0] == 0.0F && e[k].shift[1] == 0.0F);
}

/* ---- explicit contours ---- */

enum { POINTS = 300, GATES = 2000 };

/* Fill edge[POINTS] with a Gaussian process of the covariance sigma^2 exp(-(r /
   length)^(2 h)) at distances of 1 nm, by the Cholesky factor `low`. */
static void make_edge(const double *low, uint64_t gate, uint32_t stream,
                      double *edge) {
  double z[POINTS];
  for (uint32_t i = 0; i < POINTS; i++) z[i] = normal_at(7, stream, gate, i);
  for (int i = 0; i < POINTS; i++) {
    edge[i] = 0;
    for (int j = 0; j <= i; j++) edge[i] += low[i * POINTS + j] * z[j];
  }
}

static double *factor_of(const roughness *r) {
  double *a = eda_alloc((size_t)POINTS * POINTS, sizeof *a);
  for (int i = 0; i < POINTS; i++)
    for (int j = 0; j <= i; j++) {
      double sum =
          r->sigma * r->sigma * exp(-pow((i - j) / r->length, 2 * r->hurst));
      if (i == j) sum += 1e-9;
      for (int k = 0; k < j; k++) sum -= a[i * POINTS + k] * a[j * POINTS + k];
      a[i * POINTS + j] = i == j ? sqrt(sum) : sum / a[j * POINTS + j];
    }
  return a;
}

/* Moments of the current of gates with rough contours, over the current without
   roughness. */
typedef struct contours {
  double mean[2], second[2], fourth[2]; /* central */
  double ln_mean[2], ln_square[2];
} contours;

/* Sum the currents of GATES gates of 1 nm strips with two rough edges. */
static void contours_sample(const roughness *r, const double *length,
                            contours *c) {
  double *low = factor_of(r), edge[2][POINTS], nominal[2] = {0};
  double(*current)[2] = eda_alloc(GATES, sizeof *current);
  *c = (contours){{0}, {0}, {0}, {0}, {0}};
  for (int i = 0; i < POINTS; i++)
    for (int q = 0; q < CURRENTS; q++)
      nominal[q] += exp(ln_current(q, length[i * 12 / POINTS]));
  for (uint64_t gate = 0; gate < GATES; gate++) {
    for (uint32_t s = 0; s < 2; s++) make_edge(low, gate, s, edge[s]);
    for (int q = 0; q < CURRENTS; q++) {
      for (int i = 0; i < POINTS; i++)
        current[gate][q] += exp(ln_current(q, length[i * 12 / POINTS] +
                                                  edge[0][i] + edge[1][i])) /
                            nominal[q];
      double x = log(current[gate][q]);
      c->mean[q] += current[gate][q] / GATES;
      c->ln_mean[q] += x / GATES;
      c->ln_square[q] += x * x / GATES;
    }
  }
  for (size_t gate = 0; gate < GATES; gate++)
    for (int q = 0; q < CURRENTS; q++) {
      double d = current[gate][q] - c->mean[q];
      c->second[q] += d * d / GATES;
      c->fourth[q] += d * d * d * d / GATES;
    }
  free(current);
  free(low);
}

/* Compare the standard deviation of ln Ion, and mean and standard deviation of
   both currents, within four standard errors of the samples. */
static void test_contours(void) {
  static const roughness kinds[] = {{1.3, 25, 0.5}, {1.3, 40, 0.9}};
  double width[12], length[12];
  for (int s = 0; s < 12; s++) {
    width[s] = POINTS / 12.0;
    length[s] = 62 + 0.5 * s; /* a wedge */
  }
  for (size_t k = 0; k < G_N_ELEMENTS(kinds); k++) {
    roughness_effect e[KNOTS];
    contours c;
    effects(&kinds[k], 12, width, length, e);
    contours_sample(&kinds[k], length, &c);
    double ln_sigma = sqrt(c.ln_square[0] - c.ln_mean[0] * c.ln_mean[0]);
    assert_near((double)e[KNOT_ZERO].sigma[ION], ln_sigma, 0.03);
    for (int q = 0; q < CURRENTS; q++) {
      double s = (double)e[KNOT_ZERO].sigma[q], sd = sqrt(c.second[q]);
      double mean = exp((double)e[KNOT_ZERO].shift[q] + s * s / 2);
      double sigma = mean * sqrt(expm1(s * s));
      double error =
          sqrt((c.fourth[q] - c.second[q] * c.second[q]) / GATES) / (2 * sd);
      g_test_message(
          "current %d: mean %.5f, %.5f of contours; sigma %.5f, "
          "%.5f",
          q, mean, c.mean[q], sigma, sd);
      g_assert_cmpfloat(fabs(mean - c.mean[q]), <, 4 * sd / sqrt(GATES));
      g_assert_cmpfloat(fabs(sigma - sd), <, 4 * error);
      g_assert_cmpfloat(error, <, 0.15 * sd);
    }
  }
}

/* Sample a threshold voltage in addition to correlated changes of both
   currents; 0.25 um^2, so that its standard deviation is 8 mV. */
static void test_mismatch(void) {
  enum { N = 100000 };
  const mismatch m = {0.004, 2, 0.08};
  roughness_effect e[KNOTS];
  double sum[3] = {0};
  for (int k = 0; k < KNOTS; k++)
    e[k] = (roughness_effect){{0.1F, 0.2F}, {0.02F, 0.3F}, 0.6F};
  mismatch_add(&m, 0.25e6, e);
  for (uint64_t i = 0; i < N; i++) {
    double a = normal_at(1, 0, i, 0), b = normal_at(1, 0, i, 1);
    double volts = 0.008 * normal_at(1, 0, i, 2);
    double on = 0.02 * a - 2 * volts;
    double off = 0.3 * (0.6 * a + 0.8 * b) - log(10) * volts / 0.08;
    sum[0] += on * on / N;
    sum[1] += off * off / N;
    sum[2] += on * off / N;
  }
  const roughness_effect *one = &e[KNOTS - 1];
  assert_near((double)one->sigma[ION], sqrt(sum[0]), 0.01);
  assert_near((double)one->sigma[IOFF], sqrt(sum[1]), 0.01);
  assert_near((double)one->correlation, sum[2] / sqrt(sum[0] * sum[1]), 0.01);
  g_assert_true(one->shift[ION] == 0.1F && one->shift[IOFF] == 0.2F);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/roughness/equal", test_equal);
  g_test_add_func("/roughness/short", test_short);
  g_test_add_func("/roughness/none", test_none);
  g_test_add_func("/roughness/contours", test_contours);
  g_test_add_func("/roughness/mismatch", test_mismatch);
  return g_test_run();
}
