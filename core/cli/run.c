/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/run.h"

#include <limits.h>
#include <malloc.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/cli/progress.h"
#include "core/plugin/guard.h"

/* ---- stopping ---- */

static volatile sig_atomic_t stopped;

/* The first signal asks; a second one, of either kind, ends what does not heed
   it. */
static void stop(int number) {
  (void)number;
  if (stopped) opc_guard_end(CLI_STOPPED);
  stopped = 1;
}

static void catch_signals(void) {
  struct sigaction action = {.sa_handler = stop};
  sigaction(SIGINT, &action, NULL);
  sigaction(SIGTERM, &action, NULL);
}

static int is_stopped(void *data) {
  (void)data;
  return stopped;
}

/* ---- a sweep ---- */

/* Whether the cells of a column differ. */
static gboolean varies(const opc_column *c, size_t rows) {
  g_autofree char *first = rows ? opc_table_cell(c, 0) : NULL;
  for (size_t i = 1; i < rows; i++) {
    g_autofree char *cell = opc_table_cell(c, i);
    if (strcmp(first, cell)) return TRUE;
  }
  return FALSE;
}

/* What to look at: the parameters and the metrics that they change, to six
   digits. */
static char *sweep_text(const opc_run *run) {
  const opc_table *all = run->points;
  guint parameters = run->sweep->axes->len;
  g_autofree opc_column *shown = g_new(opc_column, all->n_columns);
  g_autoptr(GPtrArray) rounded = g_ptr_array_new_with_free_func(g_free);
  size_t n = 0;
  for (size_t i = 0; i < all->n_columns; i++) {
    const opc_column *c = &all->columns[i];
    if (i > parameters &&
        (!varies(c, all->rows) || !strcmp(c->name, "seconds")) &&
        !(i + 1 == all->n_columns && run->failed_points))
      continue;
    shown[n++] = *c;
    if (c->type != OPC_REAL) continue;
    double *reals = g_new(double, MAX(all->rows, 1));
    for (size_t row = 0; row < all->rows; row++) {
      char digits[40];
      g_ascii_formatd(digits, sizeof digits, "%.6g",
                      ((const double *)c->data)[row]);
      reals[row] = g_ascii_strtod(digits, NULL);
    }
    g_ptr_array_add(rounded, reals);
    shown[n - 1].data = reals;
  }
  opc_error error;
  opc_table *table = opc_table_new("sweep", 0, all->rows, shown, n, &error);
  char *text = opc_table_text(table);
  opc_table_free(table);
  return text;
}

/* ---- what came of it ---- */

static void print_text(const opc_run *run) {
  for (guint i = 0; i < run->tables->len; i++) {
    const opc_run_table *t = run->tables->pdata[i];
    if (!(t->table->flags & OPC_TABLE_PRINT)) continue;
    g_autofree char *text = opc_table_text(t->table);
    cli_print("%s.%s\n%s\n", t->step, t->table->name, text);
  }
  if (run->points) {
    g_autofree char *text = sweep_text(run);
    cli_print("%s\n", text);
  }
  if (run->folder) cli_print("%s: %.2f s\n", run->folder, run->total);
}

static void add_tables(JsonBuilder *b, const opc_run *run) {
  json_builder_set_member_name(b, "tables");
  json_builder_begin_array(b);
  for (guint i = 0; i < run->tables->len; i++) {
    const opc_run_table *t = run->tables->pdata[i];
    if (!(t->table->flags & OPC_TABLE_PRINT)) continue;
    JsonNode *node = opc_table_json(t->table);
    json_object_set_string_member(json_node_get_object(node), "step", t->step);
    json_builder_add_value(b, node);
  }
  json_builder_end_array(b);
}

static JsonNode *run_json(const opc_run *run) {
  JsonBuilder *b = json_builder_new();
  json_builder_begin_object(b);
  json_builder_set_member_name(b, "folder");
  json_builder_add_string_value(b, run->folder);
  json_builder_set_member_name(b, "seconds");
  json_builder_add_double_value(b, run->total);
  json_builder_set_member_name(b, "metrics");
  json_builder_add_value(b, opc_run_metrics_json(run));
  add_tables(b, run);
  if (run->points) {
    json_builder_set_member_name(b, "sweep");
    json_builder_add_value(b, opc_table_json(run->points));
  }
  json_builder_end_object(b);
  JsonNode *node = json_builder_get_root(b);
  g_object_unref(b);
  return node;
}

/* ---- the work ---- */

typedef struct request {
  const char *path;
  GPtrArray *sets, *sweeps, *variants; /* NULL-terminated */
  opc_run_options options;
  gboolean json, quiet;
} request;

/* What the runs of a request share. */
typedef struct series {
  const request *request;
  opc_registry *registry;
  const opc_recipe *recipe;
  const opc_sweep *sweep;
  GPtrArray *chosen; /* const opc_variant *; NULL: none */
  JsonArray *json;   /* of each run, where there are several */
} series;

/* A run that came to nothing, or to a part: `folder` may be NULL. */
static void tell_failure(const series *s, const char *folder,
                         opc_problems *problems) {
  g_autoptr(JsonBuilder) b = json_builder_new();
  json_builder_begin_object(b);
  if (folder) {
    json_builder_set_member_name(b, "folder");
    json_builder_add_string_value(b, folder);
  }
  json_builder_set_member_name(b, "problems");
  json_builder_add_value(b, cli_problems_json(problems));
  json_builder_end_object(b);
  if (s && s->chosen->len > 1)
    json_array_add_element(s->json, json_builder_get_root(b));
  else
    cli_print_json(json_builder_get_root(b));
}

static int tell(const series *s, const opc_run *run, opc_problems *problems) {
  if (problems->list->len) {
    if (s->request->json) tell_failure(s, run->folder, problems);
    int code = cli_problems(problems);
    if (run->points && run->points->rows && !s->request->quiet) print_text(run);
    if (run->folder)
      cli_message("note", "what was written so far is in '%s'", run->folder);
    return stopped ? CLI_STOPPED : code;
  }
  if (s->request->json && s->chosen->len == 1)
    cli_print_json(run_json(run));
  else if (s->request->json)
    json_array_add_element(s->json, run_json(run));
  else if (!s->request->quiet)
    print_text(run);
  if (run->failed_points)
    cli_message("error", "%zu of %zu points failed", run->failed_points,
                run->sweep->points);
  return cli_exit_code(run->points_code);
}

/* DIR, or DIR/VARIANT where there are several. */
static char *output_folder(const series *s, const opc_variant *variant) {
  const char *output = s->request->options.output;
  if (!output || s->chosen->len == 1) return g_strdup(output);
  return g_build_filename(output, variant ? variant->name : "base", NULL);
}

static int run_one(const series *s, const opc_variant *variant) {
  const opc_choice choice = {
      .variant = variant,
      .sweep = s->sweep,
      .sets = (const char *const *)s->request->sets->pdata};
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_make(s->recipe, &choice, s->registry, problems);
  if (problems->list->len) {
    if (s->request->json) tell_failure(s, NULL, problems);
    return cli_problems(problems);
  }
  g_autofree char *output = output_folder(s, variant);
  opc_run_options options = s->request->options;
  options.output = output;
  if (s->chosen->len > 1 && !s->request->json && !s->request->quiet)
    cli_print("variant %s\n\n", variant ? variant->name : "base");
  cli_progress progress;
  cli_progress_start(&progress, s->request->quiet);
  const opc_watch watch = {&progress,         cli_progress_log,
                           cli_progress_step, cli_progress_show,
                           is_stopped,        cli_progress_point};
  g_autoptr(opc_run) run =
      s->sweep->axes->len
          ? opc_run_sweep(flow, &choice, s->registry, &options, &watch,
                          problems)
          : opc_run_flow(flow, s->registry, &options, &watch, problems);
  cli_progress_end(&progress);
  return tell(s, run, problems);
}

/* All are checked before the first one runs. */
static gboolean check_all(const series *s, opc_problems *problems) {
  for (guint i = 0; i < s->chosen->len; i++) {
    const opc_choice choice = {
        .variant = s->chosen->pdata[i],
        .sweep = s->sweep,
        .sets = (const char *const *)s->request->sets->pdata};
    opc_flow_check(s->recipe, &choice, s->registry, NULL, problems);
  }
  return !problems->list->len;
}

/* The exit code of the first run that is not good. */
static int run_all(const series *s) {
  int code = CLI_GOOD;
  catch_signals();
  for (guint i = 0; i < s->chosen->len && !stopped; i++) {
    if (i && !s->request->json && !s->request->quiet) cli_print("\n");
    int one = run_one(s, s->chosen->pdata[i]);
    if (!code || one == CLI_STOPPED) code = one;
  }
  if (s->request->json && s->chosen->len > 1) {
    JsonNode *node = json_node_new(JSON_NODE_ARRAY);
    json_node_set_array(node, s->json);
    cli_print_json(node);
  }
  return code;
}

static void choose_variants(series *s, opc_problems *problems) {
  GPtrArray *names = s->request->variants;
  for (guint i = 0; i + 1 < names->len; i++) {
    const char *name = names->pdata[i];
    gboolean all = !strcmp(name, "all");
    for (guint k = 0; all && k < s->recipe->variants->len; k++)
      g_ptr_array_add(s->chosen, s->recipe->variants->pdata[k]);
    if (all && !s->recipe->variants->len) {
      const opc_place at = {s->recipe->path, 0, 0};
      opc_problem_add(problems, OPC_INVALID, &at, "has no variants");
    }
    if (!all)
      g_ptr_array_add(s->chosen, strcmp(name, "base")
                                     ? (gpointer)opc_recipe_variant(
                                           s->recipe, name, problems)
                                     : NULL);
  }
  if (names->len == 1) g_ptr_array_add(s->chosen, NULL);
}

static int run_flow(const request *r) {
  g_autoptr(opc_registry) registry = opc_registry_new(cli_plugin_path());
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_recipe) recipe = opc_recipe_read(r->path, problems);
  if (!recipe) {
    if (r->json) tell_failure(NULL, NULL, problems);
    return cli_problems(problems);
  }
  g_autoptr(opc_sweep) sweep =
      opc_sweep_new(recipe, (const char *const *)r->sets->pdata,
                    (const char *const *)r->sweeps->pdata, problems);
  g_autoptr(GPtrArray) chosen = g_ptr_array_new();
  series s = {r, registry, recipe, sweep, chosen, json_array_new()};
  choose_variants(&s, problems);
  gboolean good = check_all(&s, problems);
  cli_warnings(problems);
  if (!good && r->json) tell_failure(NULL, NULL, problems);
  int code = good ? run_all(&s) : cli_problems(problems);
  json_array_unref(s.json);
  return code;
}

static int set_threads(const char *text) {
  if (!text) return -1;
  char *end;
  unsigned long n = strtoul(text, &end, 10);
  if (!g_ascii_isdigit(*text) || *end || !n || n > 4096) {
    cli_message("error", "'--threads' needs a number from 1 to 4096, not '%s'",
                text);
    return CLI_USAGE;
  }
  opc_set_threads((unsigned)n);
  return -1;
}

/* Fields come and go, each tens of megabytes and of the same sizes again: keep
   their memory rather than have it mapped and cleared each time, which costs a
   tenth of a correction. */
static void keep_memory(void) {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
}

static int run(const cli_verb *verb, int argc, char **argv) {
  keep_memory();
  request r = {0};
  const char *threads = NULL;
  g_autoptr(GPtrArray) sets = g_ptr_array_new();
  g_autoptr(GPtrArray) sweeps = g_ptr_array_new();
  g_autoptr(GPtrArray) variants = g_ptr_array_new();
  const cli_option options[] = {
      {"set", "STEP.PARAMETER=VALUE", "over what the flow says", NULL, NULL,
       sets},
      {"variant", "NAME", "a variant of the flow, 'base' or 'all'", NULL, NULL,
       variants},
      {"sweep", "STEP.PARAMETER=[...]", "run at each of these values", NULL,
       NULL, sweeps},
      {"keep", NULL, "keep what each point of a sweep writes", &r.options.keep,
       NULL, NULL},
      {"output", "DIR", "the run folder (default: runs/NAME)", NULL,
       &r.options.output, NULL},
      {"force", NULL, "replace an earlier run in DIR", &r.options.force, NULL,
       NULL},
      {"threads", "N", "default: as many as there are processors", NULL,
       &threads, NULL},
      {"json", NULL, "the result as JSON", &r.json, NULL, NULL},
      {"quiet", NULL, "nothing but warnings and errors", &r.quiet, NULL, NULL},
      {0}};
  g_autoptr(GPtrArray) rest = g_ptr_array_new();
  g_autoptr(GPtrArray) command = g_ptr_array_new();
  g_ptr_array_add(command, (char *)"opcflow");
  g_ptr_array_add(command, (char *)verb->name);
  for (int i = 0; i < argc; i++) g_ptr_array_add(command, argv[i]);
  g_ptr_array_add(command, NULL);
  int code = cli_parse(verb, argc, argv, options, 1, 1, rest);
  if (code < 0) code = set_threads(threads);
  if (code >= 0) return code;
  g_ptr_array_add(sets, NULL);
  g_ptr_array_add(sweeps, NULL);
  g_ptr_array_add(variants, NULL);
  r.path = rest->pdata[0];
  r.sets = sets;
  r.sweeps = sweeps;
  r.variants = variants;
  r.options.command = (const char *const *)command->pdata;
  return run_flow(&r);
}

const cli_verb cli_run = {
    .name = "run", .arguments = "FLOW", .summary = "Run a flow", .run = run};
