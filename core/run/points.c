/* SPDX-License-Identifier: BSD-3-Clause */
/* Running a flow at the points of a sweep: steps that it does not touch run
   once, in the trunk; the others in a branch for each point. */
#include <math.h>
#include <string.h>

#include <store/files.h>
#include "core/run/run.h"

/* ---- state ---- */

typedef struct sweeper {
  opc_run *trunk; /* the steps that run once; the folder, the table */
  const opc_choice *choice;
  const opc_sweep *sweep;
  size_t done;
  double *seconds; /* of each point */
  char **results;  /* of each: "good", or what went wrong */
} sweeper;

/* ---- what depends on the sweep ---- */

void opc_run_find_swept(const opc_flow *flow, const opc_sweep *sweep,
                        gboolean *swept) {
  g_autofree unsigned *levels = opc_sweep_levels(sweep, flow);
  for (guint i = 0; i < flow->steps->len; i++) swept[i] = levels[i] > 0;
}

/* ---- the table: point, the parameters, the metrics, seconds, result ---- */

static void add_axes(const sweeper *s, opc_table *table) {
  int64_t *numbers = opc_table_add(table, "point", NULL, OPC_INT, 0);
  for (size_t i = 0; i < table->rows; i++) numbers[i] = (int64_t)i + 1;
  for (guint a = 0; a < s->sweep->axes->len; a++) {
    const opc_inner_axis *axis = &((opc_axis *)s->sweep->axes->pdata[a])->told;
    void *data = opc_table_add(table, axis->path, axis->unit,
                               axis->values ? OPC_REAL : OPC_TEXT, -1);
    for (size_t i = 0; i < table->rows; i++) {
      guint k = opc_sweep_index(s->sweep, a, i);
      if (axis->values)
        ((double *)data)[i] = axis->values[k];
      else
        ((char **)data)[i] = g_strdup(axis->texts[k]);
    }
  }
}

/* The values of "first.model.terms" at all points. */
static double *metric_column(const sweeper *s, const opc_inner_metric *m) {
  opc_table *table = s->trunk->points;
  g_autofree char *name = g_strdup_printf("%s.%s", m->path, m->metric->name);
  for (size_t i = 1 + s->sweep->axes->len; i < table->n_columns; i++)
    if (!strcmp(table->columns[i].name, name) &&
        !g_strcmp0(table->columns[i].unit, m->metric->unit))
      return (double *)table->columns[i].data;
  double *values = opc_table_add(table, name, m->metric->unit, OPC_REAL, -1);
  for (size_t i = 0; i < table->rows; i++) values[i] = NAN;
  return values;
}

static void take_metrics(const sweeper *s, const opc_run *run, size_t point) {
  for (guint i = 0; i < run->metrics->len; i++) {
    const opc_inner_metric *m =
        &g_array_index(run->metrics, opc_inner_metric, i);
    metric_column(s, m)[point] = m->value;
  }
}

/* Of the points that are done; takes the results. */
static void finish_table(const sweeper *s, opc_table *table) {
  double *seconds = opc_table_add(table, "seconds", NULL, OPC_REAL, 3);
  char **results = opc_table_add(table, "result", NULL, OPC_TEXT, 0);
  memcpy(seconds, s->seconds, s->done * sizeof *seconds);
  memcpy(results, s->results, s->done * sizeof *results);
  table->rows = s->done;
}

/* ---- one point ---- */

opc_run *opc_run_branch(opc_run *trunk, const opc_choice *choice,
                        opc_problems *problems) {
  opc_flow *flow =
      opc_flow_make(trunk->flow->recipe, choice, trunk->registry, problems);
  if (problems->list->len) {
    opc_flow_free(flow);
    return NULL;
  }
  opc_run *run =
      opc_run_new(flow, trunk->registry, trunk->options, &trunk->watch);
  run->own = flow;
  opc_run_borrow(run, trunk);
  return run;
}

void opc_run_borrow(opc_run *run, opc_run *from) {
  run->base = from;
  for (guint i = 0; i < run->flow->steps->len; i++) {
    opc_flow_step *step = run->flow->steps->pdata[i];
    const opc_flow_step *its = opc_flow_find(from->flow, step->name);
    void **objects = its ? from->objects[its->number] : NULL;
    run->left_out[i] = its && !from->left_out[its->number];
    run->objects[i] = objects;
  }
}

void opc_run_branch_close(const opc_run *run, gboolean keep,
                          opc_problems *problems) {
  if (!run->work) return;
  if (!keep) {
    opc_remove_tree(run->work);
    return;
  }
  opc_run_write(run, "flow.yaml", opc_flow_resolved(run->flow, NULL), problems);
  opc_run_write(run, "metrics.json", opc_run_metrics_text(run), problems);
}

/* FALSE if the user wants to stop. */
static gboolean do_point(sweeper *s, size_t point) {
  opc_run *trunk = s->trunk;
  trunk->point = point + 1;
  trunk->watch.point(trunk, point + 1, s->sweep->points);
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_problems) broken = opc_problems_new();
  g_autofree char *name = g_strdup_printf("%04zu", point + 1);
  g_autofree char *folder = g_build_filename(trunk->work, name, NULL);
  gint64 start = g_get_monotonic_time();
  opc_choice choice = *s->choice;
  choice.point = point;
  g_autoptr(opc_run) run = opc_run_branch(trunk, &choice, problems);
  if (run) {
    opc_run_in(run, trunk, folder, problems);
    take_metrics(s, trunk, point);
    take_metrics(s, run, point);
    if (!problems->list->len) opc_run_judge(run);
    opc_run_take_verdicts(trunk, run, point + 1, "");
    opc_run_add_broken(run, broken);
    opc_run_branch_close(run, trunk->options->keep, problems);
  }
  s->seconds[point] = (double)(g_get_monotonic_time() - start) * 1e-6;
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) return FALSE;
  opc_problems_merge(problems, broken, NULL);
  code = opc_problems_code(problems);
  s->results[s->done++] = code ? opc_problems_text(problems) : g_strdup("good");
  if (!code) return TRUE;
  gboolean differs = trunk->failed_points && trunk->points_code != code;
  trunk->points_code = differs || code != OPC_LIMIT ? OPC_FAILED : code;
  trunk->failed_points++;
  return TRUE;
}

void opc_run_points(opc_run *trunk, const opc_choice *choice,
                    opc_problems *problems) {
  size_t n = trunk->sweep->points;
  g_autofree double *seconds = g_new0(double, n);
  g_autofree char **results = g_new0(char *, n);
  sweeper s = {trunk, choice, trunk->sweep, 0, seconds, results};
  opc_error error;
  gboolean going = TRUE;
  trunk->points =
      opc_table_new("sweep", OPC_TABLE_PRINT, n, NULL, 0, 0, &error);
  add_axes(&s, trunk->points);
  while (going && s.done < n) going = do_point(&s, s.done);
  finish_table(&s, trunk->points);
  if (going)
    opc_run_write(trunk, "sweep.csv", opc_table_csv(trunk->points), problems);
  else
    opc_problem_add(problems, OPC_CANCELLED, NULL,
                    "stopped after %zu of %zu points", s.done, n);
}
