/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow explain: reads the manifest of a run and prints, for each step, why
   the step ran, or that the result was reused. */
#include <base/file.h>
#include <base/suggest.h>
#include <string.h>

#include <store/contents.h>
#include "core/cli/cli.h"
#include "tools/devel/verbs.h"

static gboolean json;

static const cli_option options[] = {
    {"json", "print the result as JSON", .flag = &json}, {0}};

/* ---- reading ---- */

static const char *text_of(JsonObject *o, const char *name) {
  return json_object_get_string_member_with_default(o, name, NULL);
}

static double number_of(JsonObject *o, const char *name) {
  return json_object_get_double_member_with_default(o, name, 0);
}

static JsonArray *results_of(JsonNode *manifest, JsonObject **store) {
  JsonNode *node =
      manifest && JSON_NODE_HOLDS_OBJECT(manifest)
          ? json_object_get_member(json_node_get_object(manifest), "store")
          : NULL;
  *store =
      node && JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
  node = *store ? json_object_get_member(*store, "results") : NULL;
  return node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
}

/* ---- printing: one line for equal lines of several points ---- */

typedef struct line {
  const char *step, *result, *reason;
  guint count;
  double point, seconds; /* point of the first entry; sum of all entries */
} line;

static void add_line(GArray *lines, JsonObject *o) {
  const line one = {.step = text_of(o, "step"),
                    .result = text_of(o, "result"),
                    .reason = text_of(o, "reason"),
                    .count = 1,
                    .point = number_of(o, "point"),
                    .seconds = number_of(o, "seconds")};
  for (guint i = 0; i < lines->len; i++) {
    line *l = &g_array_index(lines, line, i);
    if (g_strcmp0(l->step, one.step) || g_strcmp0(l->result, one.result) ||
        g_strcmp0(l->reason, one.reason))
      continue;
    l->count++;
    l->seconds += one.seconds;
    return;
  }
  g_array_append_val(lines, one);
}

static char *times_text(const line *l) {
  if (l->count > 1) return g_strdup_printf("%u times", l->count);
  return l->point > 0 ? g_strdup_printf("point %.0f", l->point) : g_strdup("");
}

static void print_lines(JsonArray *results, JsonObject *store) {
  static const char *const names[] = {"step", "", "seconds", "times", "why"};
  g_autoptr(GArray) lines = g_array_new(FALSE, FALSE, sizeof(line));
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  guint n = json_array_get_length(results);
  for (guint i = 0; i < n; i++) {
    JsonNode *node = json_array_get_element(results, i);
    if (JSON_NODE_HOLDS_OBJECT(node))
      add_line(lines, json_node_get_object(node));
  }
  for (guint i = 0; i < lines->len; i++) {
    const line *l = &g_array_index(lines, line, i);
    g_ptr_array_add(cells, g_strdup(l->step ? l->step : ""));
    g_ptr_array_add(cells, g_strdup(l->result ? l->result : ""));
    g_ptr_array_add(cells, g_strdup_printf("%.3f", l->seconds));
    g_ptr_array_add(cells, times_text(l));
    g_ptr_array_add(cells, g_strdup(l->reason ? l->reason : ""));
  }
  cli_print_rows(names, G_N_ELEMENTS(names), cells);
  double steps = number_of(store, "steps");
  cli_print("\n%.0f of %.0f steps reused\n", number_of(store, "reused"), steps);
  if (steps > n) cli_print("the manifest lists the first %u\n", n);
}

/* ---- the verb ---- */

/* Return a suggestion for the name of a run folder (g_free): the nearest run in
   the same folder, or in 'runs'. */
static char *run_suggestion(const char *folder) {
  g_autofree char *parent = g_path_get_dirname(folder);
  g_autofree char *base = g_path_get_basename(folder);
  const char *const places[] = {parent, "runs"};
  for (size_t i = 0; i < G_N_ELEMENTS(places); i++) {
    g_autoptr(GPtrArray) names = opc_folder_names(places[i]);
    const char *near = names ? opc_nearest(base, names) : NULL;
    g_autofree char *path =
        near ? g_build_filename(places[i], near, NULL) : g_strdup("");
    g_autofree char *file = g_build_filename(path, "manifest.json", NULL);
    if (near && g_file_test(file, G_FILE_TEST_EXISTS))
      return g_strdup_printf(", did you mean '%s'?", path);
  }
  return g_strdup(": pass the folder that 'opcflow run' wrote, 'runs/NAME'");
}

/* Return the text of a run's manifest (g_free); NULL, after a message. */
static char *read_manifest(const char *folder, const char *path) {
  char *text = NULL;
  const char *fault = opc_file_fault(path, NULL);
  g_autofree char *hint = run_suggestion(folder);
  if (!g_file_test(folder, G_FILE_TEST_EXISTS))
    cli_message("error", "'%s': no such run folder%s", folder, hint);
  else if (!g_file_test(folder, G_FILE_TEST_IS_DIR))
    cli_message("error", "'%s': is a file, not the folder of a run", folder);
  else if (!g_file_test(path, G_FILE_TEST_EXISTS))
    cli_message("error", "'%s': is not the folder of a run: no manifest.json",
                folder);
  else if (fault || !g_file_get_contents(path, &text, NULL, NULL))
    cli_message("error", "'%s': %s", path, fault ? fault : "cannot be read");
  return text;
}

static int explain_run(const cli_verb *verb, const GPtrArray *arguments) {
  const char *folder = arguments->pdata[0];
  g_autofree char *path = g_build_filename(folder, "manifest.json", NULL);
  g_autofree char *text = read_manifest(folder, path);
  JsonObject *store;
  (void)verb;
  if (!text) return CLI_IO;
  g_autoptr(JsonNode) manifest = opc_contents_parse(text);
  JsonArray *results = results_of(manifest, &store);
  if (!results)
    return cli_error(CLI_USAGE,
                     "'%s': no record; was the run made with '--no-cache', "
                     "with an empty OPCFLOW_STORE, or by an earlier version?",
                     path);
  if (json)
    cli_print_object(json_object_ref(store));
  else
    print_lines(results, store);
  return CLI_GOOD;
}

const cli_verb devel_explain = {CLI_EXPLAIN, .options = options, .least = 1,
                                .most = 1, .run = explain_run};
