/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the collection of rule violations of printed images and masks. A
   violation belongs to the nearest transistor. The violation is stored with the
   print (class of equal masked environments) of that transistor and applies to
   all transistors of the print. */
#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include <correct/rules.h>
#include "work.h"

/* Kind of a record for the regulator's rules; the text of the rule follows the
   record. */
enum { TEXT = UINT32_MAX };

/* Record of a violation in a work unit; `size`: length of the text. */
typedef struct kept {
  uint32_t place, kind, size, unused;
  double value, limit;
} kept;

/* A violation in a print of the chip. */
typedef struct fault {
  uint32_t print, kind;
  double value, limit;
} fault;

struct faults {
  GArray *fault;
  GPtrArray *rule; /* texts of the regulator's rules, kinds from first_text */
};

faults *faults_new(void) {
  faults *f = eda_alloc(1, sizeof *f);
  f->fault = g_array_new(FALSE, FALSE, sizeof(fault));
  f->rule = g_ptr_array_new_with_free_func(g_free);
  return f;
}

void faults_free(faults *f) {
  g_array_free(f->fault, TRUE);
  g_ptr_array_free(f->rule, TRUE);
  free(f);
}

/* Return the kind of a mask rule violation in a layer. `drawn`: 1 for the drawn
   layer, 0 for the mask. */
static uint32_t kind_of(size_t layer, int rule, int drawn) {
  return (uint32_t)((layer * EDA_RULES + (size_t)rule) * 2 + (size_t)!drawn);
}

static uint32_t first_text(const work *w) {
  return kind_of(w->chip->layers, 0, 1);
}

/* ---- violations on a sheet ---- */

typedef struct finder {
  const work *work;
  const sheet *sheet;
  eda_index *index;
  opc_bytes *out;
} finder;

static double distance_beyond(int32_t low, int32_t high, double at) {
  return fmax(fmax(low - at, at - high), 0);
}

/* Return the place of the transistor nearest to (x, y), at most half the margin
   away, because beyond that distance a transistor omitted from the sheet may be
   nearer. Return UINT32_MAX if there is no such transistor, or if this sheet
   does not verify it. */
static uint32_t place_of(const finder *f, double x, double y) {
  const eda_gates *g = f->sheet->gates;
  double least = INFINITY;
  uint32_t nearest = UINT32_MAX;
  int32_t reach = f->work->margin / 2;
  x = round(x / g->grid), y = round(y / g->grid);
  const eda_box at = {(int32_t)x, (int32_t)y, (int32_t)x, (int32_t)y};
  eda_finder find = eda_index_find(f->index, eda_box_grown(at, reach));
  for (uint32_t i; eda_index_next(&find, &i);) {
    eda_box b = g->box[i];
    double d =
        hypot(distance_beyond(b.x0, b.x1, x), distance_beyond(b.y0, b.y1, y));
    if (d > reach || d > least || (d == least && i > nearest)) continue;
    least = d;
    nearest = i;
  }
  return nearest == UINT32_MAX ? UINT32_MAX : f->sheet->place[nearest];
}

static void finder_add(const finder *f, double x, double y, kept one,
                       const char *text) {
  one.place = place_of(f, x, y);
  if (one.place == UINT32_MAX) return;
  one.size = (uint32_t)strlen(text);
  f->out->add(f->out, &one, sizeof one);
  f->out->add(f->out, text, one.size);
}

static void keep_mask(const finder *f, size_t layer, const eda_shapes *shapes,
                      int drawn) {
  eda_rule_fault *v;
  const double *limit = f->work->with->rules;
  size_t n = eda_rules_check(shapes, f->work->chip->grid, limit, &v);
  for (size_t i = 0; i < n; i++)
    finder_add(f, v[i].x, v[i].y,
               (kept){.kind = kind_of(layer, v[i].rule, drawn),
                      .value = v[i].value,
                      .limit = limit[v[i].rule]},
               "");
  free(v);
}

static int keep_violations(const finder *f, const eda_printed *printed,
                           opc_error *error) {
  const work *w = f->work;
  size_t n = 0;
  eda_violation *v = NULL;
  int code = correct_violations(w->host->context, w->with->regulator, printed,
                                &v, &n, error);
  for (size_t i = 0; !code && i < n; i++)
    finder_add(f, v[i].x, v[i].y,
               (kept){.kind = TEXT, .value = v[i].value, .limit = v[i].limit},
               v[i].rule);
  free(v);
  return code;
}

int faults_find(const work *w, const sheet *s, const eda_printed *printed,
                opc_bytes *out, opc_error *error) {
  const eda_gates *g = s->gates;
  finder f = {w, s, eda_index_new(g->box, g->count, 0), out};
  for (size_t k = 0; k < g->layers; k++) {
    if (!g->corrected[k]) continue;
    keep_mask(&f, k, &g->drawn[k], 1);
    keep_mask(&f, k, &printed->shapes[k], 0);
  }
  int code = w->with->regulator ? keep_violations(&f, printed, error) : OPC_OK;
  eda_index_free(f.index);
  return code;
}

/* ---- results ---- */

static uint32_t text_of(work *w, const char *text, size_t size) {
  GPtrArray *rule = w->faults->rule;
  g_autofree char *copy = g_strndup(text, size);
  guint k;
  if (!g_ptr_array_find_with_equal_func(rule, copy, g_str_equal, &k)) {
    k = rule->len;
    g_ptr_array_add(rule, g_steal_pointer(&copy));
  }
  return first_text(w) + k;
}

void faults_take(work *w, size_t first, const char *at, const char *end) {
  for (kept one; at < end; at += one.size) {
    memcpy(&one, at, sizeof one);
    at += sizeof one;
    const fault of = {
        .print = (uint32_t)first + one.place,
        .kind = one.kind == TEXT ? text_of(w, at, one.size) : one.kind,
        .value = one.value,
        .limit = one.limit};
    w->print[of.print].violations += one.kind == TEXT;
    g_array_append_val(w->faults->fault, of);
  }
}

void faults_renumber(faults *f, const uint32_t *number) {
  guint n = 0;
  fault *all = (fault *)(void *)f->fault->data;
  for (guint k = 0; k < f->fault->len; k++) {
    all[n] = all[k];
    all[n].print = number[all[k].print];
    n += all[n].print != UINT32_MAX;
  }
  g_array_set_size(f->fault, n);
}

void faults_put(const work *w, eda_mask *m) {
  const GArray *all = w->faults->fault;
  eda_violation *v = eda_alloc(all->len, sizeof *v);
  size_t n = 0;
  for (guint k = 0; k < all->len; k++) {
    const fault *f = &g_array_index(all, fault, k);
    if (f->kind < first_text(w)) continue;
    eda_box b = m->gates->box[f->print];
    v[n++] = (eda_violation){
        .rule = g_ptr_array_index(w->faults->rule, f->kind - first_text(w)),
        .gate = (int32_t)f->print,
        .x = ((double)b.x0 + b.x1) / 2 * m->gates->grid,
        .y = ((double)b.y0 + b.y1) / 2 * m->gates->grid,
        .value = f->value,
        .limit = f->limit};
  }
  eda_mask_set_violations(m, v, n);
  free(v);
}

/* ---- report ---- */

/* Number of violations of a kind, the first transistor with such a violation,
   and the worst value. */
typedef struct tally {
  size_t count, first;
  double value, limit;
} tally;

static tally *count_all(const work *w) {
  const eda_chip *c = w->chip;
  const GArray *all = w->faults->fault;
  size_t *size = eda_alloc(c->prints, sizeof *size),
         *first = eda_alloc(c->prints, sizeof *first);
  tally *out = eda_alloc(first_text(w) + w->faults->rule->len, sizeof *out);
  for (size_t i = c->count; i-- > 0;) {
    size[c->gate[i].print]++;
    first[c->gate[i].print] = i;
  }
  for (guint k = 0; k < all->len; k++) {
    const fault *f = &g_array_index(all, fault, k);
    tally *t = &out[f->kind];
    if (!t->count || first[f->print] < t->first) t->first = first[f->print];
    if (!t->count || fabs(f->value - f->limit) > fabs(t->value - t->limit)) {
      t->value = f->value;
      t->limit = f->limit;
    }
    t->count += size[f->print];
  }
  free(size);
  free(first);
  return out;
}

static double tally_middle(const work *w, const tally *t, int d) {
  eda_box b = w->chip->gate[t->first].box;
  double twice = d == EDA_X ? (double)b.x0 + b.x1 : (double)b.y0 + b.y1;
  return t->count ? twice / 2 * w->chip->grid : NAN;
}

static int report_masks(const work *w, const tally *all, opc_error *error) {
  const eda_chip *c = w->chip;
  rules_row *row = eda_alloc(c->layers * EDA_RULES, sizeof *row);
  size_t n = 0;
  for (size_t k = 0; k < c->layers; k++)
    for (int rule = 0; c->corrected[k] && rule < EDA_RULES; rule++) {
      const tally *t = &all[kind_of(k, rule, 0)];
      row[n++] = (rules_row){.layer = c->layer[k],
                             .rule = eda_rule_name(rule),
                             .limit = w->with->rules[rule],
                             .drawn = (int64_t)all[kind_of(k, rule, 1)].count,
                             .count = (int64_t)t->count,
                             .least = t->count ? t->value : NAN,
                             .x = tally_middle(w, t, EDA_X),
                             .y = tally_middle(w, t, EDA_Y)};
    }
  int code = correct_rules_table(w->host, row, n, error);
  free(row);
  return code;
}

typedef struct text_row {
  const char *rule;
  int64_t places;
  double x, y, value, limit;
} text_row;

/* Write the violations of the regulator's rules, one row for each rule. */
static int report_texts(const work *w, const tally *all, opc_error *error) {
  const GPtrArray *rule = w->faults->rule;
  text_row *row = eda_alloc(rule->len, sizeof *row);
  size_t n = 0, count = 0, unexplained = 0;
  for (guint k = 0; k < rule->len; k++) {
    const tally *t = &all[first_text(w) + k];
    text_row r = {g_ptr_array_index(rule, k),
                  (int64_t)t->count,
                  tally_middle(w, t, EDA_X),
                  tally_middle(w, t, EDA_Y),
                  t->value,
                  t->limit};
    if (!t->count) continue;
    row[n++] = r;
    count += t->count;
    if (!strchr(r.rule, ';'))
      unexplained += t->count;
    else
      w->host->log(w->host, OPC_LOG_FINDING,
                   "%zu location%s cannot meet a rule: %s; the first is beside "
                   "the transistor at (%g, %g) nm",
                   t->count, t->count == 1 ? "" : "s", r.rule, r.x, r.y);
  }
  if (count)
    w->host->log(
        w->host, OPC_LOG_WARNING,
        "%zu rule violation%s, %zu without a known cause: see violations.csv",
        count, count == 1 ? "" : "s", unexplained);
  const opc_column columns[] = {{"rule", NULL, OPC_TEXT, 0, &row->rule},
                                {"places", NULL, OPC_INT, 0, &row->places},
                                {"x", "nm", OPC_REAL, 1, &row->x},
                                {"y", "nm", OPC_REAL, 1, &row->y},
                                {"value", "nm", OPC_REAL, 2, &row->value},
                                {"limit", "nm", OPC_REAL, 2, &row->limit}};
  int code = n ? opc_put_rows(w->host, "violations", OPC_TABLE_PRINT, n,
                              sizeof *row, OPC_ARRAY(columns), error)
               : OPC_OK;
  free(row);
  const opc_metric_value values[] = {
      {"violations", (double)count},
      {"violations_unexplained", (double)unexplained}};
  return code ? code : opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

int faults_report(const work *w, opc_error *error) {
  tally *all = count_all(w);
  int code = w->with->regulator ? report_texts(w, all, error) : OPC_OK;
  if (!code) code = report_masks(w, all, error);
  free(all);
  return code;
}
