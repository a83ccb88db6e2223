/* SPDX-License-Identifier: BSD-3-Clause */
/* A resolved flow as a list of parameters. Each is on a line of its own, which
   ends with a comment on the origin of the value. */
#include "runs/parameters.h"

#include <string.h>

typedef struct walk {
  runs_tree *flow;
  char **lines;
  size_t n_lines;
  GArray *out;
  GPtrArray *texts;
  opc_error *error;
} walk;

static char *text_keep(walk *w, char *text) {
  g_ptr_array_add(w->texts, text);
  return text;
}

/* Restore the braces hidden by hide_braces of text.c. */
static void show_braces(GString *text) {
  g_string_replace(text, "\xEE\x80\x80", "{", 0);
  g_string_replace(text, "\xEE\x80\x81", "}", 0);
}

/* Append a value on one line in the syntax of flows. Recursion is as deep as
   the flow. */
static void value_append(walk *w, const yaml_node_t *node, GString *out) {
  if (node->type == YAML_SCALAR_NODE) {
    const char *text = runs_word(node);
    g_string_append(out, text ? text : "null");
  } else if (node->type == YAML_SEQUENCE_NODE) {
    const yaml_node_item_t *item = node->data.sequence.items.start;
    g_string_append_c(out, '[');
    for (; item < node->data.sequence.items.top; item++) {
      if (item > node->data.sequence.items.start) g_string_append(out, ", ");
      value_append(w, runs_node(w->flow, *item), out);
    }
    g_string_append_c(out, ']');
  } else if (node->type == YAML_MAPPING_NODE) {
    const yaml_node_pair_t *pair = node->data.mapping.pairs.start;
    g_string_append(out, "{ ");
    for (; pair < node->data.mapping.pairs.top; pair++) {
      if (pair > node->data.mapping.pairs.start) g_string_append(out, ", ");
      value_append(w, runs_node(w->flow, pair->key), out);
      g_string_append(out, ": ");
      value_append(w, runs_node(w->flow, pair->value), out);
    }
    g_string_append(out, " }");
  }
}

static int is_default(const walk *w, const yaml_node_t *value) {
  size_t line = value->end_mark.line;
  return line < w->n_lines &&
         g_str_has_suffix(g_strchomp(w->lines[line]), " # default");
}

static void add_value(walk *w, const char *name, const yaml_node_t *value) {
  g_autoptr(GString) text = g_string_new(NULL);
  value_append(w, value, text);
  show_braces(text);
  eda_run_parameter p = {name, text_keep(w, g_strdup(text->str)),
                         !is_default(w, value)};
  g_array_append_val(w->out, p);
}

/* Add the entries of a map with longer names. Recursion is as deep as the
   flow. */
static int add_map(walk *w, const char *before, const yaml_node_t *map) {
  int code = OPC_OK;
  const yaml_node_pair_t *pair = map->data.mapping.pairs.start;
  for (; !code && pair < map->data.mapping.pairs.top; pair++) {
    const yaml_node_t *key = runs_node(w->flow, pair->key);
    const yaml_node_t *value = runs_node(w->flow, pair->value);
    const char *word = runs_word(key);
    if (!word) return runs_fail(w->flow, key, w->error, "a key is not a text");
    const char *name = text_keep(
        w, g_strdup_printf("%s%s%s", before, *before ? "." : "", word));
    if (value->type == YAML_MAPPING_NODE)
      code = add_map(w, name, value);
    else
      add_value(w, name, value);
  }
  return code;
}

int runs_parameters(runs_tree *flow, GArray *out, GPtrArray *texts,
                    opc_error *error) {
  const yaml_node_t *steps = runs_get(flow, runs_root(flow), "steps");
  if (!steps || steps->type != YAML_MAPPING_NODE)
    return runs_fail(flow, runs_root(flow), error, "has no steps");
  g_auto(GStrv) lines = g_strsplit(flow->text, "\n", -1);
  walk w = {.flow = flow,
            .lines = lines,
            .n_lines = g_strv_length(lines),
            .out = out,
            .texts = texts,
            .error = error};
  return add_map(&w, "", steps);
}
