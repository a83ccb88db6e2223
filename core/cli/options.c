/* SPDX-License-Identifier: BSD-3-Clause */
/* Reads the words of a command line by the options of a verb, and tells what
   they are. */
#include <base/suggest.h>
#include <stdlib.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/plugin/host.h"

/* ---- plugins ---- */

static GPtrArray *folders; /* of --plugin-path */

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

opc_registry *cli_registry(void) {
  static opc_registry *registry;
  if (!registry) registry = opc_registry_new(cli_list(folders));
  return registry;
}

/* ---- help ---- */

static gboolean help, version;
static const char *taken; /* --plugin-path has been read before */

const cli_option cli_common_options[] = {
    {"plugin-path", "look for plugins here first", "DIR", .text = &taken},
    {"wide", "tables with all columns side by side, and all digits",
     .flag = &cli_wide},
    {"help", "show this", .flag = &help},
    {"version", "tell the version", .flag = &version},
    {0}};

static void print_options(const cli_option *o) {
  for (; o && o->name; o++) {
    g_autofree char *left =
        g_strdup_printf("--%s%s%s", o->name, o->argument ? " " : "",
                        o->argument ? o->argument : "");
    cli_print("  %-28s  %s\n", left, o->help);
  }
}

/* In the form of which help2man makes manual pages. */
void cli_print_help(const cli_verb *verb) {
  cli_print("Usage: opcflow %s%s%s%s\n\n%s.\n\nOptions:\n", verb->name,
            *verb->arguments ? " " : "", verb->arguments,
            verb->options ? " [OPTIONS]" : "", verb->summary);
  print_options(verb->options);
  print_options(cli_common_options);
}

/* ---- reading ---- */

const char *cli_flow(const cli_verb *verb, const GPtrArray *arguments) {
  static const char usual[] = "flow.yaml";
  if (arguments->len) return arguments->pdata[0];
  if (g_file_test(usual, G_FILE_TEST_EXISTS)) return usual;
  cli_message("error", "'%s' needs FLOW, see 'opcflow help %s'", verb->name,
              verb->name);
  return NULL;
}

const char *const *cli_list(GPtrArray *list) {
  static const char *const none[] = {NULL};
  if (!list || !list->len) return none;
  if (list->pdata[list->len - 1]) g_ptr_array_add(list, NULL);
  return (const char *const *)list->pdata;
}

/* The option of that name, of the verb or of all; NULL if there is none. */
static const cli_option *find_option(const cli_verb *verb, const char *name,
                                     GPtrArray *names) {
  const cli_option *const both[] = {verb->options, cli_common_options};
  for (int i = 0; i < 2; i++)
    for (const cli_option *o = both[i]; o && o->name; o++) {
      if (!strcmp(o->name, name)) return o;
      g_ptr_array_add(names, (char *)o->name);
    }
  return NULL;
}

static int unknown_option(const cli_verb *verb, const char *word,
                          const char *name, const GPtrArray *names) {
  const char *nearest = opc_nearest(name, names);
  if (nearest)
    return cli_error(CLI_USAGE,
                     "unknown option '%s' of '%s', did you mean '--%s'?", word,
                     verb->name, nearest);
  return cli_error(CLI_USAGE, "unknown option '%s', see 'opcflow help %s'",
                   word, verb->name);
}

/* Take the option at words[*i]; -1 or the exit code. */
static int take_option(const cli_verb *verb, guint n, char **words, guint *i) {
  const char *word = strcmp(words[*i], "-h") ? words[*i] : "--help";
  const char *equals = strchr(word, '='), *bare = word + strspn(word, "-");
  g_autofree char *name = g_strndup(bare, strcspn(bare, "="));
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  const cli_option *o = find_option(verb, name, names);
  if (!o || strncmp(word, "--", 2) != 0 || bare != word + 2)
    return unknown_option(verb, word, name, names);
  if (!o->argument && equals)
    return cli_error(CLI_USAGE, "option '--%s' takes no value", o->name);
  if (o->argument && !equals && *i + 1 == n)
    return cli_error(CLI_USAGE, "option '--%s' needs a value: %s", o->name,
                     o->argument);
  if (o->flag) *o->flag = TRUE;
  if (!o->argument) return -1;
  const char *value = equals ? equals + 1 : words[++*i];
  if (o->text) *o->text = value;
  if (o->list && !*o->list) *o->list = g_ptr_array_new();
  if (o->list) g_ptr_array_add(*o->list, (char *)value);
  return -1;
}

int cli_parse(const cli_verb *verb, guint n, char **words, GPtrArray *rest) {
  int code = -1;
  for (guint i = 0; i < n && code < 0; i++)
    if (!strcmp(words[i], "--"))
      while (++i < n) g_ptr_array_add(rest, words[i]);
    else if (*words[i] != '-' || !words[i][1])
      g_ptr_array_add(rest, words[i]);
    else
      code = take_option(verb, n, words, &i);
  if (code >= 0) return code;
  if (help) cli_print_help(verb);
  if (version) cli_print("opcflow-%s (opcflow) %s\n", verb->name, OPC_VERSION);
  if (help || version) return CLI_GOOD;
  if (rest->len < verb->least)
    return cli_error(CLI_USAGE, "'%s' needs %s, see 'opcflow help %s'",
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
    return cli_error(
        CLI_USAGE, "'--threads' needs a number from 1 to 4096, not '%s'", text);
  opc_set_threads((unsigned)n);
  return -1;
}
