/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow check: all that is wrong with a flow and its variants. */
#include "core/cli/cli.h"
#include "core/flow/run.h"

static GPtrArray *sets, *sweeps;
static gboolean json;

static const cli_option options[] = {
    {"set", "over what the flow says", "STEP.PARAMETER=VALUE", .list = &sets},
    {"sweep", "also at these values", "STEP.PARAMETER=[...]", .list = &sweeps},
    {"json", "what is wrong as JSON, too", .flag = &json},
    {0}};

/* What instances say while they are made. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  (void)data;
  if (level >= OPC_LOG_WARNING) cli_message("warning", "%s: %s", path, message);
}

static void check_all(const opc_recipe *recipe, opc_problems *problems) {
  static const opc_watch watch = {.log = take_log};
  g_autoptr(opc_sweep) sweep =
      opc_sweep_new(recipe, cli_list(sets), NULL, cli_list(sweeps), problems);
  opc_choice choice = {.sweep = sweep, .sets = cli_list(sets)};
  opc_flow_check(recipe, &choice, cli_registry(), &watch, problems);
  for (guint i = 0; i < recipe->variants->keys->len; i++) {
    choice.variant = opc_node_key(recipe->variants, i);
    opc_flow_check(recipe, &choice, cli_registry(), &watch, problems);
  }
}

static int run(const cli_verb *verb, const GPtrArray *arguments) {
  (void)verb;
  const char *path = arguments->pdata[0];
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_recipe) recipe = opc_recipe_read(path, problems);
  if (recipe) check_all(recipe, problems);
  if (json) {
    JsonObject *o = json_object_new();
    json_object_set_string_member(o, "flow", path);
    json_object_set_boolean_member(o, "valid", !problems->list->len);
    cli_add_problems(o, problems);
    cli_print_object(o);
  }
  return cli_problems(problems);
}

const cli_verb cli_check = {
    .name = "check",
    .arguments = "FLOW",
    .summary = "Check a flow and its variants without running them",
    .options = options,
    .least = 1,
    .most = 1,
    .run = run};
