/* SPDX-License-Identifier: BSD-3-Clause */
/* Bounded, robust least squares of gauges. Parameters within bounds are mapped
   to a sine (F. James, MINUIT), so that GSL's unbounded method applies. */
#include <eda/memory.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "calibrate.h"

/* Step of central differences, in parts of a parameter's range. The noise of
   printed widths, about 1e-5 nm, then has little effect: less than 1e-3 of a
   typical derivative. */
static const double step = 1e-3;
/* Distance from a bound, in parts of the range, at which a parameter counts as
   being at its bound. */
static const double touching = 1e-3;
enum { ROUNDS = 20, ITERATIONS = 40 };

/* A GSL problem: u[k] is the angle of free parameter k. */
typedef struct problem {
  fitting *f;
  size_t index[TERMS], n;
  double value[TERMS];
  double *width; /* [gauges] */
  opc_error *error;
} problem;

static void problem_values(const problem *q, const gsl_vector *u,
                           double p[TERMS]) {
  memcpy(p, q->value, sizeof q->value);
  for (size_t k = 0; k < q->n; k++) {
    size_t t = q->index[k];
    double low = q->f->from[t], high = q->f->to[t];
    p[t] = low + (high - low) * (1 + sin(gsl_vector_get(u, k))) / 2;
  }
}

static int problem_errors(const gsl_vector *u, void *data, gsl_vector *out) {
  problem *q = data;
  const model *m = q->f->model;
  double p[TERMS];
  problem_values(q, u, p);
  if (model_widths(m, p, q->width, q->error)) return GSL_EBADFUNC;
  for (size_t i = 0; i < m->count; i++)
    gsl_vector_set(out, i,
                   (q->width[i] - m->gauges[i].width) / m->gauges[i].sd);
  return GSL_SUCCESS;
}

static int problem_slopes(const gsl_vector *u, void *data, gsl_matrix *out) {
  problem *q = data;
  size_t n = q->f->model->count;
  gsl_vector *at = gsl_vector_alloc(q->n), *a = gsl_vector_alloc(n),
             *b = gsl_vector_alloc(n);
  const double by = 2 * step; /* the sine's slope is at most 1/2 */
  int status = GSL_SUCCESS;
  for (size_t k = 0; k < q->n && !status; k++) {
    gsl_vector_memcpy(at, u);
    gsl_vector_set(at, k, gsl_vector_get(u, k) + by);
    status = problem_errors(at, q, a);
    gsl_vector_set(at, k, gsl_vector_get(u, k) - by);
    if (!status) status = problem_errors(at, q, b);
    for (size_t i = 0; i < n && !status; i++)
      gsl_matrix_set(out, i, k,
                     (gsl_vector_get(a, i) - gsl_vector_get(b, i)) / (2 * by));
  }
  gsl_vector_free(at);
  gsl_vector_free(a);
  gsl_vector_free(b);
  return status;
}

/* ---- robust weights ---- */

static int by_value(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Return the robust standard deviation of the errors of the used gauges: the
   median of |error| / 0.6745. */
static double fit_scale(const fitting *f, const double *errors) {
  size_t n = 0, count = f->model->count;
  double *all = eda_alloc(count, sizeof *all);
  for (size_t i = 0; i < count; i++)
    if (f->use[i]) all[n++] = fabs(errors[i]);
  qsort(all, n, sizeof *all, by_value);
  double median = n ? (all[(n - 1) / 2] + all[n / 2]) / 2 : 0;
  free(all);
  return fmax(median / 0.6745, 1e-4);
}

static double fit_error(const fitting *f, size_t i) {
  return (f->width[i] - f->model->gauges[i].width) / f->model->gauges[i].sd;
}

/* Set the weights by the errors of f->width; return the largest change. */
static double fit_weigh(fitting *f) {
  size_t n = f->model->count;
  double *errors = eda_alloc(n, sizeof *errors), most = 0;
  for (size_t i = 0; i < n; i++) errors[i] = fit_error(f, i);
  double limit = f->robust * fit_scale(f, errors);
  for (size_t i = 0; i < n; i++) {
    double w = f->use[i] ? fmin(1, limit / fabs(errors[i])) : 0;
    most = fmax(most, fabs(w - f->weight[i]));
    f->weight[i] = w;
  }
  free(errors);
  return most;
}

/* Return the sum of |errors|, which compares fits of different scale. */
static double fit_cost(const fitting *f) {
  double sum = 0;
  for (size_t i = 0; i < f->model->count; i++)
    if (f->use[i]) sum += fabs(fit_error(f, i));
  return sum;
}

/* ---- fit ---- */

/* Iterate least squares with the present weights, from and to *u. */
static int problem_solve(problem *q, gsl_vector *u) {
  size_t n = q->f->model->count;
  gsl_multifit_nlinear_fdf fdf = {.f = problem_errors,
                                  .df = problem_slopes,
                                  .n = n,
                                  .p = q->n,
                                  .params = q};
  gsl_multifit_nlinear_parameters how =
      gsl_multifit_nlinear_default_parameters();
  gsl_multifit_nlinear_workspace *w =
      gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &how, n, q->n);
  gsl_vector_const_view weight = gsl_vector_const_view_array(q->f->weight, n);
  int status = gsl_multifit_nlinear_winit(u, &weight.vector, &fdf, w), info;
  /* GSL_ENOPROG and GSL_EMAXITER: no better point was found. */
  if (!status)
    (void)gsl_multifit_nlinear_driver(ITERATIONS, 1e-6, 1e-8, 0, NULL, NULL,
                                      &info, w);
  if (!status) gsl_vector_memcpy(u, w->x);
  gsl_multifit_nlinear_free(w);
  return status;
}

int fit_run(fitting *f, const double start[TERMS], fitted *out,
            opc_error *error) {
  problem q = {.f = f, .error = error, .width = f->width};
  error->code = OPC_OK;
  memcpy(q.value, start, sizeof q.value);
  for (size_t t = 0; t < TERMS; t++)
    if (f->is_free[t]) q.index[q.n++] = t;
  for (size_t i = 0; i < f->model->count; i++) f->weight[i] = f->use[i];
  gsl_vector *u = gsl_vector_alloc(q.n);
  for (size_t k = 0; k < q.n; k++) {
    size_t t = q.index[k];
    double part = (start[t] - f->from[t]) / (f->to[t] - f->from[t]);
    gsl_vector_set(u, k, asin(fmax(-0.999, fmin(0.999, 2 * part - 1))));
  }
  int status = GSL_SUCCESS;
  for (int round = 0; round < ROUNDS && !status; round++) {
    status = problem_solve(&q, u);
    problem_values(&q, u, out->value);
    if (!status) status = model_widths(f->model, out->value, f->width, error);
    if (!status && fit_weigh(f) < 1e-3) break;
  }
  gsl_vector_free(u);
  out->cost = fit_cost(f);
  if (error->code) return error->code;
  return status ? opc_fail(error, OPC_FAILED, NULL, "the fit failed: %s",
                           gsl_strerror(status))
                : OPC_OK;
}

/* ---- intervals ---- */

/* Compute derivatives of the errors by parameter t, per range of the parameter.
 */
static int fit_column(fitting *f, const fitted *at, size_t t, double *out,
                      opc_error *error) {
  size_t n = f->model->count;
  double *other = eda_alloc(n, sizeof *other), p[TERMS];
  double range = f->to[t] - f->from[t], by = step * range;
  memcpy(p, at->value, sizeof p);
  p[t] = at->value[t] + by;
  int code = model_widths(f->model, p, out, error);
  p[t] = at->value[t] - by;
  if (!code) code = model_widths(f->model, p, other, error);
  for (size_t i = 0; i < n; i++)
    out[i] = (out[i] - other[i]) / (2 * step) / f->model->gauges[i].sd;
  free(other);
  return code;
}

/* Return the factor of the covariance: the variance of Huber's estimate (P. J.
   Huber, Robust Statistics, 1981, 7.6), for `m` parameters. */
static double fit_variance(const fitting *f, size_t m) {
  double n = 0, inside = 0, sum = 0;
  for (size_t i = 0; i < f->model->count; i++) {
    if (!f->use[i]) continue;
    double psi = f->weight[i] * fit_error(f, i);
    n++;
    inside += f->weight[i] >= 1;
    sum += psi * psi;
  }
  double part = inside / n;
  return n > (double)m && part > 0 ? sum / (n - (double)m) / (part * part)
                                   : INFINITY;
}

/* Invert the normal matrix by its eigenvalues into `inverse`. Set out->weak to
   the direction of the smallest eigenvalue. */
static void fit_invert(gsl_matrix *normal, const size_t *index, size_t m,
                       double inverse[TERMS][TERMS], fitted *out) {
  gsl_vector *value = gsl_vector_alloc(m);
  gsl_matrix *vector = gsl_matrix_alloc(m, m);
  gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(m);
  gsl_eigen_symmv(normal, value, vector, w);
  gsl_eigen_symmv_sort(value, vector, GSL_EIGEN_SORT_VAL_ASC);
  double largest = gsl_vector_get(value, m - 1);
  for (size_t a = 0; a < m; a++) {
    out->weak[index[a]] = gsl_matrix_get(vector, a, 0);
    for (size_t b = 0; b < m; b++) {
      inverse[a][b] = 0;
      for (size_t k = 0; k < m; k++)
        inverse[a][b] +=
            gsl_matrix_get(vector, a, k) * gsl_matrix_get(vector, b, k) /
            fmax(gsl_vector_get(value, k), fmax(1e-14 * largest, 1e-300));
    }
  }
  gsl_eigen_symmv_free(w);
  gsl_vector_free(value);
  gsl_matrix_free(vector);
}

/* Compute the normal matrix of the parameters index[m], per range. */
static int fit_normal(fitting *f, const fitted *out, const size_t *index,
                      size_t m, gsl_matrix *normal, opc_error *error) {
  size_t n = f->model->count;
  double *slope = eda_alloc(m * n, sizeof *slope);
  int code = OPC_OK;
  for (size_t k = 0; k < m && !code; k++)
    code = fit_column(f, out, index[k], slope + k * n, error);
  for (size_t a = 0; a < m && !code; a++)
    for (size_t b = 0; b < m; b++) {
      double sum = 0;
      for (size_t i = 0; i < n; i++)
        if (f->use[i]) sum += slope[a * n + i] * slope[b * n + i];
      gsl_matrix_set(normal, a, b, sum);
    }
  free(slope);
  return code;
}

int fit_intervals(fitting *f, fitted *out, opc_error *error) {
  size_t index[TERMS], m = 0, used = 0;
  for (size_t i = 0; i < f->model->count; i++) used += f->use[i];
  for (size_t t = 0; t < TERMS; t++) {
    double range = f->to[t] - f->from[t];
    out->low[t] = out->high[t] = out->value[t];
    out->at_bound[t] =
        f->is_free[t] && fmin(out->value[t] - f->from[t],
                              f->to[t] - out->value[t]) < touching * range;
    if (f->is_free[t] && !out->at_bound[t]) index[m++] = t;
  }
  if (!m) return OPC_OK;
  double inverse[TERMS][TERMS];
  gsl_matrix *normal = gsl_matrix_alloc(m, m);
  int code = fit_normal(f, out, index, m, normal, error);
  if (!code) fit_invert(normal, index, m, inverse, out);
  gsl_matrix_free(normal);
  if (code) return code;
  double variance = fit_variance(f, m);
  double quantile =
      used > m ? gsl_cdf_tdist_Pinv(0.975, (double)(used - m)) : INFINITY;
  for (size_t a = 0; a < m; a++) {
    size_t t = index[a];
    double range = f->to[t] - f->from[t];
    out->sd[t] = range * sqrt(variance * inverse[a][a]);
    out->low[t] = out->value[t] - quantile * out->sd[t];
    out->high[t] = out->value[t] + quantile * out->sd[t];
    out->open[t] = !(out->high[t] - out->low[t] < range);
    for (size_t b = 0; b < m; b++)
      out->correlation[t][index[b]] =
          inverse[a][b] / sqrt(inverse[a][a] * inverse[b][b]);
  }
  return OPC_OK;
}
