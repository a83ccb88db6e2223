/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements loader.py: plugins in Python. Instances and the requests that all
   kinds have in common. */
#include "py.h"

#include <opcflow/loader.h>
#include <stdlib.h>
#include <string.h>

/* ---- instances ---- */

static py_instance *instance_of(void *self) {
  py_instance *in = self;
  if (in->plugin) return in;
  const opc_plugin *own = in->host->service(in->host, OPC_DESCRIPTOR);
  in->plugin = (const py_plugin *)(const void *)own->id;
  return in;
}

py_worker *py_open(py_instance *instance, const char *call, opc_error *error) {
  py_instance *in = instance_of(instance);
  if (!in->worker)
    in->worker = py_worker_start(in->plugin->path, in->plugin->id, error);
  if (in->worker) py_request(in->worker, call);
  return in->worker;
}

int py_send(py_instance *in, py_answer *answer, opc_error *error) {
  return py_call(in->worker, in->host, in->call_limit, answer, error);
}

int py_check(void *self, opc_error *error) {
  py_instance *in = instance_of(self);
  if (!py_defines(in->plugin, "check")) return OPC_OK;
  if (!py_open(in, "check", error)) return error->code;
  py_add_parameters(in);
  return py_send(in, NULL, error);
}

void py_clear(void *self) {
  py_instance *in = self;
  py_worker_free(in->worker);
  if (in->verdicts) g_ptr_array_free(in->verdicts, TRUE);
  g_free(in->target);
  g_free(in->place);
  g_free(in->width);
}

/* ---- values ---- */

static JsonArray *reals_json(const opc_reals *reals) {
  JsonArray *list = json_array_new();
  for (size_t i = 0; i < reals->count; i++)
    json_array_add_double_element(list, reals->values[i]);
  return list;
}

static JsonObject *map_json(const opc_map *map) {
  JsonObject *object = json_object_new();
  for (size_t i = 0; i < map->count; i++)
    json_object_set_string_member(object, map->pairs[i].key,
                                  map->pairs[i].value);
  return object;
}

static void set_choice(JsonObject *values, const opc_parameter *p, int index) {
  g_auto(GStrv) words = g_strsplit(p->choices, "|", -1);
  if (index >= 0)
    json_object_set_string_member(values, p->name, words[index]);
  else
    json_object_set_null_member(values, p->name);
}

/* Set the value of a parameter; null if it has none. */
static void set_parameter(JsonObject *values, const opc_parameter *p,
                          const void *field) {
  int64_t integer;
  memcpy(&integer, field, sizeof integer);
  switch (p->type) {
    case OPC_BOOL:
      if (*(const int *)field < 0)
        json_object_set_null_member(values, p->name);
      else
        json_object_set_boolean_member(values, p->name,
                                       *(const int *)field != 0);
      return;
    case OPC_INT:
      if (integer == OPC_NO_INT)
        json_object_set_null_member(values, p->name);
      else
        json_object_set_int_member(values, p->name, integer);
      return;
    case OPC_REAL:
      py_set_number(values, p->name, *(const double *)field);
      return;
    case OPC_CHOICE:
      set_choice(values, p, *(const int *)field);
      return;
    case OPC_REALS:
      json_object_set_array_member(values, p->name, reals_json(field));
      return;
    case OPC_MAP:
      json_object_set_object_member(values, p->name, map_json(field));
      return;
    default:
      json_object_set_string_member(values, p->name,
                                    *(const char *const *)field);
  }
}

void py_add_parameters(py_instance *in) {
  const opc_plugin *d = &in->plugin->descriptor;
  JsonObject *values = json_object_new();
  for (size_t i = 0; i < d->n_parameters; i++) {
    const opc_parameter *p = &d->parameters[i];
    if (p->type != OPC_INPUT)
      set_parameter(values, p, (const char *)in + p->offset);
  }
  json_object_set_object_member(py_values(in->worker), "parameters", values);
}

/* ---- data ---- */

void py_add_named(py_worker *w, const char *prefix, const char *name,
                  const char *type, size_t count, const void *data) {
  g_autofree char *whole = g_strconcat(prefix, ".", name, NULL);
  py_add_array(w, whole, type, count, data);
}

void py_add_performance(py_worker *w, const char *prefix,
                        const eda_performance *p) {
  const struct {
    const char *name;
    const double *data;
  } figures[] = {{"ion", p->ion},         {"ioff", p->ioff},
                 {"leq_ion", p->leq_ion}, {"leq_ioff", p->leq_ioff},
                 {"weq", p->weq},         {"area", p->area}};
  for (size_t i = 0; i < G_N_ELEMENTS(figures); i++)
    if (figures[i].data)
      py_add_named(w, prefix, figures[i].name, "f8", p->count, figures[i].data);
  if (p->outside)
    py_add_named(w, prefix, "outside", "u1", p->count, p->outside);
}

void py_add_scanner(py_worker *w, eda_scanner scanner) {
  JsonObject *o = json_object_new();
  py_set_number(o, "wavelength", scanner.wavelength);
  py_set_number(o, "na", scanner.na);
  json_object_set_object_member(py_values(w), "scanner", o);
}

static void set_texts(JsonObject *to, const char *name, char *const *texts,
                      size_t n) {
  JsonArray *list = json_array_new();
  for (size_t i = 0; texts && i < n; i++)
    json_array_add_string_element(list, texts[i]);
  json_object_set_array_member(to, name, list);
}

void py_add_shapes(py_worker *w, const char *prefix, size_t layer,
                   const eda_shapes *shapes) {
  g_autofree char *own = g_strdup_printf("%s.shapes.%zu", prefix, layer);
  size_t points = shapes->count ? shapes->start[shapes->count] : 0;
  py_add_named(w, own, "start", "u4", shapes->count ? shapes->count + 1 : 0,
               shapes->start);
  py_add_named(w, own, "points", "i4", 2 * points, shapes->points);
  py_add_named(w, own, "hole", "u1", shapes->count, shapes->hole);
}

void py_add_gates(py_worker *w, const char *prefix, const eda_gates *g) {
  JsonObject *o = json_object_new();
  const int32_t extent[] = {g->extent.x0, g->extent.y0, g->extent.x1,
                            g->extent.y1};
  json_object_set_string_member(o, "name", g->name);
  py_set_number(o, "grid", g->grid);
  json_object_set_int_member(o, "count", (gint64)g->count);
  set_texts(o, "layers", g->layer, g->layers);
  set_texts(o, "instance", g->instance, g->count);
  set_texts(o, "cell", g->cell, g->count);
  set_texts(o, "flavour", g->flavour, g->count);
  json_object_set_object_member(py_values(w), prefix, o);
  py_add_named(w, prefix, "extent", "i4", 4, extent);
  py_add_named(w, prefix, "corrected", "u1", g->layers, g->corrected);
  py_add_named(w, prefix, "box", "i4", 4 * g->count, g->box);
  py_add_named(w, prefix, "type", "u1", g->count, g->type);
  py_add_named(w, prefix, "axis", "u1", g->count, g->axis);
  py_add_named(w, prefix, "length", "f8", g->count, g->length);
  py_add_named(w, prefix, "width", "f8", g->count, g->width);
  py_add_named(w, prefix, "space", "f8", 2 * g->count, g->space);
  py_add_named(w, prefix, "extension", "f8", 2 * g->count, g->extension);
  py_add_named(w, prefix, "number", "u4", g->count, g->number);
  for (size_t k = 0; k < g->layers; k++)
    if (g->drawn) py_add_shapes(w, prefix, k, &g->drawn[k]);
}

/* ---- entry ---- */

static const char *const *py_files(const char *id) {
  return ((const py_plugin *)(const void *)id)->files;
}

typedef struct py_loader {
  const opc_host *host;
} py_loader;

static const opc_loader functions = {.load = py_describe, .files = py_files};

OPC_PLUGIN(py_loader, .id = "loader.py", .kind = "loader", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "plugins in Python, each instance in its own process",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_FUNCTIONS(functions));
