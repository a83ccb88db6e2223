/* SPDX-License-Identifier: BSD-3-Clause */
/* opcflow run: runs a flow or its variants and prints the results. */

#include <guard/stop.h>
#include <limits.h>
#include <malloc.h>
#include <string.h>

#include "core/cli/cli.h"
#include "core/cli/progress.h"
#include "core/report/json.h"
#include "core/run/pieces.h"
#include "core/run/whole.h"

/* Values of the options of the command line. */
static GPtrArray *sets, *variants, *sweeps;
static const char *threads, *level_word;
static opc_run_options wanted;
static gboolean json, quiet, no_cache;
static int level = OPC_LOG_WARNING; /* lowest level printed */
static gboolean steps = TRUE;       /* report steps and progress */

static const cli_option options[] = {
    {"set", "parameter value that replaces that of the flow",
     "STEP.PARAMETER=VALUE", .list = &sets},
    {"variant", "variant to run, 'base' for none, or 'all'", "NAME",
     .list = &variants},
    {"sweep", "parameter values, one run for each", "STEP.PARAMETER=[...]",
     .list = &sweeps},
    {"keep", "keep the files of each point of a sweep", .flag = &wanted.keep},
    {"output", "run folder (default: runs/NAME)", "DIR",
     .text = &wanted.output},
    {"force",
     "replace DIR if DIR is empty, or an earlier run with unchanged files",
     .flag = &wanted.force},
    {"no-cache", "run all steps and store no results", .flag = &no_cache},
    {"threads", "number of threads (default: number of processors)", "N",
     .text = &threads},
    {"json", "print the result as JSON", .flag = &json},
    {"log", "lowest level of messages (default: steps)",
     "debug|info|steps|warning", .text = &level_word},
    {"quiet", "print only warnings and errors", .flag = &quiet},
    {0}};

/* ---- a sweep ---- */

/* Return whether the cells of a column differ. */
static gboolean column_varies(const opc_column *c, size_t rows) {
  g_autofree char *first = rows ? opc_table_cell(c, 0) : NULL;
  for (size_t i = 1; i < rows; i++) {
    g_autofree char *cell = opc_table_cell(c, i);
    if (strcmp(first, cell)) return TRUE;
  }
  return FALSE;
}

/* Print the table of a sweep: the parameters and the metrics that vary. */
static void print_sweep(const opc_run *run) {
  const opc_table *all = run->out.points;
  guint parameters = run->out.sweep->axes->len;
  g_autofree opc_column *shown = g_new(opc_column, all->n_columns);
  size_t n = 0;
  for (size_t i = 0; i < all->n_columns; i++) {
    const opc_column *c = &all->columns[i];
    if (i <= parameters ||
        (column_varies(c, all->rows) && strcmp(c->name, "seconds")) ||
        (i + 1 == all->n_columns && run->out.failed_points))
      shown[n++] = *c;
  }
  opc_error error;
  opc_table *table =
      opc_table_new("sweep", 0, all->rows, shown, n, sizeof *shown, &error);
  cli_print_table(table);
  opc_table_free(table);
}

/* ---- results ---- */

static void print_text(const opc_run *run) {
  for (guint i = 0; i < run->out.tables->len; i++) {
    const opc_table *t = run->out.tables->pdata[i];
    if (!(t->flags & OPC_TABLE_PRINT)) continue;
    cli_print("%s.%s\n", t->step, t->name);
    cli_print_table(t);
    cli_print("\n");
  }
  if (run->out.points) {
    print_sweep(run);
    cli_print("\n");
  }
  if (!run->out.folder) return;
  cli_print("%s: %.2f s", run->out.folder, run->out.total);
  if (run->out.histories.reused)
    cli_print(", %zu of %zu steps reused", run->out.histories.reused,
              run->out.histories.done);
  cli_print("\n");
}

static JsonArray *tables_json(const opc_run *run) {
  JsonArray *list = json_array_new();
  for (guint i = 0; i < run->out.tables->len; i++) {
    const opc_table *t = run->out.tables->pdata[i];
    if (!(t->flags & OPC_TABLE_PRINT)) continue;
    JsonNode *node = opc_table_json(t);
    json_object_set_string_member(json_node_get_object(node), "step", t->step);
    json_array_add_element(list, node);
  }
  return list;
}

static JsonObject *run_json(const opc_run *run, opc_problems *broken) {
  JsonObject *o = json_object_new();
  json_object_set_string_member(o, "folder", run->out.folder);
  json_object_set_double_member(o, "seconds", run->out.total);
  if (wanted.store) {
    json_object_set_int_member(o, "steps", (gint64)run->out.histories.done);
    json_object_set_int_member(o, "reused", (gint64)run->out.histories.reused);
  }
  json_object_set_member(o, "metrics", opc_outcome_metrics(&run->out));
  opc_outcome_add_findings(o, &run->out);
  json_object_set_array_member(o, "tables", tables_json(run));
  if (run->out.points)
    json_object_set_member(o, "sweep", opc_table_json(run->out.points));
  if (broken->list->len) cli_add_problems(o, broken);
  return o;
}

/* ---- the work ---- */

/* State shared by the runs of all variants. */
typedef struct series {
  const opc_recipe *recipe;
  const opc_sweep *sweep;
  GPtrArray *chosen; /* char *: variants; NULL for the flow itself */
  JsonArray *list;   /* one document per run, if there are several */
} series;

static opc_choice choice_of(const series *s, const char *variant) {
  return (opc_choice){
      .variant = variant, .sweep = s->sweep, .sets = cli_list(sets)};
}

/* Print one document, or append it to the list of several runs; takes ownership
   of the object. */
static void print_json(const series *s, JsonObject *object) {
  if (s->chosen->len > 1)
    json_array_add_object_element(s->list, object);
  else
    cli_print_object(object);
}

/* Return the document of a run that failed; `run` may be NULL. */
static JsonObject *failure_json(const opc_run *run, opc_problems *problems) {
  JsonObject *o = json_object_new();
  if (run && run->out.folder)
    json_object_set_string_member(o, "folder", run->out.folder);
  if (run) opc_outcome_add_findings(o, &run->out);
  cli_add_problems(o, problems);
  return o;
}

/* Print the findings last, after all other output. */
static void findings_print(const opc_run *run, const char *note) {
  g_autoptr(GPtrArray) lines = opc_findings_lines(&run->out.findings);
  cli_flush();
  for (guint i = 0; i < lines->len; i++)
    cli_message("finding", "%s%s", (char *)lines->pdata[i], note);
}

/* Print the results of a run. `note`: the variant if several variants run. */
static int run_print_results(const series *s, const opc_run *run,
                             const char *note, const opc_problems *found) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_problems_merge(problems, found, note);
  if (problems->list->len) {
    if (json) print_json(s, failure_json(run, problems));
    int code = cli_problems(problems);
    if (run->out.points && run->out.points->rows && !quiet) print_text(run);
    findings_print(run, note);
    if (run->out.folder)
      cli_message("note", "files written so far are in '%s'", run->out.folder);
    return cli_is_stopped(NULL) ? CLI_STOPPED : code;
  }
  g_autoptr(opc_problems) missed = opc_problems_new();
  opc_verdicts_add_broken(run->out.verdicts, missed);
  opc_problems_merge(problems, missed, note);
  if (json)
    print_json(s, run_json(run, problems));
  else if (!quiet)
    print_text(run);
  findings_print(run, note);
  if (run->out.failed_points && run->out.sweep)
    cli_message("error", "%zu of %zu points failed", run->out.failed_points,
                run->out.sweep->points);
  int code = cli_problems(problems);
  return run->out.points_code ? cli_exit_code(run->out.points_code) : code;
}

/* Return whether this process is a rank other than the first. */
static gboolean is_second(void) { return wanted.ranks && wanted.ranks->rank; }

static int run_one(const series *s, const char *variant) {
  const opc_choice choice = choice_of(s, variant);
  const char *name = variant ? variant : "base";
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_flow) flow =
      opc_flow_make(s->recipe, &choice, cli_registry(), problems);
  if (problems->list->len) {
    if (json) print_json(s, failure_json(NULL, problems));
    return cli_problems(problems);
  }
  /* DIR, or DIR/VARIANT if several variants run. */
  opc_run_options its = wanted;
  g_autofree char *output =
      wanted.output ? g_build_filename(wanted.output, name, NULL) : NULL;
  if (s->chosen->len > 1) its.output = output;
  if (s->chosen->len > 1 && !json && !quiet) cli_print("variant %s\n\n", name);
  cli_progress progress;
  cli_progress_start(&progress, level, steps);
  const opc_watch shown = {&progress,         cli_progress_log,
                           cli_progress_step, cli_progress_show,
                           cli_is_stopped,    cli_progress_point};
  const opc_watch unseen = {.cancelled = cli_is_stopped};
  const opc_watch watch = is_second() ? unseen : shown;
  g_autoptr(opc_run) run =
      opc_run_flow(flow, &choice, cli_registry(), &its, &watch, problems);
  cli_progress_end(&progress);
  g_autofree char *note = s->chosen->len > 1
                              ? g_strdup_printf(" (variant '%s')", name)
                              : g_strdup("");
  return run_print_results(s, run, note, problems);
}

/* Run all variants. Return the first failed exit code, or CLI_STOPPED. */
static int run_all(const series *s) {
  int code = CLI_GOOD;
  stop_on_signals(CLI_STOPPED);
  for (guint i = 0; i < s->chosen->len && !cli_is_stopped(NULL); i++) {
    if (i && !json && !quiet) cli_print("\n");
    int one = run_one(s, s->chosen->pdata[i]);
    if (!code || one == CLI_STOPPED) code = one;
  }
  if (json && s->chosen->len > 1) cli_print_array(json_array_ref(s->list));
  return code;
}

/* Keep freed memory in the process, because arrays of tens of megabytes are
   freed and allocated again and again. Mapping and zeroing new pages each time
   would cost about a tenth of the run time. */
static void keep_memory(void) {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, INT_MAX);
}

/* Set the level of messages. Returns -1, or the exit code. */
static int set_level(void) {
  static const char *const words[] = {"debug", "info", "steps", "warning",
                                      NULL};
  steps = !quiet;
  for (int i = 0; level_word && words[i]; i++)
    if (!strcmp(words[i], level_word)) {
      level = MIN(i, OPC_LOG_WARNING);
      steps = i <= OPC_LOG_WARNING;
      return -1;
    }
  return level_word
             ? cli_error(
                   CLI_USAGE,
                   "'--log' must be debug, info, steps or warning, found '%s'",
                   level_word)
             : -1;
}

/* Return the store of results; NULL if all steps run. */
static opc_store *open_store(void) {
  opc_error error = {0};
  opc_store *store = no_cache ? NULL : opc_store_open(&error);
  if (error.code)
    cli_message("warning", "no results are kept or reused: %s", error.message);
  return store;
}

/* ---- ranks ---- */

/* Join the ranks if several processes were started to run the flow; only the
   first one prints. Returns -1, or the exit code. */
static int meet_ranks(void) {
  int rank, size;
  opc_error error;
  if (!ranks_launched(&rank, &size)) return -1;
  g_autofree char *object = opc_find_installed(OPC_LIBDIR, RANKS_OBJECT);
  wanted.ranks = ranks_load(object, stop_is_asked, &error);
  if (!wanted.ranks) return cli_fail(&error);
  if (is_second()) cli_be_silent();
  return -1;
}

/* Wait until the first rank has written everything and return the exit code.
   Other ranks return CLI_GOOD, as mpirun ends all processes when one fails. */
static int leave_ranks(int code) {
  cli_flush();
  if (wanted.ranks) wanted.ranks->end();
  return !is_second() || code == CLI_STOPPED ? code : CLI_GOOD;
}

/* ---- the verb ---- */

/* Check all variants, then run them. */
static int check_and_run(const char *path) {
  wanted.command = cli_command_line();
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_recipe) recipe = opc_recipe_read(path, problems);
  g_autoptr(opc_sweep) sweep = NULL;
  g_autoptr(GPtrArray) chosen =
      cli_choose_variants(recipe, variants, FALSE, problems);
  g_autoptr(JsonArray) list = json_array_new();
  if (recipe)
    sweep =
        opc_sweep_new(recipe, cli_list(sets), NULL, cli_list(sweeps), problems);
  const series s = {recipe, sweep, chosen, list};
  for (guint i = 0; i < chosen->len; i++) {
    const opc_choice choice = choice_of(&s, chosen->pdata[i]);
    opc_flow_check(recipe, &choice, cli_registry(), NULL, problems);
  }
  if (opc_ranks_agree(wanted.ranks, "the flow", problems)) {
    g_autoptr(opc_store) store = open_store();
    wanted.store = store;
    return run_all(&s);
  }
  if (json) cli_print_object(failure_json(NULL, problems));
  return cli_problems(problems);
}

static int run_run(const cli_verb *verb, const GPtrArray *arguments) {
  int code = cli_set_threads(threads);
  if (code < 0) code = set_level();
  if (code < 0 && wanted.force && !wanted.output)
    code = cli_error(
        CLI_USAGE, "'--force' requires '--output', the run folder to replace");
  const char *path = code < 0 ? cli_flow(verb, arguments) : NULL;
  if (code < 0 && !path) code = CLI_USAGE;
  if (code < 0) code = meet_ranks();
  if (code >= 0) return code;
  keep_memory();
  return leave_ranks(check_and_run(path));
}

const cli_verb cli_run = {.name = "run",
                          .arguments = "[FLOW]",
                          .summary = "Run a flow",
                          .options = options,
                          .least = 0,
                          .most = 1,
                          .run = run_run};
