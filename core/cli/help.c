/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow help and opcflow version. */
#include <string.h>

#include "core/cli/cli.h"

/* Print the verbs of plugins; each plugin is loaded in a child process. */
static void print_plugin_verbs(void) {
  g_autoptr(GPtrArray) found =
      opc_registry_usable(cli_registry(), "command.", CLI_PATIENCE);
  for (guint i = 0; i < found->len; i++) {
    const opc_candidate *c = found->pdata[i];
    if (!i) cli_print("\nVerbs of plugins:\n");
    cli_print_pair(strchr(c->id, '.') + 1, "", c->summary);
  }
}

static int run_help(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  opc_error error = {0};
  if (arguments->len) {
    const cli_verb *about = cli_find_verb(arguments->pdata[0], &error);
    if (!about) return cli_fail(&error);
    if (!about->run) return cli_run_devel(about);
    cli_print_help(about);
    return CLI_GOOD;
  }
  cli_print(
      "Usage: opcflow VERB ...\n"
      "\n"
      "Runs flows: YAML files that list plugins in "
      "their order, with parameters.\n"
      "\nVerbs:\n");
  for (size_t i = 0; cli_verbs[i] && !cli_verbs[i]->hidden; i++)
    cli_print_pair(cli_verbs[i]->name, cli_verbs[i]->arguments,
                   cli_verbs[i]->summary);
  print_plugin_verbs();
  cli_print("\n'opcflow help VERB' prints the options of a verb.\n");
  return CLI_GOOD;
}

const cli_verb cli_help = {.name = "help",
                           .arguments = "[VERB]",
                           .summary = "Show help",
                           .most = 1,
                           .run = run_help};

static gboolean json;

static int run_version(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb, (void)arguments;
  if (!json) {
    cli_print("opcflow %s (plugin interface %u.%u)\n", OPC_VERSION,
              OPC_ABI_MAJOR, OPC_ABI_MINOR);
    return CLI_GOOD;
  }
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "opcflow", OPC_VERSION);
  json_object_set_int_member(o, "interface_major", OPC_ABI_MAJOR);
  json_object_set_int_member(o, "interface_minor", OPC_ABI_MINOR);
  cli_print_object(o);
  return CLI_GOOD;
}

static const cli_option version_options[] = {
    {"json", "print the version as JSON", .flag = &json}, {0}};

const cli_verb cli_version = {.name = "version",
                              .arguments = "",
                              .summary = "Show the version",
                              .options = version_options,
                              .run = run_version};
