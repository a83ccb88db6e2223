/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/cli/cli.h"

static int help_verb(const char *name, gboolean man) {
  const cli_verb *verb = cli_find_verb(name);
  if (!verb) {
    cli_message("error", "unknown verb '%s', see 'opcflow help'", name);
    return CLI_USAGE;
  }
  if (man) {
    cli_print_manual(verb);
    return CLI_GOOD;
  }
  char *help[] = {(char *)"--help"};
  return verb->run(verb, 1, help);
}

static int run(const cli_verb *verb, int argc, char **argv) {
  gboolean man = FALSE;
  const cli_option options[] = {
      {"man", NULL, "as a manual page, in roff", &man, NULL, NULL}, {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 0, 1, rest);
  if (code >= 0) return code;
  if (rest->len) return help_verb(rest->pdata[0], man);
  if (man) {
    cli_print_manual(NULL);
    return CLI_GOOD;
  }
  cli_print("usage: opcflow VERB ...\n\n");
  for (size_t i = 0; cli_verbs[i] && !cli_verbs[i]->hidden; i++) {
    g_autofree char *left =
        g_strdup_printf("%s %s", cli_verbs[i]->name, cli_verbs[i]->arguments);
    cli_print("  %-16s %s\n", left, cli_verbs[i]->summary);
  }
  cli_print("\n'opcflow help VERB' tells the options of one.\n");
  return CLI_GOOD;
}

const cli_verb cli_help = {.name = "help",
                           .arguments = "[VERB]",
                           .summary = "Tell what there is",
                           .run = run};
