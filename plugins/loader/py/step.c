/* SPDX-License-Identifier: BSD-3-Clause */
/* Kind step in Python: inputs of the data kinds gates and mask; tables, metrics
   and files as results. */
#include <math.h>
#include <string.h>

#include <opcflow/table.h>

#include "py.h"

/* ---- results ---- */

/* Fill a column from {"name", "unit", "type", "decimals", "values"}. Returns
   the array of its data (g_free). */
static void *column_fill(opc_column *column, JsonObject *o, guint rows) {
  const char *type = py_text(o, "type");
  JsonArray *list = py_list(o, "values");
  void *data = g_malloc0_n(rows + 1, sizeof(double));
  *column = (opc_column){.name = py_text(o, "name"),
                         .unit = py_text(o, "unit"),
                         .decimals = (int32_t)py_number(o, "decimals"),
                         .type = !strcmp(type, "text")  ? OPC_TEXT
                                 : !strcmp(type, "int") ? OPC_INT
                                                        : OPC_REAL,
                         .data = data};
  for (guint i = 0; i < rows && i < json_array_get_length(list); i++)
    if (column->type == OPC_TEXT)
      ((const char **)data)[i] = json_array_get_string_element(list, i);
    else if (column->type == OPC_INT)
      ((int64_t *)data)[i] = json_array_get_int_element(list, i);
    else
      ((double *)data)[i] = json_array_get_null_element(list, i)
                                ? NAN
                                : json_array_get_double_element(list, i);
  return data;
}

static int put_table(const opc_host *host, JsonObject *o, opc_error *error) {
  JsonArray *list = py_list(o, "columns");
  guint n = json_array_get_length(list), rows = (guint)py_number(o, "rows");
  g_autofree opc_column *columns = g_new0(opc_column, n + 1);
  g_autoptr(GPtrArray) data = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < n; i++) {
    JsonObject *column = json_array_get_object_element(list, i);
    g_ptr_array_add(data, column_fill(&columns[i], column, rows));
  }
  return opc_put_table(host, py_text(o, "name"),
                       py_number(o, "print") != 0 ? OPC_TABLE_PRINT : 0, rows,
                       columns, n, error);
}

static int step_answer(const opc_host *host, const char *what, JsonObject *o,
                       const char **answer, opc_error *error) {
  if (!strcmp(what, "table")) return put_table(host, o, error);
  if (!strcmp(what, "metric"))
    return host->metric(host, py_text(o, "name"), py_number(o, "value"), error);
  if (!strcmp(what, "output_path")) {
    *answer = host->output_path(host, py_text(o, "name"), error);
    return *answer ? OPC_OK : error->code;
  }
  if (strcmp(what, "progress"))
    return opc_fail(error, OPC_FAILED, NULL, "unknown request '%s'", what);
  const opc_progress progress = {.done = py_number(o, "done"),
                                 .total = py_number(o, "total"),
                                 .worst = NAN};
  host->progress(host, &progress);
  return OPC_OK;
}

/* ---- inputs ---- */

static void put_mask(py_worker *w, const char *name, const eda_mask *mask) {
  py_begin(w, name, '{');
  py_put_gates(w, "gates", mask->gates);
  py_put_performance(w, "design", &mask->design);
  py_put_performance(w, "before", &mask->before);
  py_put_performance(w, "after", &mask->after);
  py_put_array(w, "flags", "u4", mask->gates->count, 0, mask->flags);
  py_put_shapes(w, "shapes", mask->layers, mask->shapes);
  py_end(w, '}');
}

static int step_run(void *self, void **outputs, opc_error *error) {
  py_instance *in = self;
  py_worker *w = py_open(in, "run", 1, error);
  (void)outputs;
  if (!w) return error->code;
  const opc_plugin *d = &in->plugin->descriptor;
  py_begin(w, "inputs", '{');
  for (size_t i = 0; i < d->n_parameters; i++) {
    const opc_parameter *p = &d->parameters[i];
    const void *object = *(void *const *)((const char *)in + p->offset);
    if (p->type != OPC_INPUT || !object) continue;
    if (!strcmp(p->choices, "mask"))
      put_mask(w, p->name, object);
    else
      py_put_gates(w, p->name, object);
  }
  py_end(w, '}');
  return py_send(in, step_answer, error);
}

void py_step_set(py_plugin *p) {
  *PY_FUNCTIONS(p, step) =
      (opc_step){.run = step_run, .output_size = sizeof(opc_port)};
}
