/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the texts of a comparison: models of a process for the step that
   judges all masks, and its layouts as cases. */
#include "tools/devel/comparison.h"

#include <string.h>

#include "core/binding/lookup.h"
#include "core/cli/cli.h"
#include "core/plugin/declaration.h"

/* Append a plugin with its parameters of the flow, on one line. Names
   of files become absolute. Slots in slots are as deep as the flow. */
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

/* Return the text of the plugin in a slot of a step; NULL if there is none. */
static char *slot_text(const opc_flow_step *step, const char *slot) {
  const opc_binding *b = step->binding;
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    if (strcmp(b->plugin->parameters[i].name, slot) != 0 || !b->slots[i])
      continue;
    GString *out = g_string_new(NULL);
    append_plugin(out, b->slots[i]);
    return g_string_free(out, FALSE);
  }
  return NULL;
}

static const opc_flow_step *find_correction(const opc_flow *flow) {
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *s = flow->steps->pdata[i];
    if (s->binding && !strcmp(s->binding->plugin->id, "correct")) return s;
  }
  return NULL;
}

/* Return the removal of steps that draw or report a single run. */
static char *removed_steps(const opc_flow *flow) {
  GString *out = g_string_new(NULL);
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *s = flow->steps->pdata[i];
    const char *id = s->binding ? s->binding->plugin->id : "";
    if (g_str_has_prefix(id, "draw.") || g_str_has_prefix(id, "report."))
      g_string_append_printf(out, "  %s: ~\n", s->name);
  }
  return g_string_free(out, FALSE);
}

static char *cases_text(const char *file, const GPtrArray *inputs) {
  GString *out = g_string_new(NULL);
  g_string_append_printf(out, "      - %s:\n", file);
  for (guint i = 0; i < inputs->len; i++) {
    g_string_append(out, "          - ");
    opc_text_append(out, inputs->pdata[i]);
    g_string_append_c(out, '\n');
  }
  return g_string_free(out, FALSE);
}

/* Return whether the flow has requirements of a step. */
static gboolean has_demands(const opc_flow *flow, const char *step) {
  const opc_node *all = opc_node_get(flow->demands, "require");
  size_t n = strlen(step);
  for (guint i = 0; all && i < all->keys->len; i++) {
    const char *key = opc_node_key(all, i);
    if (!strncmp(key, step, n) && (!key[n] || key[n] == '.')) return TRUE;
  }
  return FALSE;
}

static void word_clear(void *data) { g_free(((comparison_word *)data)->text); }

static GArray *words_of(const opc_flow *flow, const opc_flow_step *mask,
                        const char *path, const GPtrArray *inputs) {
  g_autoptr(GArray) open = cli_open_files(flow);
  const char *name = mask->name;
  const char *file =
      open->len ? g_array_index(open, cli_open_file, 0).path : "layout.file";
  gboolean demands = has_demands(flow, name);
  GString *process = g_string_new(NULL);
  opc_text_append(process, path);
  const comparison_word words[] = {
      {"@PROCESS@", g_string_free(process, FALSE)},
      {"@MASK@", g_strdup(name)},
      {"@LITHO@", slot_text(mask, "litho")},
      {"@RESIST@", slot_text(mask, "resist")},
      {"@EXTRACTOR@", slot_text(mask, "extractor")},
      {"@REMOVED@", removed_steps(flow)},
      {"@DEMANDS@", demands ? g_strdup_printf("%s: ~, ", name) : g_strdup("")},
      {"@CASES@", cases_text(file, inputs)}};
  GArray *all = g_array_new(FALSE, FALSE, sizeof *words);
  g_array_set_clear_func(all, word_clear);
  g_array_append_vals(all, words, G_N_ELEMENTS(words));
  return all;
}

GArray *comparison_words(const char *path, const GPtrArray *inputs, int *code) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_load(path, NULL, cli_registry(), problems);
  const opc_flow_step *mask = flow ? find_correction(flow) : NULL;
  if (mask) return words_of(flow, mask, path, inputs);
  *code = flow ? cli_error(CLI_USAGE,
                           "'%s' has no step 'correct': it is no process", path)
               : cli_problems(problems);
  return NULL;
}
