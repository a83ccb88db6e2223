/* SPDX-License-Identifier: BSD-3-Clause */
/* Running a flow at each point of a sweep. */
#include <errno.h>
#include <glib/gstdio.h>
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
  opc_registry *registry;
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

static metric_column *column_of(sweeper *s, const opc_run_metric *m) {
  const char *unit = m->metric->unit;
  g_autofree char *name =
      g_strdup_printf("%s.%s", m->binding->path, m->metric->name);
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
    const opc_run_metric *m = &g_array_index(run->metrics, opc_run_metric, i);
    column_of(s, m)->values[point] = m->value;
  }
}

/* ---- one point ---- */

void opc_run_write_point(const opc_run *run, opc_problems *problems) {
  opc_run_write(run, "flow.yaml", opc_flow_resolved(run->flow), problems);
  opc_run_write(run, "metrics.json", opc_json_text(opc_run_metrics_json(run)),
                problems);
}

/* A folder of its own within that of the sweep. */
static gboolean open_point(const sweeper *s, opc_run *run, size_t point,
                           opc_problems *problems) {
  g_autofree char *name = g_strdup_printf("%04zu", point + 1);
  run->work = g_build_filename(s->trunk->work, name, NULL);
  opc_run_reserve(run);
  if (!g_mkdir(run->work, 0777)) return TRUE;
  opc_problem_add(problems, OPC_IO, NULL, "'%s': %s", run->work,
                  g_strerror(errno));
  return FALSE;
}

opc_run *opc_run_branch(const opc_run *trunk, opc_flow *flow) {
  opc_run *run =
      opc_run_new(flow, trunk->registry, trunk->options, trunk->watch);
  for (guint i = 0; i < flow->steps->len; i++) {
    run->left_out[i] = !trunk->left_out[i];
    run->objects[i] = trunk->objects[i];
  }
  return run;
}

static void run_point(sweeper *s, opc_flow *flow, size_t point,
                      opc_problems *problems) {
  const opc_run *trunk = s->trunk;
  g_autoptr(opc_run) run = opc_run_branch(trunk, flow);
  if (opc_run_create(run, problems) && opc_run_sum(s->trunk, flow, problems) &&
      open_point(s, run, point, problems)) {
    opc_run_steps(run, problems);
    opc_run_release(run);
    take_metrics(s, trunk, point);
    take_metrics(s, run, point);
    if (trunk->options->keep)
      opc_run_write_point(run, problems);
    else
      opc_remove_tree(run->work);
  }
}

/* FALSE if the user wants to stop. */
static gboolean do_point(sweeper *s, size_t point) {
  const opc_watch *watch = s->trunk->watch;
  if (watch->point) watch->point(watch->data, point + 1, s->sweep->points);
  g_autoptr(opc_problems) problems = opc_problems_new();
  gint64 start = g_get_monotonic_time();
  opc_choice choice = *s->choice;
  choice.point = point;
  g_autoptr(opc_flow) flow =
      opc_flow_make(s->trunk->flow->recipe, &choice, s->registry, problems);
  if (!problems->list->len) run_point(s, flow, point, problems);
  s->seconds[point] = (double)(g_get_monotonic_time() - start) * 1e-6;
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) return FALSE;
  char *result = code ? opc_problems_text(problems) : g_strdup("good");
  g_ptr_array_add(s->results, result);
  s->done++;
  if (!code) return TRUE;
  opc_run *trunk = s->trunk;
  gboolean differs = trunk->failed_points && trunk->points_code != code;
  trunk->points_code = differs || code != OPC_LIMIT ? OPC_FAILED : code;
  trunk->failed_points++;
  return TRUE;
}

/* ---- the table ---- */

/* The values of an axis at all points: numbers with one unit, or texts. */
typedef struct axis_column {
  const char *unit;
  double *reals; /* NULL: texts */
  char **texts;
} axis_column;

static void fill_axis(const sweeper *s, guint a, axis_column *column) {
  const opc_axis *axis = s->sweep->axes->pdata[a];
  gboolean numeric = opc_axis_is_numeric(axis, &column->unit);
  if (!numeric || !*column->unit) column->unit = NULL;
  column->texts = g_new0(char *, s->done + 1);
  if (numeric) column->reals = g_new(double, MAX(s->done, 1));
  for (size_t i = 0; i < s->done; i++) {
    const opc_node *node = opc_sweep_value(s->sweep, a, i);
    if (numeric)
      column->reals[i] = g_ascii_strtod(node->text, NULL);
    else
      column->texts[i] = opc_node_line(node);
  }
}

/* point, the parameters, the metrics, seconds, result */
static opc_table *make_table(const sweeper *s) {
  guint n_axes = s->sweep->axes->len, n_metrics = s->columns->len, n = 0;
  g_autofree opc_column *columns = g_new0(opc_column, n_axes + n_metrics + 3);
  g_autofree axis_column *axes = g_new0(axis_column, n_axes);
  g_autofree int64_t *numbers = g_new(int64_t, MAX(s->done, 1));
  for (size_t i = 0; i < s->done; i++) numbers[i] = (int64_t)i + 1;
  columns[n++] = (opc_column){"point", NULL, OPC_INT, 0, numbers};
  for (guint a = 0; a < n_axes; a++) {
    const opc_axis *axis = s->sweep->axes->pdata[a];
    fill_axis(s, a, &axes[a]);
    columns[n++] = (opc_column){
        axis->path, axes[a].unit, axes[a].reals ? OPC_REAL : OPC_TEXT, -1,
        axes[a].reals ? (const void *)axes[a].reals : axes[a].texts};
  }
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
    g_strfreev(axes[a].texts);
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
    sweeper s = {.trunk = trunk,
                 .choice = choice,
                 .sweep = choice->sweep,
                 .registry = registry};
    if (opc_run_steps(trunk, problems)) run_all(&s, problems);
    opc_run_release(trunk);
    trunk->total = (double)(g_get_monotonic_time() - start) * 1e-6;
    opc_run_close(trunk, target, problems);
  }
  return trunk;
}
