/* SPDX-License-Identifier: BSD-3-Clause */
/* Parameters of a resolved flow. In the resolved flow, each parameter has its
   own line; a comment at the end of the line states the origin of the value. */
#include "runs/parameters.h"

#include <string.h>

typedef struct flat_parameters {
  char **lines;
  size_t n_lines;
  GArray *out;
  GPtrArray *texts;
} flat_parameters;

static char *text_keep(flat_parameters *w, char *text) {
  g_ptr_array_add(w->texts, text);
  return text;
}

/* Append a value on one line in the syntax of flows. The recursion depth equals
   the nesting depth of the flow. */
static void value_append(const opc_node *node, GString *out) {
  if (node->type == OPC_NODE_TEXT) {
    const char *text = runs_word(node);
    g_string_append(out, text ? text : "null");
    return;
  }
  g_string_append(out, node->keys ? "{ " : "[");
  for (guint i = 0; i < node->items->len; i++) {
    if (i) g_string_append(out, ", ");
    if (node->keys) g_string_append_printf(out, "%s: ", opc_node_key(node, i));
    value_append(node->items->pdata[i], out);
  }
  g_string_append(out, node->keys ? " }" : "]");
}

static int is_default(const flat_parameters *w, const opc_node *value) {
  size_t line = value->at.line - 1;
  return line < w->n_lines &&
         g_str_has_suffix(g_strchomp(w->lines[line]), " # default");
}

static void add_value(flat_parameters *w, const char *name,
                      const opc_node *value) {
  g_autoptr(GString) text = g_string_new(NULL);
  value_append(value, text);
  eda_run_parameter p = {name, text_keep(w, g_strdup(text->str)),
                         !is_default(w, value)};
  g_array_append_val(w->out, p);
}

/* Add the entries of a map; `before` is the prefix of their names. The
   recursion depth equals the nesting depth of the flow. */
static void add_map(flat_parameters *w, const char *before,
                    const opc_node *map) {
  for (guint i = 0; i < map->items->len; i++) {
    const opc_node *value = map->items->pdata[i];
    const char *name =
        text_keep(w, g_strdup_printf("%s%s%s", before, *before ? "." : "",
                                     opc_node_key(map, i)));
    if (value->type == OPC_NODE_MAP)
      add_map(w, name, value);
    else
      add_value(w, name, value);
  }
}

int runs_parameters(const runs_tree *flow, GArray *out, GPtrArray *texts,
                    opc_error *error) {
  const opc_node *steps = opc_node_get(runs_root(flow), "steps");
  if (!steps || steps->type != OPC_NODE_MAP)
    return runs_fail(runs_root(flow), error, "has no steps");
  g_auto(GStrv) lines = g_strsplit(flow->text, "\n", -1);
  flat_parameters w = {.lines = lines,
                       .n_lines = g_strv_length(lines),
                       .out = out,
                       .texts = texts};
  add_map(&w, "", steps);
  return OPC_OK;
}
