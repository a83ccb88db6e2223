/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <string.h>

#include "core/flow/unit.h"
#include "core/plugin/declaration.h"
#include "core/plugin/suggest.h"
#include "core/search/search.h"

/* What all checks need. */
typedef struct planner {
  opc_search_plan *plan;
  const opc_binding *binding; /* of the search */
  const opc_flow *flow;       /* the inner one */
  const opc_sweep *sweep;
  opc_problems *problems;
} planner;

#define WRONG(p, node, ...) \
  opc_problem_add((p)->problems, OPC_INVALID, &(node)->at, __VA_ARGS__)

/* ---- finding ---- */

/* A binding of the inner flow by its path, or all paths. */
typedef struct lookup {
  const char *path;
  const opc_binding *found;
  GPtrArray *paths;
} lookup;

static void look_at(opc_binding *b, void *data) {
  lookup *l = data;
  if (!strcmp(b->path, l->path)) l->found = b;
  g_ptr_array_add(l->paths, b->path);
}

static const opc_binding *find_binding(const planner *p, const opc_node *node,
                                       const char *path) {
  g_autoptr(GPtrArray) paths = g_ptr_array_new();
  lookup l = {path, NULL, paths};
  for (guint i = 0; i < p->flow->steps->len; i++) {
    const opc_flow_step *step = p->flow->steps->pdata[i];
    opc_binding_visit(step->binding, look_at, &l);
  }
  if (l.found) return l.found;
  g_autofree char *suggestion = opc_suggestion(path, paths);
  WRONG(p, node, "there is no '%s' in '%s'%s", path, p->flow->path, suggestion);
  return NULL;
}

/* The step that a path begins with; NULL and a problem. */
static const opc_flow_step *find_step(const planner *p, const opc_node *node,
                                      const char *path) {
  size_t n = strcspn(path, ".");
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < p->flow->steps->len; i++) {
    const opc_flow_step *step = p->flow->steps->pdata[i];
    if (strlen(step->name) == n && !strncmp(step->name, path, n)) return step;
    g_ptr_array_add(names, (char *)step->name);
  }
  g_autofree char *name = g_strndup(path, n);
  g_autofree char *suggestion = opc_suggestion(name, names);
  WRONG(p, node, "unknown step '%s' of '%s'%s", name, p->flow->path,
        suggestion);
  return NULL;
}

/* ---- the figure ---- */

static void find_metric(const planner *p, const opc_node *node,
                        const char *name) {
  const opc_plugin *plugin = p->plan->of->plugin;
  p->plan->metric = opc_metric_find(plugin, name);
  if (p->plan->metric) return;
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (size_t i = 0; i < plugin->n_metrics; i++)
    g_ptr_array_add(names, (char *)opc_metric_at(plugin, i)->name);
  g_autofree char *suggestion = opc_suggestion(name, names);
  WRONG(p, node, "'%s' (%s) has no metric '%s'%s", p->plan->of->path,
        plugin->id, name, suggestion);
}

static void plan_figure(const planner *p) {
  const opc_value *v = p->binding->values;
  gboolean least = v[SEARCH_MINIMISE].type != OPC_ABSENT;
  gboolean greatest = v[SEARCH_MAXIMISE].type != OPC_ABSENT;
  if (least == greatest) {
    opc_problem_add(p->problems, OPC_INVALID, &p->binding->at,
                    "a search needs either 'minimise' or 'maximise'");
    return;
  }
  size_t parameter = least ? SEARCH_MINIMISE : SEARCH_MAXIMISE;
  const opc_node *node = p->binding->origin[parameter];
  const char *text = v[parameter].text, *dot = strrchr(text, '.');
  p->plan->greatest = greatest;
  if (!dot) {
    WRONG(p, node, "'%s' is no figure, as 'step.metric'", text);
    return;
  }
  g_autofree char *path = g_strndup(text, (gsize)(dot - text));
  p->plan->of = find_binding(p, node, path);
  if (!p->plan->of) return;
  p->plan->figure_step = find_step(p, node, path)->number;
  find_metric(p, node, dot + 1);
}

/* ---- the mask ---- */

/* The port of a step that has a mask, -1 if it has none. */
static int mask_port(const opc_flow_step *step) {
  for (size_t i = 0; i < opc_port_count(step->binding->plugin); i++)
    if (!strcmp(opc_port_at(step->binding->plugin, i)->kind, "mask"))
      return (int)i;
  return -1;
}

/* That of the step that is named, or of the figure's. */
static void plan_mask(const planner *p) {
  const opc_node *node = p->binding->origin[SEARCH_MASK];
  const opc_flow_step *step =
      node ? find_step(p, node, p->binding->values[SEARCH_MASK].text)
           : p->flow->steps->pdata[p->plan->figure_step];
  if (!step) return;
  int port = mask_port(step);
  p->plan->mask_step = step->number;
  p->plan->mask_port = (size_t)port;
  if (port >= 0) return;
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < p->flow->steps->len; i++) {
    const opc_flow_step *other = p->flow->steps->pdata[i];
    if (mask_port(other) >= 0) g_ptr_array_add(names, (char *)other->name);
  }
  opc_problem_add(p->problems, OPC_INVALID, node ? &node->at : &p->binding->at,
                  names->len ? "step '%s' (%s) makes no mask: 'mask' names the "
                               "step whose mask is wanted, such as '%s'"
                             : "step '%s' (%s) makes no mask",
                  step->name, step->binding->plugin->id,
                  names->len ? (const char *)names->pdata[0] : "");
}

/* ---- what shares a run ---- */

static int find_axis(const planner *p, const opc_node *key) {
  g_autoptr(GPtrArray) paths = g_ptr_array_new();
  for (guint i = 0; i < p->sweep->axes->len; i++) {
    const opc_axis *axis = p->sweep->axes->pdata[i];
    if (!strcmp(axis->path, key->text)) return (int)i;
    g_ptr_array_add(paths, axis->path);
  }
  g_autofree char *suggestion = opc_suggestion(key->text, paths);
  WRONG(p, key, "'%s' is not swept%s", key->text, suggestion);
  return -1;
}

static void take_values(const planner *p, const opc_node *key) {
  opc_search_plan *plan = p->plan;
  const opc_axis *axis = p->sweep->axes->pdata[plan->along];
  const char *unit;
  gboolean good = opc_axis_is_numeric(axis, &unit) && !*unit;
  plan->count = axis->values->len;
  plan->values = g_new0(double, plan->count);
  for (guint i = 0; i < axis->values->len && good; i++) {
    const opc_node *node = axis->values->pdata[i];
    plan->values[i] = g_ascii_strtod(node->text, NULL);
    good = !i || plan->values[i] > plan->values[i - 1];
  }
  if (!good)
    WRONG(p, key, "'%s' needs plain numbers that increase, to share a run",
          axis->path);
}

static void plan_column(const planner *p, const opc_node *node,
                        const char *text) {
  g_auto(GStrv) parts = g_strsplit(text, ".", -1);
  if (g_strv_length(parts) != 3) {
    WRONG(p, node, "'%s' is no column, as 'step.table.column'", text);
    return;
  }
  const opc_flow_step *step = find_step(p, node, parts[0]);
  if (!step) return;
  if (!p->plan->of || strcmp(p->plan->of->path, step->name)) {
    WRONG(p, node, "the table has to be of the step of the figure, not of '%s'",
          step->name);
    return;
  }
  p->plan->table = g_strdup(parts[1]);
  p->plan->column = g_strdup(parts[2]);
}

static void plan_along(const planner *p) {
  const opc_node *map = p->binding->origin[SEARCH_ALONG];
  p->plan->along = -1;
  p->plan->count = p->plan->stride = 1;
  if (!map || !map->items->len) return;
  const opc_node *key = map->keys->pdata[0];
  if (map->items->len > 1)
    WRONG(p, (const opc_node *)map->keys->pdata[1],
          "only one parameter can share runs");
  p->plan->along = find_axis(p, key);
  if (p->plan->along < 0) return;
  take_values(p, key);
  for (guint i = (guint)p->plan->along + 1; i < p->sweep->axes->len; i++)
    p->plan->stride *= ((opc_axis *)p->sweep->axes->pdata[i])->values->len;
  plan_column(p, map->items->pdata[0],
              p->binding->values[SEARCH_ALONG].pairs[0].value);
}

/* ---- all of it ---- */

/* A parameter that the figure and the mask do not depend on is a mistake. */
static void check_axes(const planner *p) {
  g_autofree gboolean *needed = g_new0(gboolean, p->flow->steps->len);
  needed[p->plan->figure_step] = needed[p->plan->mask_step] = TRUE;
  opc_flow_find_needed(p->flow, needed);
  for (guint i = 0; i < p->sweep->axes->len; i++) {
    const opc_axis *axis = p->sweep->axes->pdata[i];
    const opc_node at = {.at = axis->at};
    const opc_flow_step *step = find_step(p, &at, axis->path);
    if (step && !needed[step->number])
      WRONG(p, &at, "'%s' changes nothing: step '%s' comes after the figure",
            axis->path, step->name);
  }
}

void opc_search_plan_make(opc_search_plan *plan, const opc_binding *binding,
                          opc_problems *problems) {
  guint before = problems->list->len;
  const planner p = {plan, binding, binding->inner->flow, binding->inner->sweep,
                     problems};
  *plan = (opc_search_plan){.along = -1};
  plan_figure(&p);
  plan_along(&p);
  if (!p.sweep->axes->len)
    opc_problem_add(problems, OPC_INVALID, &binding->at,
                    "a search needs a 'sweep', here or in '%s'", p.flow->path);
  if (problems->list->len > before) return;
  plan_mask(&p);
  if (problems->list->len == before) check_axes(&p);
}

void opc_search_plan_clear(opc_search_plan *plan) {
  g_free(plan->values);
  g_free(plan->table);
  g_free(plan->column);
}

void opc_search_check(const opc_binding *binding, opc_problems *problems) {
  opc_search_plan plan;
  opc_search_plan_make(&plan, binding, problems);
  opc_search_plan_clear(&plan);
}
