/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables and metrics of the step `search`. */
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>

#include "search.h"

eda_settings *search_settings(const search *s) {
  eda_settings *out = eda_settings_new(s->n_axes);
  for (size_t i = 0; i < s->n_axes; i++) {
    const opc_inner_axis *a = s->axes[i];
    eda_settings_parameter(out, i, a->path, a->unit, a->count, a->values,
                           a->texts);
  }
  eda_settings_figure(out, s->plan.figure, s->plan.unit, s->figure, s->best);
  return out;
}

/* Publish the table with the columns setting, parameters, figure, run,
   result. */
static int settings_table(const search *s, const eda_settings *all,
                          opc_error *error) {
  size_t n = 0, stride = s->count;
  g_autofree opc_column *columns = g_new0(opc_column, all->n_parameters + 4);
  g_autofree int64_t *numbers = g_new(int64_t, s->count);
  g_autofree const char **results = g_new(const char *, s->count);
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < s->count; i++) {
    numbers[i] = (int64_t)i + 1;
    results[i] = s->results[s->run[i] - 1];
  }
  columns[n++] = (opc_column){"setting", NULL, OPC_INT, 0, numbers};
  for (size_t a = 0; a < all->n_parameters; a++) {
    const eda_setting *p = &all->parameters[a];
    double *reals = g_new(double, s->count);
    const char **texts = g_new(const char *, s->count);
    g_ptr_array_add(cells, reals);
    g_ptr_array_add(cells, texts);
    stride /= p->count;
    for (size_t i = 0; i < s->count; i++) {
      size_t value = i / stride % p->count;
      reals[i] = p->values ? p->values[value] : NAN;
      texts[i] = p->texts[value];
    }
    columns[n++] =
        (opc_column){p->name, p->unit, p->values ? OPC_REAL : OPC_TEXT, -1,
                     p->values ? (const void *)reals : texts};
  }
  columns[n++] = (opc_column){all->name, all->unit, OPC_REAL, -1, all->figure};
  columns[n++] = (opc_column){"run", NULL, OPC_INT, 0, s->run};
  columns[n++] = (opc_column){"result", NULL, OPC_TEXT, 0, results};
  return opc_put_table(s->host, "settings", 0, s->count, columns, n, error);
}

/* Rows of a table with two columns. */
typedef struct sheet {
  GPtrArray *what, *value;
} sheet;

static void add_number(sheet *t, char *what, double value, const char *unit) {
  char number[40];
  g_ascii_formatd(number, sizeof number, "%.6g", value);
  g_ptr_array_add(t->what, what);
  g_ptr_array_add(t->value, g_strdup_printf("%s%s%s", number, unit ? " " : "",
                                            unit ? unit : ""));
}

/* Publish the best setting with all metrics of its run, and the numbers of runs
   and simulations. */
static int best_table(const search *s, const eda_settings *all,
                      opc_error *error) {
  sheet t = {g_ptr_array_new_with_free_func(g_free),
             g_ptr_array_new_with_free_func(g_free)};
  size_t stride = s->count, n;
  for (size_t a = 0; a < all->n_parameters; a++) {
    const eda_setting *p = &all->parameters[a];
    stride /= p->count;
    g_ptr_array_add(t.what, g_strdup(p->name));
    g_ptr_array_add(t.value, g_strdup(p->texts[s->best / stride % p->count]));
  }
  const opc_inner_metric *const *m =
      opc_get_inner(s->host)->metrics(s->host, 0, &n);
  for (size_t i = 0; i < n; i++)
    add_number(&t, g_strdup_printf("%s.%s", m[i]->path, m[i]->metric->name),
               m[i]->value, m[i]->metric->unit);
  add_number(&t, g_strdup("settings"), (double)s->count, NULL);
  add_number(&t, g_strdup("runs"), (double)s->runs, NULL);
  add_number(&t, g_strdup("failed settings"), (double)s->failed, NULL);
  add_number(&t, g_strdup("litho simulations"), s->simulations, NULL);
  const opc_column columns[] = {
      {"of the best setting", NULL, OPC_TEXT, 0, t.what->pdata},
      {"value", NULL, OPC_TEXT, 0, t.value->pdata}};
  int code = opc_put_table(s->host, "best", OPC_TABLE_PRINT, t.what->len,
                           columns, G_N_ELEMENTS(columns), error);
  g_ptr_array_free(t.what, TRUE);
  g_ptr_array_free(t.value, TRUE);
  return code;
}

int search_report(const search *s, const eda_settings *all, opc_error *error) {
  const opc_metric_value values[] = {
      {s->plan.greatest ? "greatest" : "least", s->figure[s->best]},
      {"setting", (double)s->best + 1},
      {"settings", (double)s->count},
      {"failed", (double)s->failed},
      {"runs", (double)s->runs},
      {"simulations", s->simulations}};
  int code = settings_table(s, all, error);
  if (!code) code = best_table(s, all, error);
  if (!code) code = opc_put_metrics(s->host, OPC_ARRAY(values), error);
  if (!code && s->failed)
    s->host->log(s->host, OPC_LOG_WARNING,
                 "%zu of %zu settings failed: see settings.csv", s->failed,
                 s->count);
  return code;
}
