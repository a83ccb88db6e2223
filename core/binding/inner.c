/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the reading, the checks and the queries of inner flows. */
#include "core/binding/inner.h"

#include <base/suggest.h>
#include <string.h>

#include "core/binding/connect.h"
#include "core/binding/expand.h"
#include "core/binding/lookup.h"
#include "core/plugin/declaration.h"

/* Limit of nested inner flows, such as an experiment that runs searches. */
enum { DEEPEST = 2 };

/* ---- reading: variant and parameters ---- */

/* Return the index of a parameter by name and type, -1 if missing. */
static int find_parameter(const opc_plugin *plugin, const char *name,
                          uint32_t type) {
  int i = opc_parameter_find(plugin, name);
  return i >= 0 && plugin->parameters[i].type == type ? i : -1;
}

static const opc_node *find_map(const opc_binding *b, const char *name) {
  int i = find_parameter(b->plugin, name, OPC_MAP);
  return i < 0 ? NULL : b->origin[i];
}

static void choose_variant(opc_inner *inner, const opc_binding *b,
                           opc_problems *problems) {
  int i = find_parameter(b->plugin, "variant", OPC_TEXT);
  if (i < 0 || !b->values[i].present) return;
  inner->choice.variant = b->values[i].field.text;
  opc_recipe_has(inner->recipe, inner->choice.variant,
                 opc_binding_origin(b, (size_t)i), problems);
}

/* ---- reading: files ---- */

/* Make the file names in a text, list or map absolute. The depth limit of flow
   files also limits the recursion. */
static void make_files_absolute(const opc_flow *flow, const char *path,
                                opc_node *node) {
  if (node->type == OPC_NODE_TEXT) {
    const opc_parameter *p = opc_flow_parameter(flow, path);
    if (!p || p->type != OPC_FILE || g_path_is_absolute(node->text)) return;
    g_autofree char *file = opc_node_path(node);
    g_free(node->text);
    node->text = g_canonicalize_filename(file, NULL);
    return;
  }
  for (guint i = 0; i < node->items->len; i++) {
    g_autofree char *deeper =
        node->keys ? g_strdup_printf("%s%s%s", path, *path ? "." : "",
                                     opc_node_key(node, i))
                   : g_strdup(path);
    make_files_absolute(flow, deeper, node->items->pdata[i]);
  }
}

/* ---- reading: layers, and steps that are given ---- */

static void add_layers(opc_inner *inner, const opc_binding *b,
                       opc_problems *problems) {
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    const opc_parameter *p = &b->plugin->parameters[i];
    if (p->flags & OPC_INNER_AXIS && b->origin[i])
      opc_expand(inner->sweep, p->name, b->origin[i], inner->recipe,
                 &inner->choice, inner->registry, problems);
  }
}

/* Make the file names in layers and the names of list files absolute. */
static void make_layers_absolute(const opc_flow *flow, opc_node *all) {
  for (guint i = 0; i < all->items->len; i++) {
    opc_node *layer = all->items->pdata[i], *list = opc_node_get(layer, "list");
    make_files_absolute(flow, "", layer);
    if (!list || list->type != OPC_NODE_TEXT) continue;
    g_autofree char *file = opc_node_path(list);
    g_free(list->text);
    list->text = g_canonicalize_filename(file, NULL);
  }
}

static void find_steps(opc_inner *inner, const opc_binding *b,
                       opc_problems *problems) {
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    const opc_parameter *p = &b->plugin->parameters[i];
    if (p->flags & OPC_INNER_AXIS && b->origin[i])
      make_layers_absolute(inner->flow, (opc_node *)b->origin[i]);
    if (!(p->flags & OPC_INNER_STEP) || !b->values[i].present) continue;
    const opc_flow_step *step = opc_flow_find(inner->flow, p->name);
    const opc_plugin *plugin = step ? step->binding->plugin : NULL;
    if (!plugin || opc_port_count(plugin) != 1 ||
        strcmp(opc_port_at(plugin, 0)->kind, p->choices) != 0)
      opc_problem_add(problems, OPC_INVALID, opc_binding_origin(b, i),
                      "'%s' has no step '%s' with an output of the kind %s as "
                      "the only output",
                      inner->recipe->path, p->name, p->choices);
    else
      g_hash_table_insert(inner->given, g_strdup(p->name), g_new0(void *, 1));
  }
}

/* ---- reading: inner flows ---- */

static void open_recipe(opc_inner *inner, const opc_binding *b,
                        opc_problems *problems) {
  guint before = problems->list->len;
  const opc_node *set = find_map(b, "set"), *sweep = find_map(b, "sweep");
  /* A parameter in `set` is not swept, even if the inner flow sweeps it. */
  inner->sweep = opc_sweep_new(inner->recipe, NULL, set, NULL, problems);
  if (sweep) opc_sweep_lay_over(inner->sweep, sweep, problems);
  inner->choice.over = set;
  inner->choice.sweep = inner->sweep;
  choose_variant(inner, b, problems);
  if (problems->list->len == before) add_layers(inner, b, problems);
  if (problems->list->len > before) return;
  opc_flow_check(inner->recipe, &inner->choice, inner->registry, NULL,
                 problems);
  if (problems->list->len > before) return;
  g_autoptr(opc_problems) known = opc_problems_new();
  inner->flow =
      opc_flow_make(inner->recipe, &inner->choice, inner->registry, known);
  if (set) make_files_absolute(inner->flow, "", (opc_node *)set);
  if (sweep) make_files_absolute(inner->flow, "", (opc_node *)sweep);
  find_steps(inner, b, problems);
  const GPtrArray *axes = inner->sweep->axes;
  inner->axes = g_new0(opc_inner_axis *, axes->len + 1);
  for (guint i = 0; i < axes->len; i++)
    inner->axes[i] = &((opc_axis *)axes->pdata[i])->info;
}

static void inner_free(opc_inner *inner) {
  if (inner->runs) inner->runs_free(inner->runs);
  opc_flow_free(inner->flow);
  opc_sweep_free(inner->sweep);
  opc_recipe_free(inner->recipe);
  g_free(inner->axes);
  g_hash_table_destroy(inner->wanted);
  g_hash_table_destroy(inner->given);
  g_free(inner);
}

/* Report the problems that the checks of instances in the inner flow find. */
static int inner_check(const opc_inner *inner, opc_error *error) {
  static const opc_watch nowhere = {.data = NULL};
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_flow_check(inner->recipe, &inner->choice, inner->registry, &nowhere,
                 problems);
  return opc_problems_error(problems, error);
}

/* Fail: an inner flow cannot be started outside a run. */
static int refuse_to_begin(const opc_host *host, opc_error *error) {
  return opc_fail(error, OPC_FAILED, NULL, "%s runs in flows only",
                  ((const opc_binding *)host->data)->plugin->id);
}

static const opc_inner_service asking = {.size = sizeof asking,
                                         .axes = opc_inner_axes,
                                         .axis = opc_inner_find_axis,
                                         .metric = opc_inner_find_metric,
                                         .output = opc_inner_find_output,
                                         .begin = refuse_to_begin};

static const opc_nested nested = {&asking, inner_check, inner_free};

static void open_one(opc_binding *binding, opc_registry *registry,
                     unsigned flags, opc_problems *problems) {
  const opc_plugin *plugin = binding->plugin;
  size_t i = 0;
  while (i < plugin->n_parameters &&
         !(plugin->parameters[i].flags & OPC_INNER_FLOW))
    i++;
  if (i == plugin->n_parameters || !binding->values[i].present) return;
  if (flags / OPC_BIND_INNER >= DEEPEST) {
    opc_problem_add(
        problems, OPC_INVALID, &binding->at,
        "'%s' cannot be used here: inner flows may be nested only twice",
        plugin->id);
    return;
  }
  opc_inner *inner = binding->inner = g_new0(opc_inner, 1);
  binding->nested = &nested;
  inner->binding = binding;
  inner->registry = registry;
  inner->wanted = g_hash_table_new(g_str_hash, g_str_equal);
  inner->given = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  inner->choice.bind = flags + OPC_BIND_INNER;
  inner->recipe = opc_recipe_read(binding->values[i].field.text, problems);
  if (inner->recipe) open_recipe(inner, binding, problems);
}

void opc_inner_open(opc_binding *binding, opc_registry *registry,
                    unsigned flags, opc_problems *problems) {
  g_autoptr(GPtrArray) all = g_ptr_array_new();
  opc_binding_list(binding, all);
  for (guint i = 0; i < all->len; i++)
    open_one(all->pdata[i], registry, flags, problems);
}

void opc_inner_end(opc_inner *inner) {
  if (inner && inner->runs) inner->runs_end(inner->runs);
}

const opc_flow *opc_inner_flow(const opc_inner *inner) { return inner->flow; }

void opc_inner_visit(const opc_inner *inner,
                     void (*visit)(void *data, const opc_flow *flow),
                     void *data) {
  visit(data, inner->flow);
  for (guint a = 0; a < inner->sweep->axes->len; a++) {
    const opc_axis *axis = inner->sweep->axes->pdata[a];
    for (guint i = 1; i < axis->values->len; i++) {
      opc_choice choice = inner->choice;
      choice.point = opc_sweep_point(inner->sweep, a, i);
      g_autoptr(opc_problems) known = opc_problems_new();
      g_autoptr(opc_flow) flow =
          opc_flow_make(inner->recipe, &choice, inner->registry, known);
      visit(data, flow);
    }
  }
}

/* ---- queries ---- */

gboolean *opc_inner_needed(const opc_inner *in, const opc_flow *flow) {
  g_autofree gboolean *given = g_new0(gboolean, flow->steps->len);
  g_autofree gboolean *wanted = g_new0(gboolean, flow->steps->len);
  gboolean all = !g_hash_table_size(in->wanted);
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    given[i] = g_hash_table_contains(in->given, step->name);
    wanted[i] = all || g_hash_table_contains(in->wanted, step->name);
  }
  return opc_flow_needed(flow, wanted, given);
}

opc_inner *opc_inner_of(const opc_host *host) {
  return ((const opc_binding *)host->data)->inner;
}

const opc_metric *opc_inner_find_metric(const opc_host *host, const char *path,
                                        opc_error *error) {
  opc_inner *in = opc_inner_of(host);
  const opc_binding *b;
  const opc_metric *metric = opc_flow_metric(in->flow, path, &b, error);
  if (metric)
    g_hash_table_add(in->wanted, (char *)opc_flow_find(in->flow, path)->name);
  return metric;
}

int opc_inner_port(const opc_plugin *plugin, const char *kind) {
  for (size_t i = 0; i < opc_port_count(plugin); i++)
    if (!strcmp(opc_port_at(plugin, i)->kind, kind)) return (int)i;
  return -1;
}

const char *opc_inner_find_output(const opc_host *host, const char *name,
                                  const char *kind, opc_error *error) {
  opc_inner *in = opc_inner_of(host);
  const opc_binding *b = name ? opc_flow_binding(in->flow, name, error) : NULL;
  for (guint i = 0; !name && i < in->flow->steps->len; i++) {
    b = ((const opc_flow_step *)in->flow->steps->pdata[i])->binding;
    if (opc_inner_port(b->plugin, kind) >= 0) break;
  }
  if (!b) return NULL;
  g_hash_table_add(in->wanted, (char *)opc_flow_find(in->flow, b->path)->name);
  if (opc_inner_port(b->plugin, kind) >= 0) return b->path;
  g_autofree char *label = opc_binding_label(b);
  opc_fail(error, OPC_INVALID, NULL, "%s makes no %s", label, kind);
  return NULL;
}

const opc_inner_axis *const *opc_inner_axes(const opc_host *host,
                                            size_t *count) {
  opc_inner *in = opc_inner_of(host);
  g_autofree gboolean *needed = opc_inner_needed(in, in->flow);
  *count = in->sweep->axes->len;
  for (size_t i = 0; i < *count; i++) {
    const opc_axis *axis = in->sweep->axes->pdata[i];
    in->axes[i]->used = FALSE;
    for (guint k = 0; k < in->flow->steps->len; k++) {
      const opc_flow_step *step = in->flow->steps->pdata[k];
      in->axes[i]->used |=
          needed[k] && opc_axis_touches(axis, in->recipe, step->name);
    }
  }
  return (const opc_inner_axis *const *)in->axes;
}

int opc_inner_find_axis(const opc_host *host, const char *path,
                        opc_error *error) {
  const opc_inner *in = opc_inner_of(host);
  g_autoptr(GPtrArray) paths = g_ptr_array_new();
  for (guint i = 0; i < in->sweep->axes->len; i++) {
    if (!strcmp(in->axes[i]->path, path)) return (int)i;
    g_ptr_array_add(paths, (char *)in->axes[i]->path);
  }
  g_autofree char *suggestion = opc_suggestion(path, paths);
  opc_fail(error, OPC_INVALID, NULL, "'%s' is not a swept parameter%s", path,
           suggestion);
  return -1;
}
