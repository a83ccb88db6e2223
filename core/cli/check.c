/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/cli/cli.h"
#include "core/flow/run.h"

/* What instances say while they are made. */
static void take_log(void *data, int level, const char *message) {
  const opc_binding *binding = data;
  if (level >= OPC_LOG_WARNING)
    cli_message("warning", "%s: %s", binding->path, message);
}

/* What stands on the command line. */
typedef struct request {
  const char *path;
  GPtrArray *sets, *sweeps; /* NULL-terminated */
  gboolean json;
} request;

static void check_all(const request *r, const opc_recipe *recipe,
                      opc_registry *registry, opc_problems *problems) {
  static const opc_sink sink = {.log = take_log};
  const char *const *sets = (const char *const *)r->sets->pdata;
  g_autoptr(opc_sweep) sweep = opc_sweep_new(
      recipe, sets, (const char *const *)r->sweeps->pdata, problems);
  opc_choice choice = {.sweep = sweep, .sets = sets};
  opc_flow_check(recipe, &choice, registry, &sink, problems);
  for (guint i = 0; i < recipe->variants->len; i++) {
    choice.variant = recipe->variants->pdata[i];
    opc_flow_check(recipe, &choice, registry, &sink, problems);
  }
}

static void print_json(const char *path, opc_problems *problems) {
  g_autoptr(JsonBuilder) b = json_builder_new();
  json_builder_begin_object(b);
  json_builder_set_member_name(b, "flow");
  json_builder_add_string_value(b, path);
  json_builder_set_member_name(b, "valid");
  json_builder_add_boolean_value(b, !problems->list->len);
  json_builder_set_member_name(b, "problems");
  json_builder_add_value(b, cli_problems_json(problems));
  json_builder_end_object(b);
  cli_print_json(json_builder_get_root(b));
}

static int check(const request *r) {
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_recipe) recipe = opc_recipe_read(r->path, problems);
  if (recipe) check_all(r, recipe, registry, problems);
  cli_warnings(problems);
  if (r->json) print_json(r->path, problems);
  return cli_problems(problems);
}

static int run(const cli_verb *verb, int argc, char **argv) {
  gboolean json = FALSE;
  g_autoptr(GPtrArray) sets = g_ptr_array_new();
  g_autoptr(GPtrArray) sweeps = g_ptr_array_new();
  const cli_option options[] = {
      {"set", "STEP.PARAMETER=VALUE", "over what the flow says", NULL, NULL,
       sets},
      {"sweep", "STEP.PARAMETER=[...]", "also at these values", NULL, NULL,
       sweeps},
      {"json", NULL, "what is wrong as JSON, too", &json, NULL, NULL},
      {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  int code = cli_parse(verb, argc, argv, options, 1, 1, rest);
  if (code >= 0) return code;
  g_ptr_array_add(sets, NULL);
  g_ptr_array_add(sweeps, NULL);
  const request r = {rest->pdata[0], sets, sweeps, json};
  return check(&r);
}

const cli_verb cli_check = {
    .name = "check",
    .arguments = "FLOW",
    .summary = "Check a flow and its variants without running them",
    .run = run};
