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
  const char *type = json_object_get_string_member(o, "type");
  JsonArray *list = json_object_get_array_member(o, "values");
  void *data = g_malloc0_n(rows + 1, sizeof(double));
  *column = (opc_column){
      .name = json_object_get_string_member(o, "name"),
      .unit = json_object_get_string_member_with_default(o, "unit", NULL),
      .decimals =
          (int32_t)json_object_get_int_member_with_default(o, "decimals", -1),
      .data = data};
  column->type = !strcmp(type, "text")  ? OPC_TEXT
                 : !strcmp(type, "int") ? OPC_INT
                                        : OPC_REAL;
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
  JsonArray *list = json_object_get_array_member(o, "columns");
  guint n = json_array_get_length(list);
  guint rows = (guint)json_object_get_int_member(o, "rows");
  g_autofree opc_column *columns = g_new0(opc_column, n + 1);
  g_autoptr(GPtrArray) data = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; i < n; i++)
    g_ptr_array_add(
        data,
        column_fill(&columns[i], json_array_get_object_element(list, i), rows));
  return opc_put_table(
      host, json_object_get_string_member(o, "name"),
      json_object_get_boolean_member(o, "print") ? OPC_TABLE_PRINT : 0, rows,
      columns, n, error);
}

static int step_answer(const opc_host *host, const char *what, JsonObject *o,
                       const char **answer, opc_error *error) {
  if (!strcmp(what, "table")) return put_table(host, o, error);
  if (!strcmp(what, "metric"))
    return host->metric(host, json_object_get_string_member(o, "name"),
                        json_object_get_double_member(o, "value"), error);
  if (!strcmp(what, "output_path")) {
    *answer = host->output_path(host, json_object_get_string_member(o, "name"),
                                error);
    return *answer ? OPC_OK : error->code;
  }
  if (strcmp(what, "progress"))
    return opc_fail(error, OPC_FAILED, NULL, "unknown request '%s'", what);
  const opc_progress progress = {
      .done = json_object_get_double_member(o, "done"),
      .total = json_object_get_double_member(o, "total"),
      .worst = NAN};
  host->progress(host, &progress);
  return OPC_OK;
}

/* ---- inputs ---- */

static void add_mask(py_worker *w, JsonObject *to, const char *name,
                     const eda_mask *mask) {
  JsonObject *o = py_object(to, name);
  py_add_gates(w, o, "gates", mask->gates);
  py_add_performance(w, o, "design", &mask->design);
  py_add_performance(w, o, "before", &mask->before);
  py_add_performance(w, o, "after", &mask->after);
  py_add_array(w, o, "flags", "u4", mask->gates->count, 1, mask->flags);
  py_add_shapes(w, o, "shapes", mask->layers, mask->shapes);
}

static int step_run(void *self, void **outputs, opc_error *error) {
  py_instance *in = self;
  py_worker *w = py_open(in, "run", 1, error);
  (void)outputs;
  if (!w) return error->code;
  const opc_plugin *d = &in->plugin->descriptor;
  JsonObject *inputs = py_object(py_values(w), "inputs");
  for (size_t i = 0; i < d->n_parameters; i++) {
    const opc_parameter *p = &d->parameters[i];
    const void *object = *(void *const *)((const char *)in + p->offset);
    if (p->type != OPC_INPUT || !object) continue;
    if (!strcmp(p->choices, "mask"))
      add_mask(w, inputs, p->name, object);
    else
      py_add_gates(w, inputs, p->name, object);
  }
  return py_send(in, step_answer, error);
}

void py_step_set(py_plugin *p) {
  *PY_FUNCTIONS(p, step) =
      (opc_step){.run = step_run, .output_size = sizeof(opc_port)};
}
