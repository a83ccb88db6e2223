/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulates the contours at each focus and dose, for displaced images of
   active, and for masks with moved edges. A change of the dose scales an image;
   another focus or mask requires a new image. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "window.h"

enum { LAYERS = 2 }; /* EDA_POLY, EDA_ACTIVE */

/* State of the simulations of a part of the mask. Without an extractor, active
   is not simulated. */
typedef struct exposure {
  window *w;
  const eda_mask_part *part;
  const eda_gates *gates; /* of the part */
  uint32_t *count;        /* [gates], transistors that a gate represents */
  eda_performance design; /* [gates], as drawn; set if an extractor exists */
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
  window_print *out;
} cutter;

static void cut_gate(void *data, size_t i) {
  const cutter *c = data;
  if (!c->e->count[i]) return;
  c->out->cuts[eda_mask_part_gate(c->e->part, i)] =
      eda_gate_section(c->e->gates, i, EDA_POLY, &c->e->print[EDA_POLY],
                       &c->e->scaled[EDA_POLY]);
}

static double log_ratio(double printed, double drawn, int failed) {
  return failed || !(printed > 0) ? NAN : log(printed / drawn);
}

static int exposure_measure(exposure *e, window_print *out, opc_error *error) {
  const window *w = e->w;
  const eda_performance *p = &e->measured.performance;
  int code =
      eda_measure_short(w->host->context, e->gates, e->print, w->extractor,
                        e->count, &e->measured, &out->slices, error);
  for (size_t i = 0; i < e->gates->count && !code; i++) {
    size_t k = eda_mask_part_gate(e->part, i);
    int failed = eda_print_failed(e->measured.flags[i]);
    if (!e->count[i]) continue;
    out->ion[k] = log_ratio(p->ion[i], e->design.ion[i], failed);
    out->ioff[k] = log_ratio(p->ioff[i], e->design.ioff[i], failed);
  }
  if (!code)
    eda_spread_add(&out->sums, e->gates, e->count, &e->design, p,
                   e->measured.flags);
  return code;
}

/* Evaluate the images at a dose (%), with the image of active displaced by the
   overlay. */
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
  cutter c = {e, out};
  if (!code) opc_parallel(w->host->context, e->gates->count, cut_gate, &c);
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
  const eda_gates *g = e->gates;
  const eda_mask *mask = e->part->mask;
  const eda_shapes *all = mask && g->corrected[layer] ? mask->shapes : g->drawn;
  eda_shapes moved;
  int32_t steps = (int32_t)lround(by / g->grid);
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

static int go_on(const exposure *e, size_t done, opc_error *error) {
  const window *w = e->w;
  size_t each = w->focus.count + w->mask_error.count;
  opc_progress progress = {.done = (double)(e->part->index * each + done),
                           .total = (double)(e->part->count * each),
                           .worst = NAN};
  w->host->progress(w->host, &progress);
  if (!opc_cancelled(w->host->context)) return OPC_OK;
  return opc_fail(error, OPC_CANCELLED, NULL, "stopped");
}

static int all_places(exposure *e, opc_error *error) {
  window *w = e->w;
  int code = take_masks(e, 0, error);
  for (size_t f = 0; f < w->focus.count && !code; f++) {
    code = go_on(e, f, error);
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
    code = go_on(e, w->focus.count + k, error);
    if (!code) code = take_masks(e, w->mask_error.values[k], error);
    if (!code) code = image_at(e, w->focus.values[w->nominal_focus], error);
    if (!code)
      code = print_at(e, w->dose.values[w->nominal_dose], aligned, &w->wrong[k],
                      error);
  }
  return code;
}

static int exposure_prepare(exposure *e, opc_error *error) {
  const window *w = e->w;
  int code = eda_printer_prepare(&e->printer, error);
  if (code || !w->extractor) return code;
  code = eda_extractor_prepare(w->host->context, w->extractor, error);
  return code ? code
              : eda_measure_drawn(w->host->context, e->gates, w->extractor,
                                  &e->design, error);
}

/* Simulate all conditions of a part of the mask. */
static int part_expose(void *data, const eda_mask_part *part,
                       opc_error *error) {
  window *w = data;
  const eda_gates *g = part->mask ? part->mask->gates : w->gates;
  exposure e = {.w = w,
                .part = part,
                .gates = g,
                .count = eda_alloc(g->count, sizeof *e.count),
                .layers = w->extractor ? LAYERS : 1,
                .print = eda_alloc(g->layers, sizeof *e.print)};
  for (size_t i = 0; i < g->count; i++) {
    size_t k = eda_mask_part_gate(part, i);
    e.count[i] = k == UINT32_MAX ? 0 : (uint32_t)window_count(w, k);
  }
  eda_performance_init(&e.design, g->count);
  eda_measurement_init(&e.measured, g->count);
  eda_printer_init(&e.printer, w->host->context, g, w->litho, w->resist,
                   isnan(part->clear) ? w->margin : part->clear);
  if (part->gate) e.printer.drawn = NULL; /* all parts share one calibration */
  int code = exposure_prepare(&e, error);
  if (!code) code = all_places(&e, error);
  if (!code) code = all_overlays(&e, error);
  if (!code) code = all_mask_errors(&e, error);
  clear_images(&e);
  for (size_t k = 0; k < e.layers; k++) eda_spectrum_clear(&e.mask[k]);
  eda_measurement_clear(&e.measured);
  eda_performance_clear(&e.design);
  eda_printer_clear(&e.printer);
  free(e.print);
  free(e.count);
  return code;
}

static window_print *prints_new(const window *w, size_t n) {
  window_print *out = eda_alloc(n, sizeof *out);
  for (size_t k = 0; k < n; k++) {
    out[k].cuts = eda_alloc(w->gates->count, sizeof *out->cuts);
    if (!w->extractor) continue;
    out[k].ion = eda_alloc(w->gates->count, sizeof *out->ion);
    out[k].ioff = eda_alloc(w->gates->count, sizeof *out->ioff);
  }
  return out;
}

static void prints_end(window_print *prints, size_t n) {
  for (size_t k = 0; k < n; k++)
    prints[k].spread = eda_spread_end(&prints[k].sums);
}

int window_expose(window *w, opc_error *error) {
  const eda_mask_part drawn = {.clear = NAN, .count = 1};
  size_t prints = w->focus.count * w->dose.count;
  w->print = prints_new(w, prints);
  w->wrong = prints_new(w, w->mask_error.count);
  w->shifted = prints_new(w, window_overlays(w));
  int code =
      w->mask ? eda_mask_each_class(w->mask, w->margin, part_expose, w, error)
              : part_expose(w, &drawn, error);
  prints_end(w->print, prints);
  prints_end(w->wrong, w->mask_error.count);
  prints_end(w->shifted, window_overlays(w));
  return code;
}
