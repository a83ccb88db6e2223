/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow check: reports all problems of a flow and its variants. */
#include "core/cli/cli.h"
#include "core/run/forecast.h"

static GPtrArray *sets, *variants, *sweeps;
static gboolean json, quick;

static const cli_option options[] = {
    {"set", "parameter value that replaces that of the flow",
     "STEP.PARAMETER=VALUE", .list = &sets},
    {"variant", "variant to check, 'base' for none, or 'all'", "NAME",
     .list = &variants},
    {"sweep", "further parameter values to check", "STEP.PARAMETER=[...]",
     .list = &sweeps},
    {"quick",
     "skip reading inputs and asking steps for their required resources",
     .flag = &quick},
    {"json", "print the result as JSON", .flag = &json},
    {0}};

/* Print each message of the instances once, also if several variants log it. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  static GMutex lock;
  if (level < OPC_LOG_WARNING) return;
  char *line = g_strdup_printf("%s: %s", path, message);
  g_mutex_lock(&lock);
  if (g_hash_table_add(data, line)) cli_message("warning", "%s", line);
  g_mutex_unlock(&lock);
}

/* ---- forecasts of a run ---- */

/* Least memory, bytes, for which a forecast without a work text is printed. */
static const double little = 1e6;

static void variant_forecast(const opc_recipe *recipe, const opc_choice *choice,
                             const opc_watch *watch, JsonArray *forecasts,
                             opc_problems *problems) {
  g_autoptr(GArray) list = g_array_new(FALSE, TRUE, sizeof(opc_outlook));
  opc_run_forecast(recipe, choice, cli_registry(), watch, list, problems);
  for (guint i = 0; i < list->len; i++) {
    const opc_outlook *o = &g_array_index(list, opc_outlook, i);
    g_autofree char *text = opc_forecast_text(&o->forecast);
    JsonObject *object = json_object_new();
    if (choice->variant)
      json_object_set_string_member(object, "variant", choice->variant);
    json_object_set_string_member(object, "step", o->step);
    json_object_set_string_member(object, "work", o->forecast.work);
    if (o->forecast.memory > 0)
      json_object_set_double_member(object, "memory", o->forecast.memory);
    json_array_add_object_element(forecasts, object);
    if (!json && (*o->forecast.work || o->forecast.memory >= little))
      cli_print("%s%s%s: %s\n", choice->variant ? choice->variant : "",
                choice->variant ? "/" : "", o->step, text);
    g_free(o->step);
  }
}

/* ---- the work ---- */

static GArray *open_files(const opc_recipe *recipe, const opc_choice *choice) {
  g_autoptr(opc_problems) others = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_make(recipe, choice, cli_registry(), others);
  return cli_open_files(flow);
}

/* Report the required files that the flow or a variant does not name, and
   return whether any file is missing. Files that the flow itself lacks are not
   reported again for its variants. A missing file is not a problem: the user
   may set the file later by --set. */
static gboolean needs_files(const opc_recipe *recipe, const opc_choice *choice,
                            GHashTable *reported, JsonArray *missing) {
  g_autoptr(GArray) its = open_files(recipe, choice);
  for (guint i = 0; i < its->len; i++) {
    const cli_open_file *file = &g_array_index(its, cli_open_file, i);
    if (g_hash_table_contains(reported, file->path)) continue;
    JsonObject *object = json_object_new();
    if (choice->variant)
      json_object_set_string_member(object, "variant", choice->variant);
    else
      g_hash_table_add(reported, g_strdup(file->path));
    json_object_set_string_member(object, "parameter", file->path);
    json_array_add_object_element(missing, object);
    if (!json)
      cli_print("%s%srequires --set %s=FILE, %s\n",
                choice->variant ? choice->variant : "",
                choice->variant ? ": " : "", file->path, file->summary);
  }
  return its->len > 0;
}

static void check_all(const opc_recipe *recipe, JsonArray *forecasts,
                      JsonArray *open, opc_problems *problems) {
  g_autoptr(GHashTable) reported =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  const opc_watch watch = {.data = reported, .log = take_log};
  g_autoptr(opc_sweep) sweep =
      opc_sweep_new(recipe, cli_list(sets), NULL, cli_list(sweeps), problems);
  opc_choice choice = {.sweep = sweep, .sets = cli_list(sets)};
  g_autoptr(GPtrArray) chosen =
      cli_choose_variants(recipe, variants, TRUE, problems);
  for (guint i = 0; i < chosen->len; i++) {
    guint before = problems->list->len;
    choice.variant = chosen->pdata[i];
    choice.bind = 0;
    gboolean needs = needs_files(recipe, &choice, reported, open);
    if (needs) choice.bind = OPC_BIND_NO_FILES;
    opc_flow_check(recipe, &choice, cli_registry(), needs ? NULL : &watch,
                   problems);
    if (!quick && !needs && problems->list->len == before)
      variant_forecast(recipe, &choice, &watch, forecasts, problems);
  }
}

static int check_run(const cli_verb *verb, const GPtrArray *arguments) {
  const char *path = cli_flow(verb, arguments);
  if (!path) return CLI_USAGE;
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_recipe) recipe = opc_recipe_read(path, problems);
  g_autoptr(JsonArray) forecasts = json_array_new();
  g_autoptr(JsonArray) open = json_array_new();
  if (recipe) check_all(recipe, forecasts, open, problems);
  if (json) {
    JsonObject *o = json_object_new();
    json_object_set_string_member(o, "flow", path);
    json_object_set_boolean_member(o, "valid", !problems->list->len);
    json_object_set_array_member(o, "forecast", json_array_ref(forecasts));
    json_object_set_array_member(o, "open", json_array_ref(open));
    cli_add_problems(o, problems);
    cli_print_object(o);
  }
  return cli_problems(problems);
}

const cli_verb cli_check = {
    .name = "check",
    .arguments = "[FLOW]",
    .summary = "Check a flow with all variants, without a run",
    .options = options,
    .least = 0,
    .most = 1,
    .run = check_run};
