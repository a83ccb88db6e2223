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

/* Add the value of a parameter; null if it has none. */
static void put_parameter(py_worker *w, const opc_parameter *p,
                          const void *field) {
  const opc_reals *reals = field;
  const opc_map *map = field;
  int number = *(const int *)field;
  if (p->type == OPC_BOOL) {
    py_put(w, p->name, number < 0 ? "null" : number ? "true" : "false");
  } else if (p->type == OPC_INT) {
    if (*(const int64_t *)field == OPC_NO_INT)
      py_put(w, p->name, "null");
    else
      py_put_int(w, p->name, *(const int64_t *)field);
  } else if (p->type == OPC_REAL) {
    py_put_number(w, p->name, *(const double *)field);
  } else if (p->type == OPC_CHOICE) {
    g_auto(GStrv) words = g_strsplit(p->choices, "|", -1);
    py_put_text(w, p->name, number < 0 ? NULL : words[number]);
  } else if (p->type == OPC_REALS) {
    py_begin(w, p->name, '[');
    for (size_t i = 0; i < reals->count; i++)
      py_put_number(w, NULL, reals->values[i]);
    py_end(w, ']');
  } else if (p->type == OPC_MAP) {
    py_begin(w, p->name, '{');
    for (size_t i = 0; i < map->count; i++)
      py_put_text(w, map->pairs[i].key, map->pairs[i].value);
    py_end(w, '}');
  } else if (p->type != OPC_INPUT) {
    py_put_text(w, p->name, *(const char *const *)field);
  }
}

/* ---- requests ---- */

py_worker *py_open(py_instance *in, const char *call, int parameters,
                   opc_error *error) {
  const opc_plugin *d = &in->plugin->descriptor;
  const char *python =
      py_text(json_node_get_object(in->plugin->about), "python");
  py_worker *w = in->worker;
  if (!w)
    w = in->worker =
        py_worker_start(in->plugin->path, in->plugin->id, python, error);
  if (!w) return NULL;
  py_request(w, call);
  if (!parameters) return w;
  py_begin(w, "parameters", '{');
  for (size_t i = 0; i < d->n_parameters; i++)
    put_parameter(w, &d->parameters[i],
                  (const char *)in + d->parameters[i].offset);
  py_end(w, '}');
  return w;
}

int py_send(py_instance *in, py_answer *answer, opc_error *error) {
  int code = py_call(in->worker, in->host, in->call_limit, answer, error);
  if (code) in->serial = 0;
  return code;
}

int py_ask(py_instance *in, const char *call, opc_error *error) {
  return py_open(in, call, 1, error) ? py_send(in, NULL, error) : error->code;
}

int py_check(void *self, opc_error *error) {
  py_instance *in = instance_of(self);
  if (!py_defines(in->plugin, "check")) return OPC_OK;
  return py_ask(in, "check", error);
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
