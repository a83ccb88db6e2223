/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements process.window: evaluates the gates of a mask at lists of doses,
   foci, mask errors and overlays (Bossung curves; exposure latitude and depth
   of focus: C. A. Mack, "Fundamental Principles of Optical Lithography", 2007,
   chapter 8). */
#include "window.h"

#include <correct/fine.h>
#include <eda/drawing.h>
#include <eda/memory.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- state: window.h ---- */

enum { MAX_PLACES = 100 };

/* ---- work ---- */

static size_t nearest_to_0(opc_reals list) {
  size_t out = 0;
  for (size_t i = 0; i < list.count; i++)
    if (fabs(list.values[i]) < fabs(list.values[out])) out = i;
  return out;
}

/* Check the mask errors: the moved edges must be on the mask grid. */
static int check_mask_errors(const window *w, opc_error *error) {
  double grid = w->gates->grid;
  for (size_t k = 0; k < w->mask_error.count; k++) {
    double steps = w->mask_error.values[k] / grid;
    if (fabs(steps - round(steps)) > 1e-6)
      return opc_fail(error, OPC_INVALID, "mask_error",
                      "%g nm is no multiple of the mask grid of %g nm",
                      w->mask_error.values[k], grid);
  }
  return OPC_OK;
}

static int window_run(void *self, void **outputs, opc_error *error) {
  window *w = self;
  (void)outputs;
  if (!w->mask == !w->as_drawn)
    return opc_fail(error, OPC_INVALID, "mask", "set either 'mask' or 'gates'");
  w->gates = w->mask ? w->mask->gates : w->as_drawn;
  w->count = w->mask ? w->mask->count : NULL;
  if (!w->gates->count)
    return opc_fail(error, OPC_INVALID, w->mask ? "mask" : "gates",
                    "the layout has no transistors to measure");
  if (window_overlays(w) && !w->extractor)
    return opc_fail(error, OPC_INVALID, "extractor",
                    "'overlay_x' and 'overlay_y' require an 'extractor'");
  if (w->margin == 0)
    w->host->log(w->host, OPC_LOG_INFO,
                 "margin 0 nm: the layout is one period of a pattern");
  else if (correct_fine_margin(w->host, w->litho, 0, &w->margin, error))
    return error->code;
  w->nominal_dose = nearest_to_0(w->dose);
  w->nominal_focus = nearest_to_0(w->focus);
  if (check_mask_errors(w, error)) return error->code;
  w->low = eda_alloc(w->focus.count, sizeof *w->low);
  w->high = eda_alloc(w->focus.count, sizeof *w->high);
  if (window_expose(w, error)) return error->code;
  window_limits(w);
  int code = window_report(w, error);
  return code ? code : window_draw(w, error);
}

static int window_forecast(void *self, opc_forecast *out, opc_error *error) {
  const window *w = self;
  eda_printer printer;
  (void)error;
  if (!w->mask && !w->as_drawn) return OPC_OK; /* `run` reports this */
  const eda_gates gates =
      w->mask ? eda_mask_part_outline(w->mask, w->margin) : *w->as_drawn;
  eda_printer_init(&printer, w->host->context, &gates, w->litho, w->resist,
                   w->margin);
  size_t layers = w->extractor ? 2 : 1;
  eda_image_size one = eda_printer_forecast(&printer, layers);
  size_t images = w->focus.count + w->mask_error.count;
  size_t prints =
      w->focus.count * w->dose.count + w->mask_error.count + window_overlays(w);
  eda_printer_clear(&printer);
  out->memory = one.bytes + (double)prints * (double)gates.count *
                                (sizeof(eda_section) + 2 * sizeof(double));
  (void)snprintf(out->work, sizeof out->work,
                 "%zu images of about %.0f x %.0f points, %zu simulations",
                 layers * images, one.columns, one.rows, layers * prints);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller 'margin', fewer values of 'dose' and 'defocus', or "
                 "part of the layout");
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(window, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "corrected mask whose gates are measured"),
    OPC_PARAMETER_NAMED(
        "gates", window, as_drawn, .type = OPC_INPUT, .choices = "gates",
        .summary = "gates of the mask as drawn, instead of `mask`"),
    OPC_PARAMETER(window, litho, .type = OPC_SLOT, .flags = OPC_REQUIRED,
                  .choices = "litho", .summary = "model of the optics"),
    OPC_PARAMETER(window, resist, .type = OPC_SLOT, .flags = OPC_REQUIRED,
                  .choices = "resist",
                  .summary = "model of the resist, calibrated at 0 % and 0 nm"),
    OPC_PARAMETER(
        window, extractor, .type = OPC_SLOT, .choices = "extractor",
        .summary =
            "model of transistor currents; if set, currents are reported, too"),
    OPC_PARAMETER(window, dose, .type = OPC_REALS, .unit = "%",
                  .preset = "[-8 %, -4 %, 0 %, 4 %, 8 %]",
                  .summary = "relative changes of the dose, increasing"),
    OPC_PARAMETER_NAMED("defocus", window, focus, .type = OPC_REALS,
                        .unit = "nm",
                        .summary = "defocus values, increasing; default: 0, "
                                   "+-0.1457 and +-0.2915 lambda/NA^2"),
    OPC_PARAMETER(window, tolerance, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .preset = "10 %", .min = 0,
                  .summary = "largest deviation of the printed length, "
                             "relative to the drawn one"),
    OPC_PARAMETER(window, mask_error, .type = OPC_REALS, .unit = "nm",
                  .preset = "[]",
                  .summary = "outward displacements of all mask edges, "
                             "increasing; simulated at nominal dose and focus"),
    OPC_PARAMETER_NAMED(
        "overlay_x", window, overlay[0], .type = OPC_REALS, .unit = "nm",
        .preset = "[]",
        .summary = "displacements of the image of active against poly along "
                   "x, increasing; at nominal dose and focus"),
    OPC_PARAMETER_NAMED(
        "overlay_y", window, overlay[1], .type = OPC_REALS, .unit = "nm",
        .preset = "[]",
        .summary = "displacements of the image of active against poly along "
                   "y, increasing; combined with `overlay_x`"),
    OPC_PARAMETER(
        window, ion_limit, .type = OPC_REAL, .flags = OPC_ABOVE, .unit = "%",
        .preset = "10 %", .min = 0,
        .summary = "largest |Ion deviation| of a transistor inside the window"),
    OPC_PARAMETER(window, ioff_limit, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .preset = "200 %", .min = 0,
                  .summary = "largest excess of Ioff over drawn of a "
                             "transistor inside the window"),
    OPC_PARAMETER(window, margin, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "nm", .follows = "3.886 lambda/NA", .min = 0,
                  .summary = "clear field around the layout; 0: the layout is "
                             "one period of a pattern"),
    OPC_PARAMETER(window, cut_lines, .type = OPC_BOOL, .preset = "false",
                  .summary = "write a table of the lengths of every gate"),
    OPC_PARAMETER(window, file, .type = OPC_OUTPUT,
                  .preset = "process_window.png",
                  .summary = "picture, .png, .svg or .pdf"),
};

static const opc_metric metrics[] = {
    {"exposure_latitude", "%", OPC_HIGHER, 0.05,
     "range of doses within tolerance, at the focus with the largest range"},
    {"depth_of_focus", "nm", OPC_HIGHER, 0.5,
     "range of foci within tolerance, at the dose nearest to 0 %"},
    {"nils_min", NULL, OPC_HIGHER, 0.001,
     "smallest normalised image log slope of all gates and conditions"},
    {"failed_max", NULL, OPC_LOWER, 0,
     "number of gates that are open or merged, at the worst condition"},
    {"ion_window", "%nm", OPC_HIGHER, 0.5,
     "area of dose and focus where all transistors meet ion_limit"},
    {"ioff_window", "%nm", OPC_HIGHER, 0.5,
     "area of dose and focus where all transistors meet ioff_limit"},
    {"both_window", "%nm", OPC_HIGHER, 0.5,
     "area of dose and focus where all transistors meet both limits"},
    {"ion_sd_max", "%", OPC_LOWER, 0.01,
     "standard deviation of Ion of the n- or the p-transistors, at the worst "
     "condition"},
    {"ion_worst", "%", OPC_LOWER, 0.01,
     "largest |Ion deviation| at all conditions"},
    {"leakage_max", NULL, OPC_LOWER, 0.01,
     "ratio of total Ioff to drawn total Ioff, at the worst condition"},
    {"transistors_failed_max", NULL, OPC_LOWER, 0,
     "number of transistors that do not print as one separate transistor, at "
     "the worst condition"},
    {"outside_max", NULL, OPC_LOWER, 0,
     "number of transistors with results extrapolated beyond the device table, "
     "at the worst condition"},
    {"short_slices_max", NULL, OPC_LOWER, 0,
     "number of slices shorter than the device model covers, at the worst "
     "condition"},
    {"meef_mean", NULL, OPC_LOWER, 0.01,
     "mean mask error factor: printed length per mask length"},
    {"meef_max", NULL, OPC_LOWER, 0.01,
     "largest mask error factor: printed length per mask length"},
    {"ion_per_nm_mean", "%", OPC_LOWER, 0.01,
     "mean of |change of Ion| when all edges of the mask move by 1 nm"},
    {"ion_per_nm_max", "%", OPC_LOWER, 0.01,
     "largest |change of Ion| when all edges of the mask move by 1 nm"},
    {"overlay_ion_worst", "%", OPC_LOWER, 0.01,
     "largest |Ion deviation| of all overlays"},
    {"overlay_leakage_max", NULL, OPC_LOWER, 0.01,
     "ratio of total Ioff to drawn total Ioff, at the worst overlay"},
};

/* Check that a list has `least` to MAX_PLACES increasing values, all above
   `above` and at most 1e6, in the unit of the parameter (% or nm). */
static int check_list(const char *name, opc_reals list, size_t least,
                      double above, opc_error *error) {
  static const double most = 1e6;
  const double *v = list.values;
  if (list.count < least || list.count > MAX_PLACES)
    return opc_fail(error, OPC_INVALID, name,
                    "'%s' must have %zu to %d values, found %zu", name, least,
                    MAX_PLACES, list.count);
  for (size_t i = 0; i < list.count; i++)
    if (!(v[i] > above && v[i] <= most))
      return opc_fail(error, OPC_INVALID, name,
                      "'%s' of %g is out of range, expected more than %g and "
                      "at most %g",
                      name, v[i], above, most);
  for (size_t i = 1; i < list.count; i++)
    if (!(v[i] > v[i - 1]))
      return opc_fail(error, OPC_INVALID, name,
                      "'%s' must increase, %g comes after %g", name, v[i],
                      v[i - 1]);
  return OPC_OK;
}

/* Set the default foci and margin: 0, 50 and 100 nm of defocus at 193 nm and NA
   0.75, other values in proportion. */
static void window_set_defaults(window *w) {
  eda_scanner scanner = eda_scanner_of(w->litho);
  EDA_FOLLOW(w->host, "process.window", w, parameters, scanner);
  if (w->focus.count) return;
  double far = eda_natural(&scanner, "0.2915 lambda/NA^2");
  double near = eda_natural(&scanner, "0.1457 lambda/NA^2");
  const double foci[] = {-far, -near, 0, near, far};
  memcpy(w->foci, foci, sizeof foci);
  w->focus = (opc_reals){w->foci, sizeof foci / sizeof *foci};
  w->host->log(w->host, OPC_LOG_INFO,
               "process.window: defocus 0, +-%g and +-%g nm, from wavelength "
               "and NA",
               near, far);
}

static int window_check(void *self, opc_error *error) {
  window *w = self;
  window_set_defaults(w);
  if (check_list("dose", w->dose, 1, -100, error) ||
      check_list("defocus", w->focus, 1, -1e6, error) ||
      check_list("mask_error", w->mask_error, 0, -1e3, error) ||
      check_list("overlay_x", w->overlay[0], 0, -1e3, error) ||
      check_list("overlay_y", w->overlay[1], 0, -1e3, error))
    return error->code;
  if (w->mask_error.count == 1)
    return opc_fail(error, OPC_INVALID, "mask_error",
                    "'mask_error' requires at least two values, found 1");
  return eda_paper_check(w->file, "file", error);
}

static void clear_prints(window_print *prints, size_t n) {
  for (size_t k = 0; prints && k < n; k++) {
    free(prints[k].cuts);
    free(prints[k].ion);
    free(prints[k].ioff);
  }
  free(prints);
}

static void window_clear(void *self) {
  window *w = self;
  clear_prints(w->print, w->focus.count * w->dose.count);
  clear_prints(w->wrong, w->mask_error.count);
  clear_prints(w->shifted, window_overlays(w));
  free(w->low);
  free(w->high);
}

/* ---- entry ---- */

static const opc_step functions = {.run = window_run,
                                   .forecast = window_forecast};

OPC_PLUGIN(window, .id = "process.window", .kind = "step", .version = "0.3.0",
           .licence = "BSD-3-Clause",
           .summary =
               "gate lengths, image slopes and currents over dose, focus and "
               "mask errors",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = window_check, .clear = window_clear,
           OPC_FUNCTIONS(functions));
