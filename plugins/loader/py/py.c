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

void py_clear(void *self) {
  py_instance *in = self;
  py_worker_free(in->worker);
  if (in->verdicts) g_ptr_array_free(in->verdicts, TRUE);
  g_free(in->target);
  g_free(in->place);
  g_free(in->width);
  g_free(in->boxes);
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

/* ---- requests ---- */

py_worker *py_open(py_instance *in, const char *call, int parameters,
                   opc_error *error) {
  const opc_plugin *d = &in->plugin->descriptor;
  if (!in->worker)
    in->worker =
        py_worker_start(in->plugin->path, in->plugin->id,
                        json_object_get_string_member(
                            json_node_get_object(in->plugin->about), "python"),
                        error);
  if (!in->worker) return NULL;
  py_request(in->worker, call);
  JsonObject *values =
      parameters ? py_object(py_values(in->worker), "parameters") : NULL;
  for (size_t i = 0; parameters && i < d->n_parameters; i++) {
    const opc_parameter *p = &d->parameters[i];
    if (p->type != OPC_INPUT)
      set_parameter(values, p, (const char *)in + p->offset);
  }
  return in->worker;
}

int py_send(py_instance *in, py_answer *answer, opc_error *error) {
  int code = py_call(in->worker, in->host, in->call_limit, answer, error);
  if (code) in->serial = 0;
  return code;
}

int py_check(void *self, opc_error *error) {
  py_instance *in = instance_of(self);
  if (!py_defines(in->plugin, "check")) return OPC_OK;
  return py_open(in, "check", 1, error) ? py_send(in, NULL, error)
                                        : error->code;
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
