/* SPDX-License-Identifier: BSD-3-Clause */
/* Report of an experiment: the figures of all runs, and their means by
   method. */
#include <eda/verdicts.h>
#include <math.h>
#include <opcflow/table.h>
#include <string.h>

#include "experiment.h"

/* Largest width of the summary, in terminal columns. */
enum { WIDEST = 100 };

/* Metrics that methods optimise, of any step. They are the first columns of the
   summary. */
static const char *const aims[] = {"ion_mean",  "ion_max", "ioff_mean",
                                   "area_mean", "shots",   "violations"};

/* ---- figures ---- */

void figure_free(void *object) {
  figure *f = object;
  g_free(f->name);
  g_free(f->values);
  g_free(f);
}

static figure *find_figure(const experiment *e, const char *name) {
  for (guint i = 0; i < e->figures->len; i++) {
    figure *f = e->figures->pdata[i];
    if (!strcmp(f->name, name)) return f;
  }
  return NULL;
}

/* Return the figure of a metric, created if new. Metrics of different plugins
   with equal name but different unit are separate figures. */
static figure *get_figure(experiment *e, const opc_inner_metric *m) {
  g_autofree char *name = g_strdup_printf("%s.%s", m->path, m->metric->name);
  for (guint i = 0; i < e->figures->len; i++) {
    figure *f = e->figures->pdata[i];
    if (!strcmp(f->name, name) && !g_strcmp0(f->unit, m->metric->unit))
      return f;
  }
  figure *f = g_new(figure, 1);
  *f = (figure){g_steal_pointer(&name), m->metric->unit, m->metric->better,
                g_new(double, e->count)};
  for (size_t i = 0; i < e->count; i++) f->values[i] = NAN;
  g_ptr_array_add(e->figures, f);
  return f;
}

void take_figures(experiment *e, size_t run) {
  size_t n;
  const opc_inner_metric *const *m =
      opc_get_inner(e->host)->metrics(e->host, 0, &n);
  for (size_t i = 0; i < n; i++) get_figure(e, m[i])->values[run] = m[i]->value;
}

/* ---- experiment.csv ---- */

static int write_runs(const experiment *e, opc_error *error) {
  enum { HEAD = 5 };
  size_t n = HEAD + e->figures->len;
  g_autofree opc_column *columns = g_new0(opc_column, n);
  g_autofree const char **cases = g_new(const char *, e->count);
  g_autofree const char **methods = g_new(const char *, e->count);
  for (size_t i = 0; i < e->count; i++) {
    cases[i] = e->case_names[i / e->n_methods];
    methods[i] = e->method_names[i % e->n_methods];
  }
  const char *step = NULL;
  g_auto(GStrv) folders = g_new0(char *, e->count + 1);
  for (size_t i = 0; i < e->count; i++) {
    /* The column `folder` has paths inside the outer run folder: step/run. */
    if (!step && e->folders[i]) {
      size_t whole = strlen(e->folders[i]), inside = strlen(e->places[i]);
      g_autofree char *own = g_strndup(e->folders[i], whole - inside - 1);
      step = g_intern_string(strrchr(own, '/') + 1);
    }
  }
  for (size_t i = 0; i < e->count; i++)
    folders[i] = *e->places[i] ? g_build_filename(step, e->places[i], NULL)
                               : g_strdup("");
  columns[0] = (opc_column){"case", NULL, OPC_TEXT, 0, cases};
  columns[1] = (opc_column){"method", NULL, OPC_TEXT, 0, methods};
  columns[2] = (opc_column){"folder", NULL, OPC_TEXT, 0, folders};
  columns[3] = (opc_column){"result", NULL, OPC_TEXT, 0, e->results};
  columns[4] = (opc_column){"seconds", NULL, OPC_REAL, 6, e->seconds};
  for (guint i = 0; i < e->figures->len; i++) {
    const figure *f = e->figures->pdata[i];
    columns[HEAD + i] = (opc_column){f->name, f->unit, OPC_REAL, -1, f->values};
  }
  return opc_put_table(e->host, "experiment", 0, e->count, columns, n, error);
}

/* ---- the summary ---- */

/* Return the mean over the cases with a value, or NAN if no case has one. */
static double mean_of(const experiment *e, const double *values,
                      size_t method) {
  double sum = 0, n = 0;
  for (size_t i = method; i < e->count; i += e->n_methods)
    if (!isnan(values[i])) {
      sum += values[i];
      n++;
    }
  return n > 0 ? sum / n : NAN;
}

static gboolean figure_differs(const experiment *e, const figure *f) {
  double first = mean_of(e, f->values, 0);
  for (size_t m = 1; m < e->n_methods; m++)
    if (mean_of(e, f->values, m) != first) return TRUE;
  return FALSE;
}

/* Round to four significant digits. */
static double round_to_digits(double value) {
  char digits[40];
  g_ascii_formatd(digits, sizeof digits, "%.4g", value);
  return g_ascii_strtod(digits, NULL);
}

/* Columns of the summary table, and the printed width. */
typedef struct summary {
  const experiment *e;
  GArray *columns;
  GPtrArray *cells; /* columns' data, freed with the summary */
  size_t width;
} summary;

/* Add a column of means. Returns FALSE, without adding the column, if the table
   would be too wide and `must` is FALSE. */
static gboolean add_means(summary *s, const char *head, const char *unit,
                          const double *values, gboolean must) {
  const experiment *e = s->e;
  enum { LARGEST = 9 }; /* characters of a rounded number */
  size_t width = strlen(head) + (unit ? strlen(unit) + 3 : 0);
  width = MAX(width, LARGEST) + 2;
  if (!must && s->width + width > WIDEST) return FALSE;
  s->width += width;
  double *means = g_new(double, e->n_methods);
  g_ptr_array_add(s->cells, means);
  for (size_t m = 0; m < e->n_methods; m++)
    means[m] = round_to_digits(mean_of(e, values, m));
  const opc_column column = {head, unit, OPC_REAL, -1, means};
  g_array_append_val(s->columns, column);
  return TRUE;
}

/* Return the figure of the last step with the metric `aim`, or NULL. The last
   step is chosen because later steps verify earlier ones. */
static const figure *find_aim(const experiment *e, const char *aim) {
  for (guint i = e->figures->len; i-- > 0;) {
    const figure *f = e->figures->pdata[i];
    if (!strcmp(strrchr(f->name, '.') + 1, aim)) return f;
  }
  return NULL;
}

/* Add the metrics that methods optimise and the run time. Then add, as far as
   the width permits, all other figures that have a direction and differ between
   methods. */
static void add_preset_figures(summary *s) {
  const experiment *e = s->e;
  g_autoptr(GHashTable) added = g_hash_table_new(NULL, NULL);
  for (size_t i = 0; i < G_N_ELEMENTS(aims); i++) {
    const figure *f = find_aim(e, aims[i]);
    if (f && g_hash_table_add(added, (gpointer)f))
      add_means(s, f->name, f->unit, f->values, TRUE);
  }
  add_means(s, "seconds", NULL, e->seconds, TRUE);
  for (guint i = 0; i < e->figures->len; i++) {
    const figure *f = e->figures->pdata[i];
    if (f->better != OPC_NEUTRAL && !g_hash_table_contains(added, f) &&
        figure_differs(e, f))
      add_means(s, f->name, f->unit, f->values, FALSE);
  }
}

/* Add the requested figures and the run time. */
static void add_figures(summary *s) {
  const experiment *e = s->e;
  for (size_t i = 0; i < e->columns.count; i++) {
    const opc_pair *pair = &e->columns.pairs[i];
    const figure *f = find_figure(e, pair->key);
    if (f)
      add_means(s, pair->value, f->unit, f->values, TRUE);
    else
      e->host->log(e->host, OPC_LOG_WARNING, "no run has a value of '%s'",
                   pair->key);
  }
  add_means(s, "seconds", NULL, e->seconds, TRUE);
}

/* Publish the summary by method: completed runs and means. */
static int print_summary(const experiment *e, opc_error *error) {
  summary s = {e, g_array_new(FALSE, TRUE, sizeof(opc_column)),
               g_ptr_array_new_with_free_func(g_free), 0};
  int64_t *runs = g_new0(int64_t, e->n_methods);
  g_ptr_array_add(s.cells, runs);
  for (size_t i = 0; i < e->count; i++)
    runs[i % e->n_methods] += e->folders[i] != NULL;
  const opc_column head[] = {{"method", NULL, OPC_TEXT, 0, e->method_names},
                             {"cases", NULL, OPC_INT, 0, runs}};
  g_array_append_vals(s.columns, head, G_N_ELEMENTS(head));
  for (size_t m = 0; m < e->n_methods; m++)
    s.width = MAX(s.width, strlen(e->method_names[m]));
  s.width += strlen("cases") + 4;
  if (e->columns.count)
    add_figures(&s);
  else
    add_preset_figures(&s);
  int code = opc_put_table(e->host, "summary", OPC_TABLE_PRINT, e->n_methods,
                           (const opc_column *)(void *)s.columns->data,
                           s.columns->len, error);
  g_array_free(s.columns, TRUE);
  g_ptr_array_free(s.cells, TRUE);
  return code;
}

/* ---- verdicts ---- */

/* A change of a figure between two methods. */
typedef struct pair_row {
  const char *method, *against;
  eda_change c;
} pair_row;

/* Publish pairs.csv, the changes from each method to each later one. */
static int write_pairs(const experiment *e, const eda_verdict *v, size_t n,
                       opc_error *error) {
  g_autofree pair_row *r = g_new0(pair_row, n * EDA_CHANGES + 1);
  size_t rows = 0;
  for (size_t i = 0; i < n * EDA_CHANGES; i++) {
    const eda_verdict *of = &v[i / EDA_CHANGES];
    const eda_change *c = &of->changes[i % EDA_CHANGES];
    if (c->n) r[rows++] = (pair_row){of->method, of->against, *c};
  }
  const opc_column columns[] = {
      {"method", NULL, OPC_TEXT, 0, &r->method},
      {"against", NULL, OPC_TEXT, 0, &r->against},
      {"figure", NULL, OPC_TEXT, 0, &r->c.name},
      {"base", NULL, OPC_REAL, -1, &r->c.base},
      {"value", NULL, OPC_REAL, -1, &r->c.value},
      {"change", NULL, OPC_REAL, -1, &r->c.change},
      {"unit", NULL, OPC_TEXT, 0, &r->c.unit},
      {"median", NULL, OPC_REAL, -1, &r->c.median.value},
      {"low", NULL, OPC_REAL, -1, &r->c.median.low},
      {"high", NULL, OPC_REAL, -1, &r->c.median.high},
      {"independent", NULL, OPC_INT, 0, &r->c.median.n},
      {"verdict", NULL, OPC_TEXT, 0, &r->c.word}};
  return opc_put_rows(e->host, "pairs", 0, rows, sizeof *r, columns,
                      G_N_ELEMENTS(columns), error);
}

/* Publish the figures of all pairs of methods, and the verdicts on each method
   against the first one. Logs a warning for a run folder that cannot be
   read. */
static int print_verdicts(const experiment *e, opc_error *error) {
  opc_error why = {0};
  size_t n;
  eda_verdict *v = eda_verdicts_new(e->n_cases, e->n_methods, e->method_names,
                                    (const char *const *)e->folders, &n, &why);
  if (!v) {
    e->host->log(e->host, OPC_LOG_WARNING, "no verdicts: %s", why.message);
    return OPC_OK;
  }
  g_autofree const char **texts = g_new(const char *, n + 1);
  for (size_t i = 0; i < n; i++) texts[i] = v[i].text;
  const opc_column column = {"verdict", NULL, OPC_TEXT, 0, texts};
  int code = n ? write_pairs(e, v, n, error) : OPC_OK;
  if (n && !code)
    code = opc_put_table(e->host, "verdicts", OPC_TABLE_PRINT, e->n_methods - 1,
                         &column, 1, error);
  eda_verdicts_free(v, n);
  return code;
}

/* ---- complete report ---- */

static void figures_report(const experiment *e) {
  const opc_host *host = e->host;
  if (e->failed)
    host->log(host, OPC_LOG_FINDING,
              "%zu of %zu runs failed: see 'result' in experiment.csv",
              e->failed, e->count);
  if (e->with_findings)
    host->log(
        host, OPC_LOG_FINDING,
        "%zu of %zu runs have findings: see metrics.json in the run folders",
        e->with_findings, e->count);
}

int experiment_report(experiment *e, opc_error *error) {
  const opc_metric_value values[] = {{"cases", (double)e->n_cases},
                                     {"methods", (double)e->n_methods},
                                     {"failed", (double)e->failed},
                                     {"missed", (double)e->missed}};
  int code = write_runs(e, error);
  if (!code) code = print_summary(e, error);
  if (!code) code = print_verdicts(e, error);
  if (!code) code = opc_put_metrics(e->host, OPC_ARRAY(values), error);
  if (!code) figures_report(e);
  return code;
}
