/* SPDX-License-Identifier: BSD-3-Clause */
/* All settings of a search. Steps that none of them touches run once; those
   that are not needed for the figure or the mask do not run at all. */
#include <errno.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>

#include "core/flow/files.h"
#include "core/plugin/declaration.h"
#include "core/plugin/suggest.h"
#include "core/search/search.h"

/* ---- who looks on ---- */

/* Each run has the same to say: the last one says it. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  const opc_search *s = data;
  const opc_watch *watch = s->outer->watch;
  if (!watch->log || (!s->telling && level >= OPC_LOG_INFO)) return;
  g_autofree char *whole = g_strdup_printf("%s.%s", s->binding->path, path);
  watch->log(watch->data, whole, level, message);
}

/* Settings that are done, with the part that is of those of this run. */
static void tell_progress(const opc_search *s, double part) {
  const opc_progress progress = {
      .size = sizeof progress,
      .done = (double)s->done + floor(part * (double)s->plan.count),
      .total = (double)s->count,
      .worst = NAN};
  s->host->progress(s->host, &progress);
}

static void take_progress(void *data, const char *path,
                          const opc_progress *at) {
  const opc_search *s = data;
  (void)path;
  gboolean known = at->total > 0 && at->done >= 0 && at->done < at->total;
  if (s->done < s->count) tell_progress(s, known ? at->done / at->total : 0);
}

static int is_cancelled(void *data) {
  const opc_search *s = data;
  return s->host->cancelled(s->host);
}

/* ---- one run ---- */

/* Leave out what neither figure nor mask needs. */
static void prune(const opc_search *s, opc_run *run) {
  g_autofree gboolean *needed = g_new0(gboolean, run->flow->steps->len);
  needed[s->plan.figure_step] = needed[s->plan.mask_step] = TRUE;
  opc_flow_find_needed(run->flow, needed);
  for (guint i = 0; i < run->flow->steps->len; i++)
    run->left_out[i] |= !needed[i];
}

/* Files are called as in a run of the whole flow. */
static void copy_claim(gpointer name, gpointer owner, gpointer claims) {
  g_hash_table_insert(claims, g_strdup(name), g_strdup(owner));
}

static gboolean open_folder(opc_run *run, const char *path,
                            opc_problems *problems) {
  run->work = g_strdup(path);
  opc_run_reserve(run);
  if (!g_mkdir_with_parents(path, 0777)) return TRUE;
  opc_problem_add(problems, OPC_IO, NULL, "'%s': %s", path, g_strerror(errno));
  return FALSE;
}

/* The run at a setting, in the folder `path`; its flow is *flow. NULL and a
   problem; a run that failed is there with its problem. */
static opc_run *run_at(const opc_search *s, size_t setting, const char *path,
                       opc_flow **flow, opc_problems *problems) {
  opc_choice choice = s->inner->choice;
  choice.point = setting;
  *flow =
      opc_flow_make(s->inner->recipe, &choice, s->inner->registry, problems);
  if (problems->list->len) return NULL;
  opc_run *run = opc_run_branch(s->trunk, *flow);
  g_hash_table_foreach(s->trunk->claims, copy_claim, run->claims);
  prune(s, run);
  if (opc_run_create(run, problems) && opc_run_sum(s->outer, *flow, problems) &&
      open_folder(run, path, problems))
    opc_run_steps(run, problems);
  return run;
}

static void end_run(opc_run *run, opc_flow *flow) {
  if (run) opc_run_release(run);
  opc_run_free(run);
  opc_flow_free(flow);
}

/* ---- its figures ---- */

static double find_metric(const opc_search *s, const opc_run *run) {
  for (guint i = 0; i < run->metrics->len; i++) {
    const opc_run_metric *m = &g_array_index(run->metrics, opc_run_metric, i);
    if (!strcmp(m->binding->path, s->plan.of->path) &&
        !strcmp(m->metric->name, s->plan.metric->name))
      return m->value;
  }
  return NAN;
}

/* The litho simulations of a run, as its steps count them. */
static double count_simulations(const opc_run *run) {
  double sum = 0;
  for (guint i = 0; i < run->metrics->len; i++) {
    const opc_run_metric *m = &g_array_index(run->metrics, opc_run_metric, i);
    if (!strcmp(m->metric->name, "simulations")) sum += m->value;
  }
  return sum;
}

static double real_at(const opc_column *c, size_t row) {
  return c->type == OPC_REAL ? ((const double *)c->data)[row]
                             : (double)((const int64_t *)c->data)[row];
}

static const opc_column *find_column(const opc_search *s,
                                     const opc_table *table, const char *name,
                                     opc_error *error) {
  const opc_column *column = opc_table_column(table, name);
  if (column && column->type != OPC_TEXT) return column;
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (size_t i = 0; i < table->n_columns; i++)
    g_ptr_array_add(names, (char *)table->columns[i].name);
  g_autofree char *suggestion = opc_suggestion(name, names);
  opc_fail(error, OPC_INVALID, "along",
           "the table '%s' of '%s' has no numbers '%s'%s", table->name,
           s->plan.of->path, name, suggestion);
  return NULL;
}

static const opc_table *find_table(const opc_search *s, const opc_run *run,
                                   opc_error *error) {
  const opc_search_plan *plan = &s->plan;
  g_autoptr(GPtrArray) names = g_ptr_array_new();
  for (guint i = 0; i < run->tables->len; i++) {
    const opc_run_table *t = run->tables->pdata[i];
    if (strcmp(t->step, plan->of->path)) continue;
    if (!strcmp(t->table->name, plan->table)) return t->table;
    g_ptr_array_add(names, t->table->name);
  }
  g_autofree char *suggestion = opc_suggestion(plan->table, names);
  opc_fail(error, OPC_INVALID, "along", "'%s' published no table '%s'%s",
           plan->of->path, plan->table, suggestion);
  return NULL;
}

/* The figure at each value is in the last row that does not go beyond it: a run
   that ends early is at rest. */
static int take_column(opc_search *s, const opc_run *run, size_t setting,
                       opc_error *error) {
  const opc_table *table = find_table(s, run, error);
  if (!table) return error->code;
  const opc_column *value = find_column(s, table, s->plan.column, error);
  const opc_column *figure =
      value ? find_column(s, table, s->plan.metric->name, error) : NULL;
  if (!figure) return error->code;
  for (size_t k = 0, row = 0; k < s->plan.count; k++) {
    while (row < table->rows && real_at(value, row) <= s->plan.values[k]) row++;
    if (row) s->figure[setting + k * s->plan.stride] = real_at(figure, row - 1);
  }
  return OPC_OK;
}

static void take_metric(opc_search *s, const opc_run *run, size_t setting,
                        opc_problems *problems) {
  double figure = find_metric(s, run);
  s->figure[setting] = isnan(figure) ? find_metric(s, s->trunk) : figure;
  if (isnan(s->figure[setting]))
    opc_problem_add(problems, OPC_FAILED, &s->plan.of->at,
                    "step '%s' published no metric '%s'", s->plan.of->path,
                    s->plan.metric->name);
}

/* ---- all runs ---- */

/* The first one of equals. */
static void compare(opc_search *s, size_t setting) {
  double figure = s->figure[setting];
  if (isnan(figure)) return;
  double best = s->best < s->count ? s->figure[s->best] : NAN;
  gboolean better = s->plan.greatest ? figure > best : figure < best;
  if (isnan(best) || better || (figure == best && setting < s->best))
    s->best = setting;
}

/* Run the settings that share the run of `first`, which has the first value of
   the shared axis. */
static int run_settings(opc_search *s, size_t first, const char *folder,
                        opc_error *error) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autofree char *name = g_strdup_printf("%04zu", s->runs + 1);
  g_autofree char *path = g_build_filename(folder, name, NULL);
  size_t last = first + (s->plan.count - 1) * s->plan.stride;
  opc_flow *flow = NULL;
  opc_run *run = run_at(s, last, path, &flow, problems);
  int wrong = OPC_OK; /* for all runs */
  if (run) s->simulations += count_simulations(run);
  if (!problems->list->len && s->plan.along >= 0)
    wrong = take_column(s, run, first, error);
  else if (!problems->list->len)
    take_metric(s, run, first, problems);
  if (run && run->work && s->trunk->options->keep)
    opc_run_write_point(run, problems);
  else if (run && run->work)
    opc_remove_tree(run->work);
  end_run(run, flow);
  if (wrong) return wrong;
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) return opc_fail(error, code, NULL, "stopped");
  s->runs++;
  if (code) s->failed += s->plan.count;
  g_ptr_array_add(s->results,
                  code ? opc_problems_text(problems) : g_strdup("good"));
  for (size_t k = 0; k < s->plan.count; k++) {
    size_t setting = first + k * s->plan.stride;
    s->run[setting] = (int64_t)s->runs;
    if (!code) compare(s, setting);
  }
  s->done += s->plan.count;
  tell_progress(s, 0);
  return OPC_OK;
}

static int run_all(opc_search *s, const char *folder, opc_error *error) {
  int code = OPC_OK;
  const size_t block = s->plan.count * s->plan.stride;
  tell_progress(s, 0);
  for (size_t i = 0; i < s->count && !code; i++)
    if (i % block < s->plan.stride) code = run_settings(s, i, folder, error);
  if (code || s->best < s->count) return code;
  return opc_fail(error, OPC_FAILED, NULL, "no setting has a figure: %s",
                  (const char *)s->results->pdata[0]);
}

/* ---- the best one ---- */

/* The run of the best setting, for its objects and for what it writes. */
static int run_best(opc_search *s, const char *folder, opc_error *error) {
  g_autoptr(opc_problems) problems = opc_problems_new();
  s->telling = TRUE;
  s->best_run = run_at(s, s->best, folder, &s->best_flow, problems);
  s->telling = FALSE;
  if (problems->list->len) return opc_problems_error(problems, error);
  s->simulations += count_simulations(s->best_run);
  double figure = find_metric(s, s->best_run);
  if (isnan(figure)) figure = find_metric(s, s->trunk);
  if (figure != s->figure[s->best])
    s->host->log(s->host, OPC_LOG_WARNING,
                 "the best setting run alone has %.9g, not %.9g: its run does "
                 "not begin as the shared one does",
                 figure, s->figure[s->best]);
  opc_run_write_point(s->best_run, problems);
  return opc_problems_error(problems, error);
}

/* ---- the whole ---- */

/* Steps that settings do not touch. Those without an output are needed for
   nothing; which of the others a setting needs may depend on it. */
static int run_trunk(opc_search *s, const char *folder, opc_error *error) {
  const opc_flow *flow = s->inner->flow;
  g_autoptr(opc_problems) problems = opc_problems_new();
  s->trunk = opc_run_new(s->inner->flow, s->inner->registry, s->outer->options,
                         &s->watch);
  opc_run_find_swept(flow, s->inner->sweep, s->trunk->left_out);
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    s->trunk->left_out[i] |=
        !opc_port_count(step->binding->plugin) && i != s->plan.figure_step;
  }
  s->telling = TRUE;
  if (opc_run_create(s->trunk, problems) &&
      open_folder(s->trunk, folder, problems))
    opc_run_steps(s->trunk, problems);
  s->telling = FALSE;
  s->simulations += count_simulations(s->trunk);
  return opc_problems_error(problems, error);
}

/* What the trunk and the best run write lies in a folder of the step's name. */
int opc_search_scan(opc_search *s, opc_error *error) {
  s->watch = (opc_watch){.data = s,
                         .log = take_log,
                         .progress = take_progress,
                         .cancelled = is_cancelled};
  s->count = s->best = s->inner->sweep->points;
  s->figure = g_new(double, s->count);
  for (size_t i = 0; i < s->count; i++) s->figure[i] = NAN;
  s->run = g_new0(int64_t, s->count);
  s->results = g_ptr_array_new_with_free_func(g_free);
  g_autofree char *name = g_build_filename(s->binding->path, "flow.yaml", NULL);
  const char *path = s->host->output_path(s->host, name, error);
  if (!path) return error->code;
  g_autofree char *folder = g_path_get_dirname(path);
  int code = run_trunk(s, folder, error);
  if (!code) code = run_all(s, folder, error);
  if (!code) code = run_best(s, folder, error);
  return code;
}

void opc_search_clear(opc_search *s) {
  end_run(s->best_run, s->best_flow);
  end_run(s->trunk, NULL);
  g_free(s->figure);
  g_free(s->run);
  if (s->results) g_ptr_array_free(s->results, TRUE);
  opc_search_plan_clear(&s->plan);
}
