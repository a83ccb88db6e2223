/* SPDX-License-Identifier: BSD-3-Clause */
/* --set step.parameter=value */
#include <string.h>

#include "core/flow/flow.h"
#include "core/plugin/suggest.h"

static GPtrArray *key_names(const opc_node *map) {
  GPtrArray *names = g_ptr_array_new();
  for (guint i = 0; i < map->keys->len; i++)
    g_ptr_array_add(names, ((opc_node *)map->keys->pdata[i])->text);
  return names;
}

/* The map that holds the last of `parts`, made where it is missing (a group or
   a slot that the file left out); NULL and a problem. */
static opc_node *find_parent(opc_node *steps, char **parts,
                             const opc_source *source, opc_problems *problems) {
  const opc_place at = {source->name, 0, 0};
  opc_node *map = opc_node_get(steps, parts[0]);
  if (!map) {
    g_autoptr(GPtrArray) names = key_names(steps);
    g_autofree char *suggestion = opc_suggestion(parts[0], names);
    opc_problem_add(problems, OPC_INVALID, &at, "unknown step '%s'%s", parts[0],
                    suggestion);
    return NULL;
  }
  for (guint i = 1; parts[i]; i++) {
    if (map->type != OPC_NODE_MAP) {
      opc_problem_add(problems, OPC_INVALID, &at, "'%s' is not a map",
                      parts[i - 1]);
      return NULL;
    }
    if (!parts[i + 1]) break;
    opc_node *next = opc_node_get(map, parts[i]);
    if (!next) {
      next = opc_node_map_new(source, &at);
      opc_node_set(map, opc_node_text_new(source, parts[i]), next);
    }
    map = next;
  }
  return map;
}

/* Nodes of an override have the place of the override, not a line of it. */
static void forget_lines(opc_node *node) {
  node->at.line = node->at.column = 0;
  for (guint i = 0; node->keys && i < node->keys->len; i++)
    forget_lines(node->keys->pdata[i]);
  for (guint i = 0; node->items && i < node->items->len; i++)
    forget_lines(node->items->pdata[i]);
}

static opc_node *parse_value(const char *text, const opc_source *source,
                             opc_problems *problems) {
  g_autoptr(opc_problems) found = opc_problems_new();
  const opc_place at = {source->name, 0, 0};
  if (!*text) {
    opc_problem_add(problems, OPC_INVALID, &at, "has no value");
    return NULL;
  }
  opc_node *value = opc_node_parse(source, text, strlen(text), found);
  for (guint i = 0; i < found->list->len; i++)
    opc_problem_add(problems, OPC_INVALID, &at, "%s",
                    ((opc_problem *)found->list->pdata[i])->message);
  if (value) forget_lines(value);
  return value;
}

void opc_override(opc_node *root, const char *set, GPtrArray *sources,
                  opc_problems *problems) {
  const char *equals = strchr(set, '=');
  g_autofree char *path =
      equals ? g_strndup(set, (gsize)(equals - set)) : g_strdup(set);
  g_autofree char *name = g_strdup_printf("--set %s", path);
  opc_source *source = opc_source_new(name, NULL);
  g_ptr_array_add(sources, source);
  const opc_place at = {source->name, 0, 0};
  g_auto(GStrv) parts = g_strsplit(path, ".", -1);
  gboolean good = equals && g_strv_length(parts) > 1;
  for (guint i = 0; parts[i]; i++) good &= *parts[i] != 0;
  if (!good) {
    opc_problem_add(problems, OPC_INVALID, &at,
                    "needs the form 'step.parameter=value'");
    return;
  }
  opc_node *steps = opc_node_get(root, "steps");
  if (!steps || steps->type != OPC_NODE_MAP) return;
  opc_node *parent = find_parent(steps, parts, source, problems);
  opc_node *value = parse_value(equals + 1, source, problems);
  if (!parent || !value) {
    opc_node_free(value);
    return;
  }
  const char *last = parts[g_strv_length(parts) - 1];
  opc_node_set(parent, opc_node_text_new(source, last), value);
}
