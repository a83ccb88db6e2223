/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow schema: a JSON Schema of flows, with the plugins of this moment. */
#include "core/flow/schema.h"

#include <store/files.h>
#include "core/cli/cli.h"
#include "core/run/run.h"

/* All plugins that can be used, by id: const opc_plugin *. */
static GPtrArray *usable_plugins(void) {
  GPtrArray *plugins = g_ptr_array_new();
  g_autoptr(GPtrArray) list =
      opc_registry_scan(cli_registry(), "", CLI_PATIENCE);
  for (guint i = 0; i < list->len; i++) {
    const opc_candidate *c = list->pdata[i];
    opc_error error;
    if (c->reason || c->hidden_by) continue;
    const opc_plugin *plugin = opc_registry_find(cli_registry(), c->id, &error);
    if (plugin) g_ptr_array_add(plugins, (void *)plugin);
  }
  return plugins;
}

static const char *output;

static const cli_option options[] = {
    {"output", "default: standard output", "FILE", .text = &output}, {0}};

static int run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb, (void)arguments;
  g_autoptr(GPtrArray) plugins = usable_plugins();
  g_autofree char *text = opc_json_text(opc_flow_schema(plugins));
  opc_error error = {0};
  if (output && opc_write_file(output, text, &error)) return cli_fail(&error);
  if (!output) cli_print("%s", text);
  return CLI_GOOD;
}

const cli_verb cli_schema = {
    .name = "schema",
    .arguments = "",
    .summary = "Write a JSON Schema of flow files, for editors",
    .options = options,
    .run = run};
