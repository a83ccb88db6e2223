/* SPDX-License-Identifier: BSD-3-Clause */
/* Running a flow at the points of a sweep: steps that it does not touch run
   once, in the trunk; the others in a branch for each point. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "core/flow/files.h"
#include "core/flow/run.h"

/* ---- state ---- */

/* A metric that some point has, and its values at all of them. */
typedef struct metric_column {
  char *name;       /* "mask.litho.kernels" */
  const char *unit; /* of the plugin, which stays loaded */
  double *values;
} metric_column;

typedef struct sweeper {
  opc_run *trunk; /* the steps that run once; the folder */
  const opc_choice *choice;
  const opc_sweep *sweep;
  size_t done;
  GPtrArray *columns;  /* metric_column * */
  GHashTable *by_name; /* name and unit -> metric_column */
  GPtrArray *results;  /* of each point: "good", or what went wrong */
  double *seconds;     /* of each */
} sweeper;

static void column_free(gpointer item) {
  metric_column *column = item;
  g_free(column->name);
  g_free(column->values);
  g_free(column);
}

/* ---- what depends on the sweep ---- */

static gboolean is_swept(const opc_sweep *sweep, const opc_flow_step *step) {
  size_t n = strlen(step->name);
  for (guint i = 0; i < sweep->axes->len; i++) {
    const char *path = ((const opc_axis *)sweep->axes->pdata[i])->path;
    if (!strncmp(path, step->name, n) && path[n] == '.') return TRUE;
  }
  return FALSE;
}

void opc_run_find_swept(const opc_flow *flow, const opc_sweep *sweep,
                        gboolean *swept) {
  for (guint i = 0; i < flow->order->len; i++) {
    const opc_flow_step *step = flow->order->pdata[i];
    gboolean is = is_swept(sweep, step);
    for (guint k = 0; k < step->inputs->len; k++)
      is |= swept[g_array_index(step->inputs, opc_flow_input, k).from->number];
    swept[step->number] = is;
  }
}

/* ---- metrics ---- */

static metric_column *column_of(sweeper *s, const opc_inner_metric *m) {
  const char *unit = m->metric->unit;
  g_autofree char *name = g_strdup_printf("%s.%s", m->path, m->metric->name);
  g_autofree char *key = g_strdup_printf("%s (%s)", name, unit ? unit : "");
  metric_column *column = g_hash_table_lookup(s->by_name, key);
  if (column) return column;
  column = g_new0(metric_column, 1);
  column->name = g_steal_pointer(&name);
  column->unit = unit;
  column->values = g_new(double, s->sweep->points);
  for (size_t i = 0; i < s->sweep->points; i++) column->values[i] = NAN;
  g_ptr_array_add(s->columns, column);
  g_hash_table_insert(s->by_name, g_steal_pointer(&key), column);
  return column;
}

static void take_metrics(sweeper *s, const opc_run *run, size_t point) {
  for (guint i = 0; i < run->metrics->len; i++) {
    const opc_inner_metric *m =
        &g_array_index(run->metrics, opc_inner_metric, i);
    column_of(s, m)->values[point] = m->value;
  }
}

/* ---- one point ---- */

gboolean opc_run_open_at(opc_run *run, const char *path,
                         opc_problems *problems) {
  opc_run_reserve(run);
  if (!g_mkdir_with_parents(path, 0777)) {
    run->work = g_strdup(path);
    return TRUE;
  }
  opc_problem_add(problems, OPC_IO, NULL, "'%s': %s", path, g_strerror(errno));
  return FALSE;
}

opc_run *opc_run_branch(const opc_run *trunk, const opc_choice *choice,
                        opc_problems *problems) {
  opc_flow *flow =
      opc_flow_make(trunk->flow->recipe, choice, trunk->registry, problems);
  if (problems->list->len) {
    opc_flow_free(flow);
    return NULL;
  }
  opc_run *run =
      opc_run_new(flow, trunk->registry, trunk->options, trunk->watch);
  for (guint i = 0; i < flow->steps->len; i++) {
    run->left_out[i] = !trunk->left_out[i];
    run->objects[i] = trunk->objects[i];
  }
  return run;
}

void opc_run_branch_steps(opc_run *run, opc_run *main_run, const char *path,
                          opc_problems *problems) {
  if (opc_run_create(run, problems) &&
      opc_run_sum(main_run, run->flow, problems) &&
      opc_run_open_at(run, path, problems))
    opc_run_steps(run, problems);
}

void opc_run_branch_close(const opc_run *run, gboolean keep,
                          opc_problems *problems) {
  if (!run->work) return;
  if (!keep) {
    opc_remove_tree(run->work);
    return;
  }
  opc_run_write(run, "flow.yaml", opc_flow_resolved(run->flow), problems);
  opc_run_write(run, "metrics.json", opc_json_text(opc_run_metrics_json(run)),
                problems);
}

void opc_run_branch_free(opc_run *run) {
  if (!run) return;
  opc_flow *flow = run->flow;
  opc_run_release(run);
  opc_run_free(run);
  opc_flow_free(flow);
}

/* FALSE if the user wants to stop. */
static gboolean do_point(sweeper *s, size_t point) {
  opc_run *trunk = s->trunk;
  const opc_watch *watch = trunk->watch;
  if (watch->point) watch->point(watch->data, point + 1, s->sweep->points);
  g_autoptr(opc_problems) problems = opc_problems_new();
  g_autofree char *name = g_strdup_printf("%04zu", point + 1);
  g_autofree char *folder = g_build_filename(trunk->work, name, NULL);
  gint64 start = g_get_monotonic_time();
  opc_choice choice = *s->choice;
  choice.point = point;
  opc_run *run = opc_run_branch(trunk, &choice, problems);
  if (run) {
    opc_run_branch_steps(run, trunk, folder, problems);
    take_metrics(s, trunk, point);
    take_metrics(s, run, point);
    opc_run_branch_close(run, trunk->options->keep, problems);
    opc_run_branch_free(run);
  }
  s->seconds[point] = (double)(g_get_monotonic_time() - start) * 1e-6;
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) return FALSE;
  char *result = code ? opc_problems_text(problems) : g_strdup("good");
  g_ptr_array_add(s->results, result);
  s->done++;
  if (!code) return TRUE;
  gboolean differs = trunk->failed_points && trunk->points_code != code;
  trunk->points_code = differs || code != OPC_LIMIT ? OPC_FAILED : code;
  trunk->failed_points++;
  return TRUE;
}

/* ---- the table ---- */

/* The values of an axis at the points that are done. */
typedef struct axis_column {
  opc_inner_axis axis;
  double *reals; /* NULL: texts */
  const char **texts;
} axis_column;

static opc_column fill_axis(const sweeper *s, guint a, axis_column *c) {
  opc_axis_describe(s->sweep->axes->pdata[a], &c->axis);
  if (c->axis.values) c->reals = g_new(double, MAX(s->done, 1));
  c->texts = g_new(const char *, MAX(s->done, 1));
  for (size_t i = 0; i < s->done; i++) {
    guint k = opc_sweep_index(s->sweep, a, i);
    if (c->reals) c->reals[i] = c->axis.values[k];
    c->texts[i] = c->axis.texts[k];
  }
  return (opc_column){c->axis.path, c->axis.unit,
                      c->reals ? OPC_REAL : OPC_TEXT, -1,
                      c->reals ? (const void *)c->reals : c->texts};
}

/* point, the parameters, the metrics, seconds, result */
static opc_table *make_table(const sweeper *s) {
  guint n_axes = s->sweep->axes->len, n_metrics = s->columns->len, n = 0;
  g_autofree opc_column *columns = g_new0(opc_column, n_axes + n_metrics + 3);
  g_autofree axis_column *axes = g_new0(axis_column, n_axes);
  g_autofree int64_t *numbers = g_new(int64_t, MAX(s->done, 1));
  for (size_t i = 0; i < s->done; i++) numbers[i] = (int64_t)i + 1;
  columns[n++] = (opc_column){"point", NULL, OPC_INT, 0, numbers};
  for (guint a = 0; a < n_axes; a++) columns[n++] = fill_axis(s, a, &axes[a]);
  for (guint i = 0; i < n_metrics; i++) {
    const metric_column *m = s->columns->pdata[i];
    columns[n++] = (opc_column){m->name, m->unit, OPC_REAL, -1, m->values};
  }
  columns[n++] = (opc_column){"seconds", NULL, OPC_REAL, 3, s->seconds};
  columns[n++] = (opc_column){"result", NULL, OPC_TEXT, 0, s->results->pdata};
  opc_error error;
  opc_table *table =
      opc_table_new("sweep", OPC_TABLE_PRINT, s->done, columns, n, &error);
  for (guint a = 0; a < n_axes; a++) {
    opc_inner_axis_clear(&axes[a].axis);
    g_free(axes[a].texts);
    g_free(axes[a].reals);
  }
  return table;
}

/* ---- the sweep ---- */

static void run_points(sweeper *s, opc_problems *problems) {
  opc_run *trunk = s->trunk;
  gboolean going = TRUE;
  while (going && s->done < s->sweep->points) going = do_point(s, s->done);
  trunk->points = make_table(s);
  if (!going) {
    opc_problem_add(problems, OPC_CANCELLED, NULL,
                    "stopped after %zu of %zu points", s->done,
                    s->sweep->points);
    return;
  }
  opc_run_write(trunk, "sweep.csv", opc_table_csv(trunk->points), problems);
}

static void run_all(sweeper *s, opc_problems *problems) {
  s->columns = g_ptr_array_new_with_free_func(column_free);
  s->by_name = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  s->results = g_ptr_array_new_with_free_func(g_free);
  s->seconds = g_new0(double, s->sweep->points);
  run_points(s, problems);
  g_hash_table_destroy(s->by_name);
  g_ptr_array_free(s->columns, TRUE);
  g_ptr_array_free(s->results, TRUE);
  g_free(s->seconds);
}

opc_run *opc_run_sweep(opc_flow *flow, const opc_choice *choice,
                       opc_registry *registry, const opc_run_options *options,
                       const opc_watch *watch, opc_problems *problems) {
  opc_run *trunk = opc_run_new(flow, registry, options, watch);
  trunk->sweep = choice->sweep;
  opc_run_find_swept(flow, choice->sweep, trunk->left_out);
  gint64 start = g_get_monotonic_time();
  g_autofree char *target = opc_run_target(trunk);
  if (opc_run_create(trunk, problems) && opc_run_sum(trunk, flow, problems) &&
      opc_run_open(trunk, target, problems)) {
    sweeper s = {.trunk = trunk, .choice = choice, .sweep = choice->sweep};
    if (opc_run_steps(trunk, problems)) run_all(&s, problems);
    opc_run_release(trunk);
    trunk->total = (double)(g_get_monotonic_time() - start) * 1e-6;
    opc_run_close(trunk, target, problems);
  }
  return trunk;
}
