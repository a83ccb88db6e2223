/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds extractor, resist and litho in Python. Their functions may be called
   from several threads; the worker computes one call at a time. */
#include <string.h>

#include "py.h"

/* ---- extractor ---- */

static int extractor_prepare(void *self, opc_error *error) {
  py_instance *in = self;
  size_t n = 0, shares = 0;
  int code = py_ask(in, "prepare", error);
  if (code) return code;
  const double *place = py_new_array(in->worker, "place", "f8", &n);
  const double *width = py_new_array(in->worker, "width", "f8", &shares);
  if (!place || !width || !n || n != shares)
    return opc_fail(error, OPC_FAILED, NULL,
                    "'%s': 'slicing' returned %zu places and %zu widths",
                    in->plugin->id, n, shares);
  g_free(in->place);
  g_free(in->width);
  in->place = g_memdup2(place, n * sizeof *place);
  in->width = g_memdup2(width, n * sizeof *width);
  in->slices = n;
  return OPC_OK;
}

static size_t extractor_slicing(const void *self, const double **place,
                                const double **width) {
  const py_instance *in = self;
  *place = in->place;
  *width = in->width;
  return in->slices;
}

static int extractor_extract(const void *self, const eda_slices *s,
                             eda_performance *out, opc_error *error) {
  py_instance *in = (py_instance *)self;
  g_autoptr(GMutexLocker) locker = g_mutex_locker_new(&in->lock);
  py_worker *w = s->count ? py_open(in, "extract", 0, error) : NULL;
  if (!w) return s->count ? error->code : OPC_OK;
  py_begin(w, "slices", '{');
  py_put_texts(w, "flavour", s->flavour, s->count);
  py_put_array(w, "type", "u1", s->count, 0, s->type);
  py_put_array(w, "width", "f8", s->count, s->slices, s->width);
  py_put_array(w, "length", "f8", s->count, s->slices, s->length);
  py_put_array(w, "edge", "f8", s->count, s->slices, s->edge);
  py_end(w, '}');
  py_begin(w, "out", '{');
  py_put_table(w, &py_performance, s->count, out, 1);
  py_end(w, '}');
  return py_send(in, NULL, error);
}

void py_extractor_set(py_plugin *p) {
  *PY_FUNCTIONS(p, extractor) = (eda_extractor){.prepare = extractor_prepare,
                                                .slicing = extractor_slicing,
                                                .extract = extractor_extract};
}

/* ---- resist ---- */

static int resist_prepare(void *self, const opc_module *litho,
                          opc_error *error) {
  py_instance *in = self;
  py_worker *w = py_open(in, "prepare", 1, error);
  if (!w) return error->code;
  py_put_scanner(w, eda_scanner_of(litho));
  return py_send(in, NULL, error);
}

static int resist_print(const void *self, int layer, eda_field *field,
                        opc_error *error) {
  py_instance *in = (py_instance *)self;
  eda_field_samples(in->host->context, field);
  g_autoptr(GMutexLocker) locker = g_mutex_locker_new(&in->lock);
  py_worker *w = py_open(in, "print", 0, error);
  if (!w) return error->code;
  py_put_int(w, "layer", layer);
  py_begin(w, "image", '{');
  py_put_frame(w, field->frame);
  py_lend_array(w, "values", "f4", (size_t)field->ny, (size_t)field->nx,
                field->coefficients);
  py_end(w, '}');
  int code = py_send(in, NULL, error);
  if (!code) eda_field_from_samples(in->host->context, field);
  return code;
}

void py_resist_set(py_plugin *p) {
  *PY_FUNCTIONS(p, resist) =
      (eda_resist){.prepare = resist_prepare, .print = resist_print};
}

/* ---- litho ---- */

static int litho_prepare(void *self, opc_error *error) {
  py_instance *in = self;
  int code = py_ask(in, "prepare", error);
  if (!code) in->band = py_number(py_result(in->worker), "band");
  return code;
}

static double litho_band(const void *self) {
  return ((const py_instance *)self)->band;
}

/* Copy the image of the reply, values at nodes, to *out. */
static int take_image(py_instance *in, eda_frame frame, eda_field *out,
                      opc_error *error) {
  size_t n = 0;
  const float *values = py_new_array(in->worker, "image", "f4", &n);
  size_t nx = (size_t)py_number(py_result(in->worker), "nx");
  if (!values || !nx || !n || n % nx)
    return opc_fail(error, OPC_FAILED, NULL, "'%s': 'image' returned no image",
                    in->plugin->id);
  *out = (eda_field){frame, (int32_t)nx, (int32_t)(n / nx),
                     g_memdup2(values, n * sizeof *values)};
  return OPC_OK;
}

static int litho_image_at(const void *self, int layer, const eda_spectrum *mask,
                          double defocus, eda_field *out, opc_error *error) {
  py_instance *in = (py_instance *)self;
  g_autoptr(GMutexLocker) locker = g_mutex_locker_new(&in->lock);
  py_worker *w = py_open(in, "image", 0, error);
  if (!w) return error->code;
  py_put_int(w, "layer", layer);
  py_put_number(w, "defocus", defocus);
  py_begin(w, "mask", '{');
  py_put_number(w, "band", mask->band);
  py_put_frame(w, mask->frame);
  py_put_array(w, "spectrum", "f4", (size_t)mask->rows,
               2 * (size_t)mask->columns, mask->data);
  py_end(w, '}');
  int code = py_send(in, NULL, error);
  if (!code) code = take_image(in, mask->frame, out, error);
  if (!code) eda_field_from_samples(in->host->context, out);
  return code;
}

static int litho_image(const void *self, int layer, const eda_spectrum *mask,
                       eda_field *out, opc_error *error) {
  return litho_image_at(self, layer, mask, 0, out, error);
}

/* A failure is logged, because the function of the kind cannot fail. */
static eda_scanner litho_scanner(const void *self) {
  py_instance *in = (py_instance *)self;
  opc_error error;
  g_autoptr(GMutexLocker) locker = g_mutex_locker_new(&in->lock);
  if (!py_ask(in, "scanner", &error))
    return (eda_scanner){py_number(py_result(in->worker), "wavelength"),
                         py_number(py_result(in->worker), "na")};
  in->host->log(in->host, OPC_LOG_WARNING, "%s", error.message);
  return (eda_scanner){0};
}

void py_litho_set(py_plugin *p) {
  *PY_FUNCTIONS(p, litho) =
      (eda_litho){.prepare = litho_prepare,
                  .band = litho_band,
                  .image = litho_image,
                  .image_at = py_defines(p, "focuses") ? litho_image_at : NULL,
                  .scanner = py_defines(p, "scanner") ? litho_scanner : NULL};
}
