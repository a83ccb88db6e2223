/* SPDX-License-Identifier: BSD-3-Clause */
/* Parses a command line by the options of a verb, and prints their help. */
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "core/cli/cli.h"
#include "core/plugin/host.h"

/* ---- plugins ---- */

static GPtrArray *folders; /* folders given by --plugin-path */

void cli_take_plugin_path(guint n, char **words) {
  static const char option[] = "--plugin-path=";
  if (!folders) folders = g_ptr_array_new();
  for (guint i = 0; i < n && strcmp(words[i], "--") != 0; i++)
    if (g_str_has_prefix(words[i], option))
      g_ptr_array_add(folders, words[i] + strlen(option));
    else if (!strcmp(words[i], "--plugin-path") && i + 1 < n)
      g_ptr_array_add(folders, words[++i]);
}

void cli_look_first(const char *folder) {
  g_ptr_array_insert(folders, 0, (char *)folder);
}

/* Warn of folders that every user can write to: a plugin placed there by
   another user would run with the rights of this user. */
static void folders_check(const GPtrArray *list) {
  struct stat s;
  for (guint i = 0; i < list->len; i++)
    if (!stat(list->pdata[i], &s) && (s.st_mode & S_IWOTH))
      cli_message("warning",
                  "every user can write to the plugin folder '%s' (mode %03o): "
                  "its plugins run with your rights; use 'chmod o-w'",
                  (const char *)list->pdata[i], s.st_mode & 0777);
}

opc_registry *cli_registry(void) {
  static opc_registry *registry;
  if (registry) return registry;
  registry = opc_registry_new(cli_list(folders));
  folders_check(opc_registry_folders(registry));
  return registry;
}

/* ---- help ---- */

static gboolean help, version;
static const char *taken; /* text of --plugin-path, never read:
                             cli_take_plugin_path handles the option */

const cli_option cli_common_options[] = {
    {"plugin-path", "folder to search first for plugins", "DIR",
     .text = &taken},
    {"wide", "print tables with all columns side by side and all digits",
     .flag = &cli_wide},
    {"help", "show this help", .flag = &help},
    {"version", "print the version", .flag = &version},
    {0}};

/* Print help in the form that help2man converts to manual pages. */
void cli_print_help(const cli_verb *verb) {
  cli_print("Usage: opcflow %s%s%s%s\n\n%s.\n\nOptions:\n", verb->name,
            *verb->arguments ? " " : "", verb->arguments,
            verb->options ? " [OPTIONS]" : "", verb->summary);
  cli_print_options(verb->options);
  cli_print_options(cli_common_options);
}

/* ---- reading ---- */

const char *cli_flow(const cli_verb *verb, const GPtrArray *arguments) {
  static const char usual[] = "flow.yaml";
  if (arguments->len) return arguments->pdata[0];
  if (g_file_test(usual, G_FILE_TEST_EXISTS)) return usual;
  cli_message("error", "'%s' requires FLOW, see 'opcflow help %s'", verb->name,
              verb->name);
  return NULL;
}

int cli_parse(const cli_verb *verb, guint n, char **words, GPtrArray *rest) {
  const cli_option *const both[] = {
      verb->options ? verb->options : cli_common_options, cli_common_options,
      NULL};
  for (guint i = 0; i < n; i++)
    if (!strcmp(words[i], "--"))
      while (++i < n) g_ptr_array_add(rest, words[i]);
    else if (*words[i] != '-' || !words[i][1])
      g_ptr_array_add(rest, words[i]);
    else if (!cli_take_option(both, verb->name, n, words, &i))
      return CLI_USAGE;
  if (help) cli_print_help(verb);
  if (version) cli_print("opcflow-%s (opcflow) %s\n", verb->name, OPC_VERSION);
  if (help || version) return CLI_GOOD;
  if (rest->len < verb->least)
    return cli_error(CLI_USAGE, "'%s' requires %s, see 'opcflow help %s'",
                     verb->name, verb->arguments, verb->name);
  if (rest->len > verb->most)
    return cli_error(CLI_USAGE,
                     "'%s' does not take '%s', see 'opcflow help %s'",
                     verb->name, (char *)rest->pdata[verb->most], verb->name);
  return -1;
}

int cli_set_threads(const char *text) {
  if (!text) return -1;
  char *end;
  unsigned long n = strtoul(text, &end, 10);
  if (!g_ascii_isdigit(*text) || *end || !n || n > 4096)
    return cli_error(CLI_USAGE,
                     "'--threads' must be a number from 1 to 4096, found '%s'",
                     text);
  opc_set_threads((unsigned)n);
  return -1;
}
