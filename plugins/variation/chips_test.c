/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests sampling and statistics against closed forms, with a surrogate that is
   linear or quadratic, and currents that are exponentials of the length. */
#include <eda/memory.h>
#include <glib.h>
#include <gsl/gsl_cdf.h>
#include <math.h>
#include <string.h>

#include "variation.h"

static void assert_near(double got, double want, double off) {
  if (!(fabs(got - want) <= off)) g_error("%.8g, expected %.8g", got, want);
}

/* ---- normal numbers ---- */

static void test_normals(void) {
  enum { N = 200000 };
  double sum[4] = {0}, product = 0;
  size_t beyond = 0;
  for (uint64_t chip = 0; chip < N / LANES; chip++) {
    float a[LANES], b[LANES];
    normal_pairs(normal_key(3, 9, chip), 32, a, b);
    for (int k = 0; k < LANES; k++) {
      double x = (double)a[k], y = (double)b[k];
      sum[0] += x / N, sum[1] += x * x / N, sum[2] += x * x * x / N;
      sum[3] += x * x * x * x / N;
      product += x * y / N;
      beyond += fabs(x) > 3;
      g_assert_cmpfloat(fabs(y), <, 7);
    }
  }
  double sd = 1 / sqrt(N);
  assert_near(sum[0], 0, 4 * sd);
  assert_near(sum[1], 1, 4 * sqrt(2) * sd);
  assert_near(sum[2], 0, 4 * sqrt(15) * sd);
  assert_near(sum[3], 3, 4 * sqrt(96) * sd);
  assert_near(product, 0, 4 * sd);
  double tail = 2 * gsl_cdf_ugaussian_Q(3);
  assert_near((double)beyond / N, tail, 4 * sqrt(tail / N));
  /* Single numbers. */
  double mean = 0, square = 0;
  for (uint32_t k = 0; k < N; k++) {
    double x = normal_at(1, 2, k / 100, k % 100);
    mean += x / N;
    square += x * x / N;
  }
  assert_near(mean, 0, 4 * sd);
  assert_near(square, 1, 4 * sqrt(2) * sd);
}

/* ---- a circuit in closed form ---- */

enum { GATES = 37 };

typedef struct model {
  surrogate s;
  curves curves;
  roughness_effect rough[GATES * KNOTS];
  uint8_t type[GATES];
  uint32_t neighbour[GATES], tile_of[GATES];
  double ioff[GATES], length[GATES], nominal[GATES], mix[4];
  double width[GATES], area[GATES];
  circuit c;
} model;

/* Set ln Ion = -L / 30, ln Ioff = -L / 5 relative to the drawn length. */
static model *model_new(void) {
  static const int used[VARIABLES] = {1, 1, 0, 0, 0, 1, 0, 1};
  model *m = eda_alloc(1, sizeof *m);
  surrogate_init(&m->s, used, GATES);
  curves_init(&m->curves, GATES, 40, 90);
  for (size_t i = 0; i < GATES; i++) {
    for (size_t k = 0; k < m->curves.count; k++) {
      double d = m->curves.first + (double)k * m->curves.step - 65;
      m->curves.value[ION][i * m->curves.count + k] = (float)(-d / 30);
      m->curves.value[IOFF][i * m->curves.count + k] = (float)(-d / 5);
    }
    m->type[i] = i % 3 ? EDA_NMOS : EDA_PMOS;
    m->neighbour[i] = (uint32_t)((i + 1) % GATES);
    m->ioff[i] = 1e-9 * (double)(1 + i);
    m->length[i] = m->nominal[i] = 65;
    m->width[i] = 200;
    m->area[i] = 200 * 65;
  }
  curves_share(&m->curves);
  g_assert_cmpuint(m->curves.kinds, ==, 1);
  m->c = (circuit){.surrogate = &m->s,
                   .curves = &m->curves,
                   .leakage = &m->curves,
                   .rough = m->rough,
                   .drawn_length = m->length,
                   .drawn_width = m->width,
                   .drawn_area = m->area,
                   .nominal = m->nominal,
                   .gates = GATES,
                   .type = m->type,
                   .neighbour = m->neighbour,
                   .ioff = m->ioff,
                   .tiles = 1,
                   .seed = 5};
  for (int v = 0; v < VARIABLES; v++)
    m->c.global[v] = used[v] ? 1 / variation_range : 0;
  return m;
}

static void model_free(model *m) {
  surrogate_clear(&m->s);
  curves_clear(&m->curves);
  free(m);
}

/* Return the number of the term with these powers of two variables. */
static size_t term_of(const surrogate *s, int v, int power, int w, int other) {
  for (size_t t = 0; t < s->terms; t++) {
    int all = 0;
    for (int k = 0; k < VARIABLES; k++) all += s->power[t][k];
    if (all == power + other && s->power[t][v] >= power &&
        (w < 0 || s->power[t][w] == other))
      return t;
  }
  g_error("no such term");
}

static void set_term(model *m, int figure, size_t term, float value) {
  for (size_t i = 0; i < GATES; i++)
    m->s.coefficient[figure][term * GATES + i] = value;
}

typedef struct sample {
  size_t n;
  float *chip[CHIP];
  moments moments[GATES];
} sample;

static sample *sample_new(const model *m, size_t n, const uint32_t *stream) {
  static const uint32_t streams[SOURCES] = {0, 1, 2, 3, 4, 5, 6, 7};
  sample *s = eda_alloc(1, sizeof *s);
  opc_error error;
  s->n = n;
  for (int k = 0; k < CHIP; k++) s->chip[k] = eda_alloc(n, sizeof(float));
  g_assert_false(circuit_sample(&m->c, stream ? stream : streams, 0, n, s->chip,
                                s->moments, &error));
  return s;
}

static void sample_free(sample *s) {
  for (int k = 0; k < CHIP; k++) free(s->chip[k]);
  free(s);
}

/* L is linear in two variables: ln Ion and ln Ioff are normal, currents
   log-normal. Independent line edges add their variance. */
static void test_linear(void) {
  enum { N = 60000 };
  model *m = model_new();
  /* L changes by 3 nm per standard deviation of the dose, and by 4 nm per
     standard deviation of the overlay. */
  set_term(m, LENGTH, term_of(&m->s, POLY_DOSE, 1, -1, 0), 3 * 4);
  set_term(m, LENGTH_OFF, term_of(&m->s, POLY_DOSE, 1, -1, 0), 3 * 4);
  set_term(m, LENGTH, term_of(&m->s, OVERLAY_Y, 1, -1, 0), 4 * 4);
  set_term(m, LENGTH_OFF, term_of(&m->s, OVERLAY_Y, 1, -1, 0), 4 * 4);
  set_term(m, WIDTH, term_of(&m->s, ACTIVE_MASK, 1, -1, 0), 0.02F * 4);
  for (size_t i = 0; i < (size_t)GATES * KNOTS; i++)
    m->rough[i] = (roughness_effect){{0.01F, 0.1F}, {0.12F, 0.5F}, 0.8F};
  sample *s = sample_new(m, N, NULL);
  double global[2] = {25 / 900.0 + 4e-4, 1 + 4e-4}, own[2] = {0.0144, 0.25};
  double both = 25 / 150.0 + 4e-4 + 0.8 * 0.12 * 0.5;
  for (size_t i = 0; i < GATES; i++) {
    const moments *one = &s->moments[i];
    double mean[2], sd[2];
    for (int q = 0; q < 2; q++) {
      double variance = global[q] + own[q];
      mean[q] = one->sum[q] / N;
      sd[q] = sqrt(one->square[q] / N - mean[q] * mean[q]);
      double third = one->cube[q] / N - 3 * mean[q] * one->square[q] / N +
                     2 * mean[q] * mean[q] * mean[q];
      assert_near(mean[q], q ? 0.1 : 0.01, 4 * sqrt(variance / N));
      assert_near(sd[q], sqrt(variance), 4 * sqrt(variance / (2 * N)));
      assert_near(third / pow(variance, 1.5), 0, 4 * sqrt(6.0 / N));
    }
    assert_near(one->product / N - mean[0] * mean[1], both, 0.006);
    size_t j = m->neighbour[i];
    double other = s->moments[j].sum[0] / N;
    assert_near((one->neighbour / N - mean[0] * other) / (sd[0] * sd[0]),
                global[0] / (global[0] + own[0]), 0.02);
  }
  /* The mean of Ion of n over chips is the mean of a log-normal number. */
  double variance = global[0] + own[0];
  statistics ion = statistics_of(s->chip[CHIP_ION_N], N);
  assert_near(ion.mean, exp(0.01 + variance / 2), 0.005);
  for (size_t i = 0; i < N; i++)
    g_assert_true(s->chip[CHIP_LEAST][i] <= s->chip[CHIP_MOST][i]);
  sample_free(s);
  model_free(m);
}

/* Test the mean and variance of ln Ion of one gate with quadratic and mixed
   terms. */
static void test_quadratic(void) {
  enum { N = 60000 };
  model *m = model_new();
  set_term(m, LENGTH, term_of(&m->s, POLY_FOCUS, 2, -1, 0), 2 * 16);
  set_term(m, LENGTH, term_of(&m->s, POLY_DOSE, 1, OVERLAY_Y, 1), 1 * 16);
  assert_near(curves_length(&m->curves, 3, IOFF, -0.46), 67.3, 1e-4);
  assert_near(curves_length(&m->curves, 3, ION, 9), m->curves.first, 1e-4);
  sample *s = sample_new(m, N, NULL);
  double mean = s->moments[3].sum[0] / N;
  double variance = s->moments[3].square[0] / N - mean * mean;
  assert_near(mean, -2 / 30.0, 0.002);
  assert_near(variance, (2 * 4 + 1) / 900.0, 0.0005);
  sample_free(s);
  model_free(m);
}

/* Test the longest of two paths in two tiles against the larger sum over the
   gates of derivative times ln of the size, with the sizes of the chip. Test
   the mean and variance with line edges. */
static void test_delays(void) {
  enum { N = 20000 };
  model *m = model_new();
  static const uint32_t streams[SOURCES] = {0, 1, 2, 3, 4, 5, 6, 7};
  set_term(m, LOG_LENGTH, term_of(&m->s, POLY_DOSE, 1, -1, 0), 0.06F);
  set_term(m, LOG_LENGTH, term_of(&m->s, POLY_FOCUS, 2, -1, 0), 0.04F);
  set_term(m, WIDTH, term_of(&m->s, ACTIVE_MASK, 1, -1, 0), 0.02F * 4);
  set_term(m, AREA, term_of(&m->s, POLY_DOSE, 1, -1, 0), 0.01F * 4);
  for (size_t i = 0; i < GATES; i++) m->tile_of[i] = i % 2;
  m->c.tiles = 2;
  m->c.tile_of = m->tile_of;
  m->c.mix = m->mix;
  m->mix[0] = 1, m->mix[2] = 0.6, m->mix[3] = 0.8;
  m->c.field[POLY_DOSE] = 1 / variation_range;
  double size[EDA_SIZES][GATES];
  for (size_t i = 0; i < GATES; i++) {
    size[EDA_SIZE_L][i] = 66;
    size[EDA_SIZE_W][i] = 198;
    size[EDA_SIZE_C][i] = 198 * 65.5;
  }
  eda_delay_term term[2][3] = {{{3, {40, -20, 10}}, {4, {30, 5, -2}}},
                               {{7, {35, -10, 0}}, {8, {25, 1, 3}}, {9, {9}}}};
  eda_delay_path path[2] = {{.delay = {70, 2, term[0]}},
                            {.delay = {70.5, 3, term[1]}}};
  eda_delays d = {
      .size = {size[0], size[1], size[2]}, .paths = 2, .path = path};
  delay_model paths;
  delay_model_init(&paths, &m->c, &d);
  m->c.delays = &paths;
  sample *s = sample_new(m, N, NULL);
  double *features = eda_alloc(m->s.terms, sizeof *features), most = 0;
  for (uint64_t chip = 0; chip < 2000; chip++) {
    double longest = 0;
    for (int p = 0; p < 2; p++) {
      double sum = path[p].delay.time;
      for (size_t k = 0; k < path[p].delay.terms; k++) {
        size_t i = term[p][k].gate;
        double u[VARIABLES], by[EDA_SIZES];
        for (int q = 0; q < EDA_SIZES; q++) by[q] = (double)term[p][k].by[q];
        circuit_variables(&m->c, streams, chip, m->tile_of[i], u);
        surrogate_features(&m->s, u, features);
        double l = 65 * exp(surrogate_at(&m->s, features, LOG_LENGTH, i));
        double w = 200 * exp(surrogate_at(&m->s, features, WIDTH, i));
        double a = 200 * 65 * exp(surrogate_at(&m->s, features, AREA, i));
        sum += by[0] * log(l / 66) + by[1] * log(w / 198) +
               by[2] * log(a / w / 65.5);
      }
      longest = fmax(longest, sum);
    }
    most = fmax(most, fabs(longest - (double)s->chip[CHIP_DELAY][chip]));
  }
  g_assert_cmpfloat(most, <, 1e-4);
  statistics without = statistics_of(s->chip[CHIP_DELAY], N);
  sample_free(s);
  /* With one path, the variance of line edges is added. A change of ln Ion by x
     is a change of ln L by -30 x / 65. */
  delay_model_clear(&paths);
  d.paths = 1;
  path[0].delay.terms = 1;
  delay_model_init(&paths, &m->c, &d);
  s = sample_new(m, N, NULL);
  without = statistics_of(s->chip[CHIP_DELAY], N);
  sample_free(s);
  for (size_t i = 0; i < (size_t)GATES * KNOTS; i++)
    m->rough[i] = (roughness_effect){{0.02F, 0}, {0.1F, 0}, 0};
  s = sample_new(m, N, NULL);
  statistics with = statistics_of(s->chip[CHIP_DELAY], N);
  double by = 40 * 30 / 65.0, second = -20 * 0.0104 * pow(30 / 65.0, 2);
  assert_near(with.mean - without.mean, second - 0.02 * by,
              4 * 0.1 * by / sqrt(N));
  assert_near(with.sigma, hypot(without.sigma, 0.1 * by),
              4 * with.sigma / sqrt(2 * N));
  sample_free(s);
  delay_model_clear(&paths);
  free(features);
  model_free(m);
}

static void run_parallel(const opc_context *context, size_t n,
                         void (*task)(void *data, size_t i), void *data) {
  (void)context;
  for (size_t i = n; i-- > 0;) task(data, i);
}

static int never_cancelled(const opc_context *context) {
  (void)context;
  return 0;
}

/* The order of the work units, and the number of chips, change no bit. */
static void test_order(void) {
  enum { N = 1003 };
  static const uint32_t streams[SOURCES] = {0, 1, 2, 3, 4, 5, 6, 7};
  opc_context backwards = {.parallel = run_parallel,
                           .cancelled = never_cancelled};
  model *m = model_new();
  opc_error error;
  set_term(m, LENGTH, term_of(&m->s, POLY_FOCUS, 2, -1, 0), 32);
  sample *a = sample_new(m, N, NULL);
  m->c.context = &backwards;
  sample *b = sample_new(m, N, NULL);
  for (int k = 0; k < CHIP; k++)
    g_assert_cmpmem(a->chip[k], N * sizeof(float), b->chip[k],
                    N * sizeof(float));
  g_assert_cmpmem(a->moments, sizeof a->moments, b->moments, sizeof b->moments);
  float *part[CHIP];
  for (int k = 0; k < CHIP; k++) part[k] = b->chip[k];
  g_assert_false(circuit_sample(&m->c, streams, 500, 77, part, NULL, &error));
  for (int k = 0; k < CHIP; k++)
    g_assert_cmpmem(a->chip[k] + 500, 77 * sizeof(float), part[k],
                    77 * sizeof(float));
  sample_free(a);
  sample_free(b);
  model_free(m);
}

/* Test two tiles with a correlation of 0.6 within the field. */
static void test_tiles(void) {
  enum { N = 40000 };
  model *m = model_new();
  set_term(m, LENGTH, term_of(&m->s, POLY_DOSE, 1, -1, 0), 3 * 4);
  for (size_t i = 0; i < GATES; i++) {
    m->tile_of[i] = i % 2;
    m->neighbour[i] = (uint32_t)(i + 1 < GATES ? i + 1 : i - 1);
  }
  m->c.tiles = 2;
  m->c.tile_of = m->tile_of;
  m->c.mix = m->mix;
  m->mix[0] = 1, m->mix[2] = 0.6, m->mix[3] = 0.8;
  m->c.global[POLY_DOSE] *= 0.6;
  m->c.field[POLY_DOSE] = 0.8 / variation_range;
  sample *s = sample_new(m, N, NULL);
  for (size_t i = 0; i < GATES; i++) {
    size_t j = m->neighbour[i];
    const moments *a = &s->moments[i], *b = &s->moments[j];
    double x = a->sum[0] / N, y = b->sum[0] / N;
    double variance = a->square[0] / N - x * x;
    double other = b->square[0] / N - y * y;
    assert_near(variance, 0.01, 0.0004);
    assert_near((a->neighbour / N - x * y) / sqrt(variance * other),
                0.36 + 0.64 * 0.6, 0.01);
  }
  sample_free(s);
  model_free(m);
}

/* Test the shares of the variance of x + 2 y + x z, with independent normal
   numbers. */
static void test_shares(void) {
  enum { N = 40000 };
  double *f[5];
  for (int k = 0; k < 5; k++) f[k] = eda_alloc(N, sizeof(double));
  for (uint64_t i = 0; i < N; i++) {
    double a[3], b[3];
    for (uint32_t k = 0; k < 3; k++) {
      a[k] = normal_at(1, 0, i, k);
      b[k] = normal_at(1, 1, i, k);
    }
    f[0][i] = a[0] + 2 * a[1] + a[0] * a[2];
    f[1][i] = b[0] + 2 * b[1] + b[0] * b[2];
    f[2][i] = b[0] + 2 * a[1] + b[0] * a[2];
    f[3][i] = a[0] + 2 * b[1] + a[0] * a[2];
    f[4][i] = a[0] + 2 * a[1] + a[0] * b[2];
  }
  static const double first[] = {1 / 6.0, 4 / 6.0, 0},
                      total[] = {2 / 6.0, 4 / 6.0, 1 / 6.0};
  for (int k = 0; k < 3; k++) {
    share s = share_of(f[0], f[1], f[2 + k], N);
    g_assert_cmpfloat(s.first_error, <, 0.02);
    assert_near(s.first, first[k], 4 * s.first_error + 0.01);
    assert_near(s.total, total[k], 4 * s.total_error + 0.01);
  }
  for (int k = 0; k < 5; k++) free(f[k]);
}

/* Test that each end of the interval is the probability at which the binomial
   tail is 2.5 %. Test the quantiles of a known list. */
static void test_statistics(void) {
  interval i = interval_of(90, 100);
  double low = 0, high = 0;
  for (int k = 0; k <= 100; k++) {
    double choose = exp(lgamma(101) - lgamma(k + 1) - lgamma(101 - k));
    if (k >= 90) low += choose * pow(i.low, k) * pow(1 - i.low, 100 - k);
    if (k <= 90) high += choose * pow(i.high, k) * pow(1 - i.high, 100 - k);
  }
  assert_near(low, 0.025, 1e-6);
  assert_near(high, 0.025, 1e-6);
  assert_near(interval_of(0, 50).low, 0, 0);
  assert_near(interval_of(0, 50).high, 1 - pow(0.025, 1 / 50.0), 1e-9);
  assert_near(interval_of(50, 50).high, 1, 0);
  /* Close to the normal distribution for many chips. */
  for (size_t k = 1000; k < 1000000; k += 11111) {
    double p = (double)k / 1e6, sd = sqrt(p * (1 - p) / 1e6);
    assert_near(interval_of(k, 1000000).low, p - 1.96 * sd, 0.1 * sd);
    assert_near(interval_of(k, 1000000).high, p + 1.96 * sd, 0.1 * sd);
  }
  float list[1001];
  for (int k = 0; k <= 1000; k++) list[k] = (float)((k * 10) % 1001);
  statistics s = statistics_of(list, 1001);
  for (int q = 0; q < QUANTILES; q++)
    assert_near(s.quantile[q], 1000 * statistics_at[q], 1e-3);
  assert_near(s.mean, 500, 1e-6);
  assert_near(s.sigma, sqrt(1001 * 1002 / 12.0), 1e-3);
  assert_near(s.skewness, 0, 1e-9);
}

/* The fit reproduces a polynomial of its own terms. */
static void test_fit(void) {
  enum { POINTS = 400 };
  static const int used[VARIABLES] = {1, 1, 1, 1, 1, 1, 1, 1};
  surrogate s;
  opc_error error;
  surrogate_init(&s, used, 1);
  g_assert_cmpuint(s.terms, ==, 110);
  double(*u)[VARIABLES] = eda_alloc(POINTS, sizeof *u);
  double *features = eda_alloc(s.terms, sizeof *features);
  float *value = eda_alloc((size_t)POINTS * FIGURES, sizeof *value);
  for (uint32_t p = 0; p < POINTS; p++) {
    for (uint32_t v = 0; v < VARIABLES; v++)
      u[p][v] = normal_at(1, 0, p, v) / 2;
    surrogate_features(&s, u[p], features);
    for (size_t f = 0; f < FIGURES; f++)
      for (size_t t = 0; t < s.terms; t++)
        value[p * FIGURES + f] += (float)(features[t] * sin((double)(t + f)));
  }
  const double(*points)[VARIABLES] = (const double(*)[VARIABLES])u;
  g_assert_false(surrogate_fit(&s, NULL, POINTS, points, value, &error));
  for (size_t f = 0; f < FIGURES; f++)
    for (size_t t = 0; t < s.terms; t++)
      assert_near((double)s.coefficient[f][t], sin((double)(t + f)), 1e-3);
  g_assert_true(surrogate_fit(&s, NULL, 100, points, value, &error));
  free(u);
  free(features);
  free(value);
  surrogate_clear(&s);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/chips/normals", test_normals);
  g_test_add_func("/chips/linear", test_linear);
  g_test_add_func("/chips/quadratic", test_quadratic);
  g_test_add_func("/chips/order", test_order);
  g_test_add_func("/chips/tiles", test_tiles);
  g_test_add_func("/chips/delays", test_delays);
  g_test_add_func("/chips/shares", test_shares);
  g_test_add_func("/chips/statistics", test_statistics);
  g_test_add_func("/chips/fit", test_fit);
  return g_test_run();
}
