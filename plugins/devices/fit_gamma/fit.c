/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the least-squares fits. The form `edge` needs a search for the
   decay length; the form `table` is a linear problem. */
#include "fit.h"

#include <eda/memory.h>
#include <gsl/gsl_fit.h>
#include <gsl/gsl_min.h>
#include <gsl/gsl_multifit.h>
#include <math.h>
#include <stdlib.h>

/* Range of decay lengths, nm. */
static const double least = 1, most = 300;
/* Smallest amplitude: the current at the edge is a twentieth of that of a wide
   transistor. Rectangles whose edges carry no current fit best with a short
   decay and an amplitude below -1. With this amplitude and a longer decay, the
   fit is equally good. */
static const double least_amplitude = -0.95;
enum { TRIALS = 60, CLOSE = 16, DECAYS = 12 };

static const char *const currents[EDA_CURRENTS] = {"Ion", "Ioff"};

void sample_init(sample *s, const reference *r, int type, int current) {
  *s = (sample){.type = type,
                .current = current,
                .transistor = eda_alloc(r->count, sizeof *s->transistor)};
  for (size_t i = 0; i < r->count; i++)
    if (r->transistor[i].type == type &&
        !isnan(r->transistor[i].current[current]))
      s->transistor[s->count++] = &r->transistor[i];
}

void sample_clear(sample *s) { free(s->transistor); }
void fitted_clear(fitted *f) {
  free(f->edge);
  free(f->gamma);
  *f = (fitted){0};
}

static int too_few(const sample *s, size_t need, opc_error *error) {
  return opc_fail(error, OPC_INVALID, "reference",
                  "%zu %c-transistor%s with %s, expected at least %zu",
                  s->count, "np"[s->type], s -> count == 1 ? "" : "s",
                  currents[s->current], need);
}

static void fitted_init(fitted *f, size_t points) {
  f->points = points;
  f->edge = eda_alloc(points, sizeof *f->edge);
  f->gamma = eda_alloc(points, sizeof *f->gamma);
}

/* ---- form `edge`: search for the decay length ---- */

typedef struct search {
  const sample *sample;
  double *x, *y;    /* regressor and target of each transistor */
  double amplitude; /* optimum amplitude at the last tried decay length */
} search;

/* Return the sum of squares with the optimum amplitude, within its bound. */
static double fit_cost(double log_decay, void *data) {
  search *f = data;
  double decay = exp(log_decay), covariance, squares;
  for (size_t i = 0; i < f->sample->count; i++) {
    const transistor *t = f->sample->transistor[i];
    const double *part = t->part[f->sample->current];
    double plain = 0, more = 0, want = t->current[f->sample->current];
    for (int k = 0; k < REFERENCE_NODES; k++) {
      plain += part[k];
      more += part[k] * exp(-t->edge[k] / decay);
    }
    f->x[i] = more / want;
    f->y[i] = 1 - plain / want;
  }
  gsl_fit_mul(f->x, 1, f->y, 1, f->sample->count, &f->amplitude, &covariance,
              &squares);
  if (f->amplitude >= least_amplitude) return squares;
  f->amplitude = least_amplitude;
  squares = 0;
  for (size_t i = 0; i < f->sample->count; i++)
    squares += pow(f->y[i] - f->amplitude * f->x[i], 2);
  return squares;
}

/* Return the decay length with the smallest sum of squares: the best of TRIALS
   + 1 values, refined by Brent's method. */
static double best_decay(search *f) {
  double step = log(most / least) / TRIALS, best = INFINITY, at = 0;
  for (int i = 0; i <= TRIALS; i++) {
    double c = fit_cost(log(least) + i * step, f);
    if (c < best) best = c, at = log(least) + i * step;
  }
  gsl_function function = {fit_cost, f};
  gsl_min_fminimizer *m = gsl_min_fminimizer_alloc(gsl_min_fminimizer_brent);
  if (m && !gsl_min_fminimizer_set(m, &function, at, at - step, at + step))
    for (int i = 0; i < 100; i++) {
      if (gsl_min_fminimizer_iterate(m)) break;
      at = gsl_min_fminimizer_x_minimum(m);
      if (gsl_min_fminimizer_x_upper(m) - gsl_min_fminimizer_x_lower(m) < 1e-9)
        break;
    }
  if (m) gsl_min_fminimizer_free(m);
  fit_cost(at, f);
  return exp(at);
}

int fit_edge(const sample *s, fitted *out, opc_error *error) {
  if (s->count < 2) return too_few(s, 2, error);
  search f = {.sample = s, .x = eda_alloc(2 * s->count, sizeof *f.x)};
  f.y = f.x + s->count;
  out->decay = best_decay(&f);
  out->amplitude = f.amplitude;
  free(f.x);
  fitted_init(out, CLOSE * DECAYS + 1);
  for (size_t i = 0; i < out->points; i++) {
    double decays = (double)i / CLOSE;
    out->edge[i] = decays * out->decay;
    out->gamma[i] = 1 + out->amplitude * exp(-decays);
  }
  return OPC_OK;
}

/* ---- form `table`: linear ---- */

/* Return the weight of point j in gamma at a distance x from the edge. */
static double hat_weight(const double *edge, size_t n, size_t j, double x) {
  if (x <= edge[0]) return j == 0;
  if (x >= edge[n - 1]) return j == n - 1;
  if (j > 0 && x <= edge[j] && x > edge[j - 1])
    return (x - edge[j - 1]) / (edge[j] - edge[j - 1]);
  if (j + 1 < n && x >= edge[j] && x < edge[j + 1])
    return (edge[j + 1] - x) / (edge[j + 1] - edge[j]);
  return 0;
}

static void system_fill(const sample *s, const double *edge, size_t edges,
                        gsl_matrix *a, gsl_vector *y) {
  for (size_t i = 0; i < s->count; i++) {
    const transistor *t = s->transistor[i];
    for (size_t j = 0; j < edges; j++) {
      double sum = 0;
      for (int k = 0; k < REFERENCE_NODES; k++)
        sum += t->part[s->current][k] * hat_weight(edge, edges, j, t->edge[k]);
      gsl_matrix_set(a, i, j, sum / t->current[s->current]);
    }
    gsl_vector_set(y, i, 1);
  }
}

int fit_table(const sample *s, const double *edge, size_t edges, fitted *out,
              opc_error *error) {
  if (s->count < edges) return too_few(s, edges, error);
  fitted_init(out, edges);
  out->amplitude = out->decay = NAN;
  gsl_matrix *a = gsl_matrix_alloc(s->count, edges);
  gsl_matrix *covariance = gsl_matrix_alloc(edges, edges);
  gsl_vector *y = gsl_vector_alloc(s->count), *x = gsl_vector_alloc(edges);
  gsl_multifit_linear_workspace *work =
      gsl_multifit_linear_alloc(s->count, edges);
  size_t rank = 0;
  double squares;
  int code = OPC_OK;
  system_fill(s, edge, edges, a, y);
  gsl_multifit_linear_tsvd(a, y, 1e-6, x, covariance, &squares, &rank, work);
  if (rank < edges)
    code = opc_fail(error, OPC_INVALID, "edges",
                    "%s of the %c-transistors determines gamma at only %zu of "
                    "%zu distances",
                    currents[s->current], "np"[s->type], rank, edges);
  for (size_t j = 0; j < edges && !code; j++) {
    out->edge[j] = edge[j];
    out->gamma[j] = gsl_vector_get(x, j);
    if (!(out->gamma[j] > 0))
      code = opc_fail(error, OPC_INVALID, "edges",
                      "gamma of %s of the %c-transistors would be %g at %g nm",
                      currents[s->current], "np"[s->type], out -> gamma[j],
                      edge[j]);
  }
  gsl_multifit_linear_free(work);
  gsl_matrix_free(a);
  gsl_matrix_free(covariance);
  gsl_vector_free(y);
  gsl_vector_free(x);
  return code;
}

double fit_residual(const sample *s, size_t i, const fitted *f) {
  const transistor *t = s->transistor[i];
  double sum = 0;
  for (int k = 0; k < REFERENCE_NODES; k++) {
    double gamma = f ? 0 : 1;
    for (size_t j = 0; f && j < f->points; j++)
      gamma += f->gamma[j] * hat_weight(f->edge, f->points, j, t->edge[k]);
    sum += gamma * t->part[s->current][k];
  }
  return 100 * (sum / t->current[s->current] - 1);
}
