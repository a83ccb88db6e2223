/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `variation`: statistics of the currents of a mask's
   transistors over the variation of dose, focus, mask size, overlay and line
   edges. */
#include "variation.h"

#include <eda/drawing.h>
#include <eda/memory.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- state: variation.h ---- */

/* Chips from which the moments of single transistors are computed: the standard
   error of a standard deviation is 0.6 %. */
enum { MOMENT_CHIPS = 16384 };

/* Largest number of parts of the layout with own variables, and their size in
   correlation lengths, at which the correlation within a part exceeds 0.96. */
enum { MOST_TILES = 16 };
static const double tile_size = 0.25;

/* ---- variation in the field ---- */

/* Divide the layout into tiles, and compute the Cholesky factor of their
   correlation, exp(-(distance / length)^2 / 2). */
static int variation_divide(variation *v, opc_error *error) {
  const eda_gates *g = v->gates;
  double w = ((double)g->extent.x1 - g->extent.x0) * g->grid;
  double h = ((double)g->extent.y1 - g->extent.y0) * g->grid;
  double size = tile_size * v->field_length;
  double nx = ceil(fmax(w / size, 1)), ny = ceil(fmax(h / size, 1));
  int none = v->field_dose == 0 && v->field_focus == 0 && v->field_overlay == 0;
  circuit *c = &v->circuit;
  c->tiles = 1;
  if (none || nx * ny <= 1) return OPC_OK;
  if (nx * ny > MOST_TILES)
    return opc_fail(error, OPC_INVALID, "field.length",
                    "'field.length' is %g nm, too short for a layout of %g x "
                    "%g nm: expected at least %g nm",
                    v->field_length, w, h,
                    4 * sqrt(w * h / MOST_TILES) + fmax(w, h) / 2);
  size_t n = c->tiles = (size_t)(nx * ny);
  v->tile_of = eda_alloc(g->count, sizeof *v->tile_of);
  v->mix = eda_alloc(n * n, sizeof *v->mix);
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = g->box[i];
    double x = (((double)b.x0 + b.x1) / 2 - g->extent.x0) * g->grid / w;
    double y = (((double)b.y0 + b.y1) / 2 - g->extent.y0) * g->grid / h;
    v->tile_of[i] = (uint32_t)(fmin(floor(x * nx), nx - 1) +
                               nx * fmin(floor(y * ny), ny - 1));
  }
  gsl_matrix *m = gsl_matrix_alloc(n, n);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      double x = (fmod((double)i, nx) - fmod((double)j, nx)) * w / nx;
      double y = (floor((double)i / nx) - floor((double)j / nx)) * h / ny;
      double r = hypot(x, y) / v->field_length;
      gsl_matrix_set(m, i, j, exp(-r * r / 2) + (i == j ? 1e-9 : 0));
    }
  gsl_linalg_cholesky_decomp1(m);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j <= i; j++) v->mix[i * n + j] = gsl_matrix_get(m, i, j);
  gsl_matrix_free(m);
  c->tile_of = v->tile_of;
  c->mix = v->mix;
  return OPC_OK;
}

/* ---- work ---- */

/* Return the gate with the nearest centre, or i if the layout has only one
   gate. */
static uint32_t nearest_of(const eda_gates *g, size_t i) {
  size_t best = i;
  double least = INFINITY;
  for (size_t j = 0; j < g->count; j++) {
    double x = ((double)g->box[j].x0 + g->box[j].x1) -
               ((double)g->box[i].x0 + g->box[i].x1);
    double y = ((double)g->box[j].y0 + g->box[j].y1) -
               ((double)g->box[i].y0 + g->box[i].y1);
    if (j == i || !(x * x + y * y < least)) continue;
    least = x * x + y * y;
    best = j;
  }
  return (uint32_t)best;
}

static void circuit_set(variation *v) {
  circuit *c = &v->circuit;
  const double field[VARIABLES] = {v->field_dose,    v->field_focus,  0,
                                   v->field_dose,    v->field_focus,  0,
                                   v->field_overlay, v->field_overlay};
  const double global[VARIABLES] = {v->dose,    v->focus,  v->mask_edge,
                                    v->dose,    v->focus,  v->mask_edge,
                                    v->overlay, v->overlay};
  c->context = v->host->context;
  c->surrogate = &v->surrogate;
  c->curves = &v->curves;
  c->leakage = &v->leakage;
  c->rough = v->effect;
  c->drawn_length = v->gates->length;
  c->drawn_width = v->gates->width;
  c->drawn_area = v->design.area;
  c->nominal = v->nominal;
  v->neighbour = eda_alloc(v->gates->count, sizeof *v->neighbour);
  for (size_t i = 0; i < v->gates->count; i++)
    v->neighbour[i] = nearest_of(v->gates, i);
  c->neighbour = v->neighbour;
  c->gates = v->gates->count;
  c->type = v->gates->type;
  c->ioff = v->design.ioff;
  c->seed = (uint64_t)v->seed;
  for (int i = 0; i < VARIABLES; i++) {
    double all = variation_range * v->sigma[i];
    c->global[i] = all > 0 ? global[i] / all : 0;
    c->field[i] = all > 0 ? field[i] / all : 0;
  }
  c->kept = (uint64_t)v->tables;
  c->edges = eda_alloc(c->kept * c->gates, sizeof *c->edges);
  if (!v->delays) return;
  delay_model_init(&v->delay_model, c, v->delays);
  c->delays = &v->delay_model;
}

/* Sample all chips; the first ones also for the moments of transistors. */
static int variation_sample(variation *v, opc_error *error) {
  size_t n = (size_t)v->chips, some = n < MOMENT_CHIPS ? n : MOMENT_CHIPS;
  float *rest[CHIP];
  for (int k = 0; k < CHIP; k++) {
    v->chip[k] = eda_alloc(n, sizeof *v->chip[k]);
    rest[k] = v->chip[k] + some;
  }
  v->moment_chips = some;
  v->moments = eda_alloc(v->gates->count, sizeof *v->moments);
  int code = circuit_sample(&v->circuit, variation_stream, 0, some, v->chip,
                            v->moments, error);
  if (!code && n > some)
    code = circuit_sample(&v->circuit, variation_stream, some, n - some, rest,
                          NULL, error);
  return code;
}

/* Refuse a mismatch whose exponentials have no meaning: the model of ln Ion and
   log10 Ioff is linear in the threshold voltage. */
static int mismatch_check(const variation *v, opc_error *error) {
  const double most_ion = 1, most_decades = 3;
  const eda_gates *g = v->gates;
  size_t k = 0;
  for (size_t i = 1; i < g->count; i++)
    if (g->length[i] * g->width[i] < g->length[k] * g->width[k]) k = i;
  double volts = mismatch_sigma(&v->mismatch, g->length[k] * g->width[k]);
  double ion = v->mismatch.ion * volts, decades = volts / v->mismatch.swing;
  if (v->mismatch.vt == 0 || (ion <= most_ion && decades <= most_decades))
    return OPC_OK;
  return opc_fail(error, OPC_INVALID, "mismatch.vt",
                  "'mismatch.vt' is %g V: the standard deviations of a "
                  "transistor of %g x %g nm are %g V, %g in ln Ion and %g "
                  "decades of Ioff, expected at most %g and %g decades",
                  v->mismatch.vt, g->width[k], g->length[k], volts, ion,
                  decades, most_ion, most_decades);
}

static int variation_run(void *self, void **outputs, opc_error *error) {
  variation *v = self;
  if (eda_mask_flat(v->given, &v->mask, error)) return error->code;
  v->gates = v->mask->gates;
  if (!v->gates->count)
    return opc_fail(error, OPC_INVALID, "mask",
                    "the layout has no transistors to measure");
  if (!v->delays && (v->clock > 0 || v->sdf))
    return opc_fail(error, OPC_INVALID, v->sdf ? "sdf" : "clock",
                    "'%s' requires 'delays'", v->sdf ? "sdf" : "clock");
  if (v->delays && v->delays->gates != v->gates)
    return opc_fail(error, OPC_INVALID, "delays",
                    v->delays->gates
                        ? "the delays and the mask belong to different gates"
                        : "the delays have no transistors: give 'circuit' to "
                          "the step that computes the delays");
  if (v->mismatch.vt == 0)
    v->host->log(v->host, OPC_LOG_INFO,
                 "'mismatch.vt' is 0: mismatch by dopants is not included");
  int code = mismatch_check(v, error);
  if (!code) code = variation_divide(v, error);
  if (!code) code = variation_respond(v, error);
  if (!code) circuit_set(v);
  if (!code) code = variation_sample(v, error);
  v->circuit.kept = 0; /* other streams follow */
  if (code) return code;
  eda_samples *chips = chips_sizes(v);
  code = variation_report(v, chips, error);
  if (!code) code = variation_draw(v, error);
  if (code)
    eda_samples_free(chips);
  else
    outputs[0] = chips;
  return code;
}

static int variation_forecast(void *self, opc_forecast *out, opc_error *error) {
  const variation *v = self;
  (void)error;
  correct_forecast(&v->with, v->host, v->given->gates, "50 simulations",
                   "50 accurate simulations", out);
  out->memory +=
      (double)v->chips * CHIP * sizeof(float) +
      (double)v->given->gates->count * 640 * FIGURES * sizeof(float) +
      eda_mask_flat_bytes(v->given);
  return OPC_OK;
}

/* ---- parameters ---- */

#define SIGMA(NAME, FIELD, UNIT, PRESET, SUMMARY)                            \
  OPC_PARAMETER_NAMED(NAME, variation, FIELD, .type = OPC_REAL,              \
                      .flags = OPC_AT_LEAST, .unit = UNIT, .preset = PRESET, \
                      .min = 0, .summary = SUMMARY)
#define ABOVE_0(NAME, FIELD, UNIT, PRESET, SUMMARY)                       \
  OPC_PARAMETER_NAMED(NAME, variation, FIELD, .type = OPC_REAL,           \
                      .flags = OPC_ABOVE, .unit = UNIT, .preset = PRESET, \
                      .min = 0, .summary = SUMMARY)

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("mask", variation, given, .type = OPC_INPUT,
                        .flags = OPC_REQUIRED, .choices = "mask",
                        .summary = "Mask of the circuit"),
    CORRECT_PRINT_SLOTS(variation),
    CORRECT_MARGIN(variation),
    CORRECT_FINE(variation),
    SIGMA("dose", dose, "%", "0.67 %",
          "Standard deviation of the dose of each layer between chips"),
    SIGMA("focus", focus, "nm", "20 nm",
          "Standard deviation of the focus of each layer between chips"),
    SIGMA("mask_error", mask_edge, "nm", "0.33 nm",
          "Standard deviation of the displacement of all edges of a mask"),
    SIGMA("overlay", overlay, "nm", "2.67 nm",
          "Standard deviation of the displacement of active against poly "
          "between chips, along x and along y"),
    SIGMA("field.dose", field_dose, "%", "0 %",
          "Standard deviation of the dose within the field"),
    SIGMA("field.focus", field_focus, "nm", "0 nm",
          "Standard deviation of the focus within the field"),
    SIGMA("field.overlay", field_overlay, "nm", "0 nm",
          "Standard deviation of the overlay within the field"),
    ABOVE_0("field.length", field_length, "nm", "1 mm",
            "Correlation length of the variation within the field"),
    OPC_PARAMETER_NAMED("edges.sigma", variation, rough.sigma, .type = OPC_REAL,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .unit = "nm",
                        .preset = "1.3 nm", .min = 0, .max = 100,
                        .summary = "Standard deviation of a line edge of "
                                   "poly"),
    ABOVE_0("edges.length", rough.length, "nm", "25 nm",
            "Correlation length of a line edge"),
    OPC_PARAMETER_NAMED("edges.hurst", variation, rough.hurst, .type = OPC_REAL,
                        .flags = OPC_ABOVE | OPC_AT_MOST, .preset = "0.5",
                        .min = 0, .max = 1,
                        .summary = "Hurst exponent of a line edge"),
    SIGMA("mismatch.vt", mismatch.vt, "V", "0 V",
          "Standard deviation of the threshold voltage of a transistor with "
          "W L = 1 um^2, by dopants"),
    SIGMA("mismatch.ion", mismatch.ion, NULL, "1.6",
          "Decrease of ln Ion for each V of threshold voltage"),
    ABOVE_0("mismatch.swing", mismatch.swing, "V", "0.1 V",
            "Threshold voltage that decreases Ioff by a decade"),
    ABOVE_0("ion_error", ion_error, "%", "0.3 %",
            "Largest error (rms) of Ion by the surrogate"),
    ABOVE_0("ioff_error", ioff_error, NULL, "0.02",
            "Largest error (rms) of log10 Ioff by the surrogate"),
    ABOVE_0("length_error", length_error, "nm", "0.1 nm",
            "Largest error (rms) of L by the surrogate"),
    OPC_PARAMETER(variation, chips, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "100000",
                  .min = 1000, .max = 1e8,
                  .summary = "Number of sampled chips"),
    OPC_PARAMETER(variation, tables, .type = OPC_INT,
                  .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "0", .min = 0,
                  .max = 1000,
                  .summary = "Number of chips in the output, and with a table "
                             "of all transistors (chip1.csv ...)"),
    OPC_PARAMETER(variation, seed, .type = OPC_INT, .preset = "1",
                  .summary = "Number that selects the sampled chips; masks "
                             "with equal seeds have equal conditions"),
    ABOVE_0("leakage_limit", leakage_limit, NULL, "10",
            "Largest total Ioff of a good chip, over drawn"),
    ABOVE_0("speed_limit", speed_limit, "%", "10 %",
            "Largest shortfall of the mean Ion of the n- or of the "
            "p-transistors of a good chip"),
    ABOVE_0("ion_limit", ion_limit, "%", "30 %",
            "Largest |Ion deviation| of every transistor of a good chip"),
    OPC_PARAMETER(variation, delays, .type = OPC_INPUT, .choices = "delays",
                  .summary = "Delays of the circuit, for the longest path"),
    ABOVE_0("delay_limit", delay_limit, "%", "10 %",
            "Largest increase of the longest path of a good chip over drawn"),
    SIGMA("clock", clock, "s", "0 s",
          "Largest delay of the longest path of a good chip; 0: by "
          "delay_limit"),
    OPC_PARAMETER(variation, sdf, .type = OPC_OUTPUT,
                  .summary = "SDF file with the delays of all arcs at -3, 0 "
                             "and 3 standard deviations, with 'delays'"),
    OPC_PARAMETER(variation, file, .type = OPC_OUTPUT,
                  .preset = "variation.png",
                  .summary = "Picture of the distributions, .png, .svg or "
                             ".pdf"),
};

static const opc_metric metrics[] = {
    {"yield", "%", OPC_HIGHER, 0.1, "chips within all limits"},
    {"yield_low", "%", OPC_HIGHER, 0.1,
     "lower end of the 95 % interval of the yield"},
    {"yield_high", "%", OPC_HIGHER, 0.1,
     "upper end of the 95 % interval of the yield"},
    {"yield_leakage", "%", OPC_HIGHER, 0.1, "chips within leakage_limit"},
    {"yield_speed", "%", OPC_HIGHER, 0.1, "chips within speed_limit"},
    {"yield_match", "%", OPC_HIGHER, 0.1, "chips within ion_limit"},
    {"yield_delay", "%", OPC_HIGHER, 0.1,
     "chips whose longest path is within 'clock' or 'delay_limit'"},
    {"delay_mean", "ps", OPC_LOWER, 0.01,
     "mean over chips of the longest path"},
    {"delay_sigma", "ps", OPC_LOWER, 0.01,
     "standard deviation over chips of the longest path"},
    {"delay_q99", "ps", OPC_LOWER, 0.01,
     "delay that the longest path of 1 % of the chips exceeds"},
    {"leakage_mean", NULL, OPC_LOWER, 0.01,
     "mean over chips of total Ioff over drawn"},
    {"leakage_sigma", NULL, OPC_LOWER, 0.01,
     "standard deviation over chips of total Ioff over drawn"},
    {"leakage_q99", NULL, OPC_LOWER, 0.01,
     "total Ioff over drawn that 1 % of the chips exceed"},
    {"ion_n_sigma", "%", OPC_LOWER, 0.01,
     "standard deviation over chips of the mean Ion of n"},
    {"ion_p_sigma", "%", OPC_LOWER, 0.01,
     "standard deviation over chips of the mean Ion of p"},
    {"surrogate_ion", "%", OPC_LOWER, 0.05,
     "error (rms) of Ion by the surrogate, on images left out of the fit"},
    {"surrogate_ioff", NULL, OPC_LOWER, 0.005,
     "error (rms) of log10 Ioff by the surrogate, on the same images"},
    {"surrogate_length", "nm", OPC_LOWER, 0.02,
     "error (rms) of L by the surrogate, on the same images"},
    {"images_poly", NULL, OPC_LOWER, 0, "simulated images of poly"},
    {"images_active", NULL, OPC_LOWER, 0, "simulated images of active"},
};

static int variation_check(void *self, opc_error *error) {
  variation *v = self;
  v->with.ion_limit = CORRECT_USUAL_LIMIT;
  const double sigma[VARIABLES] = {hypot(v->dose, v->field_dose),
                                   hypot(v->focus, v->field_focus),
                                   v->mask_edge,
                                   hypot(v->dose, v->field_dose),
                                   hypot(v->focus, v->field_focus),
                                   v->mask_edge,
                                   hypot(v->overlay, v->field_overlay),
                                   hypot(v->overlay, v->field_overlay)};
  for (int i = 0; i < VARIABLES; i++) v->sigma[i] = sigma[i];
  if (sigma[POLY_DOSE] * variation_range >= 100)
    return opc_fail(error, OPC_INVALID, "dose",
                    "'dose' is %g %%, expected less than %g %%",
                    sigma[POLY_DOSE], 100 / variation_range);
  if (v->tables > v->chips) v->tables = v->chips;
  int code = correct_settings_check(&v->with, v->host, error);
  return code ? code : eda_paper_check(v->file, "file", error);
}

static void variation_clear(void *self) {
  variation *v = self;
  surrogate_clear(&v->surrogate);
  eda_performance_clear(&v->design);
  for (int k = 0; k < CHIP; k++) free(v->chip[k]);
  free(v->moments);
  free(v->circuit.edges);
  delay_model_clear(&v->delay_model);
  free(v->effect);
  curves_clear(&v->curves);
  curves_clear(&v->leakage);
  free(v->nominal);
  free(v->neighbour);
  free(v->tile_of);
  free(v->mix);
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_SAMPLES("chips")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = variation_run,
                                   .forecast = variation_forecast};

OPC_PLUGIN(variation, .id = "variation", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary =
               "statistics of currents, leakage and yield over the "
               "variation of the process",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = variation_check, .clear = variation_clear,
           OPC_FUNCTIONS(functions));
