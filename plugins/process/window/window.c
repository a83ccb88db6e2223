/* SPDX-License-Identifier: BSD-3-Clause */
/* process.window: the gates of a mask, printed at a list of doses and foci
   (Bossung curves; exposure latitude and depth of focus: C. A. Mack,
   "Fundamental Principles of Optical Lithography", 2007, chapter 8). */
#include "window.h"

#include <eda/drawing.h>
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- state: window.h ---- */

enum { MAX_PLACES = 100 };

/* ---- work: prints ---- */

/* The gates in one print. */
typedef struct cutter {
  const eda_gates *gates;
  eda_field image, print;
  eda_section *cuts;
} cutter;

static void cut_gate(void *data, size_t i) {
  const cutter *c = data;
  c->cuts[i] = eda_gate_section(c->gates, i, EDA_POLY, &c->print, &c->image);
}

static int cut_dose(const window *w, const eda_printer *printer,
                    const eda_field *image, size_t focus, size_t dose,
                    opc_error *error) {
  size_t n = w->gates->count;
  cutter c = {.gates = w->gates,
              .cuts = w->cuts + (focus * w->dose.count + dose) * n};
  c.image = eda_field_scaled(image, 1 + w->dose.values[dose] / 100);
  c.print = eda_field_scaled(&c.image, 1);
  int code = eda_printer_develop(printer, EDA_POLY, &c.print, error);
  if (!code) opc_parallel(w->host->context, n, cut_gate, &c);
  eda_field_clear(&c.image);
  eda_field_clear(&c.print);
  return code;
}

static int image_at(const window *w, const eda_printer *printer,
                    const eda_spectrum *mask, double defocus, eda_field *out,
                    opc_error *error) {
  const eda_litho *litho = &printer->litho.functions;
  if (defocus == 0)
    return litho->image(&printer->litho, EDA_POLY, mask, out, error);
  if (!litho->image_at)
    return opc_fail(error, OPC_INVALID, "defocus",
                    "'%s' has one focus only: say defocus: [0 nm]",
                    w->litho->id);
  return litho->image_at(&printer->litho, EDA_POLY, mask, defocus, out, error);
}

static int cut_focus(const window *w, const eda_printer *printer,
                     const eda_spectrum *mask, size_t focus, opc_error *error) {
  opc_progress progress = {
      .done = (double)focus, .total = (double)w->focus.count, .worst = NAN};
  w->host->progress(w->host, &progress);
  if (opc_cancelled(w->host->context))
    return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  eda_field image = {0};
  int code = image_at(w, printer, mask, w->focus.values[focus], &image, error);
  for (size_t d = 0; d < w->dose.count && !code; d++)
    code = cut_dose(w, printer, &image, focus, d, error);
  eda_field_clear(&image);
  return code;
}

static int cut_all(const window *w, const eda_shapes *shapes,
                   opc_error *error) {
  eda_printer printer;
  eda_spectrum mask = {0};
  eda_printer_init(&printer, w->host->context, w->gates, w->litho, w->resist,
                   w->margin);
  int code = eda_printer_prepare(&printer, error);
  if (!code) code = eda_printer_spectrum(&printer, shapes, &mask, error);
  for (size_t f = 0; f < w->focus.count && !code; f++)
    code = cut_focus(w, &printer, &mask, f, error);
  eda_spectrum_clear(&mask);
  eda_printer_clear(&printer);
  return code;
}

/* ---- work: tables and metrics ---- */

window_summary window_summarise(const window *w, size_t focus, size_t dose) {
  window_summary s = {0, INFINITY, -INFINITY, INFINITY, 0};
  size_t n = w->gates->count;
  const eda_section *cuts = w->cuts + (focus * w->dose.count + dose) * n;
  double good = 0;
  for (size_t i = 0; i < n; i++) {
    eda_section c = cuts[i];
    double drawn = w->gates->length[i];
    if (isnan(c.length)) {
      s.failed++;
      continue;
    }
    good++;
    s.mean += c.length - drawn;
    s.min = fmin(s.min, c.length - drawn);
    s.max = fmax(s.max, c.length - drawn);
    s.nils = fmin(s.nils, drawn * fmin(c.low, c.high));
  }
  if (good == 0) return (window_summary){NAN, NAN, NAN, NAN, s.failed};
  s.mean /= good;
  return s;
}

static int window_table(const window *w, opc_error *error) {
  typedef struct row {
    double defocus, dose;
    window_summary s;
    int64_t failed;
  } row;
  size_t prints = w->focus.count * w->dose.count;
  row *rows = eda_alloc(prints, sizeof *rows);
  for (size_t k = 0; k < prints; k++) {
    size_t f = k / w->dose.count, d = k % w->dose.count;
    window_summary s = window_summarise(w, f, d);
    rows[k] =
        (row){w->focus.values[f], w->dose.values[d], s, (int64_t)s.failed};
  }
  const opc_column columns[] = {{"defocus", "nm", OPC_REAL, -1, &rows->defocus},
                                {"dose", "%", OPC_REAL, -1, &rows->dose},
                                {"mean", "nm", OPC_REAL, 2, &rows->s.mean},
                                {"min", "nm", OPC_REAL, 2, &rows->s.min},
                                {"max", "nm", OPC_REAL, 2, &rows->s.max},
                                {"nils", NULL, OPC_REAL, 3, &rows->s.nils},
                                {"failed", NULL, OPC_INT, 0, &rows->failed}};
  int code = opc_put_rows(w->host, "process_window", OPC_TABLE_PRINT, prints,
                          sizeof *rows, OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static double latitude(const window *w, size_t focus) {
  return isnan(w->low[focus]) ? 0 : w->high[focus] - w->low[focus];
}

static int latitude_table(const window *w, opc_error *error) {
  double *range = eda_alloc(w->focus.count, sizeof *range);
  for (size_t f = 0; f < w->focus.count; f++) range[f] = latitude(w, f);
  const opc_column columns[] = {
      {"defocus", "nm", OPC_REAL, -1, w->focus.values},
      {"lowest_dose", "%", OPC_REAL, 2, w->low},
      {"highest_dose", "%", OPC_REAL, 2, w->high},
      {"latitude", "%", OPC_REAL, 2, range}};
  int code = w->host->table(w->host, "exposure_latitude", OPC_TABLE_PRINT,
                            w->focus.count, OPC_ARRAY(columns), error);
  free(range);
  return code;
}

static int cut_table(const window *w, opc_error *error) {
  typedef struct row {
    double x, y, defocus, dose, drawn;
    eda_section cut;
    double nils;
  } row;
  const eda_gates *g = w->gates;
  size_t n = w->focus.count * w->dose.count * g->count;
  row *rows = eda_alloc(n, sizeof *rows);
  for (size_t k = 0; k < n; k++) {
    size_t i = k % g->count, place = k / g->count;
    eda_section cut = w->cuts[k];
    rows[k] = (row){((double)g->box[i].x0 + g->box[i].x1) / 2 * g->grid,
                    ((double)g->box[i].y0 + g->box[i].y1) / 2 * g->grid,
                    w->focus.values[place / w->dose.count],
                    w->dose.values[place % w->dose.count],
                    g->length[i],
                    cut,
                    g->length[i] * fmin(cut.low, cut.high)};
  }
  const opc_column columns[] = {
      {"x", "nm", OPC_REAL, -1, &rows->x},
      {"y", "nm", OPC_REAL, -1, &rows->y},
      {"defocus", "nm", OPC_REAL, -1, &rows->defocus},
      {"dose", "%", OPC_REAL, -1, &rows->dose},
      {"drawn", "nm", OPC_REAL, -1, &rows->drawn},
      {"printed", "nm", OPC_REAL, 3, &rows->cut.length},
      {"ils_low", "1/nm", OPC_REAL, 6, &rows->cut.low},
      {"ils_high", "1/nm", OPC_REAL, 6, &rows->cut.high},
      {"nils", NULL, OPC_REAL, 4, &rows->nils}};
  int code = opc_put_rows(w->host, "cut_lines", 0, n, sizeof *rows,
                          OPC_ARRAY(columns), error);
  free(rows);
  return code;
}

static int report(const window *w, opc_error *error) {
  size_t prints = w->focus.count * w->dose.count;
  double most = 0, nils = INFINITY, failed = 0;
  for (size_t f = 0; f < w->focus.count; f++) most = fmax(most, latitude(w, f));
  for (size_t k = 0; k < prints; k++) {
    window_summary s =
        window_summarise(w, k / w->dose.count, k % w->dose.count);
    nils = fmin(nils, s.nils); /* not if it is NAN */
    failed = fmax(failed, s.failed);
  }
  double depth = isnan(w->depth_low) ? 0 : w->depth_high - w->depth_low;
  int code = window_table(w, error);
  if (!code) code = latitude_table(w, error);
  if (!code && w->cut_lines) code = cut_table(w, error);
  const opc_metric_value values[] = {{"exposure_latitude", most},
                                     {"depth_of_focus", depth},
                                     {isfinite(nils) ? "nils_min" : NULL, nils},
                                     {"failed_max", failed}};
  return code ? code : opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

/* ---- work: a run ---- */

static int run(void *self, void **outputs, opc_error *error) {
  window *w = self;
  size_t prints = w->dose.count * w->focus.count;
  (void)outputs;
  if (!w->mask == !w->as_drawn)
    return opc_fail(error, OPC_INVALID, "mask",
                    "one of 'mask' and 'gates' is needed, and not both");
  w->gates = w->mask ? w->mask->gates : w->as_drawn;
  if (!w->gates->count)
    return opc_fail(error, OPC_INVALID, w->mask ? "mask" : "gates",
                    "there are no transistors to measure");
  for (size_t d = 0; d < w->dose.count; d++)
    if (fabs(w->dose.values[d]) < fabs(w->dose.values[w->nominal]))
      w->nominal = d;
  w->cuts = eda_alloc(prints * w->gates->count, sizeof *w->cuts);
  w->low = eda_alloc(w->focus.count, sizeof *w->low);
  w->high = eda_alloc(w->focus.count, sizeof *w->high);
  const eda_shapes *shapes = w->mask ? w->mask->shapes : w->gates->drawn;
  if (cut_all(w, &shapes[EDA_POLY], error)) return error->code;
  window_limits(w);
  int code = report(w, error);
  return code ? code : window_draw(w, error);
}

static int forecast(void *self, opc_forecast *out, opc_error *error) {
  const window *w = self;
  const eda_gates *gates = w->mask ? w->mask->gates : w->as_drawn;
  eda_printer printer;
  (void)error;
  if (!gates) return OPC_OK; /* run says so */
  eda_printer_init(&printer, w->host->context, gates, w->litho, w->resist,
                   w->margin);
  eda_image_size one = eda_printer_forecast(&printer, 1);
  eda_printer_clear(&printer);
  out->memory = one.bytes + (double)(w->dose.count * w->focus.count) *
                                (double)gates->count * sizeof *w->cuts;
  (void)snprintf(out->work, sizeof out->work,
                 "%zu images of about %.0f x %.0f points, %zu prints",
                 w->focus.count, one.columns, one.rows,
                 w->focus.count * w->dose.count);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller 'margin', fewer values of 'dose' and 'defocus', or "
                 "part of the layout");
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(window, mask, .type = OPC_INPUT, .choices = "mask",
                  .summary = "a corrected mask whose gates are measured"),
    OPC_PARAMETER_NAMED("gates", window, as_drawn, .type = OPC_INPUT,
                        .choices = "gates",
                        .summary = "in its place: gates on the mask as drawn"),
    OPC_PARAMETER(window, litho, .type = OPC_SLOT, .flags = OPC_REQUIRED,
                  .choices = "litho", .summary = "model of the optics"),
    OPC_PARAMETER(window, resist, .type = OPC_SLOT, .flags = OPC_REQUIRED,
                  .choices = "resist",
                  .summary = "model of the resist, calibrated at 0 % and 0 nm"),
    OPC_PARAMETER(window, dose, .type = OPC_REALS, .unit = "%",
                  .preset = "[-8 %, -4 %, 0 %, 4 %, 8 %]",
                  .summary = "more or less light, increasing"),
    OPC_PARAMETER_NAMED(
        "defocus", window, focus, .type = OPC_REALS, .unit = "nm",
        .preset = "[-100 nm, -50 nm, 0 nm, 50 nm, 100 nm]",
        .summary = "distances from the focus of litho, increasing"),
    OPC_PARAMETER(window, tolerance, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "%", .preset = "10 %", .min = 0,
                  .summary = "of the drawn length, that a print may be off by"),
    OPC_PARAMETER(
        window, margin, .type = OPC_REAL, .flags = OPC_AT_LEAST, .unit = "nm",
        .preset = "1000 nm", .min = 0,
        .summary = "clear field around the layout, which repeats beyond"),
    OPC_PARAMETER(window, cut_lines, .type = OPC_BOOL, .preset = "false",
                  .summary = "whether to write a table of every gate's cuts"),
    OPC_PARAMETER(window, file, .type = OPC_OUTPUT,
                  .preset = "process_window.png",
                  .summary = "the picture, .png, .svg or .pdf"),
};

static const opc_metric metrics[] = {
    {"exposure_latitude", "%", OPC_HIGHER, 0.05,
     "range of dose within tolerance, at the focus with most"},
    {"depth_of_focus", "nm", OPC_HIGHER, 0.5,
     "range of focus within tolerance, at the dose nearest to 0 %"},
    {"nils_min", NULL, OPC_HIGHER, 0.001,
     "least normalised image log slope of all gates and prints"},
    {"failed_max", NULL, OPC_LOWER, 0,
     "gates that are open or merged, in the worst print"},
};

static int check_list(const char *name, opc_reals list, double above,
                      opc_error *error) {
  const double *v = list.values;
  if (!list.count || list.count > MAX_PLACES)
    return opc_fail(error, OPC_INVALID, name,
                    "'%s' needs 1 to %d values, not %zu", name, MAX_PLACES,
                    list.count);
  for (size_t i = 0; i < list.count; i++)
    if (!isfinite(v[i]) || v[i] <= above)
      return opc_fail(error, OPC_INVALID, name, "'%s' of %g is out of range",
                      name, v[i]);
  for (size_t i = 1; i < list.count; i++)
    if (!(v[i] > v[i - 1]))
      return opc_fail(error, OPC_INVALID, name,
                      "'%s' must increase, %g comes after %g", name, v[i],
                      v[i - 1]);
  return OPC_OK;
}

static int check(void *self, opc_error *error) {
  const window *w = self;
  if (check_list("dose", w->dose, -100, error) ||
      check_list("defocus", w->focus, -1e6, error))
    return error->code;
  return eda_paper_check(w->file, "file", error);
}

static void clear(void *self) {
  window *w = self;
  free(w->cuts);
  free(w->low);
  free(w->high);
}

/* ---- entry ---- */

static const opc_step functions = {.run = run, .forecast = forecast};

OPC_PLUGIN(window, .id = "process.window", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "gate lengths and image slopes through dose and focus",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = check,
           .clear = clear, OPC_FUNCTIONS(functions));
