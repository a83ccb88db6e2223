/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes up what a plugin must be given, and an instance with it. */
#include "core/testing/instance.h"

#include <string.h>

#include "core/flow/layers.h"
#include "core/text/value.h"

/* ---- values where there is no default ---- */

static double sample_number(const opc_parameter *p) {
  gboolean low = p->flags & (OPC_AT_LEAST | OPC_ABOVE);
  gboolean high = p->flags & (OPC_AT_MOST | OPC_BELOW);
  if (low && high) return p->type == OPC_INT ? p->max : (p->min + p->max) / 2;
  if (low) return p->min + 1;
  return high ? p->max - 1 : 1;
}

/* NULL for what cannot be made up. */
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

/* Lay the value of a parameter, written as in a flow, over a map. */
static void put(opc_node *map, const opc_source *source, const char *name,
                const char *text, opc_problems *problems) {
  g_auto(GStrv) words = g_strsplit(name, ".", -1);
  g_autoptr(GString) flow = g_string_new(text);
  for (guint i = g_strv_length(words); i-- > 0;) {
    g_autofree char *inner = g_string_free(flow, FALSE);
    flow = g_string_new(NULL);
    g_string_printf(flow, "{ %s: %s }", words[i], inner);
  }
  g_autoptr(opc_node) over =
      opc_node_parse(source, flow->str, flow->len, problems);
  if (over) opc_lay(map, over, problems);
}

static void make_up(const opc_making *making, opc_instance *made,
                    opc_problems *problems) {
  const opc_plugin *plugin = making->plugin;
  for (size_t i = 0; i < plugin->n_parameters; i++) {
    const opc_parameter *p = &plugin->parameters[i];
    g_autofree char *text =
        p->flags & OPC_REQUIRED ? sample_text(making->file, p) : NULL;
    if (text) put(made->map, made->source, p->name, text, problems);
  }
}

void opc_instance_clear(opc_instance *made) {
  opc_binding_free(made->binding);
  opc_node_free(made->map);
  opc_node_free(made->given);
  opc_source_free(made->source);
}

gboolean opc_instance_make(const opc_making *making, const opc_host *like,
                           opc_problems *problems, opc_instance *made) {
  const opc_place at = {NULL, 0, 0};
  *made = (opc_instance){.source = opc_source_new("lint", "")};
  made->map = opc_node_map_new(made->source, &at);
  make_up(making, made, problems);
  made->given = opc_node_parse(made->source, making->parameters,
                               strlen(making->parameters), problems);
  if (made->given && made->given->type == OPC_NODE_MAP)
    opc_lay(made->map, made->given, problems);
  if (making->changed) {
    g_autofree char *text = opc_quantity_text(making->changed, making->number);
    put(made->map, made->source, making->changed->name, text, problems);
  }
  if (!problems->list->len)
    made->binding =
        opc_bind_plugin(making->registry, making->plugin, made->map,
                        making->plugin->id, &at, OPC_BIND_NO_INPUTS, problems);
  return !problems->list->len &&
         opc_binding_create(made->binding, NULL, like, problems);
}
