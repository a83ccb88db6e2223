/* SPDX-License-Identifier: BSD-3-Clause */
/* Search for steps, plugins, parameters and metrics by their paths. */
#include "core/binding/lookup.h"

#include <base/suggest.h>
#include <string.h>

#include "core/plugin/declaration.h"

GPtrArray *opc_flow_bindings(const opc_flow *flow) {
  GPtrArray *list = g_ptr_array_new();
  for (guint i = 0; i < flow->order->len; i++)
    opc_binding_list(((opc_flow_step *)flow->order->pdata[i])->binding, list);
  return list;
}

const opc_parameter *opc_parameter_at(const GPtrArray *bindings,
                                      const char *path, opc_binding **owner) {
  for (guint i = 0; i < bindings->len; i++) {
    opc_binding *b = bindings->pdata[i];
    size_t n = strlen(b->path);
    if (strncmp(b->path, path, n) != 0 || path[n] != '.') continue;
    int found = opc_parameter_find(b->plugin, path + n + 1);
    if (found < 0) continue;
    *owner = b;
    return &b->plugin->parameters[found];
  }
  return NULL;
}

const opc_parameter *opc_flow_parameter(const opc_flow *flow,
                                        const char *path) {
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  opc_binding *owner;
  return opc_parameter_at(all, path, &owner);
}

opc_flow_step *opc_flow_find(const opc_flow *flow, const char *path) {
  size_t n = strcspn(path, ".");
  for (guint i = 0; i < flow->steps->len; i++) {
    opc_flow_step *step = flow->steps->pdata[i];
    if (strlen(step->name) == n && !strncmp(step->name, path, n)) return step;
  }
  return NULL;
}

const opc_binding *opc_flow_binding(const opc_flow *flow, const char *path,
                                    opc_error *error) {
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  g_autoptr(GPtrArray) paths = g_ptr_array_new();
  for (guint i = 0; i < all->len; i++) {
    const opc_binding *b = all->pdata[i];
    if (!strcmp(b->path, path)) return b;
    g_ptr_array_add(paths, b->path);
  }
  g_autofree char *suggestion = opc_suggestion(path, paths);
  opc_fail(error, OPC_INVALID, NULL, "'%s' does not exist in '%s'%s", path,
           flow->recipe->path, suggestion);
  return NULL;
}

const opc_metric *opc_flow_metric(const opc_flow *flow, const char *path,
                                  const opc_binding **binding,
                                  opc_error *error) {
  const char *dot = strrchr(path, '.');
  if (!dot) {
    opc_fail(error, OPC_INVALID, NULL,
             "'%s' does not name a metric, expected 'step.metric'", path);
    return NULL;
  }
  g_autofree char *of = g_strndup(path, (gsize)(dot - path));
  const opc_binding *b = *binding = opc_flow_binding(flow, of, error);
  if (!b) return NULL;
  const opc_metric *metric = opc_metric_find(b->plugin, dot + 1);
  if (metric) return metric;
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (size_t i = 0; i < b->plugin->n_metrics; i++)
    g_ptr_array_add(names, (char *)b->plugin->metrics[i].name);
  g_autofree char *suggestion = opc_suggestion(dot + 1, names);
  opc_fail(error, OPC_INVALID, NULL, "'%s' (%s) has no metric '%s'%s", of,
           b->plugin->id, dot + 1, suggestion);
  return NULL;
}
