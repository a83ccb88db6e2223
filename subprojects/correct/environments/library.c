/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the correction of cells alone (thesis 4.2.1). The results store
   contains the masks and figures of the transistors of each cell under a hash
   of all inputs, so that other layouts reuse them. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <opcflow/results.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include <correct/start.h>
#include "cells.h"
#include "correction.h"

typedef struct library {
  work *work;
  cells cells;
  uint32_t *mask; /* [classes], new masks */
  char *settings; /* checksum of models and settings; NULL: not kept */
  size_t corrected;
} library;

/* ---- keys ---- */

/* Return a text that identifies the models, synthesizer and settings of a
   correction; NULL if one of them depends on an input. */
static char *settings_of(const work *w) {
  static const char *const slots[] = {"litho", "resist", "extractor",
                                      "synthesizer", "regulator"};
  const opc_results *results = opc_get_results(w->host);
  const correct_settings *s = w->with;
  if (!results) return NULL;
  g_autoptr(GString) all = g_string_new("cell");
  for (size_t k = 0; k < G_N_ELEMENTS(slots); k++) {
    opc_error error;
    if (!s->regulator && k + 1 == G_N_ELEMENTS(slots)) break;
    const char *sum = results->identity(w->host, slots[k], &error);
    if (!sum) return NULL;
    g_string_append_printf(all, " %s", sum);
  }
  g_string_append_printf(all, " %d %d %a %s %a %a %d", w->margin, w->radius,
                         w->chip->grid, s->fine_text ? s->fine_text : "",
                         s->fine, s->ion_limit, s->guard);
  g_string_append_printf(all, " %d", (int)s->max_iterations);
  for (int k = 0; k < EDA_RULES; k++)
    g_string_append_printf(all, " %a", s->rules[k]);
  return g_compute_checksum_for_string(G_CHECKSUM_SHA256, all->str, -1);
}

/* Return the key of a cell's result; NULL: not kept. */
static char *key_of(const library *l, const cell *c) {
  if (!l->settings) return NULL;
  g_autofree char *sum = cells_sum(c->gates);
  g_autofree char *all = g_strconcat(l->settings, " ", sum, NULL);
  return g_compute_checksum_for_string(G_CHECKSUM_SHA256, all, -1);
}

/* ---- one cell ---- */

static void take_figures(const loop *l, alone *out) {
  const eda_gates *g = l->gates;
  for (size_t i = 0; i < g->count; i++)
    out[i] =
        (alone){.known = 1,
                .result = {.design = eda_figures_of(&l->design, i),
                           .before = eda_figures_of(&l->before, i),
                           .after = eda_figures_of(&l->measured.performance, i),
                           .length = g->length[i],
                           .width = g->width[i],
                           .extension = {l->measured.extension[2 * i],
                                         l->measured.extension[2 * i + 1]},
                           .flags_before = l->guard.flags[i],
                           .flags = l->measured.flags[i]}};
}

/* Simulate the mask with the fast model, without the difference of the models,
   and set seen = ln(Ion of this simulation / Ion of the accurate model). */
static int look_cheaply(loop *l, alone *out, opc_error *error) {
  for (size_t k = 0; k < l->gates->layers; k++)
    eda_field_clear(&l->printer.difference[k]);
  correct_trial_copy(&l->next, &l->now);
  int code = correct_loop_print(l, 1, error);
  for (size_t i = 0; i < l->gates->count && !code; i++) {
    double ratio = l->measured.performance.ion[i] / out[i].result.after.ion;
    int prints = !eda_print_failed(l->measured.flags[i] | out[i].result.flags);
    out[i].seen = prints && ratio > 0 && isfinite(ratio) ? log(ratio) : 0;
  }
  return code;
}

/* Correct a cell alone. Append the figures of its transistors, and their
   records. */
static int correct_cell(library *b, size_t k, opc_bytes *out,
                        opc_error *error) {
  work *w = b->work;
  const eda_gates *g = b->cells.cell[k].gates;
  uint64_t n = g->count;
  alone *figures = eda_alloc(n, sizeof *figures);
  uint32_t *place = eda_alloc(n, sizeof *place);
  for (uint32_t i = 0; i < n; i++)
    place[i] = cells_is_own(g, i) ? i : UINT32_MAX;
  correct_settings with = *w->with;
  with.margin = w->margin * w->chip->grid;
  inner in;
  loop l;
  correction_host(w, k, b->cells.count, &in);
  correct_loop_init(&l, &in.host, g, &with);
  l.prepared = 1;
  l.printer.drawn = NULL; /* all cells share one resist calibration */
  int code = correct_loop_run(&l, error);
  if (!code) take_figures(&l, figures);
  if (!code && with.fine > 0) code = look_cheaply(&l, figures, error);
  if (!code) {
    out->add(out, &n, sizeof n);
    out->add(out, figures, n * sizeof *figures);
    code = correction_put(w, &l, place, out, error);
  }
  correct_loop_clear(&l);
  free(figures);
  free(place);
  return code;
}

/* Bytes that receive a copy of all that is added to `to`. */
typedef struct tee {
  opc_bytes bytes;
  opc_bytes *to;
  GByteArray *copy;
} tee;

static void tee_add(opc_bytes *bytes, const void *from, size_t size) {
  const tee *t = (const tee *)bytes;
  t->to->add(t->to, from, size);
  g_byte_array_append(t->copy, from, (guint)size);
}

static int library_work(void *data, size_t k, opc_bytes *out,
                        opc_error *error) {
  library *b = data;
  const opc_host *host = b->work->host;
  const opc_results *results = opc_get_results(host);
  size_t size;
  uint8_t fresh = 0;
  g_autofree char *key = key_of(b, &b->cells.cell[k]);
  void *kept = key ? results->find(host, key, &size) : NULL;
  if (kept) {
    out->add(out, &fresh, 1);
    out->add(out, kept, size);
    free(kept);
    return OPC_OK;
  }
  fresh = 1;
  out->add(out, &fresh, 1);
  tee both = {{.add = tee_add}, out, g_byte_array_new()};
  int code = correct_cell(b, k, &both.bytes, error);
  if (!code && key) results->keep(host, key, both.copy->data, both.copy->len);
  g_byte_array_unref(both.copy);
  return code;
}

/* ---- results ---- */

/* Give the classes of a cell's transistor `gate` the mask of the record. */
static void take_record(library *b, const cell *c, const alone *figures,
                        uint32_t gate, const char *at) {
  work *w = b->work;
  for (size_t i = c->first; i < c->first + c->used; i++) {
    const cell_match *m = &b->cells.match[i];
    if (m->gate != gate) continue;
    uint32_t mask = b->mask[m->place] = correction_take(w, at);
    w->alone[mask] = *figures;
  }
}

static int library_take(void *data, size_t k, const void *bytes, size_t size,
                        opc_error *error) {
  library *b = data;
  const cell *c = &b->cells.cell[k];
  const char *at = bytes, *end = at + size;
  uint64_t n;
  (void)error;
  b->corrected += *at++ == 1;
  memcpy(&n, at, sizeof n);
  at += sizeof n;
  const char *figures = at;
  /* Simulations of cells do not count, because the store may contain them. */
  for (at = correction_begin(NULL, at + n * sizeof(alone)); at < end;) {
    corrected one;
    alone of;
    const char *next = correction_next(at, &one);
    memcpy(&of, figures + one.place * sizeof of, sizeof of);
    take_record(b, c, &of, one.place, at);
    at = next;
  }
  return OPC_OK;
}

static double library_cost(void *data, size_t k) {
  const library *b = data;
  eda_box e = b->cells.cell[k].gates->extent;
  return ((double)e.x1 - e.x0) * ((double)e.y1 - e.y0);
}

/* ---- run ---- */

static int library_report(const library *b, opc_error *error) {
  const work *w = b->work;
  const opc_metric_value values[] = {
      {"cells", (double)b->cells.count},
      {"cells_corrected", (double)b->corrected},
      {"outside_cells", (double)(w->classes - b->cells.matches)}};
  w->host->log(w->host, OPC_LOG_INFO,
               "%zu cells, of which %zu were corrected now; %zu environments "
               "are not in a cell",
               b->cells.count, b->corrected, w->classes - b->cells.matches);
  return opc_put_metrics(w->host, OPC_ARRAY(values), error);
}

int cells_correct(work *w, uint32_t *mask, opc_error *error) {
  library b = {.work = w, .mask = mask};
  uint8_t *flip = eda_alloc(w->classes, 1);
  int code =
      cells_find(w->host->context, w->chip, w->first, w->kind, w->classes,
                 w->orientations, w->cells.boundary, &b.cells, error);
  b.settings = settings_of(w);
  const opc_pieces each = {.data = &b,
                           .name = "cell",
                           .count = b.cells.count,
                           .cost = library_cost,
                           .work = library_work,
                           .take = library_take};
  if (!code) code = opc_do_pieces(w->host, &each, error);
  for (size_t i = 0; i < b.cells.matches; i++)
    flip[b.cells.match[i].place] = b.cells.match[i].flip;
  for (size_t i = 0; i < w->chip->count; i++)
    w->chip->gate[i].flip ^= flip[w->chip->gate[i].mask];
  if (!code) code = library_report(&b, error);
  cells_clear(&b.cells);
  g_free(b.settings);
  free(flip);
  return code;
}
