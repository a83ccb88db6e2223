/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow lint: does a plugin keep the contract? */
#include "core/testing/lint.h"

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

static void print_json(const opc_lint *lint) {
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "plugin", lint->id);
  cli_add_texts(o, "findings", lint->findings);
  cli_add_texts(o, "checked", lint->checked);
  cli_add_texts(o, "not_checked", lint->notes);
  cli_print_object(o);
}

static void print_text(const opc_lint *lint) {
  for (guint i = 0; i < lint->findings->len; i++)
    cli_print("%s: %s\n", lint->path, (char *)lint->findings->pdata[i]);
  g_autoptr(GString) checked = g_string_new(NULL);
  for (guint i = 0; i < lint->checked->len; i++)
    g_string_append_printf(checked, "%s%s", i ? ", " : "",
                           (char *)lint->checked->pdata[i]);
  cli_message("note", "checked: %s", checked->str);
  for (guint i = 0; i < lint->notes->len; i++)
    cli_message("note", "not checked: %s", (char *)lint->notes->pdata[i]);
}

static gboolean json;
static const char *parameters = "{}";

static const cli_option options[] = {
    {"with", "parameters, as in a flow", "{ PARAMETER: VALUE }",
     .text = &parameters},
    {"json", "as JSON", .flag = &json},
    {0}};

static int run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  const char *path = arguments->pdata[0];
  if (!g_file_test(path, G_FILE_TEST_IS_REGULAR))
    return cli_error(CLI_IO, "'%s': no such file", path);
  begin_anew();
  g_autofree char *folder = g_path_get_dirname(path);
  cli_look_first(folder);
  g_autoptr(opc_lint) lint =
      opc_lint_new(path, cli_registry(), parameters, patience);
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
                           .options = options,
                           .least = 1,
                           .most = 1,
                           .run = run};
