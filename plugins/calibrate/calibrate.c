/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `calibrate`: fits optics, threshold, diffusion and bias
   of a process to measured widths. */
#include "calibrate.h"

#include <correct/fine.h>
#include <eda/memory.h>
#include <eda/random.h>
#include <gsl/gsl_errno.h>
#include <math.h>
#include <opcflow/follow.h>
#include <stdlib.h>
#include <string.h>

enum { HUBER, SQUARES };
enum { LEAVE_GAUGES, LEAVE_MASKS };

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
    size_t n = c->range[t].count;
    f->from[t] = n ? c->range[t].values[0] : NAN;
    f->to[t] = n ? c->range[t].values[n - 1] : NAN;
    f->is_free[t] =
        f->to[t] > f->from[t] && (t > ACTIVE_THRESHOLD || layers[t]);
    any |= f->is_free[t];
  }
  if (any) return OPC_OK;
  return opc_fail(error, OPC_INVALID, NULL, "all parameters are fixed");
}

/* Return the number of fits that leave gauges out. */
static size_t fold_count(const calibrate *c) {
  size_t n = c->leave == LEAVE_MASKS ? c->n_masks : (size_t)c->folds;
  return c->folds > 1 && n > 1 ? n : 0;
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
    opc_progress progress = {
        .done = (double)k,
        .total = (double)((size_t)c->starts + fold_count(c)),
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
  size_t folds = fold_count(c);
  for (size_t k = 0; k < folds && !code; k++) {
    fitted one = {0};
    for (size_t i = 0; i < c->count; i++) {
      const gauge *g = &c->gauges[i];
      f->use[i] = c->leave == LEAVE_MASKS ? (size_t)g->mask != k
                                          : g->group % folds != k;
    }
    code = fit_run(f, c->best.value, &one, error);
    for (size_t i = 0; i < c->count && !code; i++)
      if (!f->use[i]) c->left[i] = f->width[i] - c->gauges[i].width;
  }
  return code;
}

/* Return a model of the masks and gauges of the step, without images. */
static model model_of(const calibrate *c) {
  return (model){.host = c->host,
                 .masks = c->mask,
                 .n_masks = c->n_masks,
                 .optics = c->litho,
                 .margin = c->margin,
                 .image_error = c->image_error,
                 .gauges = c->gauges,
                 .count = c->count};
}

/* Set c->interpolation: simulate the images at the estimates, and compare the
   widths with those of the interpolated images. */
static int check_interpolation(calibrate *c, opc_error *error) {
  c->interpolation = NAN;
  if (c->model.nodes == 1) return OPC_OK;
  model one = model_of(c);
  double *width = eda_alloc(c->count, sizeof *width), sum = 0;
  const double *p = c->best.value;
  int code = model_prepare(&one, p, p, error);
  if (!code) code = model_widths(&one, p, width, error);
  for (size_t i = 0; i < c->count; i++) {
    double off = width[i] - (c->gauges[i].width + c->residual[i]);
    sum += off * off;
  }
  c->interpolation = sqrt(sum / (double)c->count);
  free(width);
  model_clear(&one);
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
  if (!code) code = check_interpolation(c, error);
  return code ? code : fit_folds(c, error);
}

/* Collect the given masks. */
static int take_masks(calibrate *c, opc_error *error) {
  c->n_masks = 0;
  for (size_t k = 0; k < MASKS; k++) {
    if (!c->given[k]) continue;
    int code = eda_mask_flat(c->given[k], &c->mask[c->n_masks++], error);
    if (code) return code;
  }
  return OPC_OK;
}

static int take_gauges(calibrate *c, opc_error *error) {
  int code = OPC_OK;
  if (c->path)
    code =
        gauges_read(c->path, c->mask, c->n_masks, &c->gauges, &c->count, error);
  else
    gauges_of_gates(c->mask, c->n_masks, c->drawn, &c->gauges, &c->count);
  if (!code && c->count <= TERMS)
    code = opc_fail(error, OPC_INVALID, "gauges",
                    "%zu gauges are too few for up to %d parameters", c->count,
                    TERMS);
  return code;
}

static int calibrate_run(void *self, void **outputs, opc_error *error) {
  calibrate *c = self;
  (void)outputs;
  gsl_set_error_handler_off(); /* the default handler aborts */
  int code = correct_fine_margin(c->host, c->litho, 0, &c->margin, error);
  if (!code) code = take_masks(c, error);
  if (!code) code = take_gauges(c, error);
  if (!code) code = take_ranges(c, error);
  if (code) return code;
  c->start_cost = eda_alloc((size_t)c->starts, sizeof *c->start_cost);
  c->residual = eda_alloc(c->count, sizeof *c->residual);
  c->left = eda_alloc(c->count, sizeof *c->left);
  c->weight = eda_alloc(c->count, sizeof *c->weight);
  c->model = model_of(c);
  code = model_prepare(&c->model, c->fit.from, c->fit.to, error);
  if (!code) code = model_densities(&c->model, c->density_range, error);
  if (!code) code = calibrate_fit(c, error);
  if (!code) code = calibrate_report(c, error);
  model_clear(&c->model); /* the masks exist only while the step runs */
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("mask", calibrate, given[0], .type = OPC_INPUT,
                        .flags = OPC_REQUIRED, .choices = "mask",
                        .summary = "mask that was printed"),
    OPC_PARAMETER_NAMED("mask_2", calibrate, given[1], .type = OPC_INPUT,
                        .choices = "mask",
                        .summary = "second mask of the same process"),
    OPC_PARAMETER_NAMED("mask_3", calibrate, given[2], .type = OPC_INPUT,
                        .choices = "mask",
                        .summary = "third mask of the same process"),
    OPC_PARAMETER_NAMED("mask_4", calibrate, given[3], .type = OPC_INPUT,
                        .choices = "mask",
                        .summary = "fourth mask of the same process"),
    OPC_PARAMETER_NAMED(
        "gauges", calibrate, path, .type = OPC_FILE,
        .summary = "CSV file of measured widths; default: the drawn lengths "
                   "and widths of all transistors"),
    OPC_PARAMETER(calibrate, drawn, .type = OPC_CHOICE, .preset = "both",
                  .choices = "both|lengths|widths",
                  .summary = "drawn sizes of the transistors that are gauges "
                             "without `gauges`"),
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
    OPC_PARAMETER_NAMED("na", calibrate, range[NA], .type = OPC_REALS,
                        .summary = "range of the numerical aperture, or one "
                                   "fixed value; default: that of `litho`"),
    OPC_PARAMETER_NAMED("sigma", calibrate, range[SIGMA], .type = OPC_REALS,
                        .summary = "range of the outer radius of the source, "
                                   "or one fixed value; default: that of "
                                   "`litho`"),
    OPC_PARAMETER_NAMED("bias", calibrate, range[BIAS], .type = OPC_REALS,
                        .unit = "nm", .preset = "[0 nm]",
                        .summary = "range of the width that etching adds to "
                                   "lines at a density of 0.5, or one fixed "
                                   "value"),
    OPC_PARAMETER_NAMED("bias_density", calibrate, range[BIAS_DENSITY],
                        .type = OPC_REALS, .unit = "nm", .preset = "[0 nm]",
                        .summary = "range of the change of the bias from "
                                   "density 0 to density 1, or one fixed "
                                   "value"),
    OPC_PARAMETER(calibrate, density_range, .type = OPC_REAL,
                  .flags = OPC_ABOVE, .unit = "nm", .preset = "500 nm",
                  .min = 0,
                  .summary = "standard deviation of the Gaussian that averages "
                             "the density"),
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
    OPC_PARAMETER(calibrate, leave, .type = OPC_CHOICE, .preset = "gauges",
                  .choices = "gauges|masks",
                  .summary = "parts of the gauges: `folds` parts, or the "
                             "gauges of each mask"),
    OPC_PARAMETER(calibrate, margin, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "nm", .follows = "3.886 lambda/NA", .min = 0,
                  .summary = "clear field around the layout"),
    OPC_PARAMETER_NAMED(
        "fine", calibrate, image_error, .type = OPC_REAL, .flags = OPC_AT_LEAST,
        .preset = "0.0005", .min = 5e-5,
        .summary = "largest error of the images, relative to the clear field"),
};

static const opc_metric metrics[] = {
    {"gauges", NULL, OPC_NEUTRAL, 0, "number of gauges"},
    {"rms", "nm", OPC_LOWER, 0.001, "rms of fitted minus measured width"},
    {"worst", "nm", OPC_LOWER, 0.001, "largest |fitted minus measured width|"},
    {"rms_left_out", "nm", OPC_LOWER, 0.001,
     "rms of predicted minus measured width of gauges that the fit left out"},
    {"interpolation", "nm", OPC_LOWER, 0.001,
     "rms of widths by interpolated images minus widths by images that are "
     "simulated with the estimates"},
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
    {"na", NULL, OPC_NEUTRAL, 0, "fitted or given numerical aperture"},
    {"sigma", NULL, OPC_NEUTRAL, 0, "fitted or given radius of the source"},
    {"bias", "nm", OPC_NEUTRAL, 0, "fitted or given bias"},
    {"bias_density", "nm", OPC_NEUTRAL, 0,
     "fitted or given change of the bias with the density"},
};

/* Check the order and the bounds of a range. */
static int range_check(int t, const opc_reals *r, opc_error *error) {
  if (!r->count && (t == NA || t == SIGMA)) return OPC_OK;
  if (r->count < 1 || r->count > 2 || r->values[r->count - 1] < r->values[0])
    return opc_fail(error, OPC_INVALID, term_name[t],
                    "'%s' requires [lowest, highest] or one value",
                    term_name[t]);
  double low = r->values[0], high = r->values[r->count - 1];
  if (t <= ACTIVE_THRESHOLD && !(low > 0 && high < 1))
    return opc_fail(error, OPC_INVALID, term_name[t],
                    "'%s' must be between 0 and 1", term_name[t]);
  if ((t == NA && !(low > 0)) || (t == SIGMA && !(low > 0 && high <= 1)))
    return opc_fail(error, OPC_INVALID, term_name[t], "'%s' must be above 0%s",
                    term_name[t], t == SIGMA ? " and at most 1" : "");
  if (t == DIFFUSION && low < 0)
    return opc_fail(error, OPC_INVALID, term_name[t], "'%s' must be at least 0",
                    term_name[t]);
  return OPC_OK;
}

static int calibrate_check(void *self, opc_error *error) {
  calibrate *c = self;
  EDA_FOLLOW(c->host, "calibrate", c, parameters, eda_scanner_of(c->litho));
  for (int t = 0; t < TERMS; t++)
    if (range_check(t, &c->range[t], error)) return error->code;
  if (c->path && c->drawn != DRAWN_BOTH)
    return opc_fail(error, OPC_INVALID, "drawn",
                    "'drawn' selects gauges without a file, but 'gauges' is "
                    "set");
  return OPC_OK;
}

static void calibrate_clear(void *self) {
  calibrate *c = self;
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
