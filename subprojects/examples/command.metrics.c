/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the verb `opcflow metrics RUN ...`: the metrics of run folders
   side by side. */
#include <json-glib/json-glib.h>
#include <math.h>
#include <opcflow/command.h>
#include <opcflow/table.h>
#include <string.h>

/* ---- state ---- */

typedef struct metrics {
  const opc_host *host;
  const char *step; /* NULL for all steps */
} metrics;

/* Rows of the table: each metric with a value for each run. */
typedef struct rows {
  GPtrArray *step, *metric, *unit; /* char * */
  GArray **values;                 /* double, one array for each run */
  size_t runs;
} rows;

/* ---- work ---- */

/* Return the index of the row of a metric; append a row if there is none. */
static guint find_row(rows *r, const char *step, const char *metric,
                      const char *unit) {
  static const double nothing = NAN;
  for (guint i = 0; i < r->step->len; i++)
    if (!strcmp(r->step->pdata[i], step) &&
        !strcmp(r->metric->pdata[i], metric))
      return i;
  g_ptr_array_add(r->step, g_strdup(step));
  g_ptr_array_add(r->metric, g_strdup(metric));
  g_ptr_array_add(r->unit, g_strdup(unit ? unit : ""));
  for (size_t i = 0; i < r->runs; i++)
    g_array_append_val(r->values[i], nothing);
  return r->step->len - 1;
}

static void add_step(rows *r, size_t run, const char *step, JsonObject *all) {
  GList *names = json_object_get_members(all);
  for (GList *name = names; name; name = name->next) {
    JsonObject *o = json_object_get_object_member(all, name->data);
    guint row = find_row(r, step, name->data,
                         json_object_get_null_member(o, "unit")
                             ? NULL
                             : json_object_get_string_member(o, "unit"));
    g_array_index(r->values[run], double, row) =
        json_object_get_double_member(o, "value");
  }
  g_list_free(names);
}

static int add_run(const metrics *m, rows *r, size_t run, const char *folder,
                   opc_error *error) {
  g_autofree char *path = g_build_filename(folder, "metrics.json", NULL);
  g_autoptr(JsonParser) parser = json_parser_new();
  g_autoptr(GError) fault = NULL;
  if (!json_parser_load_from_file(parser, path, &fault))
    return opc_fail(error, OPC_IO, NULL, "%s", fault->message);
  JsonNode *root = json_parser_get_root(parser);
  if (!root || !JSON_NODE_HOLDS_OBJECT(root))
    return opc_fail(error, OPC_IO, NULL,
                    "'%s' is not the metrics file of a run", path);
  JsonObject *all = json_node_get_object(root);
  GList *names = json_object_get_members(all);
  for (GList *name = names; name; name = name->next)
    if (JSON_NODE_HOLDS_OBJECT(json_object_get_member(all, name->data)) &&
        (!m->step || !strcmp(m->step, name->data)))
      add_step(r, run, name->data,
               json_object_get_object_member(all, name->data));
  g_list_free(names);
  return OPC_OK;
}

static int metrics_publish(const metrics *m, const rows *r,
                           const char *const *runs, opc_error *error) {
  g_autofree opc_column *columns = g_new0(opc_column, r->runs + 3);
  columns[0] = (opc_column){"step", NULL, OPC_TEXT, 0, r->step->pdata};
  columns[1] = (opc_column){"metric", NULL, OPC_TEXT, 0, r->metric->pdata};
  columns[2] = (opc_column){"unit", NULL, OPC_TEXT, 0, r->unit->pdata};
  for (size_t i = 0; i < r->runs; i++)
    columns[i + 3] =
        (opc_column){runs[i], NULL, OPC_REAL, -1, r->values[i]->data};
  return opc_put_table(m->host, "metrics", OPC_TABLE_PRINT, r->step->len,
                       columns, r->runs + 3, error);
}

static int metrics_run(void *self, size_t n, const char *const *arguments,
                       opc_error *error) {
  int code =
      n ? OPC_OK : opc_fail(error, OPC_INVALID, NULL, "no run folder is given");
  rows r = {g_ptr_array_new_with_free_func(g_free),
            g_ptr_array_new_with_free_func(g_free),
            g_ptr_array_new_with_free_func(g_free), g_new0(GArray *, n), n};
  for (size_t i = 0; i < n; i++)
    r.values[i] = g_array_new(FALSE, TRUE, sizeof(double));
  for (size_t i = 0; i < n && !code; i++)
    code = add_run(self, &r, i, arguments[i], error);
  if (!code) code = metrics_publish(self, &r, arguments, error);
  for (size_t i = 0; i < n; i++) g_array_free(r.values[i], TRUE);
  g_ptr_array_free(r.step, TRUE);
  g_ptr_array_free(r.metric, TRUE);
  g_ptr_array_free(r.unit, TRUE);
  g_free(r.values);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(
        metrics, step, .type = OPC_TEXT,
        .summary = "step whose metrics are shown (default: all steps)"),
};

/* ---- entry ---- */

static const opc_command functions = {.arguments = "RUN ...",
                                      .run = metrics_run};

OPC_PLUGIN(metrics, .id = "command.metrics", .kind = "command",
           .version = "1.0.0", .licence = "BSD-3-Clause",
           .summary = "Show the metrics of runs side by side",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_FUNCTIONS(functions));
