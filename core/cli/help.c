/* SPDX-License-Identifier: BSD-3-Clause */
#include <string.h>

#include "core/cli/cli.h"

static int run(const cli_verb *verb, int argc, char **argv) {
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, NULL, 0, 1, rest);
  if (code >= 0) return code;
  for (size_t i = 0; rest->len && cli_verbs[i]; i++) {
    if (strcmp(cli_verbs[i]->name, rest->pdata[0])) continue;
    char *help[] = {(char *)"--help"};
    return cli_verbs[i]->run(cli_verbs[i], 1, help);
  }
  if (rest->len) {
    cli_message("error", "unknown verb '%s', see 'opcflow help'",
                (char *)rest->pdata[0]);
    return CLI_USAGE;
  }
  cli_print("usage: opcflow VERB ...\n\n");
  for (size_t i = 0; cli_verbs[i]; i++) {
    g_autofree char *left =
        g_strdup_printf("%s %s", cli_verbs[i]->name, cli_verbs[i]->arguments);
    cli_print("  %-16s %s\n", left, cli_verbs[i]->summary);
  }
  cli_print("\n'opcflow help VERB' tells the options of one.\n");
  return CLI_GOOD;
}

const cli_verb cli_help = {"help", "[VERB]", "Tell what there is", run};
