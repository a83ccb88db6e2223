/* SPDX-License-Identifier: BSD-3-Clause */
/* Response of each transistor to the variables: a polynomial, fitted by least
   squares. All figures and transistors share the points, and therefore one QR
   decomposition. */
#include <eda/memory.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "variation.h"

const char *const variation_sources[SOURCES] = {
    "poly_dose",    "poly_focus",  "poly_mask", "active_dose",
    "active_focus", "active_mask", "overlay",   "line_edges"};

/* ---- terms ---- */

/* Largest degree in the variables of a group, and groups of variables. */
enum { POLY, ACTIVE, OVERLAY, GROUPS, DEGREE = 4 };
static const int most[GROUPS] = {4, 3, 4};
static const int group_of[VARIABLES] = {POLY,   POLY,   POLY,    ACTIVE,
                                        ACTIVE, ACTIVE, OVERLAY, OVERLAY};

static int is_term(const uint8_t power[VARIABLES], const int used[VARIABLES]) {
  int degree[GROUPS] = {0}, all = 0, groups = 0;
  for (int v = 0; v < VARIABLES; v++) {
    if (power[v] && !used[v]) return 0;
    degree[group_of[v]] += power[v];
    all += power[v];
  }
  for (int g = 0; g < GROUPS; g++) {
    if (degree[g] > most[g]) return 0;
    groups += degree[g] > 0;
  }
  if (groups <= 1) return 1;
  return all == 2 || (all == 3 && !degree[ACTIVE]);
}

static int next_power(uint8_t power[VARIABLES]) {
  for (int v = 0; v < VARIABLES; v++) {
    if (power[v] < DEGREE) {
      power[v]++;
      return 1;
    }
    power[v] = 0;
  }
  return 0;
}

void surrogate_init(surrogate *s, const int used[VARIABLES], size_t gates) {
  uint8_t power[VARIABLES] = {0};
  *s = (surrogate){.gates = gates};
  do s->terms += (size_t)is_term(power, used);
  while (next_power(power));
  s->power = eda_alloc(s->terms, sizeof *s->power);
  size_t t = 0;
  memset(power, 0, sizeof power);
  do
    if (is_term(power, used)) memcpy(s->power[t++], power, sizeof power);
  while (next_power(power));
  for (int f = 0; f < FIGURES; f++)
    s->coefficient[f] = eda_alloc(s->terms * gates, sizeof(float));
}

void surrogate_clear(surrogate *s) {
  free(s->power);
  for (int f = 0; f < FIGURES; f++) free(s->coefficient[f]);
  *s = (surrogate){0};
}

void surrogate_features(const surrogate *s, const double u[VARIABLES],
                        double *out) {
  double power[VARIABLES][DEGREE + 1];
  for (int v = 0; v < VARIABLES; v++) {
    power[v][0] = 1;
    for (int k = 0; k < DEGREE; k++) power[v][k + 1] = power[v][k] * u[v];
  }
  for (size_t t = 0; t < s->terms; t++) {
    double x = 1;
    for (int v = 0; v < VARIABLES; v++)
      if (s->power[t][v]) x *= power[v][s->power[t][v]];
    out[t] = x;
  }
}

double surrogate_at(const surrogate *s, const double *features, int figure,
                    size_t gate) {
  double x = 0;
  for (size_t t = 0; t < s->terms; t++)
    x += features[t] * (double)s->coefficient[figure][t * s->gates + gate];
  return x;
}

/* ---- fit ---- */

typedef struct fit {
  surrogate *s;
  size_t points;
  const double (*point)[VARIABLES];
  const float *value;
  const gsl_matrix *qr;
  const gsl_vector *tau;
} fit;

/* Decompose the matrix of the terms at the points p with rows[p] != 0, or at
   all points if `rows` is NULL. */
static void terms_decompose(const surrogate *s, size_t points,
                            const double (*point)[VARIABLES],
                            const uint8_t *rows, gsl_matrix *qr,
                            gsl_vector *tau) {
  double *features = eda_alloc(s->terms, sizeof *features);
  size_t row = 0;
  for (size_t p = 0; p < points; p++) {
    if (rows && !rows[p]) continue;
    surrogate_features(s, point[p], features);
    for (size_t t = 0; t < s->terms; t++)
      gsl_matrix_set(qr, row, t, features[t]);
    row++;
  }
  gsl_linalg_QR_decomp(qr, tau);
  free(features);
}

static void fit_figures(const fit *f, size_t i, const uint8_t *rows, size_t n,
                        const gsl_matrix *qr, const gsl_vector *tau) {
  surrogate *s = f->s;
  gsl_vector *b = gsl_vector_alloc(n);
  gsl_vector *x = gsl_vector_alloc(s->terms);
  gsl_vector *residual = gsl_vector_alloc(n);
  for (size_t k = 0; k < FIGURES; k++) {
    size_t row = 0;
    for (size_t p = 0; p < f->points; p++)
      if (!rows || rows[p])
        gsl_vector_set(b, row++,
                       (double)f->value[(p * FIGURES + k) * s->gates + i]);
    gsl_linalg_QR_lssolve(qr, tau, b, x, residual);
    for (size_t t = 0; t < s->terms; t++)
      s->coefficient[k][t * s->gates + i] = (float)gsl_vector_get(x, t);
  }
  gsl_vector_free(b);
  gsl_vector_free(x);
  gsl_vector_free(residual);
}

/* Fit a gate. A gate that does not print at some points needs a separate
   matrix. With fewer valid points than terms, the coefficients stay 0;
   points_check rejects such gates. */
static void fit_gate(void *data, size_t i) {
  const fit *f = data;
  const surrogate *s = f->s;
  uint8_t *rows = eda_alloc(f->points, 1);
  size_t n = 0;
  for (size_t p = 0; p < f->points; p++)
    n += rows[p] = !isnan(f->value[p * FIGURES * s->gates + i]);
  if (n == f->points) {
    fit_figures(f, i, NULL, n, f->qr, f->tau);
  } else if (n >= s->terms) {
    gsl_matrix *qr = gsl_matrix_alloc(n, s->terms);
    gsl_vector *tau = gsl_vector_alloc(s->terms);
    terms_decompose(s, f->points, f->point, rows, qr, tau);
    fit_figures(f, i, rows, n, qr, tau);
    gsl_matrix_free(qr);
    gsl_vector_free(tau);
  }
  free(rows);
}

int surrogate_fit(surrogate *s, const opc_context *context, size_t points,
                  const double (*point)[VARIABLES], const float *value,
                  opc_error *error) {
  if (points < s->terms)
    return opc_fail(error, OPC_FAILED, NULL,
                    "%zu points for %zu terms of the surrogate, expected at "
                    "least as many",
                    points, s->terms);
  gsl_matrix *qr = gsl_matrix_alloc(points, s->terms);
  gsl_vector *tau = gsl_vector_alloc(s->terms);
  terms_decompose(s, points, point, NULL, qr, tau);
  fit f = {s, points, point, value, qr, tau};
  opc_parallel(context, s->gates, fit_gate, &f);
  gsl_matrix_free(qr);
  gsl_vector_free(tau);
  return OPC_OK;
}
