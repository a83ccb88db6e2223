/* SPDX-License-Identifier: BSD-3-Clause */
/* Printing the masks of some layers: spectrum, image, level set. */
#include <eda/memory.h>
#include <eda/print.h>
#include <stdlib.h>

#include "gates/fence.h"

void eda_printer_init(eda_printer *p, const opc_context *context,
                      const eda_gates *gates, const opc_module *litho,
                      const opc_module *resist, double margin) {
  eda_box b = gates->extent;
  double grid = gates->grid;
  *p = (eda_printer){.context = context,
                     .resist = resist,
                     .grid = grid,
                     .layers = gates->layers,
                     .print = eda_alloc(gates->layers, sizeof *p->print)};
  p->frame = (eda_frame){b.x0 * grid - margin, b.y0 * grid - margin,
                         ((double)b.x1 - b.x0) * grid + 2 * margin,
                         ((double)b.y1 - b.y0) * grid + 2 * margin};
  eda_model_init(&p->litho, context, litho);
}

/* An error of the resist, unless it is what the litho model told it. */
static int blame_resist(const eda_printer *p, int code, opc_error *error) {
  if (!code || !p->litho.failed) return eda_blame(error, code, "resist");
  *error = p->litho.fault;
  return error->code;
}

int eda_printer_prepare(eda_printer *p, opc_error *error) {
  const eda_resist *resist = p->resist->functions;
  int code = p->litho.functions.prepare(&p->litho, error);
  if (code) return code;
  const char *before = eda_enter(p->context, p->resist, error);
  code = resist->prepare(p->resist->self, &p->litho.module, error);
  opc_leave(p->context, before);
  return blame_resist(p, code, error);
}

eda_image_size eda_printer_forecast(const eda_printer *p, size_t layers) {
  double band = p->litho.functions.band(&p->litho);
  if (!(band > 0)) return (eda_image_size){0};
  eda_image_size one = eda_image_forecast(p->frame, band);
  one.bytes *= (double)layers;
  return one;
}

int eda_printer_spectrum(const eda_printer *p, const eda_shapes *mask,
                         eda_spectrum *out, opc_error *error) {
  return eda_litho_spectrum(p->context, &p->litho.module, mask, p->grid,
                            p->frame, out, error);
}

int eda_printer_develop(const eda_printer *p, int layer, eda_field *field,
                        opc_error *error) {
  const eda_resist *resist = p->resist->functions;
  fence_field(field);
  const float *values = field->coefficients;
  size_t n = (size_t)field->nx * (size_t)field->ny;
  const char *before = eda_enter(p->context, p->resist, error);
  int code = resist->print(p->resist->self, layer, field, error);
  /* It may have put others in their place. */
  if (!code && field->coefficients == values)
    code = fence_check_field(values, n, "level sets", error);
  if (!code) code = eda_check_field(field, &p->frame, "level set", error);
  opc_leave(p->context, before);
  return blame_resist(p, code, error);
}

static int print_layer(eda_printer *p, int layer, const eda_shapes *mask,
                       opc_error *error) {
  eda_field *print = &p->print[layer];
  eda_field_clear(print);
  eda_spectrum spectrum;
  int code = eda_printer_spectrum(p, mask, &spectrum, error);
  if (code) return code;
  code = p->litho.functions.image(&p->litho, layer, &spectrum, print, error);
  eda_spectrum_clear(&spectrum);
  return code ? code : eda_printer_develop(p, layer, print, error);
}

/* The layers to print, side by side: what of a print is not for several
   threads is then done for all at once. */
typedef struct prints {
  eda_printer *printer;
  const eda_shapes *mask;
  int *layer; /* those to print */
} prints;

static int print_one(void *data, size_t i, opc_error *error) {
  prints *all = data;
  int layer = all->layer[i];
  return print_layer(all->printer, layer, &all->mask[layer], error);
}

int eda_printer_print(eda_printer *p, const uint8_t *layers,
                      const eda_shapes *mask, opc_error *error) {
  prints all = {p, mask, eda_alloc(p->layers, sizeof *all.layer)};
  size_t n = 0;
  for (size_t k = 0; k < p->layers; k++)
    if (layers[k]) all.layer[n++] = (int)k;
  p->simulations += (uint32_t)n;
  int code = eda_try_all(p->context, n, print_one, &all, error);
  free(all.layer);
  return code;
}

void eda_printer_clear(eda_printer *p) {
  for (size_t k = 0; k < p->layers; k++) eda_field_clear(&p->print[k]);
  free(p->print);
  p->print = NULL;
  p->layers = 0;
}
