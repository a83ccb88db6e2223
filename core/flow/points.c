/* SPDX-License-Identifier: BSD-3-Clause */
/* Running a flow at the points of a sweep: steps that it does not touch run
   once, in the trunk; the others in a branch for each point. */
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
    const char *path = ((const opc_axis *)sweep->axes->pdata[i])->told.path;
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
  run->own = flow;
  for (guint i = 0; i < flow->steps->len; i++) {
    run->left_out[i] = !trunk->left_out[i];
    run->objects[i] = trunk->objects[i];
  }
  return run;
}

void opc_run_branch_close(const opc_run *run, gboolean keep,
                          opc_problems *problems) {
  if (!run->work) return;
  if (!keep) {
    opc_remove_tree(run->work);
    return;
  }
  opc_run_write(run, "flow.yaml", opc_flow_resolved(run->flow, NULL), problems);
  opc_run_write(run, "metrics.json", opc_json_text(opc_run_metrics_json(run)),
                problems);
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
  g_autoptr(opc_run) run = opc_run_branch(trunk, &choice, problems);
  if (run) {
    opc_run_in(run, trunk, folder, problems);
    take_metrics(s, trunk, point);
    take_metrics(s, run, point);
    opc_run_branch_close(run, trunk->options->keep, problems);
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

/* The values of an axis at the points that are done; what they lie in is put
   into `owned`. */
static opc_column axis_column(const sweeper *s, guint a, GPtrArray *owned) {
  const opc_inner_axis *axis = &((opc_axis *)s->sweep->axes->pdata[a])->told;
  double *reals = g_new(double, s->done);
  const char **texts = g_new(const char *, s->done);
  for (size_t i = 0; i < s->done; i++) {
    guint k = opc_sweep_index(s->sweep, a, i);
    reals[i] = axis->values ? axis->values[k] : NAN;
    texts[i] = axis->texts[k];
  }
  g_ptr_array_add(owned, reals);
  g_ptr_array_add(owned, texts);
  if (axis->values)
    return (opc_column){axis->path, axis->unit, OPC_REAL, -1, reals};
  return (opc_column){axis->path, NULL, OPC_TEXT, -1, texts};
}

/* point, the parameters, the metrics, seconds, result */
static opc_table *make_table(const sweeper *s) {
  g_autoptr(GArray) columns = g_array_new(FALSE, FALSE, sizeof(opc_column));
  g_autoptr(GPtrArray) owned = g_ptr_array_new_with_free_func(g_free);
  g_autofree int64_t *numbers = g_new(int64_t, s->done);
  for (size_t i = 0; i < s->done; i++) numbers[i] = (int64_t)i + 1;
  opc_column column = {"point", NULL, OPC_INT, 0, numbers};
  g_array_append_val(columns, column);
  for (guint a = 0; a < s->sweep->axes->len; a++) {
    column = axis_column(s, a, owned);
    g_array_append_val(columns, column);
  }
  for (guint i = 0; i < s->columns->len; i++) {
    const metric_column *m = s->columns->pdata[i];
    column = (opc_column){m->name, m->unit, OPC_REAL, -1, m->values};
    g_array_append_val(columns, column);
  }
  const opc_column last[] = {{"seconds", NULL, OPC_REAL, 3, s->seconds},
                             {"result", NULL, OPC_TEXT, 0, s->results->pdata}};
  g_array_append_vals(columns, last, G_N_ELEMENTS(last));
  opc_error error;
  return opc_table_new("sweep", OPC_TABLE_PRINT, s->done,
                       (const opc_column *)(void *)columns->data, columns->len,
                       &error);
}

/* ---- the sweep ---- */

void opc_run_points(opc_run *trunk, const opc_choice *choice,
                    opc_problems *problems) {
  g_autoptr(GPtrArray) columns = g_ptr_array_new_with_free_func(column_free);
  g_autoptr(GHashTable) by_name =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  g_autoptr(GPtrArray) results = g_ptr_array_new_with_free_func(g_free);
  g_autofree double *seconds = g_new0(double, trunk->sweep->points);
  sweeper s = {.trunk = trunk,
               .choice = choice,
               .sweep = trunk->sweep,
               .columns = columns,
               .by_name = by_name,
               .results = results,
               .seconds = seconds};
  gboolean going = TRUE;
  while (going && s.done < s.sweep->points) going = do_point(&s, s.done);
  trunk->points = make_table(&s);
  if (going)
    opc_run_write(trunk, "sweep.csv", opc_table_csv(trunk->points), problems);
  else
    opc_problem_add(problems, OPC_CANCELLED, NULL,
                    "stopped after %zu of %zu points", s.done, s.sweep->points);
}
