/* SPDX-License-Identifier: BSD-3-Clause */
/* A run as JSON. */
#include <math.h>
#include <string.h>
#include <sys/utsname.h>

#include "core/flow/files.h"
#include "core/flow/inner.h"
#include "core/flow/run.h"
#include "core/text/unit.h"
#include "core/text/value.h"
#include "core/plugin/declaration.h"

static void set_text(JsonBuilder *b, const char *key, const char *text) {
  json_builder_set_member_name(b, key);
  if (text)
    json_builder_add_string_value(b, text);
  else
    json_builder_add_null_value(b);
}

static void set_real(JsonBuilder *b, const char *key, double value) {
  json_builder_set_member_name(b, key);
  json_builder_add_double_value(b, value);
}

static JsonNode *finish(JsonBuilder *b) {
  JsonNode *node = json_builder_get_root(b);
  g_object_unref(b);
  return node;
}

/* Write the numbers of a JSON text in their shortest exact form. This also
   mends those that json-glib 1.6 writes as "1e-07.0", which is no JSON. */
static char *shorten_numbers(const char *text) {
  GString *out = g_string_sized_new(strlen(text));
  gboolean quoted = FALSE;
  while (*text) {
    size_t n = quoted ? 0 : opc_number_length(text);
    if (n && strcspn(text, ".e") < n) {
      g_autofree char *number = opc_number_text(g_ascii_strtod(text, NULL));
      g_string_append(out, number);
      if (!strpbrk(number, ".e")) g_string_append(out, ".0");
      text += n;
      if (!strncmp(text, ".0", 2)) text += 2;
      continue;
    }
    n = MAX(n, 1);
    if (*text == '"') quoted = !quoted;
    if (quoted && *text == '\\') n = 2;
    g_string_append_len(out, text, (gssize)n);
    text += n;
  }
  return g_string_free(out, FALSE);
}

char *opc_json_text(JsonNode *node) {
  g_autofree char *text = json_to_string(node, TRUE);
  json_node_unref(node);
  g_autofree char *better = shorten_numbers(text);
  return g_strconcat(better, "\n", NULL);
}

/* ---- metrics ---- */

JsonNode *opc_metric_json(const opc_metric *metric, double value) {
  static const char *const better[] = {"neutral", "lower", "higher"};
  JsonBuilder *b = json_builder_new();
  json_builder_begin_object(b);
  set_real(b, "value", value);
  set_text(b, "unit", metric->unit);
  set_text(b, "better", better[metric->better]);
  set_real(b, "tolerance", metric->tolerance);
  json_builder_end_object(b);
  return finish(b);
}

static void add_metrics(JsonBuilder *b, const opc_run *run, const char *path) {
  for (guint i = 0; i < run->metrics->len; i++) {
    const opc_inner_metric *m =
        &g_array_index(run->metrics, opc_inner_metric, i);
    if (m->path != path) continue;
    json_builder_set_member_name(b, m->metric->name);
    json_builder_add_value(b, opc_metric_json(m->metric, m->value));
  }
}

/* By instance, in the order in which they came. */
JsonNode *opc_run_metrics_json(const opc_run *run) {
  JsonBuilder *b = json_builder_new();
  g_autoptr(GHashTable) done = g_hash_table_new(NULL, NULL);
  json_builder_begin_object(b);
  for (guint i = 0; i < run->metrics->len; i++) {
    const char *path = g_array_index(run->metrics, opc_inner_metric, i).path;
    if (!g_hash_table_add(done, (gpointer)path)) continue;
    json_builder_set_member_name(b, path);
    json_builder_begin_object(b);
    add_metrics(b, run, path);
    json_builder_end_object(b);
  }
  json_builder_end_object(b);
  return finish(b);
}

/* ---- manifest ---- */

typedef struct plugin_list {
  JsonBuilder *builder;
  const opc_run *run;
  GHashTable *done; /* opc_plugin * */
} plugin_list;

static void add_flow(const opc_flow *flow, plugin_list *list);

static void add_plugin(opc_binding *binding, void *data) {
  plugin_list *list = data;
  if (binding->inner) add_flow(opc_inner_flow(binding->inner), list);
  if (!g_hash_table_add(list->done, (gpointer)binding->plugin)) return;
  const char *path = opc_registry_path(list->run->registry, binding->plugin);
  g_autofree char *whole = path ? g_canonicalize_filename(path, NULL) : NULL;
  opc_error error;
  g_autofree char *sum = path ? opc_file_sha256(path, &error) : NULL;
  json_builder_begin_object(list->builder);
  set_text(list->builder, "id", binding->plugin->id);
  set_text(list->builder, "version", binding->plugin->version);
  set_text(list->builder, "path", whole);
  set_text(list->builder, "sha256", sum);
  json_builder_end_object(list->builder);
}

static void add_flow(const opc_flow *flow, plugin_list *list) {
  for (guint i = 0; i < flow->order->len; i++) {
    const opc_flow_step *step = flow->order->pdata[i];
    opc_binding_visit(step->binding, add_plugin, list);
  }
}

static void add_plugins(JsonBuilder *b, const opc_run *run) {
  plugin_list list = {b, run, g_hash_table_new(NULL, NULL)};
  json_builder_set_member_name(b, "plugins");
  json_builder_begin_array(b);
  add_flow(run->flow, &list);
  json_builder_end_array(b);
  g_hash_table_destroy(list.done);
}

static void add_inputs(JsonBuilder *b, const opc_run *run) {
  json_builder_set_member_name(b, "inputs");
  json_builder_begin_array(b);
  for (guint i = 0; i + 1 < run->inputs->len; i += 2) {
    json_builder_begin_object(b);
    set_text(b, "path", run->inputs->pdata[i]);
    set_text(b, "sha256", run->inputs->pdata[i + 1]);
    json_builder_end_object(b);
  }
  json_builder_end_array(b);
}

static void add_machine(JsonBuilder *b) {
  struct utsname about;
  if (uname(&about)) memset(&about, 0, sizeof about);
  json_builder_set_member_name(b, "host");
  json_builder_begin_object(b);
  set_text(b, "name", about.nodename);
  set_text(b, "system", about.sysname);
  set_text(b, "release", about.release);
  set_text(b, "machine", about.machine);
  json_builder_set_member_name(b, "processors");
  json_builder_add_int_value(b, g_get_num_processors());
  json_builder_end_object(b);
}

static void add_times(JsonBuilder *b, const opc_run *run) {
  g_autofree char *started = g_date_time_format_iso8601(run->started);
  set_text(b, "started", started);
  set_real(b, "seconds", run->total);
  json_builder_set_member_name(b, "steps");
  json_builder_begin_object(b);
  for (guint i = 0; i < run->flow->order->len; i++) {
    const opc_flow_step *step = run->flow->order->pdata[i];
    const double *seconds = g_hash_table_lookup(run->seconds, step->name);
    if (seconds) set_real(b, step->name, *seconds);
  }
  json_builder_end_object(b);
}

static void set_points(JsonBuilder *b, const opc_run *run) {
  json_builder_set_member_name(b, "points");
  json_builder_add_int_value(b, (gint64)run->sweep->points);
  json_builder_set_member_name(b, "failed_points");
  json_builder_add_int_value(b, (gint64)run->failed_points);
}

JsonNode *opc_run_manifest_json(const opc_run *run) {
  JsonBuilder *b = json_builder_new();
  json_builder_begin_object(b);
  set_text(b, "opcflow", OPC_VERSION);
  set_text(b, "flow", run->flow->path);
  if (run->flow->variant) set_text(b, "variant", run->flow->variant);
  set_text(b, "result", run->failure ? "failed" : "complete");
  if (run->failure) set_text(b, "failure", run->failure);
  if (run->sweep) set_points(b, run);
  json_builder_set_member_name(b, "command");
  json_builder_begin_array(b);
  const char *const *word = run->options->command;
  for (; word && *word; word++) json_builder_add_string_value(b, *word);
  json_builder_end_array(b);
  add_times(b, run);
  json_builder_set_member_name(b, "threads");
  json_builder_add_int_value(b, opc_threads());
  add_machine(b);
  add_plugins(b, run);
  add_inputs(b, run);
  json_builder_end_object(b);
  return finish(b);
}

/* ---- tables ---- */

/* JSON has neither NAN nor infinity: null. */
static void add_cell(JsonBuilder *b, const opc_column *c, size_t row) {
  double real = c->type == OPC_REAL ? ((const double *)c->data)[row] : 0;
  if (c->type == OPC_TEXT)
    json_builder_add_string_value(b, ((const char *const *)c->data)[row]);
  else if (c->type == OPC_INT)
    json_builder_add_int_value(b, ((const int64_t *)c->data)[row]);
  else if (isfinite(real))
    json_builder_add_double_value(b, real);
  else
    json_builder_add_null_value(b);
}

JsonNode *opc_table_json(const opc_table *table) {
  JsonBuilder *b = json_builder_new();
  json_builder_begin_object(b);
  set_text(b, "name", table->name);
  json_builder_set_member_name(b, "columns");
  json_builder_begin_array(b);
  for (size_t i = 0; i < table->n_columns; i++) {
    json_builder_begin_object(b);
    set_text(b, "name", table->columns[i].name);
    set_text(b, "unit", table->columns[i].unit);
    json_builder_end_object(b);
  }
  json_builder_end_array(b);
  json_builder_set_member_name(b, "rows");
  json_builder_begin_array(b);
  for (size_t row = 0; row < table->rows; row++) {
    json_builder_begin_array(b);
    for (size_t i = 0; i < table->n_columns; i++)
      add_cell(b, &table->columns[i], row);
    json_builder_end_array(b);
  }
  json_builder_end_array(b);
  json_builder_end_object(b);
  return finish(b);
}
