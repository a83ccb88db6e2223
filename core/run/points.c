/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs points in sequence; collects parameters and metrics in a table. */
#include "core/run/points.h"

#include <math.h>
#include <string.h>

#include "core/run/reports.h"

/* ---- the table: point, the parameters, the metrics, seconds, result ---- */

static void add_axes(const opc_points *s, opc_table *table) {
  int64_t *numbers = opc_table_add(table, "point", NULL, OPC_INT, 0);
  for (size_t i = 0; i < table->rows; i++) numbers[i] = (int64_t)i + 1;
  for (guint a = 0; a < s->trunk->out.sweep->axes->len; a++) {
    const opc_inner_axis *axis =
        &((opc_axis *)s->trunk->out.sweep->axes->pdata[a])->info;
    void *data = opc_table_add(table, axis->path, axis->unit,
                               axis->values ? OPC_REAL : OPC_TEXT, -1);
    for (size_t i = 0; i < table->rows; i++) {
      guint k = opc_sweep_index(s->trunk->out.sweep, a, i);
      if (axis->values)
        ((double *)data)[i] = axis->values[k];
      else
        ((char **)data)[i] = g_strdup(axis->texts[k]);
    }
  }
}

/* Return the column of a metric such as "first.model.terms" over all points. */
static double *metric_column(const opc_points *s, const opc_inner_metric *m) {
  opc_table *table = s->trunk->out.points;
  g_autofree char *name = g_strdup_printf("%s.%s", m->path, m->metric->name);
  for (size_t i = 1 + s->trunk->out.sweep->axes->len; i < table->n_columns; i++)
    if (!strcmp(table->columns[i].name, name) &&
        !g_strcmp0(table->columns[i].unit, m->metric->unit))
      return (double *)table->columns[i].data;
  double *values = opc_table_add(table, name, m->metric->unit, OPC_REAL, -1);
  for (size_t i = 0; i < table->rows; i++) values[i] = NAN;
  return values;
}

static void take_metrics(const opc_points *s, const opc_run *run,
                         size_t point) {
  for (guint i = 0; i < run->out.metrics->len; i++) {
    const opc_inner_metric *m =
        &g_array_index(run->out.metrics, opc_inner_metric, i);
    metric_column(s, m)[point] = m->value;
  }
}

/* Move the results of the finished points into the table. */
static void finish_table(const opc_points *s, opc_table *table) {
  double *seconds = opc_table_add(table, "seconds", NULL, OPC_REAL, 3);
  char **results = opc_table_add(table, "result", NULL, OPC_TEXT, 0);
  memcpy(seconds, s->seconds, s->done * sizeof *seconds);
  memcpy(results, s->results, s->done * sizeof *results);
  table->rows = s->done;
}

/* ---- one point ---- */

/* Run a point; returns FALSE if the user stopped the run. */
static gboolean do_point(opc_points *s, size_t point) {
  opc_run *trunk = s->trunk;
  trunk->listener.point = point + 1;
  trunk->listener.watch.point(trunk, point + 1, s->trunk->out.sweep->points);
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autoptr(opc_problems) broken = opc_problems_new();
  g_autofree char *name = g_strdup_printf("%04zu", point + 1);
  g_autofree char *folder = g_build_filename(trunk->written.work, name, NULL);
  gint64 start = g_get_monotonic_time();
  opc_levels_run(&s->levels, point, folder, problems);
  opc_run *run = s->levels.last;
  if (run) {
    take_metrics(s, trunk, point);
    take_metrics(s, run, point);
    if (!problems->list->len)
      opc_verdicts_judge(run->out.verdicts, run->flow, run->out.metrics,
                         run->left_out);
    opc_verdicts_take(trunk->out.verdicts, run->out.verdicts, point + 1, "");
    opc_verdicts_add_broken(run->out.verdicts, broken);
    opc_levels_close(run, trunk->options->keep, problems);
  }
  s->seconds[point] = (double)(g_get_monotonic_time() - start) * 1e-6;
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) return FALSE;
  opc_problems_merge(problems, broken, NULL);
  code = opc_problems_code(problems);
  s->results[s->done++] = code ? opc_problems_text(problems) : g_strdup("good");
  if (code) opc_outcome_fail_point(&trunk->out, code);
  return TRUE;
}

void opc_points_begin(opc_points *s, opc_run *trunk, const opc_choice *choice) {
  *s = (opc_points){.trunk = trunk,
                    .levels = {.recipe = trunk->flow->recipe,
                               .choice = *choice,
                               .registry = trunk->registry,
                               .watch = &trunk->listener.watch,
                               .outer = trunk}};
  opc_levels_begin(&s->levels, trunk);
}

void opc_points_run(opc_points *s, opc_problems *problems) {
  opc_run *trunk = s->trunk;
  size_t n = trunk->out.sweep->points;
  g_autofree double *seconds = g_new0(double, n);
  g_autofree char **results = g_new0(char *, n);
  opc_error error;
  gboolean going = TRUE;
  s->seconds = seconds;
  s->results = results;
  trunk->out.points =
      opc_table_new("sweep", OPC_TABLE_PRINT, n, NULL, 0, 0, &error);
  add_axes(s, trunk->out.points);
  while (going && s->done < n) going = do_point(s, s->done);
  finish_table(s, trunk->out.points);
  if (going)
    opc_reports_write_file(trunk, "sweep.csv", opc_table_csv(trunk->out.points),
                           problems);
  else
    opc_problem_add(problems, OPC_CANCELLED, NULL,
                    "stopped after %zu of %zu points", s->done, n);
}

void opc_points_clear(opc_points *s) { opc_levels_clear(&s->levels); }
