/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/schema.h"

#include "core/cli/cli.h"
#include "core/flow/files.h"
#include "core/flow/run.h"

static int write_schema(const char *path, JsonNode *schema) {
  if (!path) {
    cli_print_json(schema);
    return CLI_GOOD;
  }
  opc_error error = {0};
  g_autofree char *text = opc_json_text(schema);
  if (!opc_write_file(path, text, &error)) return CLI_GOOD;
  cli_message("error", "%s", error.message);
  return cli_exit_code(error.code);
}

static int run(const cli_verb *verb, int argc, char **argv) {
  const char *output = NULL;
  const cli_option options[] = {
      {"output", "FILE", "default: standard output", NULL, &output, NULL}, {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 0, 0, rest);
  if (code >= 0) return code;
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(GPtrArray) plugins = cli_usable_plugins(registry);
  return write_schema(output, opc_flow_schema(plugins));
}

const cli_verb cli_schema = {
    .name = "schema",
    .arguments = "",
    .summary = "Write a JSON Schema of flow files, for editors",
    .run = run};
