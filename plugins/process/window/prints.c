/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulates the contours at each focus and dose, for displaced images of
   active, and for masks with moved edges. A change of the dose scales an image;
   another focus or mask requires a new image. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "window.h"

enum { LAYERS = 2 }; /* EDA_POLY, EDA_ACTIVE */

/* State of the simulations of a mask. Without an extractor, active is not
   simulated. */
typedef struct exposure {
  window *w;
  eda_printer printer;
  size_t layers;
  eda_spectrum mask[LAYERS];
  eda_field image[LAYERS], scaled[LAYERS]; /* scaled: multiplied by the dose */
  eda_field *print;                        /* [gates->layers] */
  eda_measurement measured;
} exposure;

/* ---- one condition ---- */

typedef struct cutter {
  const exposure *e;
  eda_section *cuts;
} cutter;

static void cut_gate(void *data, size_t i) {
  const cutter *c = data;
  c->cuts[i] =
      eda_gate_section(c->e->w->gates, i, EDA_POLY, &c->e->print[EDA_POLY],
                       &c->e->scaled[EDA_POLY]);
}

static double log_ratio(double printed, double drawn, int failed) {
  return failed || !(printed > 0) ? NAN : log(printed / drawn);
}

static int exposure_measure(exposure *e, window_print *out, opc_error *error) {
  const window *w = e->w;
  const eda_performance *p = &e->measured.performance;
  int code = eda_measure(w->host->context, w->gates, e->print, w->extractor,
                         &e->measured, error);
  out->ion = eda_alloc(w->gates->count, sizeof *out->ion);
  out->ioff = eda_alloc(w->gates->count, sizeof *out->ioff);
  for (size_t i = 0; i < w->gates->count && !code; i++) {
    uint32_t flags = e->measured.flags[i];
    int failed = eda_print_failed(flags);
    out->ion[i] = log_ratio(p->ion[i], w->design.ion[i], failed);
    out->ioff[i] = log_ratio(p->ioff[i], w->design.ioff[i], failed);
  }
  if (!code)
    out->spread = eda_spread_of(w->gates, &w->design, p, e->measured.flags);
  return code;
}

/* Evaluate the images at a dose given in %, active displaced by the overlay. */
static int print_at(exposure *e, double dose, window_overlay overlay,
                    window_print *out, opc_error *error) {
  const window *w = e->w;
  int code = OPC_OK;
  for (size_t k = 0; k < e->layers && !code; k++) {
    e->scaled[k] = eda_field_scaled(&e->image[k], 1 + dose / 100);
    e->print[k] = eda_field_scaled(&e->scaled[k], 1);
    code = eda_printer_develop(&e->printer, (int)k, &e->print[k], error);
  }
  if (e->layers > EDA_ACTIVE)
    eda_field_shift(&e->print[EDA_ACTIVE], overlay.x, overlay.y);
  cutter c = {e, eda_alloc(w->gates->count, sizeof *c.cuts)};
  out->cuts = c.cuts;
  if (!code) opc_parallel(w->host->context, w->gates->count, cut_gate, &c);
  if (!code && w->extractor) code = exposure_measure(e, out, error);
  for (size_t k = 0; k < e->layers; k++) {
    eda_field_clear(&e->scaled[k]);
    eda_field_clear(&e->print[k]);
  }
  return code;
}

/* ---- images ---- */

static int image_layer(exposure *e, size_t layer, double defocus,
                       opc_error *error) {
  const eda_model *model = &e->printer.litho;
  const eda_litho *litho = &model->functions;
  eda_field *out = &e->image[layer];
  if (defocus == 0)
    return litho->image(model, (int)layer, &e->mask[layer], out, error);
  if (!litho->image_at)
    return opc_fail(error, OPC_INVALID, "defocus",
                    "'%s' has one focus only: set 'defocus: [0 nm]'",
                    e->w->litho->id);
  return litho->image_at(model, (int)layer, &e->mask[layer], defocus, out,
                         error);
}

static void clear_images(exposure *e) {
  for (size_t k = 0; k < e->layers; k++) eda_field_clear(&e->image[k]);
}

static int image_at(exposure *e, double defocus, opc_error *error) {
  int code = OPC_OK;
  clear_images(e);
  for (size_t k = 0; k < e->layers && !code; k++)
    code = image_layer(e, k, defocus, error);
  return code;
}

/* Set the mask to the shapes of a layer, all edges moved outward by `by` nm. */
static int take_mask(exposure *e, size_t layer, double by, opc_error *error) {
  const window *w = e->w;
  const eda_shapes *all =
      w->mask && w->gates->corrected[layer] ? w->mask->shapes : w->gates->drawn;
  eda_shapes moved;
  int32_t steps = (int32_t)lround(by / w->gates->grid);
  int code = eda_shapes_grow(&all[layer], steps, &moved, error);
  eda_spectrum_clear(&e->mask[layer]);
  if (!code)
    code = eda_printer_spectrum(&e->printer, &moved, &e->mask[layer], error);
  eda_shapes_clear(&moved);
  return code;
}

static int take_masks(exposure *e, double by, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < e->layers && !code; k++)
    code = take_mask(e, k, by, error);
  return code;
}

/* ---- all conditions ---- */

static const window_overlay aligned = {0, 0};

static int go_on(const window *w, size_t done, opc_error *error) {
  opc_progress progress = {
      .done = (double)done,
      .total = (double)(w->focus.count + w->mask_error.count),
      .worst = NAN};
  w->host->progress(w->host, &progress);
  if (!opc_cancelled(w->host->context)) return OPC_OK;
  return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
}

static int all_places(exposure *e, opc_error *error) {
  window *w = e->w;
  int code = take_masks(e, 0, error);
  for (size_t f = 0; f < w->focus.count && !code; f++) {
    code = go_on(w, f, error);
    if (!code) code = image_at(e, w->focus.values[f], error);
    for (size_t d = 0; d < w->dose.count && !code; d++)
      code = print_at(e, w->dose.values[d], aligned,
                      &w->print[f * w->dose.count + d], error);
  }
  return code;
}

static int all_overlays(exposure *e, opc_error *error) {
  window *w = e->w;
  if (!window_overlays(w)) return OPC_OK;
  int code = image_at(e, w->focus.values[w->nominal_focus], error);
  for (size_t k = 0; k < window_overlays(w) && !code; k++)
    code = print_at(e, w->dose.values[w->nominal_dose], window_overlay_at(w, k),
                    &w->shifted[k], error);
  return code;
}

static int all_mask_errors(exposure *e, opc_error *error) {
  window *w = e->w;
  int code = OPC_OK;
  for (size_t k = 0; k < w->mask_error.count && !code; k++) {
    code = go_on(w, w->focus.count + k, error);
    if (!code) code = take_masks(e, w->mask_error.values[k], error);
    if (!code) code = image_at(e, w->focus.values[w->nominal_focus], error);
    if (!code)
      code = print_at(e, w->dose.values[w->nominal_dose], aligned, &w->wrong[k],
                      error);
  }
  return code;
}

static int exposure_prepare(exposure *e, opc_error *error) {
  window *w = e->w;
  int code = eda_printer_prepare(&e->printer, error);
  if (code || !w->extractor) return code;
  eda_performance_init(&w->design, w->gates->count);
  code = eda_extractor_prepare(w->host->context, w->extractor, error);
  return code ? code
              : eda_measure_drawn(w->host->context, w->gates, w->extractor,
                                  &w->design, error);
}

int window_expose(window *w, opc_error *error) {
  exposure e = {.w = w, .layers = w->extractor ? LAYERS : 1};
  size_t n = w->gates->count;
  w->print = eda_alloc(w->focus.count * w->dose.count, sizeof *w->print);
  w->wrong = eda_alloc(w->mask_error.count, sizeof *w->wrong);
  w->shifted = eda_alloc(window_overlays(w), sizeof *w->shifted);
  e.print = eda_alloc(w->gates->layers, sizeof *e.print);
  eda_measurement_init(&e.measured, n);
  eda_printer_init(&e.printer, w->host->context, w->gates, w->litho, w->resist,
                   w->margin);
  int code = exposure_prepare(&e, error);
  if (!code) code = all_places(&e, error);
  if (!code) code = all_overlays(&e, error);
  if (!code) code = all_mask_errors(&e, error);
  clear_images(&e);
  for (size_t k = 0; k < e.layers; k++) eda_spectrum_clear(&e.mask[k]);
  eda_measurement_clear(&e.measured);
  eda_printer_clear(&e.printer);
  free(e.print);
  return code;
}
