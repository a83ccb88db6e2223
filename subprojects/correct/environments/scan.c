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
   and independent of the number of threads. Second value: smallest number of
   windows of a sample of a large layout. Third value: extension of a window
   beyond the radius, nm, larger than most transistors. */
enum { AT_ONCE = 8, SAMPLE = 8, BEYOND = 2000 };

typedef struct scan {
  work *work;
  size_t columns, rows;
  size_t every; /* one of `every` windows is searched; 1: all windows */
  char key[32];
  /* Transistors of the present row of windows, not yet in the chip. */
  found *found;
  size_t count, capacity, row;
  GHashTable *classes; /* maps a checksum to the class number + 1 */
  uint8_t *flip;       /* [classes], orientation of the first member */
  size_t class_capacity, kinds, kind_capacity, flips, flip_capacity;
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
  i = i * s->every + s->every / 2;
  int32_t x = all.x0 + (int32_t)(i % s->columns) * w->window,
          y = all.y0 + (int32_t)(i / s->columns) * w->window;
  return (eda_box){x, y, x + w->window, y + w->window};
}

/* ---- work units ---- */

static int scan_some(void *data, size_t part, opc_bytes *out,
                     opc_error *error) {
  const scan *s = data;
  window windows[AT_ONCE];
  size_t all = s->work->windows, first = part * AT_ONCE,
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

/* Return the class of a transistor. The first transistor of a class is the
   lowest, then leftmost member. */
static uint32_t class_of(scan *s, const found *f, size_t number) {
  work *w = s->work;
  guint class =
      GPOINTER_TO_UINT(g_hash_table_lookup(s->classes, f->around.sum));
  if (class) return class - 1;
  gpointer sum = g_memdup2(f->around.sum, SUM_SIZE);
  EDA_PUSH(w->first, w->classes, s->class_capacity, (uint32_t)number);
  EDA_PUSH(w->kind, s->kinds, s->kind_capacity, f->kind);
  EDA_PUSH(s->flip, s->flips, s->flip_capacity, f->around.flip);
  g_ptr_array_add(w->sums, sum);
  g_hash_table_insert(s->classes, sum, GUINT_TO_POINTER((guint)w->classes));
  return (uint32_t)w->classes - 1;
}

/* Append the transistors of a row of windows to the chip. The rows are disjoint
   in y, so that the transistors of all rows are sorted. */
static int row_end(scan *s, opc_error *error) {
  eda_chip *c = s->work->chip;
  if (!s->count) return OPC_OK;
  if (c->count + s->count >= UINT32_MAX)
    return opc_fail(error, OPC_INVALID, "layout", "more than 2^32 transistors");
  int code = eda_chip_reserve(c, c->count + s->count, error);
  if (code) return code;
  qsort(s->found, s->count, sizeof *s->found, by_corner);
  for (size_t i = 0; i < s->count; i++) {
    const found *f = &s->found[i];
    uint32_t class = class_of(s, f, c->count);
    c->gate[c->count++] =
        (eda_chip_gate){.box = f->box,
                        .mask = class,
                        .type = f->type,
                        .axis = f->axis,
                        .flip = f->around.flip ^ s->flip[class]};
    s->work->tallest = MAX(s->work->tallest, f->box.y1 - f->box.y0);
  }
  s->count = 0;
  return OPC_OK;
}

static int take_some(void *data, size_t part, const void *bytes, size_t size,
                     opc_error *error) {
  scan *s = data;
  const work *w = s->work;
  const char *at = bytes, *end = at + size;
  int code = OPC_OK;
  (void)part;
  for (; at < end && !code; at += sizeof(found)) {
    found f;
    memcpy(&f, at, sizeof f);
    size_t row = (size_t)((f.box.y0 - (int64_t)w->chip->extent.y0) / w->window);
    if (row != s->row) code = row_end(s, error);
    s->row = row;
    EDA_PUSH(s->found, s->count, s->capacity, f);
  }
  return code;
}

/* ---- list of work units ---- */

/* Return the key of a stored result; all dependencies are inputs of the step.
   Results of a sample are not kept: it searches other windows and does not
   determine the equivalent orientations. */
static const char *key_of(void *data, size_t part) {
  scan *s = data;
  if (s->work->sample) return NULL;
  (void)snprintf(s->key, sizeof s->key, "%zu", part);
  return s->key;
}

static void scan_done(void *data, size_t done) {
  const scan *s = data;
  size_t all = (s->work->windows + AT_ONCE - 1) / AT_ONCE;
  work_progress(s->work, (double)done / (double)all);
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

static int scan_windows(scan *s, opc_error *error) {
  const work *w = s->work;
  const opc_pieces some = {.data = s,
                           .name = "scan",
                           .count = (w->windows + AT_ONCE - 1) / AT_ONCE,
                           .key = key_of,
                           .work = scan_some,
                           .take = take_some,
                           .done = scan_done};
  s->classes = work_sums();
  int code = opc_do_pieces(w->host, &some, error);
  if (!code) code = row_end(s, error);
  g_hash_table_destroy(s->classes);
  g_ptr_array_set_size(w->sums, 0);
  free(s->found);
  free(s->flip);
  return code;
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
  s.every = w->sample ? MAX(w->windows / SAMPLE, 1) : 1;
  w->windows /= s.every;
  code = scan_windows(&s, error);
  if (!code && !w->sample && !w->chip->count)
    code =
        opc_fail(error, OPC_INVALID, "layout",
                 "no transistors: layers 'poly' and 'active' do not overlap");
  return code;
}
