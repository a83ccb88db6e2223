/* SPDX-License-Identifier: BSD-3-Clause */
#include <locale.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/plugin/guard.h"
#include "core/plugin/suggest.h"

const cli_verb *const cli_verbs[] = {
    &cli_run, &cli_check,   &cli_plugins, &cli_inspect,  &cli_lint, &cli_schema,
    &cli_new, &cli_version, &cli_help,    &cli_complete, NULL};

const cli_verb *cli_find_verb(const char *name) {
  for (size_t i = 0; cli_verbs[i]; i++)
    if (!strcmp(cli_verbs[i]->name, name)) return cli_verbs[i];
  return NULL;
}

static int unknown_verb(const char *name) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (size_t i = 0; cli_verbs[i] && !cli_verbs[i]->hidden; i++)
    g_ptr_array_add(names, (char *)cli_verbs[i]->name);
  g_autofree char *suggestion = opc_suggestion(name, names);
  cli_message("error", "unknown verb '%s'%s", name,
              *suggestion ? suggestion : ", see 'opcflow help'");
  return CLI_USAGE;
}

/* The verb is the first word that is no option; what comes before it is read
   as if it stood behind. */
int main(int argc, char **argv) {
  setlocale(LC_CTYPE, "");
  opc_guard_install(cli_is_terminal() ? "\r\033[K" : NULL);
  int at = 1;
  while (at < argc && *argv[at] == '-') {
    gboolean path = !strcmp(argv[at], "--plugin-path");
    if (!strcmp(argv[at], "--version"))
      argv[at] = (char *)"version";
    else if (!strcmp(argv[at], "--help") || !strcmp(argv[at], "-h"))
      argv[at] = (char *)"help";
    else
      at += path ? 2 : 1;
  }
  if (at >= argc) {
    cli_message("error", "no verb given, see 'opcflow help'");
    return CLI_USAGE;
  }
  const cli_verb *verb = cli_find_verb(argv[at]);
  if (!verb) return unknown_verb(argv[at]);
  g_autoptr(GPtrArray) words = g_ptr_array_new();
  for (int i = 1; i < argc; i++)
    if (i != at) g_ptr_array_add(words, argv[i]);
  return cli_finish(verb->run(verb, (int)words->len, (char **)words->pdata));
}
