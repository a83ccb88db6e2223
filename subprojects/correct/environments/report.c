/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the result of a correction by classes: the mask, and its tables,
   whose size does not grow with the number of transistors. */
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

/* Smallest disturbance that counts, %; resolution of thesis figure 4.5. */
static const double disturbed = 0.05;

/* ---- the mask ---- */

static void figures_put(eda_performance *to, size_t i, const eda_figures *f) {
  to->ion[i] = f->ion;
  to->ioff[i] = f->ioff;
  to->leq_ion[i] = f->leq_ion;
  to->leq_ioff[i] = f->leq_ioff;
  to->weq[i] = f->weq;
  to->area[i] = f->area;
}

/* Renumber the prints that have transistors. Classes of earlier rounds have
   none. */
static void prints_compact(work *w) {
  eda_chip *c = w->chip;
  uint32_t *number = eda_alloc(c->prints, sizeof *number);
  class_result *results = eda_alloc(c->prints, sizeof *results);
  uint32_t n = 0;
  memset(number, 0xff, c->prints * sizeof *number);
  for (size_t i = 0; i < c->count; i++) {
    uint32_t *k = &c->gate[i].print;
    if (number[*k] == UINT32_MAX) {
      results[n] = w->print[*k];
      number[*k] = n++;
    }
    *k = number[*k];
  }
  free(w->print);
  w->print = results;
  faults_renumber(w->faults, number);
  c->prints = n;
  free(number);
}

eda_mask *report_mask(work *w) {
  prints_compact(w);
  eda_mask *m = eda_chip_mask_new(w->chip);
  for (size_t k = 0; k < m->gates->count; k++) {
    const class_result *r = &w->print[k];
    figures_put(&m->design, k, &r->design);
    figures_put(&m->before, k, &r->before);
    figures_put(&m->after, k, &r->after);
    m->after.outside[k] = (r->flags & EDA_PRINT_OUTSIDE) != 0;
    m->flags[k] = r->flags;
    m->own->length[k] = r->length;
    m->own->width[k] = r->width;
  }
  m->moved = eda_chip_moved(w->chip, m->gates);
  m->iterations = (uint32_t)w->iterations;
  m->simulations = (uint32_t)w->simulations;
  m->fine_simulations = (uint32_t)w->fine_simulations;
  return m;
}

/* ---- findings ---- */

/* Numbers of transistors that print with the drawn mask, but not with this
   mask, or with a larger deviation, and the first class of the latter. */
typedef struct sums {
  size_t lost, worse, first;
} sums;

static void sums_add(const work *w, const eda_mask *m, size_t k, sums *s) {
  const class_result *p = &w->print[k];
  double was = fabs(eda_deviation(p->before.ion, p->design.ion));
  if (eda_print_failed(p->flags_before)) return;
  if (eda_print_failed(p->flags)) {
    s->lost += m->count[k];
  } else if (print_deviation(p) > fmax(was, w->with->ion_limit) + worse_than) {
    if (!s->worse) s->first = k;
    s->worse += m->count[k];
  }
}

static void log_faults(const work *w, const eda_mask *m, const uint32_t *before,
                       const sums *s) {
  eda_box b = s->worse ? m->gates->box[s->first] : (eda_box){0};
  double grid = m->gates->grid;
  correct_findings_of_print(w->host, m->gates, m->count, m->flags, before);
  if (s->worse)
    w->host->log(w->host, OPC_LOG_FINDING,
                 "%zu of %zu transistors deviate more than with the drawn mask "
                 "and more than the limit: the first at (%.10g, %.10g) nm",
                 s->worse, m->chip->count, ((double)b.x0 + b.x1) / 2 * grid,
                 ((double)b.y0 + b.y1) / 2 * grid);
}

/* ---- tables ---- */

/* Write a histogram of the number of transistors per class, in bins of 1, 2, 3
   to 4, 5 to 8 and so on. `prints`: 1 for classes by masked environment, 0 by
   mask. */
static int class_table(const work *w, const eda_mask *m, const char *name,
                       int prints, opc_error *error) {
  enum { SIZES = 34 };
  struct {
    int64_t most, classes, transistors;
  } row[SIZES] = {{0}};
  const eda_chip *c = m->chip;
  size_t n = prints ? c->prints : c->masks;
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

/* ---- disturbance of cells ---- */

/* Row of the table: a class whose mask was made in a cell. */
typedef struct moved_row {
  int64_t number, count;
  double x, y, cell, placed, change; /* nm; %, NAN: not printed */
} moved_row;

static moved_row row_of(const work *w, const eda_mask *m, size_t k,
                        const alone *a) {
  const class_result *p = &w->print[k];
  eda_box b = m->gates->box[k];
  double in_cell = eda_deviation(a->result.after.ion, a->result.design.ion),
         placed = eda_deviation(p->after.ion, p->design.ion);
  if (eda_print_failed(p->flags)) placed = NAN;
  return (moved_row){.number = m->gates->number[k],
                     .count = m->count[k],
                     .x = ((double)b.x0 + b.x1) / 2 * m->gates->grid,
                     .y = ((double)b.y0 + b.y1) / 2 * m->gates->grid,
                     .cell = in_cell,
                     .placed = placed,
                     .change = fabs(placed) - fabs(in_cell)};
}

/* Fill the rows of all classes whose mask is, or replaced, that of a cell.
   Return their number. */
static size_t find_rows(const work *w, const eda_mask *m, moved_row *row) {
  const eda_chip *c = m->chip;
  uint8_t *seen = eda_alloc(c->prints, 1);
  size_t n = 0;
  for (size_t i = 0; i < c->count; i++) {
    size_t k = c->gate[i].print;
    const alone *a = &w->alone[c->gate[i].mask];
    if (!seen[k] && a->known && !eda_print_failed(a->result.flags))
      row[n++] = row_of(w, m, k, a);
    seen[k] = 1;
  }
  free(seen);
  return n;
}

/* Write the change of |Ion deviation| from the cell to the layout, thesis eq.
   4.1, of all classes. */
static int disturbance_report(const work *w, const eda_mask *m,
                              opc_error *error) {
  moved_row *row = eda_alloc(m->chip->prints, sizeof *row);
  size_t n = w->cells.used ? find_rows(w, m, row) : 0;
  double sum = 0, most = -INFINITY, worse = 0, count = 0;
  for (size_t k = 0; k < n; k++) {
    double by = (double)row[k].count;
    if (isnan(row[k].change)) continue;
    sum += by * row[k].change;
    most = fmax(most, row[k].change);
    worse += row[k].change >= disturbed ? by : 0;
    count += by;
  }
  const opc_column columns[] = {
      {"transistor", NULL, OPC_INT, 0, &row->number},
      {"count", NULL, OPC_INT, 0, &row->count},
      {"x", "nm", OPC_REAL, 1, &row->x},
      {"y", "nm", OPC_REAL, 1, &row->y},
      {"ion_cell", "%", OPC_REAL, 3, &row->cell},
      {"ion_placed", "%", OPC_REAL, 3, &row->placed},
      {"disturbance", "%", OPC_REAL, 3, &row->change}};
  const opc_metric_value values[] = {{"disturbance_mean", sum / count},
                                     {"disturbance_max", most},
                                     {"disturbed", 100 * worse / count}};
  int code = OPC_OK;
  if (n)
    code = opc_put_rows(w->host, "disturbance", 0, n, sizeof *row,
                        OPC_ARRAY(columns), error);
  if (!code && count > 0)
    code = opc_put_metrics(w->host, OPC_ARRAY(values), error);
  free(row);
  return code;
}

/* ---- run ---- */

static int put_metrics(const work *w, const eda_mask *m, const sums *s,
                       opc_error *error) {
  const opc_metric_value values[] = {{"windows", (double)w->windows},
                                     {"classes", (double)w->classes},
                                     {"prints", (double)m->gates->count},
                                     {"refined", (double)w->refined},
                                     {"sheets", (double)w->sheets},
                                     {"worse", (double)s->worse},
                                     {"lost", (double)s->lost}};
  return opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

/* Write the tables that each mask has, with one row for each class. */
static int report_classes(const work *w, const eda_mask *m, const sums *s,
                          opc_error *error) {
  size_t n = m->gates->count;
  trial none;
  uint32_t *before = eda_alloc(n, sizeof *before);
  double *extension = eda_alloc(2 * n, sizeof *extension);
  for (size_t k = 0; k < n; k++) {
    before[k] = w->print[k].flags_before;
    extension[2 * k] = w->print[k].extension[0];
    extension[2 * k + 1] = w->print[k].extension[1];
  }
  correct_trial_init(&none, m->layers, n);
  none.biases.base = m->moved;
  const report content = {.mask = m,
                          .extension = extension,
                          .biases = &none.biases,
                          .flags_before = before};
  log_faults(w, m, before, s);
  int code = correct_report_mask(w->host, &content, error);
  correct_trial_clear(&none);
  free(extension);
  free(before);
  return code;
}

int report_all(const work *w, eda_mask *m, opc_error *error) {
  sums s = {0};
  correct_findings_of_drawing(w->host, m->gates, w->with->extractor);
  for (size_t k = 0; k < m->gates->count; k++) sums_add(w, m, k, &s);
  int code = report_classes(w, m, &s, error);
  if (!code) code = class_table(w, m, "masks", 0, error);
  if (!code) code = class_table(w, m, "environments", 1, error);
  if (!code && w->cells.verify) code = disturbance_report(w, m, error);
  if (!code) code = faults_report(w, error);
  return code ? code : put_metrics(w, m, &s, error);
}
