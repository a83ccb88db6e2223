/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds extractor, resist and litho in Python. Their functions may be called
   from several threads; the worker computes one call at a time. */
#include <string.h>

#include "py.h"

/* ---- extractor ---- */

/* Return a copy of an array of the reply with `*n` elements (g_free); if *n is
   0, set *n. */
static double *take_array(const py_instance *in, const char *name, size_t *n,
                          opc_error *error) {
  size_t count = 0;
  const double *data = py_new_array(in->worker, name, "f8", &count);
  if (data && count && (!*n || *n == count)) {
    *n = count;
    return g_memdup2(data, count * sizeof *data);
  }
  opc_fail(error, OPC_FAILED, NULL,
           "'%s': 'slicing' returned %zu values of '%s', expected %zu",
           in->plugin->id, count, name, *n);
  return NULL;
}

static int extractor_prepare(void *self, opc_error *error) {
  py_instance *in = self;
  py_worker *w = py_open(in, "prepare", 1, error);
  int code = w ? py_send(in, NULL, error) : error->code;
  if (code) return code;
  g_clear_pointer(&in->place, g_free);
  g_clear_pointer(&in->width, g_free);
  in->slices = 0;
  in->place = take_array(in, "place", &in->slices, error);
  if (in->place) in->width = take_array(in, "width", &in->slices, error);
  return in->width ? OPC_OK : error->code;
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
  JsonObject *o = py_object(py_values(w), "slices");
  py_add_texts(o, "flavour", s->flavour, s->count);
  py_add_array(w, o, "type", "u1", s->count, 0, s->type);
  py_add_array(w, o, "width", "f8", s->count, s->slices, s->width);
  py_add_array(w, o, "length", "f8", s->count, s->slices, s->length);
  py_add_array(w, o, "edge", "f8", s->count, s->slices, s->edge);
  JsonObject *to =
      py_add_table(w, py_values(w), "out", &py_performance, s->count, out);
  int code = py_send(in, NULL, error);
  if (!code) py_get_table(w, to, &py_performance, out);
  return code;
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
  py_add_scanner(py_values(w), eda_scanner_of(litho));
  return py_send(in, NULL, error);
}

static int resist_print(const void *self, int layer, eda_field *field,
                        opc_error *error) {
  py_instance *in = (py_instance *)self;
  eda_field_samples(in->host->context, field);
  g_autoptr(GMutexLocker) locker = g_mutex_locker_new(&in->lock);
  py_worker *w = py_open(in, "print", 0, error);
  if (!w) return error->code;
  JsonObject *o = py_object(py_values(w), "image");
  json_object_set_int_member(py_values(w), "layer", layer);
  py_add_frame(w, o, field->frame);
  py_add_array(w, o, "values", "f4", (size_t)field->ny, (size_t)field->nx,
               field->coefficients);
  int code = py_send(in, NULL, error);
  if (code) return code;
  py_get_array(w, o, "values", field->coefficients);
  eda_field_from_samples(in->host->context, field);
  return OPC_OK;
}

void py_resist_set(py_plugin *p) {
  *PY_FUNCTIONS(p, resist) =
      (eda_resist){.prepare = resist_prepare, .print = resist_print};
}

/* ---- litho ---- */

static int litho_prepare(void *self, opc_error *error) {
  py_instance *in = self;
  py_worker *w = py_open(in, "prepare", 1, error);
  int code = w ? py_send(in, NULL, error) : error->code;
  if (code) return code;
  in->band = json_object_get_double_member(py_result(w), "band");
  return OPC_OK;
}

static double litho_band(const void *self) {
  return ((const py_instance *)self)->band;
}

/* Copy the image of the reply, values at nodes, to *out. */
static int take_image(py_instance *in, eda_frame frame, eda_field *out,
                      opc_error *error) {
  size_t n = 0;
  const float *values = py_new_array(in->worker, "image", "f4", &n);
  gint64 nx = json_object_get_int_member(py_result(in->worker), "nx");
  if (!values || nx < 1 || !n || n % (size_t)nx)
    return opc_fail(error, OPC_FAILED, NULL, "'%s': 'image' returned no image",
                    in->plugin->id);
  *out = (eda_field){frame, (int32_t)nx, (int32_t)(n / (size_t)nx),
                     g_memdup2(values, n * sizeof *values)};
  return OPC_OK;
}

static int litho_image_at(const void *self, int layer, const eda_spectrum *mask,
                          double defocus, eda_field *out, opc_error *error) {
  py_instance *in = (py_instance *)self;
  g_autoptr(GMutexLocker) locker = g_mutex_locker_new(&in->lock);
  py_worker *w = py_open(in, "image", 0, error);
  if (!w) return error->code;
  JsonObject *o = py_object(py_values(w), "mask");
  json_object_set_int_member(py_values(w), "layer", layer);
  py_set_number(py_values(w), "defocus", defocus);
  py_set_number(o, "band", mask->band);
  py_add_frame(w, o, mask->frame);
  py_add_array(w, o, "spectrum", "f4", (size_t)mask->rows,
               2 * (size_t)mask->columns, mask->data);
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
  eda_scanner scanner = {0};
  g_autoptr(GMutexLocker) locker = g_mutex_locker_new(&in->lock);
  py_worker *w = py_open(in, "scanner", 1, &error);
  if (w && !py_send(in, NULL, &error)) {
    scanner.wavelength =
        json_object_get_double_member(py_result(w), "wavelength");
    scanner.na = json_object_get_double_member(py_result(w), "na");
  } else {
    in->host->log(in->host, OPC_LOG_WARNING, "%s", error.message);
  }
  return scanner;
}

void py_litho_set(py_plugin *p) {
  *PY_FUNCTIONS(p, litho) =
      (eda_litho){.prepare = litho_prepare,
                  .band = litho_band,
                  .image = litho_image,
                  .image_at = py_defines(p, "focuses") ? litho_image_at : NULL,
                  .scanner = py_defines(p, "scanner") ? litho_scanner : NULL};
}
