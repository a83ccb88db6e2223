/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/flow.h"

#include <string.h>

#include "core/flow/value.h"
#include "core/plugin/declaration.h"
#include "core/plugin/suggest.h"

#define WRONG(problems, node, ...) \
  opc_problem_add(problems, OPC_INVALID, &(node)->at, __VA_ARGS__)

/* ---- the head of the file ---- */

static void check_keys(const opc_node *root, opc_problems *problems) {
  static const char *const known[] = {"opcflow", "name", "description", "steps",
                                      NULL};
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; known[i]; i++) g_ptr_array_add(names, (char *)known[i]);
  for (guint i = 0; i < root->keys->len; i++) {
    const opc_node *key = root->keys->pdata[i];
    if (g_strv_contains(known, key->text)) continue;
    g_autofree char *suggestion = opc_suggestion(key->text, names);
    WRONG(problems, key, "unknown key '%s'%s", key->text, suggestion);
  }
}

static void check_version(const opc_node *root, opc_problems *problems) {
  const opc_node *version = opc_node_get(root, "opcflow");
  if (!version)
    WRONG(problems, root, "missing 'opcflow: 1', the version of the format");
  else if (version->type != OPC_NODE_TEXT || strcmp(version->text, "1"))
    WRONG(problems, version, "'opcflow' must be 1, the version of the format");
}

/* Letters, digits, '_', '-' and, if `dots`, dots; not a dot first. */
static gboolean is_name(const char *text, gboolean dots) {
  if (!g_ascii_isalnum(*text) && *text != '_') return FALSE;
  for (; *text; text++)
    if (!g_ascii_isalnum(*text) && *text != '_' && *text != '-' &&
        !(dots && *text == '.'))
      return FALSE;
  return TRUE;
}

/* The name that the file gives itself, or what it is called. */
static char *flow_name(const opc_node *root, const char *path,
                       opc_problems *problems) {
  const opc_node *name = opc_node_get(root, "name");
  if (name && name->type == OPC_NODE_TEXT && is_name(name->text, TRUE))
    return g_strdup(name->text);
  if (name)
    WRONG(problems, name,
          "'name' is made of letters, digits, '.', '_' and '-'");
  char *base = g_path_get_basename(path);
  char *dot = strrchr(base, '.');
  if (dot && dot > base) *dot = 0;
  for (char *c = base; *c; c++)
    if (!g_ascii_isalnum(*c) && !strchr("._-", *c)) *c = '_';
  if (*base == '.' || *base == '-') *base = '_';
  return base;
}

static char *flow_description(const opc_node *root, opc_problems *problems) {
  const opc_node *text = opc_node_get(root, "description");
  if (!text) return NULL;
  if (text->type == OPC_NODE_TEXT) return g_strdup(text->text);
  WRONG(problems, text, "'description' needs a text, not %s",
        opc_node_noun(text));
  return NULL;
}

/* ---- steps ---- */

static void step_free(gpointer item) {
  opc_flow_step *step = item;
  opc_binding_free(step->binding);
  g_array_free(step->inputs, TRUE);
  g_free(step);
}

static void read_step(opc_flow *flow, const opc_node *key, const opc_node *node,
                      opc_registry *registry, opc_problems *problems) {
  opc_flow_step *step = g_new0(opc_flow_step, 1);
  step->name = key->text;
  step->key = key;
  step->node = node;
  step->inputs = g_array_new(FALSE, TRUE, sizeof(opc_flow_input));
  step->number = flow->steps->len;
  g_ptr_array_add(flow->steps, step);
  if (!is_name(key->text, FALSE))
    WRONG(problems, key,
          "the step '%s' needs a name of letters, digits, '_' and '-'",
          key->text);
  if (node->type != OPC_NODE_MAP)
    WRONG(problems, node, "the step '%s' needs a map, as '{ use: PLUGIN }'",
          key->text);
  else
    step->binding = opc_bind(registry, node, OPC_KIND_STEP, step->name,
                             &key->at, 0, problems);
}

static void read_steps(opc_flow *flow, opc_registry *registry,
                       opc_problems *problems) {
  const opc_node *steps = opc_node_get(flow->root, "steps");
  if (!steps || steps->type != OPC_NODE_MAP || !steps->items->len) {
    WRONG(problems, steps ? steps : flow->root,
          steps ? "'steps' needs a map of steps" : "missing 'steps'");
    return;
  }
  for (guint i = 0; i < steps->items->len; i++)
    read_step(flow, steps->keys->pdata[i], steps->items->pdata[i], registry,
              problems);
}

/* ---- the whole ---- */

opc_flow *opc_flow_load(const char *path, const char *const *sets,
                        opc_registry *registry, opc_problems *problems) {
  g_autofree char *folder = g_path_get_dirname(path);
  opc_flow *flow = g_new0(opc_flow, 1);
  flow->path = g_strdup(path);
  flow->sources =
      g_ptr_array_new_with_free_func((GDestroyNotify)opc_source_free);
  flow->steps = g_ptr_array_new_with_free_func(step_free);
  flow->order = g_ptr_array_new();
  opc_source *source = opc_source_new(path, strcmp(folder, ".") ? folder : "");
  g_ptr_array_add(flow->sources, source);
  flow->root = opc_node_read(source, path, problems);
  if (flow->root && flow->root->type != OPC_NODE_MAP) {
    WRONG(problems, flow->root, "a flow is a map, not %s",
          opc_node_noun(flow->root));
    g_clear_pointer(&flow->root, opc_node_free);
  }
  if (!flow->root) {
    opc_flow_free(flow);
    return NULL;
  }
  check_keys(flow->root, problems);
  check_version(flow->root, problems);
  flow->name = flow_name(flow->root, path, problems);
  flow->description = flow_description(flow->root, problems);
  for (; sets && *sets; sets++)
    opc_override(flow->root, *sets, flow->sources, problems);
  read_steps(flow, registry, problems);
  opc_flow_connect(flow, problems);
  return flow;
}

void opc_flow_free(opc_flow *flow) {
  if (!flow) return;
  g_ptr_array_free(flow->steps, TRUE);
  g_ptr_array_free(flow->order, TRUE);
  opc_node_free(flow->root);
  g_ptr_array_free(flow->sources, TRUE);
  g_free(flow->path);
  g_free(flow->name);
  g_free(flow->description);
  g_free(flow);
}

gboolean opc_flow_create(opc_flow *flow, const opc_sink *sink, void *listener,
                         opc_problems *problems) {
  gboolean good = TRUE;
  for (guint i = 0; i < flow->order->len; i++) {
    opc_flow_step *step = flow->order->pdata[i];
    good &= opc_binding_create(step->binding, sink, listener, problems);
  }
  return good;
}
