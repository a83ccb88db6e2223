/* SPDX-License-Identifier: BSD-3-Clause */
/* Resolves references between steps and determines the order of execution. */
#include <base/suggest.h>
#include <string.h>

#include "core/binding/connect.h"
#include "core/binding/lookup.h"
#include "core/plugin/declaration.h"

/* State of resolving the references of one step. */
typedef struct connector {
  opc_flow *flow;
  opc_flow_step *step;
  opc_problems *problems;
} connector;

static gboolean unknown_step(const connector *c, const opc_node *node,
                             const char *name) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < c->flow->steps->len; i++) {
    const opc_flow_step *step = c->flow->steps->pdata[i];
    if (step != c->step) g_ptr_array_add(names, (char *)step->name);
  }
  g_autofree char *suggestion = opc_suggestion(name, names);
  return opc_wrong(c->problems, node, "unknown step '%s' in '%s'%s", name,
                   node->text, suggestion);
}

/* Store in *port the index of the output `name`, or 0 if `name` is NULL. Return
   FALSE and add a problem if the step has no such output. */
static gboolean find_port(const connector *c, const opc_node *node,
                          const opc_flow_step *from, const char *name,
                          size_t *port) {
  const opc_plugin *plugin = from->binding->plugin;
  size_t n = opc_port_count(plugin);
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  if (!n)
    return opc_wrong(c->problems, node, "step '%s' (%s) has no output",
                     from->name, plugin->id);
  for (*port = 0; *port < n; ++*port) {
    const char *its = opc_port_at(plugin, *port)->name;
    if (!name || !strcmp(its, name)) return TRUE;
    g_ptr_array_add(names, (char *)its);
  }
  g_autofree char *suggestion = opc_suggestion(name, names);
  return opc_wrong(c->problems, node, "step '%s' (%s) has no output '%s'%s",
                   from->name, plugin->id, name, suggestion);
}

static gboolean connect_input(const connector *c, opc_binding *binding,
                              size_t parameter) {
  const opc_parameter *p = &binding->plugin->parameters[parameter];
  const opc_node *node = binding->origin[parameter];
  g_auto(GStrv) parts =
      g_strsplit(binding->values[parameter].reference, ".", 2);
  const opc_flow_step *from = opc_flow_find(c->flow, parts[0]);
  opc_flow_input input = {binding, parameter, from, 0};
  if (!from) return unknown_step(c, node, parts[0]);
  if (from->binding) {
    if (!find_port(c, node, from, parts[1], &input.port)) return FALSE;
    const char *kind = opc_port_at(from->binding->plugin, input.port)->kind;
    g_auto(GStrv) wanted = opc_choice_list(p->choices);
    if (!g_strv_contains((const char *const *)wanted, kind))
      return opc_wrong(
          c->problems, node,
          "'%s' requires data of the kind '%s', but '%s' is of the kind '%s'",
          p->name, p->choices, node->text, kind);
  }
  g_array_append_val(c->step->inputs, input);
  return TRUE;
}

static void connect_step(const connector *c) {
  g_autoptr(GPtrArray) all = g_ptr_array_new();
  opc_binding_list(c->step->binding, all);
  for (guint k = 0; k < all->len; k++) {
    opc_binding *b = all->pdata[k];
    for (size_t i = 0; i < b->plugin->n_parameters; i++)
      if (b->values[i].reference) connect_input(c, b, i);
  }
}

/* Return the first step that `step` depends on and that is not `placed` in the
   order; NULL if there is no such step, so that `step` can run next. */
static opc_flow_step *step_awaited(const opc_flow_step *step,
                                   const gboolean *placed) {
  for (guint i = 0; i < step->inputs->len; i++) {
    const opc_flow_step *from =
        g_array_index(step->inputs, opc_flow_input, i).from;
    if (!placed[from->number]) return (opc_flow_step *)from;
  }
  return NULL;
}

/* Report a cycle among the steps that are not `placed` in the order: follow
   dependencies until a step repeats. */
static void report_circle(const opc_flow *flow, const gboolean *placed,
                          opc_problems *problems) {
  guint first = 0;
  while (placed[first]) first++;
  opc_flow_step *step = flow->steps->pdata[first];
  g_autoptr(GPtrArray) trail = g_ptr_array_new();
  while (!g_ptr_array_find(trail, step, &first)) {
    g_ptr_array_add(trail, step);
    step = step_awaited(step, placed);
  }
  g_autoptr(GString) text = g_string_new(NULL);
  for (guint i = first; i < trail->len; i++)
    g_string_append_printf(text, "%s -> ",
                           ((opc_flow_step *)trail->pdata[i])->name);
  opc_wrong(problems, step->key, "steps depend on each other in a cycle: %s%s",
            text->str, step->name);
}

/* Order the steps: the next step is the first one in the file whose
   dependencies are already in the order. */
static void find_order(opc_flow *flow, opc_problems *problems) {
  guint n = flow->steps->len;
  g_autofree gboolean *placed = g_new0(gboolean, MAX(n, 1));
  while (flow->order->len < n) {
    opc_flow_step *next = NULL;
    for (guint i = 0; i < n && !next; i++)
      if (!placed[i] && !step_awaited(flow->steps->pdata[i], placed))
        next = flow->steps->pdata[i];
    if (!next) {
      report_circle(flow, placed, problems);
      return;
    }
    placed[next->number] = TRUE;
    g_ptr_array_add(flow->order, next);
  }
}

void opc_flow_connect(opc_flow *flow, opc_problems *problems) {
  for (guint i = 0; i < flow->steps->len; i++) {
    const connector c = {flow, flow->steps->pdata[i], problems};
    if (c.step->binding) connect_step(&c);
  }
  find_order(flow, problems);
}

gboolean *opc_flow_needed(const opc_flow *flow, const gboolean *wanted,
                          const gboolean *given) {
  gboolean *needed = g_memdup2(wanted, flow->steps->len * sizeof *needed);
  for (guint i = flow->order->len; i-- > 0;) {
    const opc_flow_step *step = flow->order->pdata[i];
    needed[step->number] &= !given[step->number];
    for (guint k = 0; needed[step->number] && k < step->inputs->len; k++)
      needed[g_array_index(step->inputs, opc_flow_input, k).from->number] =
          TRUE;
  }
  return needed;
}
