/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes a flow of a recipe and what is laid over it. */
#include "core/flow/flow.h"

#include <string.h>

#include "core/flow/layers.h"
#include "core/plugin/declaration.h"

/* ---- steps ---- */

static void step_free(gpointer item) {
  opc_flow_step *step = item;
  opc_binding_free(step->binding);
  g_array_free(step->inputs, TRUE);
  g_free(step);
}

static void read_step(opc_flow *flow, const opc_node *key, const opc_node *node,
                      opc_registry *registry, unsigned flags,
                      opc_problems *problems) {
  opc_flow_step *step = g_new0(opc_flow_step, 1);
  step->name = key->text;
  step->key = key;
  step->inputs = g_array_new(FALSE, TRUE, sizeof(opc_flow_input));
  step->number = flow->steps->len;
  g_ptr_array_add(flow->steps, step);
  if (!opc_is_name(key->text, FALSE))
    opc_wrong(problems, key,
              "the step '%s' needs a name of letters, digits, '_' and '-'",
              key->text);
  if (node->type != OPC_NODE_MAP)
    opc_wrong(problems, node, "the step '%s' needs a map, as '{ use: PLUGIN }'",
              key->text);
  else
    step->binding =
        opc_bind(registry, node, step->name, &key->at, flags, problems);
}

/* ---- the whole ---- */

/* Lay a map of paths and values over the steps. */
static void lay_paths(opc_flow *flow, const opc_node *map,
                      opc_problems *problems) {
  for (guint i = 0; map && i < map->keys->len; i++) {
    const opc_node *key = map->keys->pdata[i];
    opc_lay_at(flow->nodes, key->text, &key->at, map->items->pdata[i],
               problems);
  }
}

static void lay_choice(opc_flow *flow, const opc_choice *choice,
                       opc_problems *problems) {
  if (choice->variant)
    lay_paths(flow, opc_node_get(flow->recipe->variants, choice->variant),
              problems);
  if (choice->sweep)
    opc_sweep_lay(choice->sweep, choice->point, flow->nodes, problems);
  for (const char *const *set = choice->sets; set && *set; set++) {
    g_autofree char *path = NULL;
    opc_source *source;
    g_autoptr(opc_node) value =
        opc_argument_parse("--set", *set, &path, &source, problems);
    g_ptr_array_add(flow->sources, source);
    if (value) opc_lay_at(flow->nodes, path, &value->at, value, problems);
  }
  lay_paths(flow, choice->over, problems);
}

opc_flow *opc_flow_make(const opc_recipe *recipe, const opc_choice *choice,
                        opc_registry *registry, opc_problems *problems) {
  const char *variant = choice ? choice->variant : NULL;
  opc_flow *flow = g_new0(opc_flow, 1);
  flow->recipe = recipe;
  flow->variant = variant;
  flow->name = g_strconcat(recipe->name, variant ? "-" : NULL, variant, NULL);
  flow->sources =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_source_free);
  flow->steps = g_ptr_array_new_with_free_func(step_free);
  flow->order = g_ptr_array_new();
  if (!recipe->steps) return flow;
  flow->nodes = opc_node_copy(recipe->steps, NULL);
  if (choice) lay_choice(flow, choice, problems);
  if (!flow->nodes->items->len)
    opc_wrong(problems, flow->nodes, "no step is left");
  const GPtrArray *keys = flow->nodes->keys, *items = flow->nodes->items;
  for (guint i = 0; i < keys->len && !opc_problems_full(problems); i++)
    read_step(flow, keys->pdata[i], items->pdata[i], registry,
              choice ? choice->bind : 0, problems);
  opc_flow_connect(flow, problems);
  return flow;
}

opc_flow *opc_flow_load(const char *path, const char *const *sets,
                        opc_registry *registry, opc_problems *problems) {
  opc_recipe *recipe = opc_recipe_read(path, problems);
  if (!recipe) return NULL;
  const opc_choice choice = {.sets = sets};
  opc_flow *flow = opc_flow_make(recipe, &choice, registry, problems);
  flow->owned = recipe;
  return flow;
}

void opc_flow_free(opc_flow *flow) {
  if (!flow) return;
  g_ptr_array_free(flow->steps, TRUE);
  g_ptr_array_free(flow->order, TRUE);
  opc_node_free(flow->nodes);
  g_ptr_array_free(flow->sources, TRUE);
  opc_recipe_free(flow->owned);
  g_free(flow->name);
  g_free(flow);
}

gboolean opc_flow_create(const opc_flow *flow, const gboolean *left_out,
                         const opc_watch *watch, const opc_host *like,
                         opc_problems *problems) {
  gboolean good = TRUE;
  for (guint i = 0; i < flow->order->len; i++) {
    const opc_flow_step *step = flow->order->pdata[i];
    if (!left_out || !left_out[step->number])
      good &= opc_binding_create(step->binding, watch, like, problems);
  }
  return good;
}

GPtrArray *opc_flow_bindings(const opc_flow *flow) {
  GPtrArray *list = g_ptr_array_new();
  for (guint i = 0; i < flow->order->len; i++)
    opc_binding_list(((opc_flow_step *)flow->order->pdata[i])->binding, list);
  return list;
}
