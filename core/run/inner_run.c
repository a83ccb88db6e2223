/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs inner flows on levels and passes their results to the step. */
#include "core/run/inner_run.h"

#include <base/suggest.h>
#include <errno.h>
#include <gio/gio.h>
#include <math.h>
#include <store/files.h>
#include <string.h>

#include "core/binding/inner.h"
#include "core/binding/lookup.h"
#include "core/run/inputs.h"
#include "core/run/levels.h"
#include "core/run/listen.h"
#include "core/run/reports.h"
#include "core/run/reuse.h"
#include "core/run/steps.h"

/* ---- state ---- */

/* State of the runs of an inner flow, from `inner_runs_begin` on. */
struct opc_inner_runs {
  opc_inner *in;
  opc_run *outer; /* run of the step */
  opc_watch watch;
  char *folder;
  opc_levels levels;
  opc_run *trunk;
  size_t count;                     /* calls of `run`; number in a folder's
                                       name */
  size_t done, share;               /* finished points; points that the current
                                       run counts as */
  gboolean verbose;                 /* pass on the messages of the run */
  opc_inner_run whole;              /* result of the last run with full
                                       reports */
  const opc_inner_metric **metrics; /* result of the last get_metrics */
};

static opc_inner_runs *runs_of(const opc_host *host) {
  return opc_inner_of(host)->runs;
}

/* Use inputs of the calling step as outputs of the steps that they replace
   (OPC_INNER_STEP). */
static void put_given(const opc_inner *in, opc_run *run) {
  const opc_binding *b = in->binding;
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    const char *name = b->plugin->parameters[i].name;
    void **objects = g_hash_table_lookup(in->given, name);
    if (!objects) continue;
    objects[0] = (void *)b->values[i].field.object;
    run->objects[opc_flow_find(run->flow, name)->number] = objects;
  }
}

/* ---- running: messages and progress ---- */

/* Pass on a message of the trunk (levels.h) or of a run with `keep`. Messages
   of other runs are dropped, because they repeat at every point. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  const opc_inner_runs *runs = data;
  const opc_watch *watch = &runs->outer->listener.watch;
  if (!runs->verbose) return;
  g_autofree char *whole =
      g_strdup_printf("%s.%s", runs->in->binding->path, path);
  watch->log(watch->data, whole, level, message);
}

/* Report the progress: the finished points, and the fraction `part` of the
   points that the current run counts as. */
static void runs_progress(const opc_inner_runs *runs, double part) {
  const opc_host *host = runs->in->binding->host;
  const opc_progress progress = {
      .done = (double)runs->done + floor(part * (double)runs->share),
      .total = (double)runs->in->sweep->points,
      .worst = NAN};
  host->progress(host, &progress);
}

static void take_progress(void *data, const char *path,
                          const opc_progress *at) {
  const opc_inner_runs *runs = data;
  (void)path;
  gboolean known = at->total > 0 && at->done >= 0 && at->done < at->total;
  if (runs->share) runs_progress(runs, known ? at->done / at->total : 0);
}

static int is_cancelled(void *data) {
  const opc_inner_runs *runs = data;
  return opc_cancelled(runs->in->binding->host->context);
}

/* ---- running: levels ---- */

static gboolean *find_needed(const void *in, const opc_flow *flow) {
  return opc_inner_needed(in, flow);
}

/* Remove the folders of the levels, which only the inner flow uses. */
static void end_runs(opc_inner_runs *runs) {
  for (unsigned level = 0; level < runs->levels.depth; level++) {
    g_autofree char *folder = opc_levels_folder(&runs->levels, level);
    opc_remove_tree(folder);
  }
}

static void free_runs(opc_inner_runs *runs) {
  g_autofree char *folder = opc_levels_folder(&runs->levels, 0);
  opc_levels_clear(&runs->levels);
  opc_run_free(runs->trunk);
  opc_remove_tree(folder);
  g_free(runs->folder);
  g_free(runs->metrics);
  g_free(runs);
}

/* Start the inner runs and run the trunk. The trunk and each level (levels.h)
   have a folder each, whose files are copied to each run that is kept. */
static int inner_runs_begin(const opc_host *host, opc_error *error) {
  const opc_binding *b = host->data;
  g_autofree char *name = g_build_filename(b->path, "flow.yaml", NULL);
  const char *path = host->output_path(host, name, error);
  if (!path) return error->code;
  opc_inner *in = b->inner;
  opc_inner_runs *runs = in->runs = g_new0(opc_inner_runs, 1);
  in->runs_end = end_runs;
  in->runs_free = free_runs;
  *runs = (opc_inner_runs){.in = in,
                           .outer = b->run,
                           .watch = {.data = runs,
                                     .log = take_log,
                                     .progress = take_progress,
                                     .cancelled = is_cancelled},
                           .folder = g_path_get_dirname(path),
                           .verbose = TRUE};
  runs->levels = (opc_levels){.recipe = in->recipe,
                              .choice = in->choice,
                              .registry = in->registry,
                              .watch = &runs->watch,
                              .outer = runs->outer,
                              .needed = find_needed,
                              .data = in,
                              .one_folder = TRUE,
                              .folder = runs->folder};
  opc_run *trunk = runs->trunk =
      opc_run_new(in->flow, in->registry, runs->outer->options, &runs->watch,
                  &runs->outer->like);
  opc_levels_begin(&runs->levels, trunk);
  put_given(in, trunk);
  g_autofree char *folder = opc_levels_folder(&runs->levels, 0);
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_steps_run_in(trunk, runs->outer, folder, problems);
  runs_progress(runs, 0);
  return opc_problems_error(problems, error);
}

/* ---- running: a point ---- */

static int copy_file(void *data, const char *path, const char *name,
                     const struct stat *about, opc_error *error) {
  g_autofree char *target = g_build_filename(data, name, NULL);
  g_autofree char *folder = g_path_get_dirname(target);
  g_autoptr(GFile) from = g_file_new_for_path(path);
  g_autoptr(GFile) to = g_file_new_for_path(target);
  g_autoptr(GError) why = NULL;
  if (S_ISDIR(about->st_mode)) return OPC_OK;
  if (g_mkdir_with_parents(folder, 0777))
    return opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  if (g_file_copy(from, to, G_FILE_COPY_NONE, NULL, NULL, NULL, &why))
    return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "%s", why->message);
}

/* Compare metrics by the order of their steps. */
static gint compare_metrics(gconstpointer a, gconstpointer b, gpointer data) {
  const opc_run *run = data;
  const opc_inner_metric *one = a, *other = b;
  guint at[2] = {0, 0};
  g_ptr_array_find(run->flow->order, opc_flow_find(run->flow, one->path),
                   &at[0]);
  g_ptr_array_find(run->flow->order, opc_flow_find(run->flow, other->path),
                   &at[1]);
  return at[0] < at[1] ? -1 : at[0] > at[1];
}

/* Add to a run the metrics, findings, histories, times and files of the steps
   that the run shares with lower levels. */
static void take_shared(const opc_levels *levels, opc_run *run,
                        opc_problems *problems) {
  opc_error error;
  g_autoptr(GArray) own = run->out.metrics;
  run->out.metrics = g_array_new(FALSE, TRUE, sizeof(opc_inner_metric));
  for (unsigned level = 0; level < levels->depth; level++) {
    const opc_run *from = levels->runs[level];
    if (!from) continue;
    g_array_append_vals(run->out.metrics, from->out.metrics->data,
                        from->out.metrics->len);
    opc_listen_take(run, from);
    opc_histories_take(&run->out.histories, &from->out.histories);
    for (guint i = 0; i < from->flow->steps->len; i++) {
      const opc_flow_step *step = from->flow->steps->pdata[i];
      const opc_flow_step *its = opc_flow_find(run->flow, step->name);
      if (!its || from->left_out[i]) continue;
      run->out.seconds[its->number] = from->out.seconds[i];
      run->out.processor[its->number] = from->out.processor[i];
    }
    if (opc_traverse(from->written.work, copy_file, run->written.work, &error))
      opc_problem_add(problems, error.code, NULL, "%s", error.message);
  }
  g_array_append_vals(run->out.metrics, own->data, own->len);
  g_array_sort_with_data(run->out.metrics, compare_metrics, run);
  run->out.total = 0;
  for (guint i = 0; i < run->flow->steps->len; i++)
    if (!isnan(run->out.seconds[i])) run->out.total += run->out.seconds[i];
}

/* Complete a run, judge the requirements and write the reports. Requirements
   apply only to runs that are kept. */
static void keep_run(opc_inner_runs *runs, const char *prefix,
                     opc_problems *problems) {
  opc_run *run = runs->levels.last;
  take_shared(&runs->levels, run, problems);
  opc_inputs_take(run, runs->outer, problems);
  opc_verdicts_judge(run->out.verdicts, run->flow, run->out.metrics, NULL);
  opc_verdicts_take(runs->outer->out.verdicts, run->out.verdicts, 0, prefix);
  opc_reports_write(run, TRUE, problems);
}

/* Count the points of a run as finished and return the code of the problems. */
static int end_point(opc_inner_runs *runs, size_t share, opc_problems *problems,
                     opc_error *error) {
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) {
    opc_levels_forget_stopped(&runs->levels);
    return opc_fail(error, code, NULL, "stopped");
  }
  runs->done += share;
  runs->share = 0;
  if (share) runs_progress(runs, 0);
  g_autofree char *text = opc_problems_text(problems);
  return code ? opc_fail(error, code, NULL, "%s", text) : OPC_OK;
}

static int run_point(const opc_host *host, size_t point, int keep, size_t share,
                     opc_error *error) {
  opc_inner_runs *runs = runs_of(host);
  runs->share = share;
  runs->verbose = keep;
  g_autofree char *name = g_strdup_printf("%04zu", ++runs->count);
  g_autofree char *folder = keep ? g_strdup(runs->folder)
                                 : g_build_filename(runs->folder, name, NULL);
  g_autofree char *prefix = g_strconcat(runs->in->binding->path, ".", NULL);
  g_autoptr(opc_problems) problems = opc_problems_new();
  opc_levels_run(&runs->levels, point, folder, problems);
  const opc_run *run = runs->levels.last;
  if (run && keep && !problems->list->len)
    keep_run(runs, prefix, problems);
  else if (run)
    opc_levels_close(run, run->options->keep, problems);
  return end_point(runs, share, problems, error);
}

static int run_whole(const opc_host *host, size_t point, const char *name,
                     size_t share, const opc_inner_run **out,
                     opc_error *error) {
  opc_inner_runs *runs = runs_of(host);
  runs->share = share;
  runs->verbose = FALSE;
  g_autofree char *folder = g_build_filename(runs->folder, name, NULL);
  g_autofree char *prefix =
      g_strdup_printf("%s/%s: ", runs->in->binding->path, name);
  g_autoptr(opc_problems) problems = opc_problems_new();
  *out = NULL;
  opc_levels_run(&runs->levels, point, folder, problems);
  if (!problems->list->len) keep_run(runs, prefix, problems);
  const opc_run *run = runs->levels.last;
  if (problems->list->len) {
    if (run && run->written.work) opc_remove_tree(folder);
  } else {
    runs->whole = (opc_inner_run){
        .folder = run->written.work,
        .seconds = run->out.total,
        .findings = run->out.findings.list->len + run->out.findings.more};
    *out = &runs->whole;
    opc_verdicts_add_broken(run->out.verdicts, problems);
  }
  int code = end_point(runs, share, problems, error);
  if (code && code != OPC_CANCELLED)
    opc_outcome_fail_point(&runs->outer->out, code);
  return code;
}

/* ---- results ---- */

static const opc_inner_metric *const *get_metrics(const opc_host *host,
                                                  int shared, size_t *count) {
  opc_inner_runs *runs = runs_of(host);
  const opc_run *run = !runs ? NULL : shared ? runs->trunk : runs->levels.last;
  *count = run ? run->out.metrics->len : 0;
  if (!run) return NULL;
  runs->metrics = g_renew(const opc_inner_metric *, runs->metrics, *count + 1);
  for (guint i = 0; i < *count; i++)
    runs->metrics[i] = &g_array_index(run->out.metrics, opc_inner_metric, i);
  return runs->metrics;
}

static const opc_table *find_table(const opc_run *run, const char *step,
                                   const char *name, opc_error *error) {
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < run->out.tables->len; i++) {
    const opc_table *t = run->out.tables->pdata[i];
    if (strcmp(t->step, step)) continue;
    if (!strcmp(t->name, name)) return t;
    g_ptr_array_add(names, t->name);
  }
  g_autofree char *suggestion = opc_suggestion(name, names);
  opc_fail(error, OPC_INVALID, NULL, "'%s' published no table '%s'%s", step,
           name, suggestion);
  return NULL;
}

static const opc_column *get_column(const opc_host *host, const char *step,
                                    const char *table_name, const char *name,
                                    size_t *rows, opc_error *error) {
  const opc_table *table =
      find_table(runs_of(host)->levels.last, step, table_name, error);
  if (!table) return NULL;
  const opc_column *column = opc_table_column(table, name);
  *rows = table->rows;
  if (column && column->type != OPC_TEXT) return column;
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (size_t i = 0; i < table->n_columns; i++)
    g_ptr_array_add(names, (char *)table->columns[i].name);
  g_autofree char *suggestion = opc_suggestion(name, names);
  opc_fail(error, OPC_INVALID, NULL,
           "table '%s' of '%s' has no column of numbers '%s'%s", table_name,
           step, name, suggestion);
  return NULL;
}

static void *get_object(const opc_host *host, const char *name,
                        const char *kind) {
  const opc_inner_runs *runs = runs_of(host);
  opc_run *run = runs->levels.last;
  const opc_flow_step *step = opc_flow_find(run->flow, name);
  g_autoptr(opc_problems) problems = opc_problems_new();
  if (!opc_reuse_provide(run, step, runs->in->binding->path, problems))
    opc_problems_error(problems, &runs->outer->written.refusal);
  void **objects = run->objects[step->number];
  return objects ? objects[opc_inner_port(step->binding->plugin, kind)] : NULL;
}

const opc_inner_service opc_inner_functions = {
    .size = sizeof opc_inner_functions,
    .axes = opc_inner_axes,
    .axis = opc_inner_find_axis,
    .metric = opc_inner_find_metric,
    .output = opc_inner_find_output,
    .begin = inner_runs_begin,
    .run = run_point,
    .metrics = get_metrics,
    .column = get_column,
    .object = get_object,
    .run_whole = run_whole,
};
