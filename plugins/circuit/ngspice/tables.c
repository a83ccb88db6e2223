/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes the result tables and metrics: all values, means and extreme
   values. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench.h"

/* Return 100 (a - b) / b, thesis eq. 3.8 without absolute value; NAN unless b >
   0. */
static double percent_deviation(double a, double b) {
  return b > 0 ? 100 * (a - b) / b : (double)NAN;
}

static int publish_metric(const bench *b, const char *name, double value,
                          opc_error *error) {
  if (isnan(value)) return OPC_OK;
  return b->host->metric(b->host, name, value, error);
}

/* ---- tables ---- */

/* Table under construction, column by column. */
typedef struct table {
  bench *b;
  size_t rows, columns;
  opc_column column[16];
} table;

static void *table_add_column(table *t, const char *name, const char *unit,
                              uint32_t type, int decimals, size_t size) {
  void *data = eda_pool_alloc(&t->b->pool, t->rows, size);
  t->column[t->columns++] = (opc_column){name, unit, type, decimals, data};
  return data;
}

static const char **add_texts(table *t, const char *name) {
  return table_add_column(t, name, NULL, OPC_TEXT, 0, sizeof(char *));
}

static double *add_numbers(table *t, const char *name, const char *unit,
                           int decimals) {
  double *x = table_add_column(t, name, unit, OPC_REAL, decimals, sizeof *x);
  for (size_t i = 0; i < t->rows; i++) x[i] = NAN;
  return x;
}

/* Add a column for one set of sizes, such as "delay before". */
static double *add_state(table *t, const char *what, int state,
                         const char *unit, int decimals) {
  static const char *const states[] = {"drawn", "before", "after"};
  char name[64];
  int n = snprintf(name, sizeof name, "%s %s", what, states[state]);
  return add_numbers(t, eda_pool_text(&t->b->pool, name, (size_t)n), unit,
                     decimals);
}

static int table_publish(const table *t, const char *name, uint32_t flags,
                         opc_error *error) {
  const opc_host *host = t->b->host;
  return opc_put_table(host, name, flags, t->rows, t->column, t->columns,
                       error);
}

/* Return the number of sets of sizes with columns. */
static int states_of(const bench *b) { return b->mask ? EDA_STATES : 1; }

/* ---- deviations of many figures ---- */

/* Mean, extreme value with sign, and count. */
typedef struct spread {
  double mean, worst;
  int64_t count;
} spread;

static void spread_include(spread *s, double x) {
  if (isnan(x)) return;
  if (!s->count || fabs(x) > fabs(s->worst)) s->worst = x;
  s->mean += (x - s->mean) / (double)++s->count;
}

static double mean_of(const spread *s) {
  return s->count ? s->mean : (double)NAN;
}

static double worst_of(const spread *s) {
  return s->count ? s->worst : (double)NAN;
}

/* Report "tr_worst" for the corrected mask, "tr_worst_before" for the mask
   before correction. */
static int worst_metric(const bench *b, const char *quantity, int state,
                        const spread *of, opc_error *error) {
  char name[64];
  snprintf(name, sizeof name, "%s_worst%s", quantity,
           state == EDA_BEFORE ? "_before" : "");
  return publish_metric(b, name, fabs(worst_of(of)), error);
}

/* Columns of the extreme and mean deviations, last in a table. */
typedef struct deviations {
  double *worst[EDA_STATES], *mean[EDA_STATES];
} deviations;

static deviations add_deviations(table *t) {
  deviations d = {{NULL}, {NULL}};
  for (int s = 1; s < states_of(t->b); s++)
    d.worst[s] = add_state(t, "worst", s, "%", 3);
  for (int s = 1; s < states_of(t->b); s++)
    d.mean[s] = add_state(t, "mean", s, "%", 3);
  return d;
}

/* Set a row of the deviation columns and report the metrics of its quantity. */
static int put_deviations(const bench *b, const deviations *d, size_t row,
                          const char *quantity, const spread of[EDA_STATES],
                          opc_error *error) {
  for (int s = 1; s < states_of(b); s++) {
    d->worst[s][row] = worst_of(&of[s]);
    d->mean[s][row] = mean_of(&of[s]);
    if (worst_metric(b, quantity, s, &of[s], error)) return error->code;
  }
  return OPC_OK;
}

/* ---- delays ---- */

enum { TR, TF, TPLH, TPHL, TP, QUANTITIES };

/* Return 1 if an arrival belongs to a quantity; the quantity tp includes both
   directions. */
static int is_of(const arrival *a, int quantity) {
  return quantity == TP || a->rises == (quantity == TR || quantity == TPLH);
}

static const double *value_of(const arrival *a, int quantity) {
  return quantity == TR || quantity == TF ? a->slope : a->delay;
}

static int quantities_report(bench *b, const delays *d, opc_error *error) {
  static const char *const names[QUANTITIES] = {
      "rise time", "fall time", "delay, rising", "delay, falling", "delay"};
  static const char *const ids[QUANTITIES] = {"tr", "tf", "tplh", "tphl", "tp"};
  table t = {.b = b, .rows = QUANTITIES};
  const char **quantity = add_texts(&t, "quantity");
  int64_t *count =
      table_add_column(&t, "transitions", NULL, OPC_INT, 0, sizeof *count);
  double *drawn = add_numbers(&t, "drawn", "ps", 3);
  deviations changes = add_deviations(&t);
  for (size_t q = 0; q < QUANTITIES; q++) {
    spread of[EDA_STATES] = {{0}};
    for (size_t i = 0; i < d->count; i++) {
      const arrival *a = &d->arrival[i];
      const double *v = value_of(a, (int)q);
      if (!is_of(a, (int)q)) continue;
      spread_include(&of[0], v[0]);
      for (int s = 1; s < EDA_STATES; s++)
        if (b->has[s]) spread_include(&of[s], percent_deviation(v[s], v[0]));
    }
    quantity[q] = names[q];
    count[q] = of[0].count;
    drawn[q] = 1e12 * mean_of(&of[0]);
    if (publish_metric(b, ids[q], drawn[q], error) ||
        put_deviations(b, &changes, q, ids[q], of, error))
      return error->code;
  }
  return table_publish(&t, "performance", OPC_TABLE_PRINT, error);
}

static int arrivals_report(bench *b, const patterns *p, const delays *d,
                           opc_error *error) {
  static const char *const whats[] = {"delay", "slope"};
  table t = {.b = b, .rows = d->count};
  const char **inputs = add_texts(&t, "inputs");
  const char **output = add_texts(&t, "output"),
             **direction = add_texts(&t, "direction");
  double *x[2][EDA_STATES], *change[2][EDA_STATES] = {{NULL}};
  for (int s = 0; s < states_of(b); s++)
    for (int k = 0; k < 2; k++) {
      x[k][s] = add_state(&t, whats[k], s, "ps", 4);
      if (s) change[k][s] = add_state(&t, whats[k], s, "%", 3);
    }
  for (size_t i = 0; i < d->count; i++) {
    const arrival *a = &d->arrival[i];
    inputs[i] = patterns_say(b, p, p->transition[d->flip[a->flip]]);
    output[i] = b->circuit->net[b->output[a->output]];
    direction[i] = a->rises ? "rises" : "falls";
    for (int s = 0; s < EDA_STATES; s++)
      for (int k = 0; b->has[s] && k < 2; k++) {
        const double *v = k ? a->slope : a->delay;
        x[k][s][i] = 1e12 * v[s];
        if (s) change[k][s][i] = percent_deviation(v[s], v[0]);
      }
  }
  return table_publish(&t, "delays", 0, error);
}

int delays_report(bench *b, const patterns *p, const delays *d,
                  opc_error *error) {
  size_t missing = 0, before = 0, early = 0;
  for (size_t i = 0; i < d->count; i++) {
    const arrival *a = &d->arrival[i];
    missing += isnan(a->delay[EDA_DRAWN]) ||
               (b->has[EDA_AFTER] && isnan(a->delay[EDA_AFTER]));
    before += b->has[EDA_BEFORE] && isnan(a->delay[EDA_BEFORE]);
    early += a->delay[0] <= 0;
  }
  if (before)
    b->host->log(
        b->host, OPC_LOG_WARNING,
        "before correction, %zu of %zu outputs do not reach the final level",
        before, d->count);
  if (missing)
    b->host->log(
        b->host, OPC_LOG_WARNING,
        "%zu of %zu outputs did not reach the final level and are omitted",
        missing, d->count);
  if (early)
    b->host->log(b->host, OPC_LOG_WARNING,
                 "%zu of %zu delays as drawn are not above 0 and have no "
                 "deviation: use a shorter 'slew'",
                 early, d->count);
  if (publish_metric(b, "transitions", (double)d->flips, error) ||
      publish_metric(b, "unmeasured", (double)missing, error) ||
      quantities_report(b, d, error))
    return error->code;
  return arrivals_report(b, p, d, error);
}

int64_t worst_arrival(const delays *d, const bench *b, int rises) {
  int state = b->has[EDA_AFTER] ? EDA_AFTER : EDA_DRAWN;
  int64_t best = -1;
  double most = -1;
  for (size_t i = 0; i < d->count; i++) {
    const arrival *a = &d->arrival[i];
    /* With drawn sizes only, find the slowest arrival. */
    double x = state == EDA_AFTER
                   ? fabs(percent_deviation(a->delay[state], a->delay[0]))
                   : a->delay[0] + 1;
    if (a->rises != rises || !(x > most)) continue;
    most = x;
    best = (int64_t)i;
  }
  return best;
}

/* ---- leakage ---- */

int leakage_report(bench *b, const patterns *p, const logic *l,
                   opc_error *error) {
  size_t n = p->count;
  double most = 0;
  spread all[EDA_STATES] = {{0}}, watts = {0};
  table t = {.b = b, .rows = n};
  const char **inputs = add_texts(&t, "inputs");
  for (size_t i = 0; i < n; i++) {
    inputs[i] = patterns_say(b, p, (transition){(uint32_t)i, (uint32_t)i});
    most = fmax(most, l->current[0][i]);
  }
  for (int s = 0; s < states_of(b); s++) {
    double *current = add_state(&t, "leakage", s, "nA", -1), *change = NULL;
    if (s) change = add_state(&t, "leakage", s, "%", 2);
    double *power = add_state(&t, "power", s, "nW", -1);
    for (size_t i = 0; b->has[s] && i < n; i++) {
      current[i] = 1e9 * l->current[s][i];
      power[i] = 1e9 * l->power[s][i];
      if (s) change[i] = percent_deviation(l->current[s][i], l->current[0][i]);
      spread_include(&all[s], s ? change[i] : l->current[s][i]);
      if (!s) spread_include(&watts, l->power[s][i]);
    }
  }
  if (publish_metric(b, "leakage", mean_of(&all[0]), error) ||
      publish_metric(b, "leakage_most", most, error) ||
      publish_metric(b, "power", mean_of(&watts), error) ||
      worst_metric(b, "leakage", EDA_BEFORE, &all[EDA_BEFORE], error) ||
      worst_metric(b, "leakage", EDA_AFTER, &all[EDA_AFTER], error) ||
      publish_metric(b, "leakage_mean_before", mean_of(&all[EDA_BEFORE]),
                     error) ||
      publish_metric(b, "leakage_mean", mean_of(&all[EDA_AFTER]), error))
    return error->code;
  return table_publish(&t, "leakage", n <= 16 ? OPC_TABLE_PRINT : 0, error);
}

/* ---- noise margins ---- */

static const char *const sides[] = {"left", "right"};

static int margins_cells(bench *b, const cell *cells, size_t count,
                         const margins *m, opc_error *error) {
  table t = {.b = b, .rows = count};
  const char **q = add_texts(&t, "cell");
  for (size_t i = 0; i < count; i++) q[i] = b->circuit->net[cells[i].q];
  for (int s = 0; s < states_of(b); s++)
    for (int side = 0; side < 2; side++) {
      double *x = add_state(&t, sides[side], s, "mV", 3), *change = NULL;
      if (s) change = add_state(&t, sides[side], s, "%", 3);
      for (size_t i = 0; b->has[s] && i < count; i++) {
        double margin = m->of[s][i].margin[side];
        x[i] = 1e3 * margin;
        if (s) change[i] = percent_deviation(margin, m->of[0][i].margin[side]);
      }
    }
  return table_publish(&t, "margins", 0, error);
}

static void warn_of_state(const bench *b, const cell *cells, size_t count,
                          const butterfly *f, int state) {
  static const char *const when[EDA_STATES] = {"", " before correction",
                                               " after correction"};
  size_t bad = 0, first = 0;
  for (size_t i = count; i-- > 0;)
    if (!(f[i].margin[0] > 0 && f[i].margin[1] > 0)) {
      bad++;
      first = i;
    }
  if (bad)
    b->host->log(b->host, OPC_LOG_WARNING,
                 "%zu of %zu cells do not hold both values%s: '%s' ...", bad,
                 count, when[state], b->circuit->net[cells[first].q]);
}

int margins_report(bench *b, const cell *cells, size_t count, const margins *m,
                   opc_error *error) {
  table t = {.b = b, .rows = 2};
  const char **margin = add_texts(&t, "margin");
  double *least = add_numbers(&t, "least drawn", "mV", 2);
  deviations changes = add_deviations(&t);
  for (int s = 0; s < EDA_STATES; s++)
    if (b->has[s]) warn_of_state(b, cells, count, m->of[s], s);
  for (size_t side = 0; side < 2; side++) {
    spread of[EDA_STATES] = {{0}};
    char name[32];
    margin[side] = sides[side];
    least[side] = INFINITY;
    for (size_t i = 0; i < count; i++) {
      double drawn = m->of[0][i].margin[side];
      least[side] = fmin(least[side], 1e3 * drawn);
      for (int s = 1; s < EDA_STATES; s++)
        if (b->has[s])
          spread_include(&of[s],
                         percent_deviation(m->of[s][i].margin[side], drawn));
    }
    snprintf(name, sizeof name, "snm_%s", sides[side]);
    if (publish_metric(b, name, least[side], error) ||
        put_deviations(b, &changes, side, name, of, error))
      return error->code;
  }
  if (publish_metric(b, "cells", (double)count, error) ||
      table_publish(&t, "snm", OPC_TABLE_PRINT, error))
    return error->code;
  return margins_cells(b, cells, count, m, error);
}

/* ---- memory cells ---- */

enum { HOLD, READ, WRITE, CURRENT, REST, FIGURES };

/* Return a figure of a side of a cell, in the unit of the table. */
static double cell_figure(const margins m[2], const accesses *a, int figure,
                          int state, size_t i, int side) {
  const access_figures *f = &a->of[state][i];
  switch (figure) {
    case WRITE:
      return 1e3 * f->write[side];
    case CURRENT:
      return 1e6 * f->read[side];
    case REST:
      return 1e12 * f->leakage[side];
    default:
      return 1e3 * m[figure].of[state][i].margin[side];
  }
}

static const char *const figure_names[FIGURES] = {
    "hold margin, mV", "read margin, mV", "write margin, mV",
    "read current, uA", "leakage, pA"};

static int accesses_cells(bench *b, const cell *cells, size_t count,
                          const margins m[2], const accesses *a,
                          opc_error *error) {
  table t = {.b = b, .rows = 2 * FIGURES * count};
  const char **q = add_texts(&t, "cell"), **quantity = add_texts(&t, "figure"),
             **where = add_texts(&t, "side");
  for (int s = 0; s < states_of(b); s++) {
    double *x = add_state(&t, "value", s, NULL, 4);
    for (size_t row = 0; row < t.rows; row++) {
      size_t i = row / 2 / FIGURES;
      int figure = (int)(row / 2 % FIGURES), side = row % 2;
      q[row] = b->circuit->net[cells[i].q];
      quantity[row] = figure_names[figure];
      where[row] = sides[side];
      if (b->has[s]) x[row] = cell_figure(m, a, figure, s, i, side);
    }
  }
  return table_publish(&t, "cells", 0, error);
}

/* Collect the values and the deviations of all cells and sides. */
static void spread_cells(const bench *b, size_t count, const margins m[2],
                         const accesses *a, int figure,
                         spread value[EDA_STATES], spread of[EDA_STATES]) {
  for (size_t i = 0; i < 2 * count; i++)
    for (int s = 0; s < EDA_STATES; s++) {
      if (!b->has[s]) continue;
      double drawn = cell_figure(m, a, figure, EDA_DRAWN, i / 2, i % 2);
      double x = cell_figure(m, a, figure, s, i / 2, i % 2);
      spread_include(&value[s], x);
      if (s) spread_include(&of[s], percent_deviation(x, drawn));
    }
}

int accesses_report(bench *b, const cell *cells, size_t count,
                    const margins m[2], const accesses *a, opc_error *error) {
  static const char *const ids[FIGURES] = {"hold_margin", "read_margin",
                                           "write_margin", "read_current",
                                           "cell_leakage"};
  table t = {.b = b, .rows = FIGURES};
  const char **quantity = add_texts(&t, "figure");
  double *drawn = add_numbers(&t, "mean drawn", NULL, 3);
  deviations changes = add_deviations(&t);
  int last = b->has[EDA_AFTER] ? EDA_AFTER : EDA_DRAWN;
  for (int s = 0; s < EDA_STATES; s++)
    for (int read = 0; read < 2 && b->has[s]; read++)
      warn_of_state(b, cells, count, m[read].of[s], s);
  for (size_t k = 0; k < FIGURES; k++) {
    spread value[EDA_STATES] = {{0}}, of[EDA_STATES] = {{0}};
    char name[32];
    spread_cells(b, count, m, a, (int)k, value, of);
    quantity[k] = figure_names[k];
    drawn[k] = mean_of(&value[EDA_DRAWN]);
    snprintf(name, sizeof name, "%s_mean", ids[k]);
    if (publish_metric(b, ids[k], mean_of(&value[last]), error) ||
        publish_metric(b, name, mean_of(&of[EDA_AFTER]), error) ||
        put_deviations(b, &changes, k, ids[k], of, error))
      return error->code;
  }
  if (publish_metric(b, "cells", (double)count, error) ||
      table_publish(&t, "memory", OPC_TABLE_PRINT, error))
    return error->code;
  return accesses_cells(b, cells, count, m, a, error);
}

size_t worst_cell(const bench *b, size_t count, const margins *m) {
  int state = b->has[EDA_AFTER] ? EDA_AFTER : EDA_DRAWN;
  size_t best = 0;
  double most = -INFINITY;
  for (size_t i = 0; i < count; i++)
    for (int side = 0; side < 2; side++) {
      double drawn = m->of[0][i].margin[side];
      double x =
          state == EDA_AFTER
              ? fabs(percent_deviation(m->of[state][i].margin[side], drawn))
              : -drawn;
      if (!(x > most)) continue;
      most = x;
      best = i;
    }
  return best;
}
