/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the template words of a comparison: plugins of a process for the
   step that judges all results, and input files as cases. */
#include "tools/devel/comparison.h"

#include <string.h>

#include "core/binding/lookup.h"
#include "core/cli/cli.h"
#include "core/plugin/declaration.h"

/* ---- plugins of the process ---- */

/* Append a plugin with its parameters of the flow, on one line. Names of files
   become absolute. Nested slots are included. */
static void append_plugin(GString *out, const opc_binding *b) {
  g_string_append_printf(out, "{ use: %s", b->plugin->id);
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    const opc_parameter *p = &b->plugin->parameters[i];
    const opc_node *given = b->origin[i];
    if (!given && !b->slots[i]) continue;
    g_string_append_printf(out, ", %s: ", p->name);
    if (b->slots[i]) {
      append_plugin(out, b->slots[i]);
    } else if (p->type == OPC_FILE && given->type == OPC_NODE_TEXT) {
      g_autofree char *path = opc_node_path(given);
      g_autofree char *whole = g_canonicalize_filename(path, NULL);
      opc_text_append(out, whole);
    } else {
      opc_node_append(out, given);
    }
  }
  g_string_append(out, " }");
}

/* Append the plugin at "step.slot"; return FALSE if there is none. */
static gboolean append_slot(GString *out, const opc_flow *flow,
                            const char *path) {
  const char *dot = strchr(path, '.');
  g_autofree char *name = dot ? g_strndup(path, (gsize)(dot - path)) : NULL;
  const opc_flow_step *step = name ? opc_flow_find(flow, name) : NULL;
  const opc_binding *b = step ? step->binding : NULL;
  for (size_t i = 0; b && i < b->plugin->n_parameters; i++) {
    if (strcmp(b->plugin->parameters[i].name, dot + 1) != 0) continue;
    if (!b->slots[i]) return FALSE;
    append_plugin(out, b->slots[i]);
    return TRUE;
  }
  return FALSE;
}

/* ---- other words ---- */

static void append_removed(GString *out, const opc_flow *flow) {
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *s = flow->steps->pdata[i];
    const char *id = s->binding ? s->binding->plugin->id : "";
    if (g_str_has_prefix(id, "draw.") || g_str_has_prefix(id, "report."))
      g_string_append_printf(out, "  %s: ~\n", s->name);
  }
}

/* Append the removal of all requirements, "STEP: ~, ". */
static void append_demands(GString *out, const opc_flow *flow) {
  const opc_node *all = opc_node_get(flow->demands, "require");
  g_autoptr(GHashTable) seen =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (guint i = 0; all && i < all->keys->len; i++) {
    const char *key = opc_node_key(all, i);
    char *step = g_strndup(key, strcspn(key, "."));
    g_autofree char *shown = g_strdup(step);
    if (g_hash_table_add(seen, step))
      g_string_append_printf(out, "%s: ~, ", shown);
  }
}

/* Append the cases; return FALSE if the process has no missing required
   file. */
static gboolean append_cases(GString *out, const opc_flow *flow,
                             const GPtrArray *inputs) {
  g_autoptr(GArray) open = cli_open_files(flow);
  if (!open->len) return FALSE;
  g_string_append_printf(out, "      - %s:\n",
                         g_array_index(open, cli_open_file, 0).path);
  for (guint i = 0; i < inputs->len; i++) {
    g_string_append(out, "          - ");
    opc_text_append(out, inputs->pdata[i]);
    g_string_append_c(out, '\n');
  }
  return TRUE;
}

/* Append the other open files as comments. */
static void append_open(GString *out, const opc_flow *flow) {
  g_autoptr(GArray) open = cli_open_files(flow);
  for (guint i = 1; i < open->len; i++) {
    const cli_open_file *file = &g_array_index(open, cli_open_file, i);
    g_string_append_printf(out, "%s#   --set each.set.%s=FILE    %s\n",
                           i == 1 ? "# Parameters to set:\n" : "", file->path,
                           file->summary);
  }
}

/* ---- templates ---- */

/* Append the text that replaces a word of the template; return FALSE if the
   process lacks the named part. */
static gboolean append_word(GString *out, const char *word,
                            const opc_flow *flow, const char *process,
                            const GPtrArray *inputs) {
  if (!strcmp(word, "CASES")) return append_cases(out, flow, inputs);
  if (!strcmp(word, "PROCESS"))
    opc_text_append(out, process);
  else if (!strcmp(word, "OPEN"))
    append_open(out, flow);
  else if (!strcmp(word, "REMOVED"))
    append_removed(out, flow);
  else if (!strcmp(word, "DEMANDS"))
    append_demands(out, flow);
  else if (!strcmp(word, "NAME"))
    g_string_append(out, "@NAME@");
  else
    return append_slot(out, flow, word);
  return TRUE;
}

char *comparison_text(const char *template, const char *process,
                      const GPtrArray *inputs, int *code) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_load(process, NULL, cli_registry(), problems);
  if (!flow) {
    *code = cli_problems(problems);
    return NULL;
  }
  g_auto(GStrv) parts = g_strsplit(template, "@", -1);
  GString *out = g_string_new(NULL);
  for (guint i = 0; parts[i]; i++) {
    if (i % 2 == 0) {
      g_string_append(out, parts[i]);
    } else if (!append_word(out, parts[i], flow, process, inputs)) {
      *code = cli_error(
          CLI_USAGE, "'%s' has no %s, which a process requires", process,
          strcmp(parts[i], "CASES") ? parts[i] : "unset input file");
      g_string_free(out, TRUE);
      return NULL;
    }
  }
  return g_string_free(out, FALSE);
}
