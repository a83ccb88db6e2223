/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables and metrics of `variation`: distributions, yield, shares of the
   variance by source, and statistics of each transistor. */
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

/* Chips for the shares of the variance: their standard error is about 0.02. */
enum { SHARE_CHIPS = 8192 };

/* Chips for the mean and covariance of the terms of the surrogate. */
enum { TERM_CHIPS = 4096 };

enum { SHOWN = 4 }; /* CHIP_LEAKAGE, CHIP_ION_N, CHIP_ION_P, CHIP_DELAY */
static const char *const figure_names[CHIP] = {
    "leakage", "ion_n", "ion_p", "delay", "ion_least", "ion_most"};
const uint32_t variation_stream[SOURCES] = {0, 1, 2, 3, 4, 5, 6, 7};

static int has_type(const variation *v, int type) {
  for (size_t i = 0; i < v->gates->count; i++)
    if (v->gates->type[i] == type) return 1;
  return 0;
}

/* Return 1 if a figure of chips exists. A circuit whose transistors have one
   type has no mean Ion of the other type. */
static int has_figure(const variation *v, int k) {
  if (k == CHIP_DELAY) return v->delays != NULL;
  if (k == CHIP_ION_N) return has_type(v, EDA_NMOS);
  return k != CHIP_ION_P || has_type(v, EDA_PMOS);
}

/* ---- surrogate ---- */

static int put_error(const variation *v, opc_error *error) {
  static const char *const names[ERRORS] = {"Ion", "log10 Ioff", "L", "W",
                                            "area"};
  static const char *const units[ERRORS] = {"%", "decades", "nm", "%", "%"};
  typedef struct row {
    const char *name, *unit;
    double rms, max;
  } row;
  row r[ERRORS];
  for (int k = 0; k < ERRORS; k++)
    r[k] = (row){names[k], units[k], v->error.rms[k], v->error.max[k]};
  const opc_column columns[] = {{"figure", NULL, OPC_TEXT, 0, &r->name},
                                {"unit", NULL, OPC_TEXT, 0, &r->unit},
                                {"rms", NULL, OPC_REAL, 4, &r->rms},
                                {"max", NULL, OPC_REAL, 4, &r->max}};
  const opc_metric_value values[] = {
      {"surrogate_ion", v->error.rms[ERROR_ION]},
      {"surrogate_ioff", v->error.rms[ERROR_IOFF]},
      {"surrogate_length", v->error.rms[ERROR_LENGTH]},
      {"images_poly", (double)v->images[EDA_POLY]},
      {"images_active", (double)v->images[EDA_ACTIVE]}};
  int code = opc_put_rows(v->host, "surrogate", OPC_TABLE_PRINT, ERRORS,
                          sizeof *r, OPC_ARRAY(columns), error);
  return code ? code : opc_put_metrics(v->host, OPC_ARRAY(values), error);
}

/* ---- yield ---- */

enum { LEAKAGE, SPEED, MATCH, DELAY, ALL, LIMITS };

/* Return the largest delay of a good chip, ps. */
static double delay_limit(const variation *v) {
  double drawn = v->delays ? v->delays->drawn : NAN;
  return v->clock > 0 ? v->clock * 1e12 : drawn * (1 + v->delay_limit / 100);
}

static int chip_meets(const variation *v, size_t i, int limit) {
  double ion = 1 - v->speed_limit / 100, off = v->ion_limit / 100;
  switch (limit) {
    case LEAKAGE:
      return (double)v->chip[CHIP_LEAKAGE][i] <= v->leakage_limit;
    case SPEED:
      return (!has_figure(v, CHIP_ION_N) ||
              (double)v->chip[CHIP_ION_N][i] >= ion) &&
             (!has_figure(v, CHIP_ION_P) ||
              (double)v->chip[CHIP_ION_P][i] >= ion);
    case MATCH:
      return (double)v->chip[CHIP_LEAST][i] >= 1 - off &&
             (double)v->chip[CHIP_MOST][i] <= 1 + off;
    default:
      return !v->delays || (double)v->chip[CHIP_DELAY][i] <= delay_limit(v);
  }
}

static int put_yield(const variation *v, opc_error *error) {
  size_t good[LIMITS] = {0}, n = (size_t)v->chips;
  for (size_t i = 0; i < n; i++) {
    int all = 1;
    for (int k = 0; k < ALL; k++) {
      int meets = chip_meets(v, i, k);
      good[k] += (size_t)meets;
      all &= meets;
    }
    good[ALL] += (size_t)all;
  }
  typedef struct row {
    const char *name, *unit;
    double limit, yield, low, high;
  } row;
  row r[LIMITS] = {{"leakage", "drawn", v->leakage_limit, 0, 0, 0},
                   {"speed", "%", v->speed_limit, 0, 0, 0},
                   {"every transistor", "%", v->ion_limit, 0, 0, 0},
                   {"longest path", "ps", delay_limit(v), 0, 0, 0},
                   {"all", "", NAN, 0, 0, 0}};
  for (int k = 0; k < LIMITS; k++) {
    interval i = interval_of(good[k], n);
    r[k].yield = 100 * i.value;
    r[k].low = 100 * i.low;
    r[k].high = 100 * i.high;
  }
  const opc_column columns[] = {{"limit", NULL, OPC_TEXT, 0, &r->name},
                                {"value", NULL, OPC_REAL, -1, &r->limit},
                                {"unit", NULL, OPC_TEXT, 0, &r->unit},
                                {"yield", "%", OPC_REAL, 3, &r->yield},
                                {"low", "%", OPC_REAL, 3, &r->low},
                                {"high", "%", OPC_REAL, 3, &r->high}};
  const opc_metric_value values[] = {
      {"yield", r[ALL].yield},
      {"yield_low", r[ALL].low},
      {"yield_high", r[ALL].high},
      {"yield_leakage", r[LEAKAGE].yield},
      {"yield_speed", r[SPEED].yield},
      {"yield_match", r[MATCH].yield},
      {v->delays ? "yield_delay" : NULL, r[DELAY].yield}};
  size_t rows = LIMITS;
  if (!v->delays) r[DELAY] = r[--rows];
  int code = opc_put_rows(v->host, "yield", OPC_TABLE_PRINT, rows, sizeof *r,
                          OPC_ARRAY(columns), error);
  return code ? code : opc_put_metrics(v->host, OPC_ARRAY(values), error);
}

/* ---- distributions ---- */

static int put_distributions(variation *v, opc_error *error) {
  typedef struct row {
    const char *name;
    statistics s;
  } row;
  row r[CHIP];
  size_t rows = 0;
  double sigma[CHIP] = {0}, mean[CHIP] = {0}, high = 0, slow = 0;
  for (int k = 0; k < CHIP; k++) {
    if (!has_figure(v, k)) continue;
    r[rows] =
        (row){figure_names[k], statistics_of(v->chip[k], (size_t)v->chips)};
    sigma[k] = r[rows].s.sigma;
    mean[k] = r[rows].s.mean;
    if (k == CHIP_LEAKAGE) high = r[rows].s.quantile[QUANTILES - 2];
    if (k == CHIP_DELAY) slow = r[rows].s.quantile[QUANTILES - 2];
    rows++;
  }
  const opc_column columns[] = {
      {"figure", NULL, OPC_TEXT, 0, &r->name},
      {"mean", NULL, OPC_REAL, 4, &r->s.mean},
      {"sigma", NULL, OPC_REAL, 4, &r->s.sigma},
      {"skewness", NULL, OPC_REAL, 2, &r->s.skewness},
      {"q0.1", NULL, OPC_REAL, 4, &r->s.quantile[0]},
      {"q1", NULL, OPC_REAL, 4, &r->s.quantile[1]},
      {"q5", NULL, OPC_REAL, 4, &r->s.quantile[2]},
      {"median", NULL, OPC_REAL, 4, &r->s.quantile[3]},
      {"q95", NULL, OPC_REAL, 4, &r->s.quantile[4]},
      {"q99", NULL, OPC_REAL, 4, &r->s.quantile[5]},
      {"q99.9", NULL, OPC_REAL, 4, &r->s.quantile[6]}};
  const opc_metric_value values[] = {
      {"leakage_mean", mean[CHIP_LEAKAGE]},
      {"leakage_sigma", sigma[CHIP_LEAKAGE]},
      {"leakage_q99", high},
      {v->delays ? "delay_mean" : NULL, mean[CHIP_DELAY]},
      {v->delays ? "delay_sigma" : NULL, sigma[CHIP_DELAY]},
      {v->delays ? "delay_q99" : NULL, slow},
      {mean[CHIP_ION_N] > 0 ? "ion_n_sigma" : NULL, 100 * sigma[CHIP_ION_N]},
      {mean[CHIP_ION_P] > 0 ? "ion_p_sigma" : NULL, 100 * sigma[CHIP_ION_P]}};
  int code = opc_put_rows(v->host, "distributions", OPC_TABLE_PRINT, rows,
                          sizeof *r, OPC_ARRAY(columns), error);
  return code ? code : opc_put_metrics(v->host, OPC_ARRAY(values), error);
}

/* ---- shares of the variance ---- */

typedef struct share_row {
  const char *source, *unit;
  double sigma;
  share of[SHOWN];
} share_row;

/* Sample chips with the given streams, and convert the leakage to its
   logarithm. */
static int share_sample(const variation *v, const uint32_t stream[SOURCES],
                        float *work, double *out, opc_error *error) {
  float *chip[CHIP];
  for (int k = 0; k < CHIP; k++) chip[k] = work + k * SHARE_CHIPS;
  int code =
      circuit_sample(&v->circuit, stream, 0, SHARE_CHIPS, chip, NULL, error);
  for (int k = 0; k < SHOWN; k++)
    for (size_t i = 0; i < SHARE_CHIPS; i++)
      out[k * SHARE_CHIPS + (int)i] =
          k == CHIP_LEAKAGE ? log((double)chip[k][i]) : (double)chip[k][i];
  return code;
}

static int put_shares(const variation *v, opc_error *error) {
  const size_t all = (size_t)SHOWN * SHARE_CHIPS;
  float *work = eda_alloc((size_t)CHIP * SHARE_CHIPS, sizeof *work);
  double *a = eda_alloc(3 * all, sizeof *a), *b = a + all, *ab = b + all;
  uint32_t other[SOURCES], mixed[SOURCES];
  share_row r[SOURCES];
  size_t rows = 0;
  for (int s = 0; s < SOURCES; s++) other[s] = variation_stream[s] + SOURCES;
  int code = share_sample(v, variation_stream, work, a, error);
  if (!code) code = share_sample(v, other, work, b, error);
  for (int s = 0; s < SOURCES && !code; s++) {
    double sigma = s == SOURCE_EDGES ? v->rough.sigma : v->sigma[s];
    if (!(sigma > 0 || (s == SOURCE_EDGES && v->mismatch.vt > 0))) continue;
    memcpy(mixed, variation_stream, sizeof mixed);
    mixed[s] = other[s];
    code = share_sample(v, mixed, work, ab, error);
    int dose = s == POLY_DOSE || s == ACTIVE_DOSE;
    share_row *one = &r[rows++];
    *one = (share_row){.source = variation_sources[s],
                       .unit = dose ? "%" : "nm",
                       .sigma = sigma};
    for (size_t k = 0; k < SHOWN; k++) {
      size_t at = k * SHARE_CHIPS;
      one->of[k] = share_of(a + at, b + at, ab + at, SHARE_CHIPS);
    }
  }
  const opc_column columns[] = {
      {"source", NULL, OPC_TEXT, 0, &r->source},
      {"sigma", NULL, OPC_REAL, 3, &r->sigma},
      {"unit", NULL, OPC_TEXT, 0, &r->unit},
      {"leakage", NULL, OPC_REAL, 3, &r->of[0].first},
      {"leakage_error", NULL, OPC_REAL, 3, &r->of[0].first_error},
      {"leakage_total", NULL, OPC_REAL, 3, &r->of[0].total},
      {"ion_n", NULL, OPC_REAL, 3, &r->of[1].first},
      {"ion_n_error", NULL, OPC_REAL, 3, &r->of[1].first_error},
      {"ion_n_total", NULL, OPC_REAL, 3, &r->of[1].total},
      {"ion_p", NULL, OPC_REAL, 3, &r->of[2].first},
      {"ion_p_error", NULL, OPC_REAL, 3, &r->of[2].first_error},
      {"ion_p_total", NULL, OPC_REAL, 3, &r->of[2].total},
      {"delay", NULL, OPC_REAL, 3, &r->of[3].first},
      {"delay_error", NULL, OPC_REAL, 3, &r->of[3].first_error},
      {"delay_total", NULL, OPC_REAL, 3, &r->of[3].total}};
  size_t shown = sizeof columns / sizeof *columns - (v->delays ? 0 : 3);
  if (!code)
    code = opc_put_rows(v->host, "sources", OPC_TABLE_PRINT, rows, sizeof *r,
                        columns, shown, error);
  free(work);
  free(a);
  return code;
}

/* ---- transistors ---- */

void terms_sample(const variation *v, term_moments *m) {
  size_t n = v->surrogate.terms;
  double *one = eda_alloc(n, sizeof *one), u[VARIABLES];
  m->mean = eda_alloc(n, sizeof *m->mean);
  m->covariance = eda_alloc(n * n, sizeof *m->covariance);
  for (uint64_t chip = 0; chip < TERM_CHIPS; chip++) {
    circuit_variables(&v->circuit, variation_stream, chip, 0, u);
    surrogate_features(&v->surrogate, u, one);
    for (size_t s = 0; s < n; s++) {
      m->mean[s] += one[s] / TERM_CHIPS;
      for (size_t t = 0; t < n; t++)
        m->covariance[s * n + t] += one[s] * one[t] / TERM_CHIPS;
    }
  }
  for (size_t s = 0; s < n; s++)
    for (size_t t = 0; t < n; t++)
      m->covariance[s * n + t] -= m->mean[s] * m->mean[t];
  free(one);
}

/* Return the covariance of a figure of two transistors, without line edges. */
static double terms_covariance(const variation *v, const term_moments *m,
                               int figure, size_t i, size_t j) {
  size_t n = v->surrogate.terms, gates = v->gates->count;
  const float *c = v->surrogate.coefficient[figure];
  double sum = 0;
  for (size_t s = 0; s < n; s++) {
    double row = 0;
    for (size_t t = 0; t < n; t++)
      row += m->covariance[s * n + t] * (double)c[t * gates + j];
    sum += row * (double)c[s * gates + i];
  }
  return sum;
}

typedef struct gate_row {
  const char *owner, *type;
  int64_t number;
  double x, y, mean[2], sigma[2], skewness[2], both, neighbour, length,
      length_sigma, width, width_sigma, area, area_sigma;
} gate_row;

typedef struct gate_task {
  const variation *v;
  const term_moments *m;
  gate_row *row;
} gate_task;

static void gate_fill(void *data, size_t i) {
  const gate_task *task = data;
  const variation *v = task->v;
  const eda_gates *g = v->gates;
  gate_row *r = &task->row[i];
  const moments *m = &v->moments[i];
  double n = (double)v->moment_chips, mean[2], sd[2];
  r->owner = eda_gates_owner(g, i);
  r->number = g->number[i];
  r->type = g->type[i] == EDA_NMOS ? "n" : "p";
  r->x = ((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid;
  r->y = ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid;
  for (int q = 0; q < 2; q++) {
    mean[q] = m->sum[q] / n;
    double m2 = m->square[q] / n - mean[q] * mean[q];
    double m3 = m->cube[q] / n - 3 * mean[q] * m->square[q] / n +
                2 * mean[q] * mean[q] * mean[q];
    sd[q] = sqrt(fmax(0, m2));
    r->skewness[q] = m2 > 0 ? m3 / (m2 * sd[q]) : 0;
  }
  r->mean[0] = 100 * expm1(mean[0]);
  r->sigma[0] = 100 * sd[0];
  r->mean[1] = mean[1] * M_LOG10E;
  r->sigma[1] = sd[1] * M_LOG10E;
  r->both = (m->product / n - mean[0] * mean[1]) / (sd[0] * sd[1]);
  size_t j = v->neighbour[i];
  const moments *near = &v->moments[j];
  double mean_j = near->sum[ION] / n;
  double sd_j = sqrt(near->square[ION] / n - mean_j * mean_j);
  r->neighbour =
      j == i ? NAN : (m->neighbour / n - mean[ION] * mean_j) / (sd[ION] * sd_j);
  r->length =
      g->length[i] + surrogate_at(&v->surrogate, task->m->mean, LENGTH, i);
  r->width =
      g->width[i] * exp(surrogate_at(&v->surrogate, task->m->mean, WIDTH, i));
  r->area = 100 * expm1(surrogate_at(&v->surrogate, task->m->mean, AREA, i));
  r->length_sigma = sqrt(terms_covariance(v, task->m, LENGTH, i, i));
  r->width_sigma =
      g->width[i] * sqrt(terms_covariance(v, task->m, WIDTH, i, i));
  r->area_sigma = 100 * sqrt(terms_covariance(v, task->m, AREA, i, i));
}

static int put_transistors(const variation *v, opc_error *error) {
  size_t n = v->gates->count;
  term_moments m;
  gate_row *r = eda_alloc(n, sizeof *r);
  terms_sample(v, &m);
  gate_task task = {v, &m, r};
  opc_parallel(v->host->context, n, gate_fill, &task);
  const opc_column columns[] = {
      {"owner", NULL, OPC_TEXT, 0, &r->owner},
      {"number", NULL, OPC_INT, 0, &r->number},
      {"type", NULL, OPC_TEXT, 0, &r->type},
      {"x", "nm", OPC_REAL, -1, &r->x},
      {"y", "nm", OPC_REAL, -1, &r->y},
      {"ion", "%", OPC_REAL, 3, &r->mean[0]},
      {"ion_sigma", "%", OPC_REAL, 3, &r->sigma[0]},
      {"ion_skewness", NULL, OPC_REAL, 3, &r->skewness[0]},
      {"log_ioff", NULL, OPC_REAL, 4, &r->mean[1]},
      {"log_ioff_sigma", NULL, OPC_REAL, 4, &r->sigma[1]},
      {"log_ioff_skewness", NULL, OPC_REAL, 3, &r->skewness[1]},
      {"ion_ioff", NULL, OPC_REAL, 3, &r->both},
      {"neighbour", NULL, OPC_REAL, 3, &r->neighbour},
      {"length", "nm", OPC_REAL, 3, &r->length},
      {"length_sigma", "nm", OPC_REAL, 3, &r->length_sigma},
      {"width", "nm", OPC_REAL, 3, &r->width},
      {"width_sigma", "nm", OPC_REAL, 3, &r->width_sigma},
      {"area", "%", OPC_REAL, 3, &r->area},
      {"area_sigma", "%", OPC_REAL, 3, &r->area_sigma}};
  int code = opc_put_rows(v->host, "transistors", 0, n, sizeof *r,
                          OPC_ARRAY(columns), error);
  free(m.mean);
  free(m.covariance);
  free(r);
  return code;
}

/* ---- single chips ---- */

eda_samples *chips_sizes(const variation *v) {
  const eda_gates *g = v->gates;
  const circuit *c = &v->circuit;
  eda_samples *out = eda_samples_new(g, (size_t)v->tables);
  double *features = eda_alloc(v->surrogate.terms, sizeof *features);
  for (size_t chip = 0; chip < out->count; chip++)
    for (size_t i = 0; i < g->count; i++) {
      double u[VARIABLES], figure[FIGURES];
      circuit_variables(c, variation_stream, chip,
                        c->tile_of ? c->tile_of[i] : 0, u);
      surrogate_features(c->surrogate, u, features);
      for (int k = 0; k < FIGURES; k++)
        figure[k] = surrogate_at(c->surrogate, features, k, i);
      double length = g->length[i] + figure[LENGTH];
      length *= exp((double)c->edges[chip * g->count + i]);
      eda_performance *p = &out->of[chip];
      p->leq_ion[i] = length;
      p->weq[i] = g->width[i] * exp(figure[WIDTH]);
      p->area[i] = v->design.area[i] * exp(figure[AREA]);
      p->ion[i] = v->design.ion[i] *
                  exp(curves_at(c->curves, i, ION, length) + figure[WIDTH]);
    }
  free(features);
  return out;
}

typedef struct chip_row {
  char transistor[300];
  const char *name;
  double length, width, area, ion;
} chip_row;

static int put_chip(const variation *v, size_t chip, const eda_performance *p,
                    chip_row *r, opc_error *error) {
  const eda_gates *g = v->gates;
  for (size_t i = 0; i < g->count; i++) {
    r[i].length = p->leq_ion[i];
    r[i].width = p->weq[i];
    r[i].area = 100 * (p->area[i] / (g->length[i] * g->width[i]) - 1);
    r[i].ion = 100 * (p->ion[i] / v->design.ion[i] - 1);
    snprintf(r[i].transistor, sizeof r->transistor, "%s:%u",
             eda_gates_owner(g, i), (unsigned)g->number[i]);
    r[i].name = r[i].transistor;
  }
  const opc_column columns[] = {{"transistor", NULL, OPC_TEXT, 0, &r->name},
                                {"leq_ion", "nm", OPC_REAL, -1, &r->length},
                                {"weq", "nm", OPC_REAL, -1, &r->width},
                                {"area_after", "%", OPC_REAL, -1, &r->area},
                                {"ion_after", "%", OPC_REAL, -1, &r->ion}};
  char name[40];
  snprintf(name, sizeof name, "chip%zu", chip + 1);
  return opc_put_rows(v->host, name, 0, g->count, sizeof *r, OPC_ARRAY(columns),
                      error);
}

/* Put the figures of the chips with tables, before the chips are sorted. */
static int put_figures(const variation *v, opc_error *error) {
  typedef struct row {
    int64_t chip;
    double figure[CHIP];
  } row;
  size_t n = (size_t)v->tables;
  row *r = eda_alloc(n, sizeof *r);
  opc_column columns[CHIP + 1] = {{"chip", NULL, OPC_INT, 0, &r->chip}};
  for (int k = 0; k < CHIP; k++) {
    for (size_t i = 0; i < n; i++) r[i].figure[k] = (double)v->chip[k][i];
    columns[k + 1] =
        (opc_column){figure_names[k], k == CHIP_DELAY ? "ps" : NULL, OPC_REAL,
                     -1, &r->figure[k]};
  }
  for (size_t i = 0; i < n; i++) r[i].chip = (int64_t)i + 1;
  int code = opc_put_rows(v->host, "chips", 0, n, sizeof *r, OPC_ARRAY(columns),
                          error);
  free(r);
  return code;
}

int chips_report(const variation *v, const eda_samples *chips,
                 opc_error *error) {
  chip_row *r = eda_alloc(v->gates->count, sizeof *r);
  int code = v->tables ? put_figures(v, error) : OPC_OK;
  for (size_t k = 0; k < chips->count && !code; k++)
    code = put_chip(v, k, &chips->of[k], r, error);
  free(r);
  return code;
}

/* ---- all ---- */

static void log_findings(const variation *v) {
  double all = (double)(v->points + v->left_out) * (double)v->gates->count;
  if (v->open)
    v->host->log(v->host, OPC_LOG_FINDING,
                 "%.2g %% of the measured transistors do not print; "
                 "their currents are extrapolated from other conditions",
                 100 * (double)v->open / all);
  if (v->failed)
    v->host->log(v->host, OPC_LOG_FINDING,
                 "%.2g %% of the measured transistors do not print "
                 "as one separate transistor; the currents of these are "
                 "estimates",
                 100 * (double)v->failed / all);
  if (v->outside)
    v->host->log(v->host, OPC_LOG_FINDING,
                 "%.2g %% of the measured transistors are outside "
                 "of the device table; their currents are extrapolated",
                 100 * (double)v->outside / all);
}

/* Largest deviation of the mean Ion of n or p, relative to drawn, within which
   delays are linear in the logarithms of the sizes (README). */
static const double ion_tested = 0.25;

static void log_delays(const variation *v) {
  size_t n = (size_t)v->chips, beyond = 0;
  for (size_t i = 0; i < n; i++) {
    double off = 0;
    for (int k = CHIP_ION_N; k <= CHIP_ION_P; k++)
      if (has_figure(v, k)) off = fmax(off, fabs((double)v->chip[k][i] - 1));
    beyond += off > ion_tested;
  }
  if (v->delays && beyond)
    v->host->log(v->host, OPC_LOG_FINDING,
                 "the mean Ion of n or p deviates by more than %g %% in "
                 "%.2g %% of the chips; their delays are extrapolated",
                 100 * ion_tested, 100 * (double)beyond / (double)n);
}

int variation_report(variation *v, const eda_samples *chips, opc_error *error) {
  log_findings(v);
  log_delays(v);
  int code = put_error(v, error);
  if (!code) code = chips_report(v, chips, error);
  if (!code) code = put_shares(v, error);
  if (!code) code = put_yield(v, error);
  if (!code) code = put_distributions(v, error);
  if (!code) code = put_transistors(v, error);
  return code || !v->delays ? code : delays_report(v, error);
}
