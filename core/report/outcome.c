/* SPDX-License-Identifier: BSD-3-Clause */
/* Sets up and clears outcomes; returns metrics and findings as JSON. */
#include "core/report/outcome.h"

#include <math.h>

#include "core/report/json.h"

void opc_outcome_init(opc_outcome *out, guint steps) {
  *out = (opc_outcome){.started = g_date_time_new_now_local()};
  out->tables = g_ptr_array_new_with_free_func((GDestroyNotify)opc_table_free);
  out->metrics = g_array_new(FALSE, TRUE, sizeof(opc_inner_metric));
  out->inputs = g_ptr_array_new_with_free_func(g_free);
  out->verdicts = opc_verdicts_new();
  opc_findings_init(&out->findings);
  opc_histories_init(&out->histories);
  out->processor = g_new0(double, steps);
  out->seconds = g_new(double, steps);
  for (guint i = 0; i < steps; i++) out->seconds[i] = NAN;
}

void opc_outcome_clear(opc_outcome *out) {
  opc_histories_clear(&out->histories);
  opc_findings_clear(&out->findings);
  g_ptr_array_free(out->verdicts, TRUE);
  g_ptr_array_free(out->inputs, TRUE);
  g_ptr_array_free(out->tables, TRUE);
  g_array_free(out->metrics, TRUE);
  opc_table_free(out->points);
  g_date_time_unref(out->started);
  g_free(out->processor);
  g_free(out->seconds);
  g_free(out->folder);
  g_free(out->failure);
}

void opc_outcome_fail_point(opc_outcome *out, int code) {
  gboolean differs = out->failed_points && out->points_code != code;
  out->points_code = differs || code != OPC_LIMIT ? OPC_FAILED : code;
  out->failed_points++;
}

static void set_text(JsonObject *o, const char *key, const char *text) {
  json_object_set_string_member(o, key, text);
}

static JsonArray *findings_json(const opc_outcome *out) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i < out->findings.list->len; i++) {
    const opc_finding *f = out->findings.list->pdata[i];
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

static JsonArray *verdicts_json(const opc_outcome *out) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i < out->verdicts->len; i++) {
    const opc_verdict *v = out->verdicts->pdata[i];
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

void opc_outcome_add_findings(JsonObject *o, const opc_outcome *out) {
  json_object_set_array_member(o, "require", verdicts_json(out));
  json_object_set_array_member(o, "findings", findings_json(out));
  if (out->findings.more)
    json_object_set_int_member(o, "more_findings", (gint64)out->findings.more);
}

JsonNode *opc_outcome_metrics(const opc_outcome *out) {
  JsonObject *all = json_object_new();
  for (guint i = 0; i < out->metrics->len; i++) {
    const opc_inner_metric *m =
        &g_array_index(out->metrics, opc_inner_metric, i);
    if (!json_object_has_member(all, m->path))
      json_object_set_object_member(all, m->path, json_object_new());
    json_object_set_member(json_object_get_object_member(all, m->path),
                           m->metric->name,
                           opc_metric_json(m->metric, m->value));
  }
  JsonNode *node = json_node_new(JSON_NODE_OBJECT);
  json_node_take_object(node, all);
  return node;
}

char *opc_outcome_metrics_text(const opc_outcome *out) {
  JsonNode *all = opc_outcome_metrics(out);
  opc_outcome_add_findings(json_node_get_object(all), out);
  return opc_json_text(all);
}
