/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the search for transistors window by window and their classes of
   equal environments. */
#include <eda/check.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "cells.h"
#include "work.h"

/* First value: number of windows per work unit, enough for two to eight cores
   and independent of the number of threads. Second value: extension of a window
   beyond the radius, nm, larger than most transistors. */
enum { AT_ONCE = 8, BEYOND = 2000 };

typedef struct scan {
  work *work;
  size_t columns, rows;
  char key[32];
} scan;

/* ---- a window ---- */

typedef struct window {
  eda_box core;
  found *found;
  size_t count;
} window;

typedef struct batch {
  const work *work;
  window *window;
} batch;

static int scan_window(void *data, size_t i, opc_error *error) {
  const batch *s = data;
  const work *w = s->work;
  window *to = &s->window[i];
  eda_gates *g;
  int32_t beyond = w->radius + (int32_t)ceil(BEYOND / w->chip->grid);
  int code = eda_segment_core(w->chip->layout, w->chip->top, &w->chip->segment,
                              to->core, beyond, &g, error);
  if (code) return code;
  environment *around = eda_alloc(g->count, sizeof *around);
  code = environments_find(w->host->context, g, to->core, w->radius,
                           w->orientations, around, error);
  to->found = eda_alloc(g->count, sizeof *to->found);
  for (size_t k = 0; k < g->count && !code; k++)
    if (environment_starts(to->core, g->box[k]))
      to->found[to->count++] =
          (found){g->box[k], g->type[k], g->axis[k],
                  0,         around[k],  w->cells.used ? cells_kind(g, k) : 0};
  free(around);
  eda_gates_free(g);
  return code;
}

static eda_box core_of(const scan *s, size_t i) {
  const work *w = s->work;
  eda_box all = w->chip->extent;
  int32_t x = all.x0 + (int32_t)(i % s->columns) * w->window,
          y = all.y0 + (int32_t)(i / s->columns) * w->window;
  return (eda_box){x, y, x + w->window, y + w->window};
}

/* ---- work units ---- */

static int scan_some(void *data, size_t part, opc_bytes *out,
                     opc_error *error) {
  const scan *s = data;
  window windows[AT_ONCE];
  size_t all = s->columns * s->rows, first = part * AT_ONCE,
         n = MIN(AT_ONCE, all - first);
  batch these = {s->work, windows};
  memset(windows, 0, sizeof windows);
  for (size_t k = 0; k < n; k++) windows[k].core = core_of(s, first + k);
  int code = eda_try_all(s->work->host->context, n, scan_window, &these, error);
  for (size_t k = 0; k < n; k++) {
    if (!code)
      out->add(out, windows[k].found,
               windows[k].count * sizeof *windows[k].found);
    free(windows[k].found);
  }
  return code;
}

static int take_some(void *data, size_t part, const void *bytes, size_t size,
                     opc_error *error) {
  const scan *s = data;
  work *w = s->work;
  size_t n = size / sizeof(found);
  (void)part;
  if (w->chip->count + n >= UINT32_MAX)
    return opc_fail(error, OPC_INVALID, "layout", "more than 2^32 transistors");
  eda_grow(&w->found, &w->capacity, w->chip->count + n, sizeof *w->found);
  if (n) memcpy(w->found + w->chip->count, bytes, n * sizeof(found));
  w->chip->count += n;
  return OPC_OK;
}

/* Return the key of a stored result; all dependencies are inputs of the step.
 */
static const char *key_of(void *data, size_t part) {
  scan *s = data;
  (void)snprintf(s->key, sizeof s->key, "%zu", part);
  return s->key;
}

static void scan_done(void *data, size_t done) {
  const scan *s = data;
  size_t all = (s->columns * s->rows + AT_ONCE - 1) / AT_ONCE;
  work_progress(s->work, (double)done / (double)all);
}

/* ---- classes ---- */

EDA_COMPARE_RISING(by_corner, found, box.y0, box.x0);

static guint hash_sum(gconstpointer sum) {
  guint hash;
  memcpy(&hash, sum, sizeof hash);
  return hash;
}

static gboolean same_sum(gconstpointer a, gconstpointer b) {
  return !memcmp(a, b, SUM_SIZE);
}

GHashTable *work_sums(void) { return g_hash_table_new(hash_sum, same_sum); }

/* Group transistors into classes. `first` of a class is the lowest, then
   leftmost member. Set `flip` of the other members to their orientation
   relative to `first`. */
static void find_classes(work *w) {
  eda_chip *c = w->chip;
  GHashTable *class_of = work_sums();
  size_t capacity = 0, kinds = 0, kind_capacity = 0;
  c->gate = eda_alloc(c->count, sizeof *c->gate);
  for (size_t i = 0; i < c->count; i++) {
    const found *f = &w->found[i];
    guint class =
        GPOINTER_TO_UINT(g_hash_table_lookup(class_of, f->around.sum));
    if (!class) {
      EDA_PUSH(w->first, w->classes, capacity, (uint32_t)i);
      EDA_PUSH(w->kind, kinds, kind_capacity, f->kind);
      class = (guint)w->classes;
      g_hash_table_insert(class_of, (gpointer)f->around.sum,
                          GUINT_TO_POINTER(class));
    }
    uint8_t as = w->found[w->first[class - 1]].around.flip;
    c->gate[i] = (eda_chip_gate){.box = f->box,
                                 .mask = class - 1,
                                 .type = f->type,
                                 .axis = f->axis,
                                 .flip = f->around.flip ^ as};
  }
  g_hash_table_destroy(class_of);
}

/* Compute the extent of the layers with transistors. */
int scan_extent(eda_chip *c, opc_error *error) {
  c->extent = (eda_box)EDA_BOX_EMPTY;
  for (size_t k = 0; k < c->layers; k++) {
    int32_t layer = eda_layout_find_layer(c->layout, c->layer[k]);
    eda_box b;
    if (layer < 0) continue;
    int code = eda_layout_bounds(c->layout, c->top, layer, c->grid, &b, error);
    if (code) return code;
    eda_box_join(&c->extent, b);
  }
  return OPC_OK;
}

int scan_all(work *w, opc_error *error) {
  scan s = {.work = w};
  int code = scan_extent(w->chip, error);
  if (code) return code;
  eda_box all = w->chip->extent;
  if (all.x0 <= all.x1) {
    s.columns = (size_t)((all.x1 - (int64_t)all.x0) / w->window + 1);
    s.rows = (size_t)((all.y1 - (int64_t)all.y0) / w->window + 1);
  }
  w->windows = s.columns * s.rows;
  const opc_pieces some = {.data = &s,
                           .name = "scan",
                           .count = (w->windows + AT_ONCE - 1) / AT_ONCE,
                           .key = key_of,
                           .work = scan_some,
                           .take = take_some,
                           .done = scan_done};
  code = opc_do_pieces(w->host, &some, error);
  if (!code && !w->chip->count)
    code =
        opc_fail(error, OPC_INVALID, "layout",
                 "no transistors: layers 'poly' and 'active' do not overlap");
  if (code) return code;
  qsort(w->found, w->chip->count, sizeof *w->found, by_corner);
  find_classes(w);
  free(w->found);
  w->found = NULL;
  return OPC_OK;
}
