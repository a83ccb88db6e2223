/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/inner.h"

#include "core/plugin/guard.h"

static const opc_inner_step *inner_step(const opc_plugin *plugin) {
  if (!plugin->get_extension || !opc_plugin_is_built_in(plugin)) return NULL;
  const char *before = opc_enter(plugin->id);
  const opc_inner_step *step = plugin->get_extension(OPC_INNER_FLOW);
  opc_leave(before);
  return step;
}

/* ---- what is laid over it ---- */

static void choose_variant(opc_inner *inner, const opc_binding *b,
                           size_t parameter, opc_problems *problems) {
  if (b->values[parameter].type == OPC_ABSENT) return;
  g_autoptr(opc_problems) found = opc_problems_new();
  inner->choice.variant =
      opc_recipe_variant(inner->recipe, b->values[parameter].text, found);
  for (guint i = 0; i < found->list->len; i++)
    opc_problem_add(problems, OPC_INVALID, &b->origin[parameter]->at, "%s",
                    ((const opc_problem *)found->list->pdata[i])->message);
}

/* What is set is not swept by the flow itself. */
static void choose_sweep(opc_inner *inner, const opc_node *swept,
                         opc_problems *problems) {
  const opc_node *set = inner->choice.over;
  g_autoptr(GPtrArray) fixed = g_ptr_array_new_with_free_func(g_free);
  for (guint i = 0; set && i < set->keys->len; i++)
    g_ptr_array_add(
        fixed, g_strconcat(((opc_node *)set->keys->pdata[i])->text, "=", NULL));
  g_ptr_array_add(fixed, NULL);
  inner->sweep = opc_sweep_new(inner->recipe, (const char *const *)fixed->pdata,
                               NULL, problems);
  if (swept) opc_sweep_lay_over(inner->sweep, swept, problems);
  inner->choice.sweep = inner->sweep;
}

/* ---- files ---- */

static void make_absolute(opc_node *node) {
  const char *folder = node->source->folder;
  if (g_path_is_absolute(node->text)) return;
  g_autofree char *path =
      g_build_filename(folder && *folder ? folder : ".", node->text, NULL);
  g_free(node->text);
  node->text = g_canonicalize_filename(path, NULL);
}

/* Of a value, of those of a list, and of what is in a map. As deep as files
   may nest. */
static void make_files_absolute(const opc_flow *flow, const char *path,
                                opc_node *node) {
  if (node->type == OPC_NODE_TEXT) {
    const opc_parameter *p = opc_flow_parameter(flow, path);
    if (p && p->type == OPC_FILE) make_absolute(node);
    return;
  }
  for (guint i = 0; i < node->items->len; i++) {
    const char *key =
        node->keys ? ((const opc_node *)node->keys->pdata[i])->text : NULL;
    g_autofree char *deeper =
        key ? g_strdup_printf("%s%s%s", path, *path ? "." : "", key)
            : g_strdup(path);
    make_files_absolute(flow, deeper, node->items->pdata[i]);
  }
}

/* ---- all of it ---- */

static void open_recipe(opc_inner *inner, const opc_binding *b,
                        const opc_inner_step *step, opc_problems *problems) {
  guint before = problems->list->len;
  const opc_node *set = b->origin[step->set], *sweep = b->origin[step->sweep];
  inner->choice = (opc_choice){.over = set, .bind = OPC_BIND_INNER};
  choose_variant(inner, b, step->variant, problems);
  choose_sweep(inner, sweep, problems);
  if (problems->list->len > before) return;
  opc_flow_check(inner->recipe, &inner->choice, inner->registry, NULL,
                 problems);
  if (problems->list->len > before) return;
  g_autoptr(opc_problems) told = opc_problems_new();
  inner->flow =
      opc_flow_make(inner->recipe, &inner->choice, inner->registry, told);
  if (set) make_files_absolute(inner->flow, "", (opc_node *)set);
  if (sweep) make_files_absolute(inner->flow, "", (opc_node *)sweep);
  step->check(b, problems);
}

void opc_inner_open(opc_binding *binding, opc_registry *registry,
                    unsigned flags, opc_problems *problems) {
  const opc_inner_step *step = inner_step(binding->plugin);
  if (!step) return;
  if (flags & OPC_BIND_INNER) {
    opc_problem_add(problems, OPC_INVALID, &binding->at,
                    "'%s' cannot stand in a flow that a step runs",
                    binding->plugin->id);
    return;
  }
  opc_inner *inner = binding->inner = g_new0(opc_inner, 1);
  inner->registry = registry;
  inner->recipe = opc_recipe_read(binding->values[step->flow].text, problems);
  if (inner->recipe) open_recipe(inner, binding, step, problems);
}

void opc_inner_free(opc_inner *inner) {
  if (!inner) return;
  opc_flow_free(inner->flow);
  opc_sweep_free(inner->sweep);
  opc_recipe_free(inner->recipe);
  g_free(inner);
}
