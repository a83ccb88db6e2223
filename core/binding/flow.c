/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds a flow from a recipe and the changes applied to it. */
#include "core/binding/flow.h"

#include <base/file.h>
#include <base/layers.h>
#include <string.h>

#include "core/binding/connect.h"
#include "core/binding/inner.h"
#include "core/binding/outputs.h"
#include "core/binding/require.h"

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
  guint before = problems->list->len;
  if (!strcmp(key->text, "require") || !strcmp(key->text, "findings"))
    opc_wrong(problems, key, "'%s' cannot be the name of a step", key->text);
  if (!opc_is_name(key->text, FALSE))
    opc_wrong(
        problems, key,
        "the name of step '%s' must consist of letters, digits, '_' and '-'",
        key->text);
  if (node->type != OPC_NODE_MAP)
    opc_wrong(problems, node,
              "step '%s' must be a map, as in '{ use: PLUGIN }'", key->text);
  else
    step->binding =
        opc_bind(registry, node, step->name, &key->at, flags, problems);
  if (step->binding && problems->list->len == before)
    opc_inner_open(step->binding, registry, flags, problems);
}

/* ---- flows ---- */

/* Set the value at `path`, in the steps or in the section "require". */
static void lay_one(opc_flow *flow, const char *path, const opc_place *key,
                    const opc_node *value, opc_problems *problems) {
  size_t word = strcspn(path, ".");
  gboolean demand =
      word == strlen("require") && g_str_has_prefix(path, "require");
  if (demand)
    opc_lay_demands(flow->demands, path, key, value, problems);
  else
    opc_lay_at(flow->nodes, path, key, value, problems);
}

/* Apply a map of paths and values. */
static void lay_paths(opc_flow *flow, const opc_node *map,
                      opc_problems *problems) {
  for (guint i = 0; map && i < map->keys->len; i++) {
    const opc_node *key = map->keys->pdata[i];
    lay_one(flow, key->text, &key->at, map->items->pdata[i], problems);
  }
}

static void lay_variant(opc_flow *flow, const char *variant,
                        opc_problems *problems) {
  lay_paths(flow, opc_node_get(flow->recipe->variants, variant), problems);
}

/* Apply the values of all axes at a point. */
static void lay_point(opc_flow *flow, const opc_sweep *sweep, size_t point,
                      opc_problems *problems) {
  for (guint a = 0; a < sweep->axes->len; a++) {
    const opc_axis *axis = sweep->axes->pdata[a];
    guint i = opc_sweep_index(sweep, a, point);
    const opc_node *value = axis->values->pdata[i];
    if (axis->variants) {
      lay_variant(flow, axis->variants[i], problems);
      lay_paths(flow, value, problems);
    } else {
      opc_lay_at(flow->nodes, axis->info.path, &axis->at, value, problems);
    }
  }
}

static void lay_choice(opc_flow *flow, const opc_choice *choice,
                       opc_problems *problems) {
  if (choice->variant) lay_variant(flow, choice->variant, problems);
  if (choice->sweep) lay_point(flow, choice->sweep, choice->point, problems);
  for (const char *const *set = choice->sets; set && *set; set++) {
    g_autofree char *path = NULL;
    opc_source *source;
    g_autoptr(opc_node) value =
        opc_argument_parse("--set", *set, &path, &source, problems);
    g_ptr_array_add(flow->sources, source);
    if (value) lay_one(flow, path, &value->at, value, problems);
  }
  lay_paths(flow, choice->over, problems);
}

opc_flow *opc_flow_make(const opc_recipe *recipe, const opc_choice *choice,
                        opc_registry *registry, opc_problems *problems) {
  const char *variant = choice ? choice->variant : NULL;
  guint before = problems->list->len;
  opc_flow *flow = g_new0(opc_flow, 1);
  flow->recipe = recipe;
  flow->variant = variant;
  flow->name = g_strconcat(recipe->name, variant ? "-" : NULL, variant, NULL);
  flow->sources =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_source_free);
  flow->steps = g_ptr_array_new_with_free_func(step_free);
  flow->order = g_ptr_array_new();
  if (!recipe->steps) return flow;
  flow->demands = opc_node_copy(recipe->demands, NULL);
  flow->nodes = opc_node_copy(recipe->steps, NULL);
  if (choice) lay_choice(flow, choice, problems);
  if (!flow->nodes->items->len)
    opc_wrong(problems, flow->nodes, "the flow has no steps");
  const GPtrArray *keys = flow->nodes->keys, *items = flow->nodes->items;
  for (guint i = 0; i < keys->len && !opc_problems_full(problems); i++)
    read_step(flow, keys->pdata[i], items->pdata[i], registry,
              choice ? choice->bind : 0, problems);
  opc_flow_connect(flow, problems);
  if (problems->list->len > before) return flow;
  g_hash_table_destroy(opc_flow_outputs(flow, problems));
  opc_flow_require(flow, problems);
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
  opc_node_free(flow->demands);
  if (flow->requirements) g_ptr_array_free(flow->requirements, TRUE);
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

/* ---- checking ---- */

/* Largest number of values checked per axis: in a longer axis, the first 999
   values and the last one are checked. */
enum { MOST_VALUES = 1000 };

static void check_one(const opc_recipe *recipe, const opc_choice *choice,
                      opc_registry *registry, const opc_watch *watch,
                      opc_problems *problems) {
  if (opc_problems_full(problems)) return;
  g_autoptr(opc_problems) found = opc_problems_new();
  g_autoptr(opc_flow) flow = opc_flow_make(recipe, choice, registry, found);
  if (!found->list->len && watch)
    opc_flow_create(flow, NULL, watch, NULL, found);
  g_autofree char *note =
      choice->variant ? g_strdup_printf(" (variant '%s')", choice->variant)
                      : NULL;
  opc_problems_merge(problems, found, note);
}

/* The values of each axis are checked with the first values of the other axes.
   Problems of other combinations are found when the point runs. */
void opc_flow_check(const opc_recipe *recipe, const opc_choice *choice,
                    opc_registry *registry, const opc_watch *watch,
                    opc_problems *problems) {
  opc_choice at = *choice;
  at.point = 0;
  check_one(recipe, &at, registry, watch, problems);
  const GPtrArray *axes = choice->sweep ? choice->sweep->axes : NULL;
  for (guint a = 0; axes && a < axes->len; a++) {
    guint n = ((const opc_axis *)axes->pdata[a])->values->len;
    for (guint i = 1; i < n; i++) {
      if (i == MOST_VALUES - 1) i = n - 1;
      at.point = opc_sweep_point(choice->sweep, a, i);
      check_one(recipe, &at, registry, watch, problems);
    }
  }
}
