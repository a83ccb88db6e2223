/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the report of a chip: figures of all transistors, in tables whose
   number of rows does not grow with the chip. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include <correct/findings.h>
#include <correct/report.h>
#include "work.h"

/* Tolerance of |Ion deviation|, %; as in guard.c. */
static const double worse_than = 0.001;

enum { SHORT_TABLE = 24 };

/* Number of transistors with a fault, and index of the first such
   transistor. */
typedef struct fault {
  size_t count, first;
} fault;

typedef struct sums {
  groups drawn, printed;
  fault failed, lost, worse, outside;
} sums;

static void fault_add(fault *f, size_t i, size_t by) {
  if (by && !f->count) f->first = i;
  f->count += by;
}

static void sums_add(const work *w, size_t i, sums *s) {
  const eda_chip_gate *g = &w->chip->gate[i];
  const eda_chip_print *p = &w->chip->print[g->print];
  int now = eda_print_failed(p->flags),
      then = eda_print_failed(p->flags_before);
  if (!then) correct_groups_add(&s->drawn, g->type, &p->design, &p->before);
  if (!now) correct_groups_add(&s->printed, g->type, &p->design, &p->after);
  double was = fabs(eda_deviation(p->before.ion, p->design.ion));
  fault_add(&s->failed, i, now);
  fault_add(&s->lost, i, now && !then);
  fault_add(
      &s->worse, i,
      !now && !then &&
          print_deviation(p) > fmax(was, w->with->ion_limit) + worse_than);
  fault_add(&s->outside, i, !now && (p->flags & EDA_PRINT_OUTSIDE));
}

static void fault_log(const work *w, const fault *f, const char *what) {
  const eda_chip *c = w->chip;
  eda_box b = c->gate[f->first].box;
  if (f->count)
    w->host->log(w->host, OPC_LOG_FINDING,
                 "%zu of %zu transistors %s: the first at (%.10g, %.10g) nm",
                 f->count, c->count, what, ((double)b.x0 + b.x1) / 2 * c->grid,
                 ((double)b.y0 + b.y1) / 2 * c->grid);
}

/* ---- tables ---- */

/* Write a histogram of the number of transistors per class, in bins of 1, 2, 3
   to 4, 5 to 8 and so on. `prints`: 1: classes of equal masked environments; 0:
   classes of equal drawn environments. */
static int class_table(const work *w, const char *name, size_t n, int prints,
                       opc_error *error) {
  enum { SIZES = 34 };
  struct {
    int64_t most, classes, transistors;
  } row[SIZES] = {{0}};
  const eda_chip *c = w->chip;
  uint32_t *size = eda_alloc(n, sizeof *size);
  for (size_t i = 0; i < c->count; i++)
    size[prints ? c->gate[i].print : c->gate[i].mask]++;
  size_t rows = 0;
  for (size_t k = 0; k < n; k++) {
    size_t at = 0;
    if (!size[k]) continue;
    while (((uint64_t)1 << at) < size[k]) at++;
    row[at].classes++;
    row[at].transistors += size[k];
  }
  free(size);
  for (size_t at = 0; at < SIZES; at++) {
    if (!row[at].classes) continue;
    row[rows] = row[at];
    row[rows++].most = (int64_t)1 << at;
  }
  const opc_column columns[] = {
      {"transistors_at_most", NULL, OPC_INT, 0, &row->most},
      {"classes", NULL, OPC_INT, 0, &row->classes},
      {"transistors", NULL, OPC_INT, 0, &row->transistors}};
  return opc_put_rows(w->host, name, 0, rows, sizeof *row, OPC_ARRAY(columns),
                      error);
}

/* Row of the table of largest deviations. */
typedef struct print_row {
  const char *type, *print;
  int64_t transistors;
  double x, y, ion_before, ion, ioff, area, off;
} print_row;

static int by_off(const void *a, const void *b) {
  const print_row *p = a, *q = b;
  if (p->off != q->off) return p->off > q->off ? -1 : 1;
  if (p->y != q->y) return p->y < q->y ? -1 : 1;
  return (p->x > q->x) - (p->x < q->x);
}

static print_row row_of(const eda_chip *c, size_t i) {
  const eda_chip_gate *g = &c->gate[i];
  const eda_chip_print *p = &c->print[g->print];
  int none = eda_print_failed(p->flags);
  return (print_row){
      .type = g->type == EDA_PMOS ? "p" : "n",
      .print = correct_report_trouble(p->flags),
      .transistors = 1,
      .x = ((double)g->box.x0 + g->box.x1) / 2 * c->grid,
      .y = ((double)g->box.y0 + g->box.y1) / 2 * c->grid,
      .ion_before = eda_print_failed(p->flags_before)
                        ? NAN
                        : eda_deviation(p->before.ion, p->design.ion),
      .ion = none ? NAN : eda_deviation(p->after.ion, p->design.ion),
      .ioff = none ? NAN : eda_deviation(p->after.ioff, p->design.ioff),
      .area = none ? NAN : eda_deviation(p->after.area, p->design.area),
      .off = print_deviation(p)};
}

/* Largest number of rows of the table of largest deviations. */
enum { MOST_ROWS = 1000 };

static int worst_table(const work *w, opc_error *error) {
  const eda_chip *c = w->chip;
  print_row *row = eda_alloc(c->prints, sizeof *row);
  size_t n = 0;
  for (size_t i = 0; i < c->count; i++) {
    print_row *r = &row[c->gate[i].print];
    if (r->transistors++ == 0) *r = row_of(c, i);
  }
  for (size_t k = 0; k < c->prints; k++)
    if (row[k].transistors) row[n++] = row[k];
  qsort(row, n, sizeof *row, by_off);
  n = MIN(n, MOST_ROWS);
  const opc_column columns[] = {
      {"x", "nm", OPC_REAL, 1, &row->x},
      {"y", "nm", OPC_REAL, 1, &row->y},
      {"type", NULL, OPC_TEXT, 0, &row->type},
      {"transistors", NULL, OPC_INT, 0, &row->transistors},
      {"ion_before", "%", OPC_REAL, 3, &row->ion_before},
      {"ion_after", "%", OPC_REAL, 3, &row->ion},
      {"ioff_after", "%", OPC_REAL, 2, &row->ioff},
      {"area_after", "%", OPC_REAL, 2, &row->area},
      {"print", NULL, OPC_TEXT, 0, &row->print}};
  int code =
      opc_put_rows(w->host, "worst", n <= SHORT_TABLE ? OPC_TABLE_PRINT : 0, n,
                   sizeof *row, OPC_ARRAY(columns), error);
  free(row);
  return code;
}

/* ---- run ---- */

static int put_metrics(const work *w, const sums *s, opc_error *error) {
  const eda_chip *c = w->chip;
  const summary p = correct_groups_sum(&s->printed),
                d = correct_groups_sum(&s->drawn);
  const opc_metric_value values[] = {
      {"transistors", (double)c->count},
      {"windows", (double)w->windows},
      {"classes", (double)w->classes},
      {"prints", (double)c->prints},
      {"refined", (double)w->refined},
      {"sheets", (double)w->sheets},
      {isnan(p.ion_mean) ? NULL : "ion_mean", p.ion_mean},
      {isnan(p.ion_mean) ? NULL : "ion_max", p.ion_max},
      {isnan(p.ion_mean) ? NULL : "ion_stdv", p.ion_stdv},
      {isnan(d.ion_mean) ? NULL : "ion_mean_drawn", d.ion_mean},
      {isnan(d.ion_mean) ? NULL : "ion_max_drawn", d.ion_max},
      {isnan(p.ion_mean) ? NULL : "area_mean", p.area_mean},
      {isnan(p.ion_mean) ? NULL : "area_max", p.area_max},
      {isnan(p.ion_mean) ? NULL : "ioff_mean", p.ioff_mean},
      {isnan(p.ion_mean) ? NULL : "ioff_max", p.ioff_max},
      {isnan(p.ion_mean) ? NULL : "ioff_total", p.ioff_total[2]},
      {isnan(p.ioff_total[0]) ? NULL : "ioff_total_n", p.ioff_total[0]},
      {isnan(p.ioff_total[1]) ? NULL : "ioff_total_p", p.ioff_total[1]},
      {"simulations", (double)w->simulations},
      {"fine_simulations", (double)w->fine_simulations},
      {"failed", (double)s->failed.count},
      {"outside", (double)s->outside.count},
      {"worse", (double)s->worse.count},
      {"lost", (double)s->lost.count}};
  return opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

/* Check the drawn lengths and widths, which equal the sides of the gates'
   boxes. */
static void find_in_drawing(const work *w) {
  const eda_chip *c = w->chip;
  eda_gates g = {.count = c->count,
                 .type = eda_alloc(c->count, sizeof *g.type),
                 .length = eda_alloc(c->count, sizeof *g.length),
                 .width = eda_alloc(c->count, sizeof *g.width)};
  for (size_t i = 0; i < c->count; i++) {
    eda_box b = c->gate[i].box;
    double wide = (b.x1 - b.x0) * c->grid, high = (b.y1 - b.y0) * c->grid;
    int along_x = c->gate[i].axis == EDA_X;
    g.type[i] = c->gate[i].type;
    g.length[i] = along_x ? wide : high;
    g.width[i] = along_x ? high : wide;
  }
  correct_findings_of_drawing(w->host, &g, w->with->extractor);
  free(g.type);
  free(g.length);
  free(g.width);
}

int report_all(const work *w, opc_error *error) {
  sums s;
  memset(&s, 0, sizeof s);
  find_in_drawing(w);
  for (size_t i = 0; i < w->chip->count; i++) sums_add(w, i, &s);
  fault_log(w, &s.failed, "do not print as one transistor and have no figures");
  fault_log(w, &s.lost, "print with the drawn mask but not with this mask");
  fault_log(w, &s.worse,
            "deviate more than with the drawn mask and more than the limit");
  fault_log(w, &s.outside, "have figures extrapolated beyond the device table");
  if (!s.drawn.ion[2].n)
    w->host->log(w->host, OPC_LOG_FINDING,
                 "no transistor of the drawn mask prints: check the 'scale' of "
                 "the layout, that optics and resist belong to the process, "
                 "and that poly and active are not exchanged");
  int code = correct_groups_table(w->host, &s.drawn, &s.printed, error);
  if (!code) code = class_table(w, "masks", w->chip->masks, 0, error);
  if (!code) code = class_table(w, "prints", w->chip->prints, 1, error);
  if (!code) code = worst_table(w, error);
  if (!code) code = faults_report(w, error);
  return code ? code : put_metrics(w, &s, error);
}
