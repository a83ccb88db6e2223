/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/plugin/lint.h"

#include <string.h>
#include <unistd.h>

#include "core/cli/cli.h"

/* How long one check may take, s. */
static const double patience = 60;

/* Begin anew without malloc's cache of each thread, of which what is free
   counts as used: leaks could not be told from it. */
static void begin_anew(void) {
  g_autofree char *line = NULL;
  gsize length;
  if (g_getenv("GLIBC_TUNABLES") ||
      !g_file_get_contents("/proc/self/cmdline", &line, &length, NULL))
    return;
  g_autoptr(GPtrArray) argv = g_ptr_array_new();
  for (const char *word = line; word < line + length; word += strlen(word) + 1)
    g_ptr_array_add(argv, (char *)word);
  g_ptr_array_add(argv, NULL);
  g_setenv("GLIBC_TUNABLES", "glibc.malloc.tcache_count=0", TRUE);
  execv("/proc/self/exe", (char **)argv->pdata); /* else go on as it is */
}

/* The folder of the plugin comes first, then what the command looks into. */
static opc_registry *make_registry(const char *path) {
  g_autofree char *folder = g_path_get_dirname(path);
  g_autoptr(GPtrArray) folders = g_ptr_array_new();
  g_ptr_array_add(folders, folder);
  for (const char *const *f = cli_plugin_path(); *f; f++)
    g_ptr_array_add(folders, (char *)*f);
  g_ptr_array_add(folders, NULL);
  return opc_registry_new((const char *const *)folders->pdata);
}

static void add_list(JsonBuilder *b, const char *name, const GPtrArray *list) {
  json_builder_set_member_name(b, name);
  json_builder_begin_array(b);
  for (guint i = 0; i < list->len; i++)
    json_builder_add_string_value(b, list->pdata[i]);
  json_builder_end_array(b);
}

static void print_json(const opc_lint *lint) {
  g_autoptr(JsonBuilder) b = json_builder_new();
  json_builder_begin_object(b);
  json_builder_set_member_name(b, "plugin");
  json_builder_add_string_value(b, lint->id);
  add_list(b, "findings", lint->findings);
  add_list(b, "not_checked", lint->notes);
  json_builder_end_object(b);
  cli_print_json(json_builder_get_root(b));
}

static void print_text(const opc_lint *lint) {
  for (guint i = 0; i < lint->findings->len; i++)
    cli_print("%s: %s\n", lint->path, (char *)lint->findings->pdata[i]);
  for (guint i = 0; i < lint->notes->len; i++)
    cli_message("note", "not checked: %s", (char *)lint->notes->pdata[i]);
}

static int run(const cli_verb *verb, int argc, char **argv) {
  gboolean json = FALSE;
  const char *parameters = "{}";
  const cli_option options[] = {
      {"with", "{ PARAMETER: VALUE }", "parameters, as in a flow", NULL,
       &parameters, NULL},
      {"json", NULL, "as JSON", &json, NULL, NULL},
      {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 1, 1, rest);
  if (code >= 0) return code;
  const char *path = rest->pdata[0];
  if (!g_file_test(path, G_FILE_TEST_IS_REGULAR)) {
    cli_message("error", "'%s': no such file", path);
    return CLI_IO;
  }
  begin_anew();
  g_autoptr(opc_registry) registry = make_registry(path);
  g_autoptr(opc_lint) lint = opc_lint_new(path, registry, parameters, patience);
  opc_lint_run(lint);
  if (json)
    print_json(lint);
  else
    print_text(lint);
  return lint->findings->len ? CLI_LIMIT : CLI_GOOD;
}

const cli_verb cli_lint = {.name = "lint",
                           .arguments = "PLUGIN.so",
                           .summary = "Check that a plugin keeps the contract",
                           .run = run};
