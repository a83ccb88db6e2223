/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulation of masks by layer: spectrum, image, level set. */
#include <eda/memory.h>
#include <eda/print.h>
#include <stdlib.h>
#include <string.h>

#include "imaging/fft.h"

void eda_printer_init(eda_printer *p, const opc_context *context,
                      const eda_gates *gates, const opc_module *litho,
                      const opc_module *resist, double margin) {
  eda_box b = gates->extent;
  double grid = gates->grid;
  *p = (eda_printer){
      .context = context,
      .resist = resist,
      .grid = grid,
      .layers = gates->layers,
      .drawn = gates,
      .print = eda_alloc(gates->layers, sizeof *p->print),
      .image = eda_alloc(gates->layers, sizeof *p->image),
      .difference = eda_alloc(gates->layers, sizeof *p->difference),
      .is_fine = eda_alloc(gates->layers, 1),
      .fine_of = eda_alloc(gates->layers, sizeof *p->fine_of)};
  p->frame = (eda_frame){b.x0 * grid - margin, b.y0 * grid - margin,
                         ((double)b.x1 - b.x0) * grid + 2 * margin,
                         ((double)b.y1 - b.y0) * grid + 2 * margin};
  eda_model_init(&p->litho, context, litho);
}

/* Attribute an error to the resist, or to the litho model if the model failed
   while the resist called the model. */
static int blame_resist(const eda_printer *p, int code, opc_error *error) {
  if (!code || !p->litho.failed) return eda_blame(error, code, "resist");
  *error = p->litho.fault;
  return error->code;
}

int eda_printer_prepare(eda_printer *p, opc_error *error) {
  const eda_resist *resist = p->resist->functions;
  int code = p->litho.functions.prepare(&p->litho, error);
  if (code) return code;
  if (!p->litho.functions.image_fine) p->fine = 0;
  p->litho.fine = p->fine;
  const char *before = eda_enter(p->context, p->resist, error);
  if (p->drawn && resist->drawn) resist->drawn(p->resist->self, p->drawn);
  code = resist->prepare(p->resist->self, &p->litho.module, error);
  opc_leave(p->context, before);
  p->litho.fine = 0; /* each later simulation passes its own accuracy */
  return blame_resist(p, code, error);
}

eda_image_size eda_printer_forecast(const eda_printer *p, size_t layers) {
  double band = p->litho.functions.band(&p->litho);
  if (!(band > 0)) return (eda_image_size){0};
  eda_image_size one = eda_image_forecast(p->frame, band);
  /* Memory of the last image (`image`) and of `difference`. */
  if (p->fine > 0 && p->litho.functions.image_fine) one.bytes += 2 * one.field;
  one.bytes *= (double)layers;
  one.field *= (double)layers;
  return one;
}

int eda_printer_spectrum(const eda_printer *p, const eda_shapes *mask,
                         eda_spectrum *out, opc_error *error) {
  return eda_litho_spectrum(p->context, &p->litho.module, mask, p->grid,
                            p->frame, out, error);
}

int eda_printer_develop(const eda_printer *p, int layer, eda_field *field,
                        opc_error *error) {
  int code = eda_call_print(p->context, p->resist, layer, field, error);
  return blame_resist(p, code, error);
}

/* Compute to = from + sign * by for each coefficient; `to` may equal `from` or
   `by`. */
static void field_add(eda_field *to, const eda_field *from, float sign,
                      const eda_field *by) {
  size_t n = (size_t)by->nx * (size_t)by->ny;
  for (size_t i = 0; i < n; i++)
    to->coefficients[i] = from->coefficients[i] + sign * by->coefficients[i];
}

/* Store a copy of the image before development; reuse allocated memory. */
static void keep_image(eda_printer *p, int layer, const eda_field *image) {
  eda_field *kept = &p->image[layer];
  size_t n = (size_t)image->nx * (size_t)image->ny;
  if (!kept->coefficients || kept->nx != image->nx || kept->ny != image->ny) {
    eda_field_clear(kept);
    *kept = eda_field_scaled(image, 1);
  } else {
    memcpy(kept->coefficients, image->coefficients, n * sizeof(float));
    kept->frame = image->frame;
  }
}

/* Return OPC_OK if two images have the same number of nodes. */
static int fields_match(const eda_field *a, const eda_field *b,
                        opc_error *error) {
  if (a->nx == b->nx && a->ny == b->ny) return OPC_OK;
  opc_fail(error, OPC_FAILED, NULL,
           "two images of one frame have %d x %d and %d x %d nodes", (int)a->nx,
           (int)a->ny, (int)b->nx, (int)b->ny);
  return eda_blame(error, error->code, "litho");
}

/* Add (accurate image `fine` - last image) of the same mask to the difference
   of the layer. add_difference adds the difference to later fast images. */
static int printer_learn(eda_printer *p, int layer, const eda_field *fine,
                         opc_error *error) {
  eda_field *last = &p->image[layer], *difference = &p->difference[layer];
  if (!last->coefficients) return OPC_OK;
  if (fields_match(fine, last, error)) return error->code;
  field_add(last, fine, -1, last);
  if (!difference->coefficients) {
    *difference = *last;
    *last = (eda_field){0};
  } else {
    field_add(difference, difference, 1, last);
  }
  return OPC_OK;
}

static int add_difference(const eda_printer *p, int layer, eda_field *image,
                          opc_error *error) {
  const eda_field *difference = &p->difference[layer];
  if (!difference->coefficients) return OPC_OK;
  if (fields_match(image, difference, error)) return error->code;
  field_add(image, image, 1, difference);
  return OPC_OK;
}

int eda_printer_correct(const eda_printer *p, int layer, eda_field *image,
                        opc_error *error) {
  int code = add_difference(p, layer, image, error);
  return code ? code : eda_printer_develop(p, layer, image, error);
}

int eda_printer_at_dose(const eda_printer *p, int layer, double factor,
                        eda_field *out, opc_error *error) {
  *out = eda_field_scaled(&p->image[layer], factor);
  return eda_printer_develop(p, layer, out, error);
}

/* Convert a new image of a layer to the level set, in place. If the image is
   accurate (`fine`), update the difference; otherwise add the difference. */
static int printer_settle(eda_printer *p, int layer, int fine, eda_field *print,
                          opc_error *error) {
  int code = fine ? printer_learn(p, layer, print, error)
                  : add_difference(p, layer, print, error);
  if (code) return code;
  if (p->fine > 0 || p->keeps) {
    keep_image(p, layer, print);
  }
  p->is_fine[layer] = (uint8_t)fine;
  return eda_printer_develop(p, layer, print, error);
}

static int print_layer(eda_printer *p, int layer, const eda_shapes *mask,
                       int fine, opc_error *error) {
  const eda_litho *litho = &p->litho.functions;
  eda_field *print = &p->print[layer];
  eda_field_clear(print);
  eda_spectrum spectrum;
  double within = p->fine_of[layer] > 0 ? p->fine_of[layer] : p->fine;
  int code = eda_printer_spectrum(p, mask, &spectrum, error);
  if (code) return code;
  if (fine)
    code = litho->image_fine(&p->litho, layer, &spectrum, p->defocus, within,
                             print, error);
  else if (p->defocus == 0)
    code = litho->image(&p->litho, layer, &spectrum, print, error);
  else
    code =
        litho->image_at(&p->litho, layer, &spectrum, p->defocus, print, error);
  eda_spectrum_clear(&spectrum);
  return code ? code : printer_settle(p, layer, fine, print, error);
}

/* Layers that are simulated in parallel, so that single-threaded parts of the
   simulations also use several threads. */
typedef struct prints {
  eda_printer *printer;
  const eda_shapes *mask;
  int fine;
  size_t count;
  int *layer; /* numbers of the layers */
} prints;

static int print_one(void *data, size_t i, opc_error *error) {
  prints *all = data;
  int layer = all->layer[i];
  return print_layer(all->printer, layer, &all->mask[layer], all->fine, error);
}

/* Simulate the layers with layers[i] = 1: fast if `fine` is 0; accurately if
   `fine` is 1, except layers whose level set is already accurate. Add the
   number of simulated layers to *simulations. */
static int print_all(eda_printer *p, const uint8_t *layers,
                     const eda_shapes *mask, int fine, uint32_t *simulations,
                     opc_error *error) {
  prints all = {p, mask, fine, 0, eda_alloc(p->layers, sizeof *all.layer)};
  for (size_t k = 0; k < p->layers; k++)
    if (layers[k] && !(fine && p->is_fine[k])) all.layer[all.count++] = (int)k;
  *simulations += (uint32_t)all.count;
  int code = eda_try_all(p->context, all.count, print_one, &all, error);
  free(all.layer);
  return code;
}

int eda_printer_print(eda_printer *p, const uint8_t *layers,
                      const eda_shapes *mask, opc_error *error) {
  return print_all(p, layers, mask, 0, &p->simulations, error);
}

int eda_printer_refine(eda_printer *p, const uint8_t *layers,
                       const eda_shapes *mask, opc_error *error) {
  if (!(p->fine > 0)) return OPC_OK;
  return print_all(p, layers, mask, 1, &p->fine_simulations, error);
}

void eda_printer_clear(eda_printer *p) {
  for (size_t k = 0; k < p->layers; k++) {
    eda_field_clear(&p->print[k]);
    eda_field_clear(&p->image[k]);
    eda_field_clear(&p->difference[k]);
  }
  free(p->print);
  free(p->image);
  free(p->difference);
  free(p->is_fine);
  free(p->fine_of);
  p->print = p->image = p->difference = NULL;
  p->is_fine = NULL;
  p->fine_of = NULL;
  eda_fft_trim();
  p->layers = 0;
}
