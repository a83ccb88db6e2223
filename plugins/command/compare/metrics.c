/* SPDX-License-Identifier: BSD-3-Clause */
/* Compares metrics of runs: a verdict for each metric of each case; means,
   median changes and counts of verdicts over the cases. */
#include <eda/median.h>
#include <eda/words.h>
#include <math.h>
#include <opcflow/table.h>
#include <string.h>

#include "tables.h"

static const char *const verdict_words[VERDICTS] = {"better", "worse", "same",
                                                    "differs", "missing"};

/* ---- choosing ---- */

static int metric_matches(const char *word, const char *metric) {
  const char *last = strrchr(metric, '.');
  return !strcmp(word, metric) || (last && !strcmp(word, last + 1)) ||
         g_pattern_match_simple(word, metric);
}

int is_chosen(const char *list, const char *metric) {
  g_auto(GStrv) words = g_strsplit(list, ",", -1);
  for (char **word = words; *word; word++)
    if (metric_matches(g_strstrip(*word), metric)) return 1;
  return 0;
}

static int word_matches_any(const comparison *c, const char *word) {
  for (guint i = 0; i < c->rows->len; i++)
    if (metric_matches(word, g_array_index(c->rows, metric_row, i).metric))
      return 1;
  return 0;
}

/* Check that each word of --metrics selects a metric. */
static int check_chosen(const comparison *c, opc_error *error) {
  if (!c->chosen) return OPC_OK;
  g_auto(GStrv) words = g_strsplit(c->chosen, ",", -1);
  g_autoptr(GPtrArray) known = g_ptr_array_new();
  for (guint i = 0; i < c->rows->len; i++)
    g_ptr_array_add(known,
                    (char *)g_array_index(c->rows, metric_row, i).metric);
  g_ptr_array_add(known, NULL);
  for (char **word = words; *word; word++) {
    if (word_matches_any(c, g_strstrip(*word))) continue;
    const char *near = eda_nearest(*word, (const char *const *)known->pdata);
    return opc_fail(error, OPC_INVALID, "metrics",
                    "metric '%s' does not exist%s%s%s", *word,
                    near ? ", did you mean '" : "", near ? near : "",
                    near ? "'?" : "");
  }
  return OPC_OK;
}

/* ---- verdicts ---- */

static int verdict_of(const eda_run_metric *m, double value) {
  double change = value - m->value;
  if (isnan(value) && isnan(m->value)) return SAME;
  if (isnan(value) || isnan(m->value)) return MISSING;
  if (value == m->value || fabs(change) <= m->tolerance) return SAME;
  if (m->better == EDA_RUN_NEUTRAL) return DIFFERS;
  return (change < 0) == (m->better == EDA_RUN_LOWER) ? BETTER : WORSE;
}

static void add_row(comparison *c, const pair *p, const eda_run_metric *m) {
  static const char *const directions[] = {"", "lower", "higher"};
  const eda_run_metric *other = eda_run_metric_of(p->other, m->name);
  double value = other ? other->value : NAN;
  int verdict = other ? verdict_of(m, value) : MISSING;
  const metric_row row = {p->name,
                          p->method,
                          m->name,
                          m->unit,
                          directions[m->better],
                          verdict_words[verdict],
                          m->tolerance,
                          m->value,
                          value,
                          value == m->value ? 0 : value - m->value,
                          verdict,
                          c->rows->len};
  g_array_append_val(c->rows, row);
}

/* Add the metrics of the base run, then those that only the other run has. */
static void add_pair(comparison *c, const pair *p) {
  const eda_run_facts *a = eda_run_info(p->base), *b = eda_run_info(p->other);
  for (size_t i = 0; i < a->n_metrics; i++) add_row(c, p, &a->metrics[i]);
  for (size_t i = 0; i < b->n_metrics; i++) {
    if (eda_run_metric_of(p->base, b->metrics[i].name)) continue;
    eda_run_metric none = b->metrics[i];
    none.value = NAN;
    add_row(c, p, &none);
  }
}

static double row_relative(const metric_row *r) {
  double share = fabs(r->change) / fmax(fabs(r->base), 1e-300);
  return isnan(share) ? -1 : share;
}

static int by_choice(const void *a, const void *b, void *data) {
  const metric_row *x = a, *y = b;
  const comparison *c = data;
  /* Order of verdicts: worse, better, differs, missing, same. */
  static const int rank[VERDICTS] = {1, 0, 4, 2, 3};
  int order = 0;
  if (c->sort == SORT_NAME) order = strcmp(x->metric, y->metric);
  if (c->sort == SORT_VERDICT) order = rank[x->verdict] - rank[y->verdict];
  if (c->sort == SORT_CHANGE)
    order = (row_relative(x) < row_relative(y)) -
            (row_relative(x) > row_relative(y));
  /* In the order of the file, rows are grouped by case. `order` then puts rows
     of the same metric together (order_by_metric). */
  if (!order && c->sort == SORT_FILE && !c->field.experiment)
    order = strcmp(x->name, y->name);
  return order ? order : (x->order > y->order) - (x->order < y->order);
}

/* Set `order` so that a later sort groups rows by metric, in the order in which
   the metrics first occur. */
static void order_by_metric(comparison *c) {
  g_autoptr(GHashTable) first = g_hash_table_new(g_str_hash, g_str_equal);
  for (guint i = 0; i < c->rows->len; i++) {
    metric_row *r = &g_array_index(c->rows, metric_row, i);
    size_t place = GPOINTER_TO_SIZE(g_hash_table_lookup(first, r->metric));
    if (!place) {
      place = g_hash_table_size(first) + 1;
      g_hash_table_insert(first, (char *)r->metric, GSIZE_TO_POINTER(place));
    }
    r->order += place * c->rows->len;
  }
}

int metrics_collect(comparison *c, opc_error *error) {
  const field *f = &c->field;
  for (guint i = 0; i < f->pairs->len; i++)
    add_pair(c, &g_array_index(f->pairs, pair, i));
  int code = check_chosen(c, error);
  for (guint i = c->rows->len; c->chosen && i-- > 0;)
    if (!is_chosen(c->chosen, g_array_index(c->rows, metric_row, i).metric))
      g_array_remove_index(c->rows, i);
  if (!f->experiment) order_by_metric(c);
  g_array_sort_with_data(c->rows, by_choice, c);
  return code;
}

int metrics_publish(comparison *c, opc_error *error) {
  g_autoptr(GArray) shown = ROWS(metric_row);
  for (guint i = 0; i < c->rows->len; i++) {
    const metric_row r = g_array_index(c->rows, metric_row, i);
    if (c->all || c->chosen || r.verdict == MISSING || r.change != 0)
      g_array_append_val(shown, r);
  }
  const metric_row *r = (const metric_row *)(void *)shown->data;
  const opc_column columns[] = {
      {"case", NULL, OPC_TEXT, 0, &r->name},
      {"run", NULL, OPC_TEXT, 0, &r->method},
      {"metric", NULL, OPC_TEXT, 0, &r->metric},
      {"unit", NULL, OPC_TEXT, 0, &r->unit},
      {"base", NULL, OPC_REAL, -1, &r->base},
      {"value", NULL, OPC_REAL, -1, &r->value},
      {"change", NULL, OPC_REAL, -1, &r->change},
      {"verdict", NULL, OPC_TEXT, 0, &r->word},
      {"tolerance", NULL, OPC_REAL, -1, &r->tolerance},
      {"better", NULL, OPC_TEXT, 0, &r->better}};
  return put_table(c, "metrics", shown->len, sizeof *r, columns,
                   G_N_ELEMENTS(columns), error);
}

/* ---- over cases ---- */

typedef struct case_row {
  const char *method, *metric, *unit, *better;
  GArray *changes; /* double, finite values only */
  double base, value, change, median, low, high;
  int64_t n, wins, losses, ties;
} case_row;

static void add_to_case(GHashTable *index, GArray *out, const metric_row *r) {
  g_autofree char *key = g_strdup_printf("%s\n%s", r->method, r->metric);
  size_t at = GPOINTER_TO_SIZE(g_hash_table_lookup(index, key));
  if (!at) {
    const case_row none = {
        .method = r->method,
        .metric = r->metric,
        .unit = r->unit,
        .better = r->better,
        .changes = g_array_new(FALSE, FALSE, sizeof(double))};
    g_array_append_val(out, none);
    at = out->len;
    g_hash_table_insert(index, g_steal_pointer(&key), GSIZE_TO_POINTER(at));
  }
  case_row *row = &g_array_index(out, case_row, at - 1);
  row->wins += r->verdict == BETTER;
  row->losses += r->verdict == WORSE;
  row->ties += r->verdict == SAME;
  if (!isfinite(r->change)) return;
  row->n++;
  row->base += r->base;
  row->value += r->value;
  g_array_append_val(row->changes, r->change);
}

static void finish_case(case_row *row) {
  const double *changes = (const double *)(void *)row->changes->data;
  eda_median m = eda_median_of(changes, row->changes->len);
  row->base /= (double)row->n;
  row->value /= (double)row->n;
  row->change = row->value - row->base;
  row->median = m.value;
  row->low = m.low;
  row->high = m.high;
}

/* Return 1 if the metric differs in a case, or if no case has finite values of
   both runs. */
static int is_changed(const case_row *row) {
  for (guint i = 0; i < row->changes->len; i++)
    if (g_array_index(row->changes, double, i) != 0) return 1;
  return !row->n;
}

int cases_publish(comparison *c, opc_error *error) {
  g_autoptr(GArray) all = ROWS(case_row);
  g_autoptr(GHashTable) index =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (guint i = 0; i < c->rows->len; i++)
    add_to_case(index, all, &g_array_index(c->rows, metric_row, i));
  for (guint i = all->len; i-- > 0;) {
    case_row *row = &g_array_index(all, case_row, i);
    finish_case(row);
    int shown = c->all || c->chosen || is_changed(row);
    g_array_free(row->changes, TRUE);
    if (!shown) g_array_remove_index(all, i);
  }
  const case_row *r = (const case_row *)(void *)all->data;
  const opc_column columns[] = {{"method", NULL, OPC_TEXT, 0, &r->method},
                                {"metric", NULL, OPC_TEXT, 0, &r->metric},
                                {"unit", NULL, OPC_TEXT, 0, &r->unit},
                                {"better", NULL, OPC_TEXT, 0, &r->better},
                                {"cases", NULL, OPC_INT, 0, &r->n},
                                {"base", NULL, OPC_REAL, -1, &r->base},
                                {"value", NULL, OPC_REAL, -1, &r->value},
                                {"change", NULL, OPC_REAL, -1, &r->change},
                                {"median", NULL, OPC_REAL, -1, &r->median},
                                {"low", NULL, OPC_REAL, -1, &r->low},
                                {"high", NULL, OPC_REAL, -1, &r->high},
                                {"wins", NULL, OPC_INT, 0, &r->wins},
                                {"losses", NULL, OPC_INT, 0, &r->losses},
                                {"ties", NULL, OPC_INT, 0, &r->ties}};
  return opc_put_rows(c->host, "cases", OPC_TABLE_PRINT, all->len, sizeof *r,
                      columns, G_N_ELEMENTS(columns), error);
}
