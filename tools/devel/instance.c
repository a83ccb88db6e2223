/* SPDX-License-Identifier: BSD-3-Clause */
/* Generates required parameters of a plugin and creates an instance. */
#include "tools/devel/instance.h"

#include <base/layers.h>
#include <string.h>

#include "core/binding/inner.h"
#include "core/plugin/value.h"

/* ---- generated values ---- */

static double sample_number(const opc_parameter *p) {
  gboolean low = p->flags & (OPC_AT_LEAST | OPC_ABOVE);
  gboolean high = p->flags & (OPC_AT_MOST | OPC_BELOW);
  if (low && high) return p->type == OPC_INT ? p->max : (p->min + p->max) / 2;
  if (low) return p->min + 1;
  return high ? p->max - 1 : 1;
}

/* Return a value (g_free); NULL for types without a generated value. */
static char *sample_text(const char *file, const opc_parameter *p) {
  g_autofree char *number = opc_quantity_text(p, sample_number(p));
  g_auto(GStrv) words = opc_choice_list(p->choices);
  switch (p->type) {
    case OPC_BOOL:
      return g_strdup("true");
    case OPC_INT:
    case OPC_REAL:
      return g_steal_pointer(&number);
    case OPC_REALS:
      return g_strdup_printf("[%s]", number);
    case OPC_CHOICE:
      return g_strdup(words[0]);
    case OPC_FILE:
      return file ? g_strdup_printf("'%s'", file) : NULL;
    case OPC_TEXT:
    case OPC_OUTPUT:
      return g_strdup("sample");
    case OPC_MAP:
      return g_strdup_printf("{ %s: sample }", words[0] ? words[0] : "sample");
    default:
      return NULL;
  }
}

/* ---- an instance ---- */

/* Set a parameter of a map to a value in flow syntax. */
static void map_put(opc_node *map, const opc_source *source, const char *name,
                    const char *text, opc_problems *problems) {
  g_autofree char *flow = g_strdup_printf("{ %s: %s }", name, text);
  g_autoptr(opc_node) over =
      opc_node_parse(source, flow, strlen(flow), problems);
  g_autoptr(opc_node) deep = over ? opc_undot(over, FALSE, problems) : NULL;
  if (deep) opc_lay(map, deep, problems);
}

/* Largest depth of nested slots. */
enum { DEEPEST = 3 };

/* Return the first loadable plugin of a kind; NULL if none. */
static const opc_plugin *first_of(opc_registry *registry, const char *kind) {
  g_autofree char *prefix = g_strconcat(kind, ".", NULL);
  g_autoptr(GPtrArray) ids = opc_registry_ids(registry, prefix);
  const opc_plugin *found = NULL;
  opc_error none;
  for (guint i = 0; i < ids->len && !found; i++)
    found = opc_registry_find(registry, ids->pdata[i], &none);
  return found;
}

static gboolean is_given(const opc_instance *made, const char *name) {
  g_autofree char *word = g_strndup(name, strcspn(name, "."));
  return made->given && opc_node_get(made->given, word);
}

/* Generate the missing required parameters of `plugin`. `inside` is the prefix
   of the parameter names: "slot." or "". */
static void generate_required(const opc_making *making,
                              const opc_plugin *plugin, const char *inside,
                              int depth, opc_instance *made,
                              opc_problems *problems) {
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    g_autofree char *name = g_strconcat(inside, p->name, NULL);
    if (!(p->flags & OPC_REQUIRED) || is_given(made, name)) continue;
    const opc_plugin *inner = p->type == OPC_SLOT && depth < DEEPEST
                                  ? first_of(making->registry, p->choices)
                                  : NULL;
    g_autofree char *text = inner ? g_strdup_printf("{ use: %s }", inner->id)
                                  : sample_text(making->file, p);
    if (text) map_put(made->map, made->source, name, text, problems);
    if (text && p->type == OPC_FILE && !made->file) made->file = g_strdup(name);
    g_autofree char *slot = g_strconcat(name, ".", NULL);
    if (inner)
      generate_required(making, inner, slot, depth + 1, made, problems);
  }
}

void opc_instance_clear(opc_instance *made) {
  opc_binding_free(made->binding);
  opc_node_free(made->map);
  opc_node_free(made->given);
  opc_source_free(made->source);
  g_free(made->file);
}

gboolean opc_instance_make(const opc_making *making, const opc_host *like,
                           opc_problems *problems, opc_instance *made) {
  const opc_place at = {NULL, 0, 0};
  *made = (opc_instance){.source = opc_source_new("lint", "")};
  made->map = opc_node_map_new(made->source, &at);
  made->given = opc_node_parse(made->source, making->parameters,
                               strlen(making->parameters), problems);
  generate_required(making, making->plugin, "", 0, made, problems);
  if (made->given && made->given->type == OPC_NODE_MAP)
    opc_lay(made->map, made->given, problems);
  if (making->changed) {
    g_autofree char *text = opc_quantity_text(making->changed, making->number);
    map_put(made->map, made->source, making->changed->name, text, problems);
  }
  if (!problems->list->len)
    made->binding =
        opc_bind_plugin(making->registry, making->plugin, made->map,
                        making->plugin->id, &at, OPC_BIND_NO_INPUTS, problems);
  if (!problems->list->len)
    opc_inner_open(made->binding, making->registry, OPC_BIND_NO_INPUTS,
                   problems);
  return !problems->list->len &&
         opc_binding_create(made->binding, making->watch, like, problems);
}
