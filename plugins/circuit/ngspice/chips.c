/* SPDX-License-Identifier: BSD-3-Clause */
/* Distribution of the figures of memory cells over sampled chips: each chip is
   simulated with the sizes of its transistors. */
#include <math.h>
#include <stdlib.h>

#include "bench.h"

enum { HOLD, READ, WRITE, CURRENT, FIGURES };

static const char *const names[FIGURES] = {"hold margin, mV", "read margin, mV",
                                           "write margin, mV",
                                           "read current, uA"};

/* A chip and a cell: the smaller figures of both sides; a cell that does not
   hold its value has figures of 0. */
typedef struct chip_row {
  int64_t chip;
  const char *cell;
  double figure[FIGURES];
} chip_row;

static double smaller(const double side[2]) {
  return isnan(side[0]) || isnan(side[1]) ? 0 : fmin(side[0], side[1]);
}

static void row_fill(chip_row *r, const margins m[2], const accesses *a,
                     int state, size_t i) {
  r->figure[HOLD] = 1e3 * smaller(m[0].of[state][i].margin);
  r->figure[READ] = 1e3 * smaller(m[1].of[state][i].margin);
  r->figure[WRITE] = 1e3 * smaller(a->of[state][i].write);
  r->figure[CURRENT] = 1e6 * smaller(a->of[state][i].read);
}

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Mean, standard deviation and quantiles of a figure; number of cells with a
   figure of 0. */
typedef struct figure_row {
  const char *name;
  double drawn, mean, sigma, least, low, median, high;
  int64_t failed;
} figure_row;

static figure_row figure_of(const chip_row *r, size_t n, int figure) {
  figure_row f = {.name = names[figure]};
  double *x = g_new(double, n), square = 0;
  for (size_t i = 0; i < n; i++) {
    x[i] = r[i].figure[figure];
    f.mean += x[i] / (double)n;
    f.failed += !(x[i] > 0);
  }
  for (size_t i = 0; i < n; i++) square += pow(x[i] - f.mean, 2);
  f.sigma = n > 1 ? sqrt(square / (double)(n - 1)) : 0;
  qsort(x, n, sizeof *x, by_size);
  f.least = x[0];
  f.low = x[n / 100];
  f.median = (x[n / 2] + x[(n - 1) / 2]) / 2;
  f.high = x[n - 1 - n / 100];
  g_free(x);
  return f;
}

/* Return the number of cells that do not hold, or are lost by a read. */
static size_t count_failed(const chip_row *r, size_t n) {
  size_t failed = 0;
  for (size_t i = 0; i < n; i++)
    failed += !(r[i].figure[HOLD] > 0 && r[i].figure[READ] > 0);
  return failed;
}

static int chips_report(const bench *b, const chip_row *r, size_t n,
                        const chip_row *drawn, size_t cells, opc_error *error) {
  figure_row f[FIGURES];
  for (int k = 0; k < FIGURES; k++) {
    f[k] = figure_of(r, n, k);
    f[k].drawn = figure_of(drawn, cells, k).mean;
  }
  const opc_column all[] = {
      {"chip", NULL, OPC_INT, 0, &r->chip},
      {"cell", NULL, OPC_TEXT, 0, &r->cell},
      {"hold margin", "mV", OPC_REAL, 4, &r->figure[HOLD]},
      {"read margin", "mV", OPC_REAL, 4, &r->figure[READ]},
      {"write margin", "mV", OPC_REAL, 4, &r->figure[WRITE]},
      {"read current", "uA", OPC_REAL, 5, &r->figure[CURRENT]}};
  const opc_column columns[] = {{"figure", NULL, OPC_TEXT, 0, &f->name},
                                {"drawn", NULL, OPC_REAL, 3, &f->drawn},
                                {"mean", NULL, OPC_REAL, 3, &f->mean},
                                {"sigma", NULL, OPC_REAL, 3, &f->sigma},
                                {"least", NULL, OPC_REAL, 3, &f->least},
                                {"q1", NULL, OPC_REAL, 3, &f->low},
                                {"median", NULL, OPC_REAL, 3, &f->median},
                                {"q99", NULL, OPC_REAL, 3, &f->high},
                                {"failed", NULL, OPC_INT, 0, &f->failed}};
  const opc_metric_value values[] = {
      {"hold_margin_sigma", f[HOLD].sigma},
      {"read_margin_sigma", f[READ].sigma},
      {"write_margin_sigma", f[WRITE].sigma},
      {"read_current_sigma", f[CURRENT].sigma},
      {"failed_cells", (double)count_failed(r, n)}};
  int code = opc_put_rows(b->host, "chips", OPC_TABLE_PRINT, FIGURES, sizeof *f,
                          OPC_ARRAY(columns), error);
  if (!code)
    code = opc_put_rows(b->host, "chip_cells", 0, n, sizeof *r, OPC_ARRAY(all),
                        error);
  return code ? code : opc_put_metrics(b->host, OPC_ARRAY(values), error);
}

static int chips_simulate(bench *b, const cell *cells, size_t count,
                          chip_row *r, margins m[2], accesses *a,
                          opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < b->chips->count && !code; k++) {
    const eda_performance *p = &b->chips->of[k];
    b->sized.after.leq_ion = p->leq_ion;
    b->sized.after.leq_ioff = p->leq_ion; /* the leakage is not reported */
    b->sized.after.weq = p->weq;
    b->sized.after.area = p->area;
    code = cells_measure(b, cells, count, m, a, error);
    for (size_t i = 0; i < count && !code; i++) {
      chip_row *one = &r[k * count + i];
      *one = (chip_row){.chip = (int64_t)k + 1,
                        .cell = b->circuit->net[cells[i].q]};
      row_fill(one, m, a, EDA_AFTER, i);
    }
  }
  return code;
}

int chips_find(bench *b, const cell *cells, size_t count, margins m[2],
               accesses *a, opc_error *error) {
  size_t n = b->chips->count * count;
  chip_row *drawn = g_new0(chip_row, count), *r = g_new0(chip_row, n);
  for (size_t i = 0; i < count; i++) row_fill(&drawn[i], m, a, EDA_DRAWN, i);
  const eda_mask *printed = b->printed;
  int has[EDA_STATES];
  for (int s = 0; s < EDA_STATES; s++) {
    has[s] = b->has[s];
    b->has[s] = s == EDA_AFTER;
  }
  b->sized = *b->mask;
  b->printed = &b->sized;
  int code = chips_simulate(b, cells, count, r, m, a, error);
  for (int s = 0; s < EDA_STATES; s++) b->has[s] = has[s];
  b->printed = printed;
  if (!code) code = chips_report(b, r, n, drawn, count, error);
  g_free(drawn);
  g_free(r);
  return code;
}
