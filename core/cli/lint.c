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
  cli_return_output();
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

static void append_all(GString *line, const GPtrArray *texts, const char *gap) {
  if (!texts->len) g_string_append(line, "nothing");
  for (guint i = 0; i < texts->len; i++)
    g_string_append_printf(line, "%s%s", i ? gap : "", (char *)texts->pdata[i]);
}

/* The last line tells what was looked at and what was not. */
static void print_text(const opc_lint *lint) {
  for (guint i = 0; i < lint->findings->len; i++)
    cli_print("%s: %s\n", lint->path, (char *)lint->findings->pdata[i]);
  g_autoptr(GString) line = g_string_new("checked: ");
  append_all(line, lint->checked, ", ");
  g_string_append(line, "; not checked: ");
  append_all(line, lint->notes, "; ");
  cli_message("note", "%s", line->str);
}

static gboolean json, strict;
static const char *parameters = "{}";

static const cli_option options[] = {
    {"with", "parameters, as in a flow", "{ PARAMETER: VALUE }",
     .text = &parameters},
    {"strict", "fail if anything could not be checked", .flag = &strict},
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
  gboolean bad = lint->findings->len || (strict && lint->notes->len);
  return bad ? CLI_LIMIT : CLI_GOOD;
}

const cli_verb cli_lint = {.name = "lint",
                           .arguments = "PLUGIN.so",
                           .summary = "Check that a plugin keeps the contract",
                           .options = options,
                           .least = 1,
                           .most = 1,
                           .run = run};
