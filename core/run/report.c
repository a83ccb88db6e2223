/* SPDX-License-Identifier: BSD-3-Clause */
/* A run as JSON. */
#include <math.h>
#include <string.h>
#include <sys/utsname.h>

#include <store/files.h>
#include "core/binding/inner.h"
#include "core/plugin/declaration.h"
#include "core/run/run.h"
#include "core/text/shown.h"
#include "core/text/unit.h"
#include "core/text/value.h"

static void set_text(JsonObject *o, const char *key, const char *text) {
  json_object_set_string_member(o, key, text);
}

static JsonNode *as_node(JsonObject *o) {
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, o);
  return node;
}

/* A list of texts that ends with NULL; NULL: an empty one. */
static JsonArray *texts_json(const char *const *texts) {
  JsonArray *list = json_array_new();
  for (; texts && *texts; texts++) json_array_add_string_element(list, *texts);
  return list;
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
  g_autofree char *shown = opc_shown_json(better);
  return g_strconcat(shown, "\n", NULL);
}

/* ---- metrics ---- */

JsonNode *opc_metric_json(const opc_metric *metric, double value) {
  static const char *const better[] = {"neutral", "lower", "higher"};
  JsonObject *o = json_object_new();
  json_object_set_double_member(o, "value", value);
  set_text(o, "unit", metric->unit);
  set_text(o, "better", better[metric->better]);
  json_object_set_double_member(o, "tolerance", metric->tolerance);
  return as_node(o);
}

static JsonArray *findings_json(const opc_run *run) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i < run->findings->len; i++) {
    const opc_finding *f = run->findings->pdata[i];
    JsonObject *o = json_object_new();
    if (f->point) json_object_set_int_member(o, "point", (gint64)f->point);
    set_text(o, "step", f->path);
    set_text(o, "text", f->text);
    json_array_add_object_element(list, o);
  }
  return list;
}

static void set_number(JsonObject *o, const char *key, double number) {
  if (isfinite(number))
    json_object_set_double_member(o, key, number);
  else
    json_object_set_null_member(o, key);
}

static JsonArray *verdicts_json(const opc_run *run) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i < run->verdicts->len; i++) {
    const opc_verdict *v = run->verdicts->pdata[i];
    JsonObject *o = json_object_new();
    if (v->point) json_object_set_int_member(o, "point", (gint64)v->point);
    set_text(o, "metric", v->path);
    set_text(o, "required", v->required);
    set_number(o, "least", v->least);
    set_number(o, "most", v->most);
    set_number(o, "value", v->value);
    set_text(o, "unit", v->unit);
    json_object_set_boolean_member(o, "kept", v->kept);
    json_array_add_object_element(list, o);
  }
  return list;
}

void opc_run_add_findings(JsonObject *o, const opc_run *run) {
  json_object_set_array_member(o, "require", verdicts_json(run));
  json_object_set_array_member(o, "findings", findings_json(run));
  if (run->more_findings)
    json_object_set_int_member(o, "more_findings", (gint64)run->more_findings);
}

/* By instance, in the order in which they came. */
JsonNode *opc_run_metrics_json(const opc_run *run) {
  JsonObject *all = json_object_new();
  for (guint i = 0; i < run->metrics->len; i++) {
    const opc_inner_metric *m =
        &g_array_index(run->metrics, opc_inner_metric, i);
    if (!json_object_has_member(all, m->path))
      json_object_set_object_member(all, m->path, json_object_new());
    json_object_set_member(json_object_get_object_member(all, m->path),
                           m->metric->name,
                           opc_metric_json(m->metric, m->value));
  }
  return as_node(all);
}

char *opc_run_metrics_text(const opc_run *run) {
  JsonNode *all = opc_run_metrics_json(run);
  opc_run_add_findings(json_node_get_object(all), run);
  return opc_json_text(all);
}

/* ---- manifest ---- */

/* Each once; `done`: opc_plugin *. */
static void add_plugins(JsonArray *list, GHashTable *done, const opc_run *run,
                        const opc_flow *flow) {
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  for (guint i = 0; i < all->len; i++) {
    const opc_binding *b = all->pdata[i];
    if (b->inner) add_plugins(list, done, run, opc_inner_flow(b->inner));
    if (!g_hash_table_add(done, (gpointer)b->plugin)) continue;
    const char *path = opc_registry_path(run->registry, b->plugin);
    g_autofree char *whole = path ? g_canonicalize_filename(path, NULL) : NULL;
    opc_error error;
    g_autofree char *sum =
        whole ? opc_store_sum(run->options->store, whole, NULL, &error) : NULL;
    JsonObject *o = json_object_new();
    set_text(o, "id", b->plugin->id);
    set_text(o, "version", b->plugin->version);
    set_text(o, "path", whole);
    set_text(o, "sha256", sum);
    json_array_add_object_element(list, o);
  }
}

static JsonArray *inputs_json(const opc_run *run) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i + 1 < run->inputs->len; i += 2) {
    JsonObject *o = json_object_new();
    set_text(o, "path", run->inputs->pdata[i]);
    set_text(o, "sha256", run->inputs->pdata[i + 1]);
    json_array_add_object_element(list, o);
  }
  return list;
}

static JsonObject *machine_json(void) {
  struct utsname about;
  if (uname(&about)) memset(&about, 0, sizeof about);
  JsonObject *o = json_object_new();
  set_text(o, "name", about.nodename);
  set_text(o, "system", about.sysname);
  set_text(o, "release", about.release);
  set_text(o, "machine", about.machine);
  json_object_set_int_member(o, "processors", g_get_num_processors());
  return o;
}

/* NULL without a store. */
static JsonObject *store_json(const opc_run *run) {
  if (!run->options->store) return NULL;
  JsonObject *o = json_object_new();
  JsonArray *list = json_array_new();
  set_text(o, "folder", opc_store_folder(run->options->store));
  json_object_set_int_member(o, "steps", (gint64)run->steps_done);
  json_object_set_int_member(o, "reused", (gint64)run->steps_reused);
  for (guint i = 0; i < run->histories->len; i++) {
    const opc_history *h = run->histories->pdata[i];
    JsonObject *one = json_object_new();
    if (h->point) json_object_set_int_member(one, "point", (gint64)h->point);
    set_text(one, "step", h->path);
    set_text(one, "result", h->reused ? "reused" : "ran");
    set_text(one, "key", h->key);
    set_text(one, "reason", h->reason);
    json_object_set_double_member(one, "seconds", h->seconds);
    json_array_add_object_element(list, one);
  }
  json_object_set_array_member(o, "results", list);
  return o;
}

static JsonObject *seconds_json(const opc_run *run) {
  JsonObject *o = json_object_new();
  for (guint i = 0; i < run->flow->order->len; i++) {
    const opc_flow_step *step = run->flow->order->pdata[i];
    double seconds = run->seconds[step->number];
    if (!isnan(seconds)) json_object_set_double_member(o, step->name, seconds);
  }
  return o;
}

JsonNode *opc_run_manifest_json(const opc_run *run) {
  JsonObject *o = json_object_new();
  JsonArray *plugins = json_array_new();
  g_autoptr(GHashTable) done = g_hash_table_new(NULL, NULL);
  g_autofree char *started = g_date_time_format_iso8601(run->started);
  add_plugins(plugins, done, run, run->flow);
  set_text(o, "opcflow", OPC_VERSION);
  set_text(o, "flow", run->flow->recipe->path);
  if (run->flow->variant) set_text(o, "variant", run->flow->variant);
  set_text(o, "result", run->failure ? "failed" : "complete");
  if (run->failure) set_text(o, "failure", run->failure);
  if (run->sweep) {
    json_object_set_int_member(o, "points", (gint64)run->sweep->points);
    json_object_set_int_member(o, "failed_points", (gint64)run->failed_points);
  }
  json_object_set_array_member(o, "command", texts_json(run->options->command));
  set_text(o, "started", started);
  json_object_set_double_member(o, "seconds", run->total);
  json_object_set_object_member(o, "steps", seconds_json(run));
  JsonObject *store = store_json(run);
  if (store) json_object_set_object_member(o, "store", store);
  json_object_set_int_member(o, "threads", opc_threads());
  json_object_set_object_member(o, "host", machine_json());
  json_object_set_array_member(o, "plugins", plugins);
  json_object_set_array_member(o, "inputs", inputs_json(run));
  return as_node(o);
}

/* ---- tables ---- */

/* JSON has neither NAN nor infinity: null. */
static void add_cell(JsonArray *cells, const opc_column *c, size_t row) {
  double real = c->type == OPC_REAL ? ((const double *)c->data)[row] : 0;
  if (c->type == OPC_TEXT)
    json_array_add_string_element(cells, ((const char *const *)c->data)[row]);
  else if (c->type == OPC_INT)
    json_array_add_int_element(cells, ((const int64_t *)c->data)[row]);
  else if (isfinite(real))
    json_array_add_double_element(cells, real);
  else
    json_array_add_null_element(cells);
}

JsonNode *opc_table_json(const opc_table *table) {
  JsonObject *o = json_object_new();
  JsonArray *columns = json_array_new(), *rows = json_array_new();
  for (size_t i = 0; i < table->n_columns; i++) {
    JsonObject *column = json_object_new();
    set_text(column, "name", table->columns[i].name);
    set_text(column, "unit", table->columns[i].unit);
    json_array_add_object_element(columns, column);
  }
  for (size_t row = 0; row < table->rows; row++) {
    JsonArray *cells = json_array_new();
    for (size_t i = 0; i < table->n_columns; i++)
      add_cell(cells, &table->columns[i], row);
    json_array_add_array_element(rows, cells);
  }
  set_text(o, "name", table->name);
  json_object_set_array_member(o, "columns", columns);
  json_object_set_array_member(o, "rows", rows);
  return as_node(o);
}
