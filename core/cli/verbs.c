/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds the verb of a command line and runs it, here or in another program. */
#include <base/suggest.h>
#include <guard/guard.h>
#include <locale.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

#include "core/cli/cli.h"

static GPtrArray *command_line;

const char *const *cli_command_line(void) { return cli_list(command_line); }

GPtrArray *cli_verb_names(void) {
  g_autoptr(GPtrArray) ids = opc_registry_ids(cli_registry(), "command.");
  GPtrArray *names = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; cli_verbs[i] && !cli_verbs[i]->hidden; i++)
    g_ptr_array_add(names, g_strdup(cli_verbs[i]->name));
  for (guint i = 0; i < ids->len; i++)
    g_ptr_array_add(names, g_strdup(strchr(ids->pdata[i], '.') + 1));
  return names;
}

const cli_verb *cli_find_verb(const char *name, opc_error *error) {
  for (size_t i = 0; cli_verbs[i]; i++)
    if (!strcmp(cli_verbs[i]->name, name)) return cli_verbs[i];
  g_autoptr(GPtrArray) names = cli_verb_names();
  if (g_ptr_array_find_with_equal_func(names, name, g_str_equal, NULL))
    return cli_plugin_verb(name, error);
  g_autofree char *suggestion = opc_suggestion(name, names);
  opc_fail(error, OPC_INVALID, NULL, "unknown verb '%s'%s", name,
           *suggestion ? suggestion : ", see 'opcflow help'");
  return NULL;
}

static char **all_words; /* words of main() */

void cli_become(const char *program) {
  cli_return_output();
  execv(program, all_words);
}

int cli_run_devel(const cli_verb *verb) {
  g_autofree char *program = opc_find_installed(OPC_LIBEXECDIR, CLI_DEVEL);
  if (program) cli_become(program);
  return cli_error(CLI_PLUGIN, "cannot run '%s': the program " CLI_DEVEL " %s",
                   verb->name, program ? "cannot be started" : "is missing");
}

/* Run the verb: the first word that is not an option. Options are also accepted
   before the verb. */
static int verbs_run(int argc, char **argv) {
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
  if (at >= argc)
    return cli_error(CLI_USAGE, "no verb given, see 'opcflow help'");
  cli_take_plugin_path((guint)argc, argv);
  opc_error error = {0};
  const cli_verb *verb = cli_find_verb(argv[at], &error);
  if (!verb) return cli_fail(&error);
  if (!verb->run) return cli_run_devel(verb);
  command_line = g_ptr_array_new();
  g_ptr_array_add(command_line, (char *)"opcflow");
  g_ptr_array_add(command_line, argv[at]);
  for (int i = 1; i < argc; i++)
    if (i != at) g_ptr_array_add(command_line, argv[i]);
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, command_line->len - 2,
                       (char **)command_line->pdata + 2, rest);
  return cli_finish(code < 0 ? verb->run(verb, rest) : code);
}

int cli_main(int argc, char **argv) {
  setlocale(LC_CTYPE, "");
  all_words = argv;
  cli_keep_output();
  signal(SIGXFSZ, SIG_IGN); /* a write beyond the file size limit fails
                               instead */
  guard_install(cli_is_terminal() ? "\r\033[K" : NULL);
  int code = verbs_run(argc, argv);
  guard_done(code);
  return code;
}
