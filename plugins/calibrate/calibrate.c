/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `calibrate`: fits threshold, diffusion, focus and bias of
   a process to measured widths. */
#include "calibrate.h"

#include <eda/memory.h>
#include <eda/random.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <opcflow/follow.h>
#include <stdlib.h>
#include <string.h>

enum { HUBER, SQUARES };

/* Huber's constant: 95 % efficiency for normal errors. */
static const double huber = 1.345;

/* ---- work ---- */

/* Set ranges and free parameters; the thresholds of layers without gauges are
   fixed. */
static int take_ranges(calibrate *c, opc_error *error) {
  fitting *f = &c->fit;
  int layers[2] = {0}, any = 0;
  for (size_t i = 0; i < c->count; i++)
    layers[c->gauges[i].layer == EDA_ACTIVE] = 1;
  for (size_t t = 0; t < TERMS; t++) {
    f->from[t] = c->range[t].values[0];
    f->to[t] = c->range[t].values[c->range[t].count - 1];
    f->is_free[t] =
        f->to[t] > f->from[t] && (t > ACTIVE_THRESHOLD || layers[t]);
    any |= f->is_free[t];
  }
  if (any) return OPC_OK;
  return opc_fail(error, OPC_INVALID, NULL, "all parameters are fixed");
}

/* Set the values of start k: the middle of the ranges, then random values. */
static void start_set(const fitting *f, size_t k, double p[TERMS]) {
  uint64_t seed = k;
  for (size_t t = 0; t < TERMS; t++) {
    double part = k ? 0.1 + 0.8 * eda_random_unit(&seed) : 0.5;
    p[t] = f->from[t] + part * (f->to[t] - f->from[t]);
  }
}

static int fit_starts(calibrate *c, opc_error *error) {
  c->best.cost = INFINITY;
  for (size_t k = 0; k < (size_t)c->starts; k++) {
    opc_progress progress = {.done = (double)k,
                             .total = (double)(c->starts + c->folds),
                             .worst = NAN};
    c->host->progress(c->host, &progress);
    if (opc_cancelled(c->host->context))
      return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
    double p[TERMS];
    fitted one = {0};
    start_set(&c->fit, k, p);
    int code = fit_run(&c->fit, p, &one, error);
    if (code) return code;
    c->start_cost[k] = one.cost;
    if (one.cost < c->best.cost) c->best = one;
  }
  /* Restore widths and weights of the best fit. */
  double best[TERMS];
  memcpy(best, c->best.value, sizeof best);
  int code = fit_run(&c->fit, best, &c->best, error);
  return code ? code : fit_intervals(&c->fit, &c->best, error);
}

/* Fit without the gauges of each fold, and predict their widths. */
static int fit_folds(calibrate *c, opc_error *error) {
  fitting *f = &c->fit;
  int code = OPC_OK;
  for (size_t k = 0; k < (size_t)c->folds && !code; k++) {
    fitted one = {0};
    for (size_t i = 0; i < c->count; i++)
      f->use[i] = c->gauges[i].group % (size_t)c->folds != k;
    code = fit_run(f, c->best.value, &one, error);
    for (size_t i = 0; i < c->count && !code; i++)
      if (!f->use[i]) c->left[i] = f->width[i] - c->gauges[i].width;
  }
  return code;
}

static int calibrate_fit(calibrate *c, opc_error *error) {
  fitting *f = &c->fit;
  f->model = &c->model;
  f->robust = c->loss == HUBER ? huber : INFINITY;
  f->use = eda_alloc(c->count, 1);
  f->width = eda_alloc(c->count, sizeof *f->width);
  f->weight = eda_alloc(c->count, sizeof *f->weight);
  memset(f->use, 1, c->count);
  int code = fit_starts(c, error);
  for (size_t i = 0; i < c->count && !code; i++) {
    c->residual[i] = f->width[i] - c->gauges[i].width;
    c->weight[i] = f->weight[i];
    c->left[i] = NAN;
  }
  if (!code && c->folds > 1) code = fit_folds(c, error);
  return code;
}

static int calibrate_run(void *self, void **outputs, opc_error *error) {
  calibrate *c = self;
  (void)outputs;
  gsl_set_error_handler_off(); /* the default handler aborts */
  const eda_gates *gates = c->mask->gates;
  if (!c->path) gauges_of_gates(gates, &c->gauges, &c->count);
  int code = c->path ? gauges_read(c->path, gates, &c->gauges, &c->count, error)
                     : OPC_OK;
  if (!code && c->count <= TERMS)
    code = opc_fail(error, OPC_INVALID, "gauges",
                    "%zu gauges are too few for up to %d parameters", c->count,
                    TERMS);
  if (!code) code = take_ranges(c, error);
  if (code) return code;
  c->start_cost = eda_alloc((size_t)c->starts, sizeof *c->start_cost);
  c->residual = eda_alloc(c->count, sizeof *c->residual);
  c->left = eda_alloc(c->count, sizeof *c->left);
  c->weight = eda_alloc(c->count, sizeof *c->weight);
  const double focus[2] = {c->fit.from[DEFOCUS], c->fit.to[DEFOCUS]};
  c->model.host = c->host;
  c->model.gauges = c->gauges;
  c->model.count = c->count;
  code = model_prepare(&c->model, c->mask, c->litho, c->margin, c->image_error,
                       focus, error);
  if (!code) code = calibrate_fit(c, error);
  return code ? code : calibrate_report(c, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(calibrate, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "mask that was printed"),
    OPC_PARAMETER_NAMED(
        "gauges", calibrate, path, .type = OPC_FILE,
        .summary = "CSV file of measured widths; default: the drawn lengths "
                   "and widths of all transistors"),
    OPC_PARAMETER(calibrate, litho, .type = OPC_SLOT, .flags = OPC_REQUIRED,
                  .choices = "litho", .summary = "model of the optics"),
    OPC_PARAMETER_NAMED("threshold", calibrate, range[THRESHOLD],
                        .type = OPC_REALS, .preset = "[0.15, 0.6]",
                        .summary = "range of the threshold of poly and layers "
                                   "after active, or one fixed value"),
    OPC_PARAMETER_NAMED("active_threshold", calibrate, range[ACTIVE_THRESHOLD],
                        .type = OPC_REALS, .preset = "[0.15, 0.6]",
                        .summary = "range of the threshold of active, or one "
                                   "fixed value"),
    OPC_PARAMETER_NAMED("diffusion", calibrate, range[DIFFUSION],
                        .type = OPC_REALS, .unit = "nm",
                        .preset = "[0 nm, 60 nm]",
                        .summary = "range of the diffusion of the resist, or "
                                   "one fixed value"),
    OPC_PARAMETER_NAMED("defocus", calibrate, range[DEFOCUS], .type = OPC_REALS,
                        .unit = "nm", .preset = "[0 nm]",
                        .summary = "range of the defocus, added to that of "
                                   "`litho`, or one fixed value"),
    OPC_PARAMETER_NAMED("bias", calibrate, range[BIAS], .type = OPC_REALS,
                        .unit = "nm", .preset = "[0 nm]",
                        .summary = "range of the width that etching adds to "
                                   "lines, or one fixed value"),
    OPC_PARAMETER(calibrate, loss, .type = OPC_CHOICE, .preset = "huber",
                  .choices = "huber|squares",
                  .summary = "robust loss, or least squares"),
    OPC_PARAMETER(calibrate, starts, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "4", .min = 1,
                  .max = 1000,
                  .summary = "number of starts: the middle of all ranges, then "
                             "random values"),
    OPC_PARAMETER(
        calibrate, folds, .type = OPC_INT, .flags = OPC_AT_LEAST | OPC_AT_MOST,
        .preset = "5", .min = 0, .max = 1000,
        .summary = "number of parts of the gauges; each part is predicted by a "
                   "fit to the other parts. 0 or 1: no such fits"),
    OPC_PARAMETER(calibrate, margin, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "nm", .follows = "3.886 lambda/NA", .min = 0,
                  .summary = "clear field around the layout"),
    OPC_PARAMETER_NAMED(
        "fine", calibrate, image_error, .type = OPC_REAL, .flags = OPC_ABOVE,
        .preset = "0.0005", .min = 0,
        .summary = "largest error of the images, relative to the clear field"),
};

static const opc_metric metrics[] = {
    {"gauges", NULL, OPC_NEUTRAL, 0, "number of gauges"},
    {"rms", "nm", OPC_LOWER, 0.001, "rms of fitted minus measured width"},
    {"worst", "nm", OPC_LOWER, 0.001, "largest |fitted minus measured width|"},
    {"rms_left_out", "nm", OPC_LOWER, 0.001,
     "rms of predicted minus measured width of gauges that the fit left out"},
    {"downweighted", NULL, OPC_NEUTRAL, 0,
     "gauges with a robust weight below 0.5"},
    {"undetermined", NULL, OPC_LOWER, 0,
     "parameters with an interval wider than their range, or at a bound"},
    {"starts_equal", NULL, OPC_NEUTRAL, 0,
     "starts that end within 1 % of the least sum of errors"},
    {"threshold", NULL, OPC_NEUTRAL, 0, "fitted or given threshold"},
    {"active_threshold", NULL, OPC_NEUTRAL, 0,
     "fitted or given threshold of active"},
    {"diffusion", "nm", OPC_NEUTRAL, 0, "fitted or given diffusion"},
    {"defocus", "nm", OPC_NEUTRAL, 0, "fitted or given defocus"},
    {"bias", "nm", OPC_NEUTRAL, 0, "fitted or given bias"},
};

static int calibrate_check(void *self, opc_error *error) {
  calibrate *c = self;
  EDA_FOLLOW(c->host, "calibrate", c, parameters, eda_scanner_of(c->litho));
  for (size_t t = 0; t < TERMS; t++) {
    const opc_reals *r = &c->range[t];
    if (r->count < 1 || r->count > 2 || r->values[r->count - 1] < r->values[0])
      return opc_fail(error, OPC_INVALID, term_name[t],
                      "'%s' requires [lowest, highest] or one value",
                      term_name[t]);
    int threshold = t <= ACTIVE_THRESHOLD;
    if ((threshold && !(r->values[0] > 0 && r->values[r->count - 1] < 1)) ||
        (t == DIFFUSION && r->values[0] < 0))
      return opc_fail(error, OPC_INVALID, term_name[t], "'%s' must be %s",
                      term_name[t],
                      threshold ? "between 0 and 1" : "at least 0");
  }
  return OPC_OK;
}

static void calibrate_clear(void *self) {
  calibrate *c = self;
  model_clear(&c->model);
  free(c->gauges);
  free(c->start_cost);
  free(c->residual);
  free(c->left);
  free(c->weight);
  free(c->fit.use);
  free(c->fit.width);
  free(c->fit.weight);
}

/* ---- entry ---- */

static const opc_step functions = {.run = calibrate_run};

OPC_PLUGIN(calibrate, .id = "calibrate", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "fit optics and resist to measured widths",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = calibrate_check, .clear = calibrate_clear,
           OPC_FUNCTIONS(functions));
