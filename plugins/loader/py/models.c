/* SPDX-License-Identifier: BSD-3-Clause */
/* Kinds extractor and resist in Python. Their functions may be called from
   several threads; the worker computes one call at a time. */
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
  if (!py_open(in, "prepare", error)) return error->code;
  py_add_parameters(in);
  int code = py_send(in, NULL, error);
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

static int extract_locked(py_instance *in, const eda_slices *s,
                          eda_performance *out, opc_error *error) {
  size_t all = s->count * s->slices;
  if (!all) return OPC_OK;
  py_worker *w = py_open(in, "extract", error);
  if (!w) return error->code;
  json_object_set_int_member(py_values(w), "slices", (gint64)s->slices);
  JsonArray *flavours = json_array_new();
  for (size_t i = 0; s->flavour && i < s->count; i++)
    json_array_add_string_element(flavours, s->flavour[i]);
  json_object_set_array_member(py_values(w), "flavour", flavours);
  py_add_array(w, "type", "u1", s->count, s->type);
  py_add_array(w, "width", "f8", all, s->width);
  py_add_array(w, "length", "f8", all, s->length);
  py_add_array(w, "edge", "f8", all, s->edge);
  eda_performance to = *out; /* has in->count elements, but may not state it */
  to.count = s->count;
  py_add_performance(w, "out", &to);
  int code = py_send(in, NULL, error);
  if (code) return code;
  py_get_array(w, "out.ion", out->ion);
  py_get_array(w, "out.ioff", out->ioff);
  py_get_array(w, "out.leq_ion", out->leq_ion);
  py_get_array(w, "out.leq_ioff", out->leq_ioff);
  py_get_array(w, "out.weq", out->weq);
  py_get_array(w, "out.area", out->area);
  if (out->outside) py_get_array(w, "out.outside", out->outside);
  return OPC_OK;
}

static int extractor_extract(const void *self, const eda_slices *slices,
                             eda_performance *out, opc_error *error) {
  py_instance *in = (py_instance *)self;
  g_mutex_lock(&in->lock);
  int code = extract_locked(in, slices, out, error);
  g_mutex_unlock(&in->lock);
  return code;
}

void py_extractor_set(py_plugin *p) {
  eda_extractor *f = &p->functions.extractor;
  *f = (eda_extractor){.prepare = extractor_prepare,
                       .slicing = extractor_slicing,
                       .extract = extractor_extract};
  p->descriptor.functions = f;
  p->descriptor.functions_size = sizeof *f;
}

/* ---- resist ---- */

static int resist_prepare(void *self, const opc_module *litho,
                          opc_error *error) {
  py_instance *in = self;
  if (!py_open(in, "prepare", error)) return error->code;
  py_add_parameters(in);
  py_add_scanner(in->worker, eda_scanner_of(litho));
  return py_send(in, NULL, error);
}

static int print_locked(py_instance *in, int layer, eda_field *field,
                        opc_error *error) {
  py_worker *w = py_open(in, "print", error);
  if (!w) return error->code;
  JsonObject *values = py_values(w);
  json_object_set_int_member(values, "layer", layer);
  json_object_set_int_member(values, "nx", field->nx);
  json_object_set_int_member(values, "ny", field->ny);
  const double frame[] = {field->frame.x0, field->frame.y0, field->frame.width,
                          field->frame.height};
  py_add_array(w, "frame", "f8", G_N_ELEMENTS(frame), frame);
  py_add_array(w, "values", "f4", (size_t)field->nx * (size_t)field->ny,
               field->coefficients);
  int code = py_send(in, NULL, error);
  if (!code) py_get_array(w, "values", field->coefficients);
  return code;
}

static int resist_print(const void *self, int layer, eda_field *field,
                        opc_error *error) {
  py_instance *in = (py_instance *)self;
  eda_field_samples(in->host->context, field);
  g_mutex_lock(&in->lock);
  int code = print_locked(in, layer, field, error);
  g_mutex_unlock(&in->lock);
  if (!code) eda_field_from_samples(in->host->context, field);
  return code;
}

void py_resist_set(py_plugin *p) {
  eda_resist *f = &p->functions.resist;
  *f = (eda_resist){.prepare = resist_prepare, .print = resist_print};
  p->descriptor.functions = f;
  p->descriptor.functions_size = sizeof *f;
}
