/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/cli/cli.h"
#include "core/flow/run.h"

/* What instances say while they are made. */
static void take_log(void *data, int level, const char *message) {
  const opc_binding *binding = data;
  if (level >= OPC_LOG_WARNING)
    cli_message("warning", "%s: %s", binding->path, message);
}

static int check(const char *path, const char *const *sets) {
  static const opc_sink sink = {.log = take_log};
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow = opc_flow_load(path, sets, registry, problems);
  if (!problems->list->len) opc_flow_create(flow, &sink, NULL, problems);
  return cli_problems(problems);
}

static int run(const cli_verb *verb, int argc, char **argv) {
  g_autoptr(GPtrArray) sets = g_ptr_array_new();
  const cli_option options[] = {{"set", "STEP.PARAMETER=VALUE",
                                 "over what the flow says", NULL, NULL, sets},
                                {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 1, 1, rest);
  if (code >= 0) return code;
  g_ptr_array_add(sets, NULL);
  return check(rest->pdata[0], (const char *const *)sets->pdata);
}

const cli_verb cli_check = {"check", "FLOW", "Check a flow without running it",
                            run};
