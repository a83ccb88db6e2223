/* SPDX-License-Identifier: BSD-3-Clause */
/* What is told: every figure in a table, their means and worst in another one
   and in metrics. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench.h"

double deviation(double a, double b) {
  return b > 0 ? 100 * (a - b) / b : (double)NAN;
}

/* ---- deviations of many figures ---- */

/* Mean, and the largest with its sign; how many there are. */
typedef struct spread {
  double mean, worst;
  int64_t count;
} spread;

static void add(spread *s, double x) {
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

static int metric(const bench *b, const char *name, double value,
                  opc_error *error) {
  if (isnan(value)) return OPC_OK;
  return b->host->metric(b->host, name, value, error);
}

/* "tr_worst" of the corrected mask, "tr_worst_before" of the other one. */
static int worst_metric(const bench *b, const char *quantity, int state,
                        double worst, opc_error *error) {
  char name[64];
  snprintf(name, sizeof name, "%s_worst%s", quantity,
           state == NETLIST_BEFORE ? "_before" : "");
  return metric(b, name, fabs(worst), error);
}

static double *column(bench *b, size_t rows, opc_error *error) {
  double *x = bench_alloc(b, rows, sizeof *x, error);
  for (size_t i = 0; x && i < rows; i++) x[i] = NAN;
  return x;
}

/* ---- delays ---- */

enum { TR, TF, TPLH, TPHL, TP, QUANTITIES };

/* Of tp, those of both directions. */
static int is_of(const arrival *a, int quantity) {
  return quantity == TP || a->rises == (quantity == TR || quantity == TPLH);
}

static const double *value_of(const arrival *a, int quantity) {
  return quantity == TR || quantity == TF ? a->slope : a->delay;
}

static int tell_quantities(bench *b, const delays *d, opc_error *error) {
  static const char *const names[QUANTITIES] = {
      "rise time", "fall time", "delay, rising", "delay, falling", "delay"};
  static const char *const ids[QUANTITIES] = {"tr", "tf", "tplh", "tphl", "tp"};
  int64_t count[QUANTITIES];
  double drawn[QUANTITIES], mean[STATES][QUANTITIES], worst[STATES][QUANTITIES];
  for (int q = 0; q < QUANTITIES; q++) {
    spread of[STATES] = {{0}};
    for (size_t i = 0; i < d->count; i++) {
      const arrival *a = &d->arrival[i];
      const double *v = value_of(a, q);
      if (!is_of(a, q)) continue;
      add(&of[0], v[0]);
      for (int s = 1; s < STATES; s++)
        if (b->has[s]) add(&of[s], deviation(v[s], v[0]));
    }
    count[q] = of[0].count;
    drawn[q] = 1e12 * mean_of(&of[0]);
    if (metric(b, ids[q], drawn[q], error)) return error->code;
    for (int s = 1; s < STATES; s++) {
      mean[s][q] = mean_of(&of[s]);
      worst[s][q] = worst_of(&of[s]);
      if (worst_metric(b, ids[q], s, worst[s][q], error)) return error->code;
    }
  }
  const opc_column columns[] = {
      {"quantity", NULL, OPC_TEXT, 0, names},
      {"transitions", NULL, OPC_INT, 0, count},
      {"drawn", "ps", OPC_REAL, 3, drawn},
      {"worst before", "%", OPC_REAL, 3, worst[NETLIST_BEFORE]},
      {"worst after", "%", OPC_REAL, 3, worst[NETLIST_AFTER]},
      {"mean before", "%", OPC_REAL, 3, mean[NETLIST_BEFORE]},
      {"mean after", "%", OPC_REAL, 3, mean[NETLIST_AFTER]},
  };
  size_t shown = b->mask ? sizeof columns / sizeof *columns : 3;
  return b->host->table(b->host, "performance", OPC_TABLE_PRINT, QUANTITIES,
                        columns, shown, error);
}

static int tell_arrivals(bench *b, const patterns *p, const delays *d,
                         opc_error *error) {
  static const char *const ways[] = {"falls", "rises"};
  size_t n = d->count;
  const char **inputs = bench_alloc(b, n, sizeof *inputs, error);
  const char **output = bench_alloc(b, n, sizeof *output, error);
  const char **way = bench_alloc(b, n, sizeof *way, error);
  double *x[2][STATES], *change[2][STATES];
  for (int s = 0; s < STATES; s++)
    for (int k = 0; k < 2; k++) {
      x[k][s] = column(b, n, error);
      change[k][s] = column(b, n, error);
      if (!x[k][s] || !change[k][s]) return error->code;
    }
  if (!inputs || !output || !way) return error->code;
  for (size_t i = 0; i < n; i++) {
    const arrival *a = &d->arrival[i];
    inputs[i] = patterns_say(b, p, p->transition[d->flip[a->flip]]);
    output[i] = b->circuit->net[b->output[a->output]];
    way[i] = ways[a->rises];
    for (int s = 0; s < STATES; s++)
      for (int k = 0; b->has[s] && k < 2; k++) {
        const double *v = k ? a->slope : a->delay;
        x[k][s][i] = 1e12 * v[s];
        change[k][s][i] = deviation(v[s], v[0]);
      }
  }
  const opc_column columns[] = {
      {"inputs", NULL, OPC_TEXT, 0, inputs},
      {"output", NULL, OPC_TEXT, 0, output},
      {"way", NULL, OPC_TEXT, 0, way},
      {"delay drawn", "ps", OPC_REAL, 4, x[0][0]},
      {"slope drawn", "ps", OPC_REAL, 4, x[1][0]},
      {"delay before", "ps", OPC_REAL, 4, x[0][1]},
      {"delay before", "%", OPC_REAL, 3, change[0][1]},
      {"slope before", "ps", OPC_REAL, 4, x[1][1]},
      {"slope before", "%", OPC_REAL, 3, change[1][1]},
      {"delay after", "ps", OPC_REAL, 4, x[0][2]},
      {"delay after", "%", OPC_REAL, 3, change[0][2]},
      {"slope after", "ps", OPC_REAL, 4, x[1][2]},
      {"slope after", "%", OPC_REAL, 3, change[1][2]},
  };
  size_t shown = b->mask ? sizeof columns / sizeof *columns : 5;
  return b->host->table(b->host, "delays", 0, n, columns, shown, error);
}

int tell_delays(bench *b, const patterns *p, const delays *d,
                opc_error *error) {
  size_t missing = 0, early = 0;
  for (size_t i = 0; i < d->count; i++) {
    const arrival *a = &d->arrival[i];
    int lost = 0;
    for (int s = 0; s < STATES; s++)
      if (b->has[s] && isnan(a->delay[s])) lost = 1;
    missing += (size_t)lost;
    early += a->delay[0] <= 0;
  }
  if (missing)
    b->host->log(b->host, OPC_LOG_WARNING,
                 "%zu of %zu outputs did not get there and are left out",
                 missing, d->count);
  if (early)
    b->host->log(b->host, OPC_LOG_WARNING,
                 "%zu of %zu delays are not above 0 as drawn and have no "
                 "deviation: a shorter 'slew' helps",
                 early, d->count);
  if (metric(b, "transitions", (double)d->flips, error) ||
      metric(b, "unmeasured", (double)missing, error) ||
      tell_quantities(b, d, error))
    return error->code;
  return tell_arrivals(b, p, d, error);
}

int64_t worst_arrival(const delays *d, const bench *b, int rises) {
  int state = b->has[NETLIST_AFTER] ? NETLIST_AFTER : NETLIST_DRAWN;
  int64_t best = -1;
  double most = -1;
  for (size_t i = 0; i < d->count; i++) {
    const arrival *a = &d->arrival[i];
    /* As drawn there is no deviation: the slowest. */
    double x = state == NETLIST_AFTER
                   ? fabs(deviation(a->delay[state], a->delay[0]))
                   : a->delay[0] + 1;
    if (a->rises != rises || !(x > most)) continue;
    most = x;
    best = (int64_t)i;
  }
  return best;
}

/* ---- leakage ---- */

int tell_leakage(bench *b, const patterns *p, const logic *l,
                 opc_error *error) {
  const opc_host *host = b->host;
  size_t n = p->count;
  double *current[STATES], *power[STATES], *change[STATES], most = 0;
  spread all[STATES] = {{0}}, watts = {0};
  const char **inputs = bench_alloc(b, n, sizeof *inputs, error);
  if (!inputs) return error->code;
  for (int s = 0; s < STATES; s++) {
    current[s] = column(b, n, error);
    power[s] = column(b, n, error);
    change[s] = column(b, n, error);
    if (!current[s] || !power[s] || !change[s]) return error->code;
    for (size_t i = 0; b->has[s] && i < n; i++) {
      current[s][i] = 1e9 * l->current[s][i];
      power[s][i] = 1e9 * l->power[s][i];
      change[s][i] = deviation(l->current[s][i], l->current[0][i]);
      add(&all[s], s ? change[s][i] : l->current[s][i]);
      if (!s) add(&watts, l->power[s][i]);
    }
  }
  for (size_t i = 0; i < n; i++) {
    inputs[i] = patterns_say(b, p, (transition){(uint32_t)i, (uint32_t)i});
    most = fmax(most, l->current[0][i]);
  }
  if (metric(b, "leakage", mean_of(&all[0]), error) ||
      metric(b, "leakage_most", most, error) ||
      metric(b, "power", mean_of(&watts), error) ||
      worst_metric(b, "leakage", 1, worst_of(&all[1]), error) ||
      worst_metric(b, "leakage", 2, worst_of(&all[2]), error) ||
      metric(b, "leakage_mean_before", mean_of(&all[1]), error) ||
      metric(b, "leakage_mean", mean_of(&all[2]), error))
    return error->code;
  const opc_column columns[] = {
      {"inputs", NULL, OPC_TEXT, 0, inputs},
      {"leakage drawn", "nA", OPC_REAL, 4, current[0]},
      {"power drawn", "nW", OPC_REAL, 4, power[0]},
      {"leakage before", "nA", OPC_REAL, 4, current[1]},
      {"leakage before", "%", OPC_REAL, 2, change[1]},
      {"power before", "nW", OPC_REAL, 4, power[1]},
      {"leakage after", "nA", OPC_REAL, 4, current[2]},
      {"leakage after", "%", OPC_REAL, 2, change[2]},
      {"power after", "nW", OPC_REAL, 4, power[2]},
  };
  size_t shown = b->mask ? sizeof columns / sizeof *columns : 3;
  return host->table(host, "leakage", n <= 16 ? OPC_TABLE_PRINT : 0, n, columns,
                     shown, error);
}

/* ---- noise margins ---- */

static const char *const sides[] = {"left", "right"};

static int tell_cells(bench *b, const cell *cells, size_t count,
                      const margins *m, opc_error *error) {
  static const char *const states[STATES] = {"drawn", "before", "after"};
  char names[2 * STATES][2][24];
  opc_column columns[1 + 4 * STATES];
  size_t n = 0;
  const char **q = bench_alloc(b, count, sizeof *q, error);
  if (!q) return error->code;
  columns[n++] = (opc_column){"cell", NULL, OPC_TEXT, 0, q};
  for (size_t i = 0; i < count; i++) q[i] = b->circuit->net[cells[i].q];
  for (int s = 0; s < (b->mask ? STATES : 1); s++)
    for (int side = 0; side < 2; side++) {
      double *x = column(b, count, error), *change = column(b, count, error);
      char *name = names[2 * s + side][0];
      if (!x || !change) return error->code;
      for (size_t i = 0; b->has[s] && i < count; i++) {
        x[i] = 1e3 * m->of[s][i].margin[side];
        change[i] =
            deviation(m->of[s][i].margin[side], m->of[0][i].margin[side]);
      }
      snprintf(name, sizeof names[0][0], "%s %s", sides[side], states[s]);
      columns[n++] = (opc_column){name, "mV", OPC_REAL, 3, x};
      if (s) columns[n++] = (opc_column){name, "%", OPC_REAL, 3, change};
    }
  return b->host->table(b->host, "margins", 0, count, columns, n, error);
}

static void warn_of_state(const bench *b, const cell *cells, size_t count,
                          const butterfly *f, int state) {
  static const char *const when[STATES] = {"", " before correction",
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

int tell_margins(bench *b, const cell *cells, size_t count, const margins *m,
                 opc_error *error) {
  double least[2], mean[STATES][2], worst[STATES][2];
  for (int s = 0; s < STATES; s++)
    if (b->has[s]) warn_of_state(b, cells, count, m->of[s], s);
  for (int side = 0; side < 2; side++) {
    spread of[STATES] = {{0}};
    char name[32];
    least[side] = INFINITY;
    for (size_t i = 0; i < count; i++) {
      double drawn = m->of[0][i].margin[side];
      least[side] = fmin(least[side], 1e3 * drawn);
      for (int s = 1; s < STATES; s++)
        if (b->has[s]) add(&of[s], deviation(m->of[s][i].margin[side], drawn));
    }
    snprintf(name, sizeof name, "snm_%s", sides[side]);
    if (metric(b, name, least[side], error)) return error->code;
    for (int s = 1; s < STATES; s++) {
      mean[s][side] = mean_of(&of[s]);
      worst[s][side] = worst_of(&of[s]);
      if (worst_metric(b, name, s, worst[s][side], error)) return error->code;
    }
  }
  const opc_column columns[] = {
      {"margin", NULL, OPC_TEXT, 0, sides},
      {"least drawn", "mV", OPC_REAL, 2, least},
      {"worst before", "%", OPC_REAL, 3, worst[NETLIST_BEFORE]},
      {"worst after", "%", OPC_REAL, 3, worst[NETLIST_AFTER]},
      {"mean before", "%", OPC_REAL, 3, mean[NETLIST_BEFORE]},
      {"mean after", "%", OPC_REAL, 3, mean[NETLIST_AFTER]},
  };
  size_t shown = b->mask ? sizeof columns / sizeof *columns : 2;
  if (metric(b, "cells", (double)count, error) ||
      b->host->table(b->host, "snm", OPC_TABLE_PRINT, 2, columns, shown, error))
    return error->code;
  return tell_cells(b, cells, count, m, error);
}

size_t worst_cell(const bench *b, size_t count, const margins *m) {
  int state = b->has[NETLIST_AFTER] ? NETLIST_AFTER : NETLIST_DRAWN;
  size_t best = 0;
  double most = -INFINITY;
  for (size_t i = 0; i < count; i++)
    for (int side = 0; side < 2; side++) {
      double drawn = m->of[0][i].margin[side];
      double x = state == NETLIST_AFTER
                     ? fabs(deviation(m->of[state][i].margin[side], drawn))
                     : -drawn;
      if (!(x > most)) continue;
      most = x;
      best = i;
    }
  return best;
}
