/* SPDX-License-Identifier: BSD-3-Clause */
/* What a search tells. */
#include <math.h>

#include "core/search/search.h"

/* ---- the settings ---- */

static void make_parameter(const opc_axis *axis, opc_setting *out) {
  const char *unit;
  gboolean numeric = opc_axis_is_numeric(axis, &unit);
  size_t n = axis->values->len;
  double *values = g_new(double, n);
  char **texts = g_new0(char *, n + 1);
  for (size_t i = 0; i < n; i++) {
    const opc_node *node = axis->values->pdata[i];
    texts[i] = opc_node_line(node);
    if (numeric) values[i] = g_ascii_strtod(node->text, NULL);
  }
  *out = (opc_setting){.name = g_strdup(axis->path),
                       .unit = numeric && *unit ? g_strdup(unit) : NULL,
                       .count = n,
                       .texts = (const char *const *)texts};
  if (numeric)
    out->values = values;
  else
    g_free(values);
}

opc_settings *opc_search_settings(const opc_search *s) {
  const GPtrArray *axes = s->inner->sweep->axes;
  opc_setting *parameters = g_new0(opc_setting, axes->len);
  for (guint a = 0; a < axes->len; a++)
    make_parameter(axes->pdata[a], &parameters[a]);
  opc_settings *out = g_new(opc_settings, 1);
  *out = (opc_settings){
      .size = sizeof *out,
      .n_parameters = axes->len,
      .parameters = parameters,
      .count = s->count,
      .figure = g_memdup2(s->figure, s->count * sizeof(double)),
      .name = g_strdup_printf("%s.%s", s->plan.of->path, s->plan.metric->name),
      .unit = g_strdup(s->plan.metric->unit),
      .best = s->best};
  return out;
}

void opc_search_settings_release(void *object) {
  opc_settings *s = object;
  for (size_t a = 0; a < s->n_parameters; a++) {
    g_free((char *)s->parameters[a].name);
    g_free((char *)s->parameters[a].unit);
    g_free((double *)s->parameters[a].values);
    g_strfreev((char **)s->parameters[a].texts);
  }
  g_free((opc_setting *)s->parameters);
  g_free((double *)s->figure);
  g_free((char *)s->name);
  g_free((char *)s->unit);
  g_free(s);
}

/* ---- tables ---- */

/* setting, the parameters, the figure, its run, how that went */
static int settings_table(const opc_search *s, const opc_settings *all,
                          opc_error *error) {
  size_t n = 0;
  g_autofree opc_column *columns = g_new0(opc_column, all->n_parameters + 4);
  g_autofree int64_t *numbers = g_new(int64_t, s->count);
  g_autofree const char **results = g_new(const char *, s->count);
  g_autoptr(GPtrArray) cells = g_ptr_array_new_with_free_func(g_free);
  for (size_t i = 0; i < s->count; i++) {
    numbers[i] = (int64_t)i + 1;
    results[i] = s->results->pdata[s->run[i] - 1];
  }
  columns[n++] = (opc_column){"setting", NULL, OPC_INT, 0, numbers};
  size_t stride = s->count;
  for (size_t a = 0; a < all->n_parameters; a++) {
    const opc_setting *p = &all->parameters[a];
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
  return s->host->table(s->host, "settings", 0, s->count, columns, n, error);
}

/* Lines of a table with two columns. */
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

/* The best setting with all metrics of its step, and the effort. */
static int best_table(const opc_search *s, const opc_settings *all,
                      opc_error *error) {
  sheet t = {g_ptr_array_new_with_free_func(g_free),
             g_ptr_array_new_with_free_func(g_free)};
  size_t stride = s->count;
  for (size_t a = 0; a < all->n_parameters; a++) {
    const opc_setting *p = &all->parameters[a];
    stride /= p->count;
    g_ptr_array_add(t.what, g_strdup(p->name));
    g_ptr_array_add(t.value, g_strdup(p->texts[s->best / stride % p->count]));
  }
  const GArray *metrics = s->best_run->metrics;
  for (guint i = 0; i < metrics->len; i++) {
    const opc_run_metric *m = &g_array_index(metrics, opc_run_metric, i);
    add_number(&t, g_strdup_printf("%s.%s", m->binding->path, m->metric->name),
               m->value, m->metric->unit);
  }
  add_number(&t, g_strdup("settings"), (double)s->count, NULL);
  add_number(&t, g_strdup("runs"), (double)s->runs, NULL);
  add_number(&t, g_strdup("failed settings"), (double)s->failed, NULL);
  add_number(&t, g_strdup("litho simulations"), s->simulations, NULL);
  const opc_column columns[] = {
      {"of the best setting", NULL, OPC_TEXT, 0, t.what->pdata},
      {"value", NULL, OPC_TEXT, 0, t.value->pdata}};
  int code = s->host->table(s->host, "best", OPC_TABLE_PRINT, t.what->len,
                            columns, G_N_ELEMENTS(columns), error);
  g_ptr_array_free(t.what, TRUE);
  g_ptr_array_free(t.value, TRUE);
  return code;
}

/* ---- all of it ---- */

int opc_search_report(const opc_search *s, const opc_settings *all,
                      opc_error *error) {
  const struct {
    const char *name;
    double value;
  } metrics[] = {{s->plan.greatest ? "greatest" : "least", s->figure[s->best]},
                 {"setting", (double)s->best + 1},
                 {"settings", (double)s->count},
                 {"failed", (double)s->failed},
                 {"runs", (double)s->runs},
                 {"simulations", s->simulations}};
  int code = settings_table(s, all, error);
  if (!code) code = best_table(s, all, error);
  for (size_t i = 0; i < G_N_ELEMENTS(metrics) && !code; i++)
    code = s->host->metric(s->host, metrics[i].name, metrics[i].value, error);
  if (!code && s->failed)
    s->host->log(s->host, OPC_LOG_WARNING,
                 "%zu of %zu settings failed: see settings.csv", s->failed,
                 s->count);
  return code;
}
