/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the mask by classes as a layout with cells and arrays. The mask is
   built window by window and never as a whole. Placed cells with equal masks
   become one cell. */
#include <eda/check.h>
#include <eda/formats.h>
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "arrays.h"
#include "clips.h"
#include "window.h"

/* Number of windows per batch, independent of the number of threads. */
enum { AT_ONCE = 8 };
/* Side of a window and largest size of a preserved cell, nm. A window is
   extended by 3 um on each side; at 15 um the extension doubles the area. A
   window of 60 um of a dense layout requires 50 MB. */
static const double side = 30000, most = 20000;

/* ---- state ---- */

typedef struct maker {
  cutter cutter;
  int32_t window;
  size_t columns, rows;
  eda_box extent; /* extent of the mask */
  eda_layout *out;
  int32_t top, *layer; /* [layers of the chip], top cell of the output; [layers
                          of the chip], layer of the output */
  int32_t
      *from; /* [layers of the chip], layer of the chip's layout; -1: none */
  GHashTable *known; /* maps the shapes of a clip to the cell number + 1 */
  int32_t *cell;     /* [n_cells], cell of the layout */
  size_t n_cells, cell_capacity;
  put *put;
  size_t n_put, put_capacity;
  size_t first; /* first window of the batch */
  clips clips[AT_ONCE];
} maker;

/* ---- displacements ---- */

static int32_t larger_magnitude(int32_t a, int32_t b) {
  if (b < 0) b = b < -INT32_MAX ? INT32_MAX : -b;
  return a > b ? a : b;
}

/* Return an upper bound of edge displacements: the bound assumes that a bias is
   entirely on one side. */
static int32_t find_moves(const eda_chip *c) {
  int32_t far = 0;
  for (size_t i = 0; i < c->masks; i++) {
    const eda_chip_mask *m = &c->mask[i];
    const int32_t of[] = {m->w, m->aside, m->l, m->jog, m->end[0], m->end[1]};
    int32_t sum = 0;
    for (size_t k = 0; k < G_N_ELEMENTS(of); k++)
      sum += larger_magnitude(0, of[k]);
    for (uint32_t k = 0; k < m->parts; k++)
      far = larger_magnitude(far, c->part[m->part + k].by);
    far = larger_magnitude(far, sum);
  }
  return far;
}

/* Return the largest distance of added shapes and cut-outs from a corner of
   their gate; *before receives the largest distance towards lower
   coordinates. */
static int32_t find_boxes(const eda_chip *c, int32_t *before) {
  int32_t far = 0;
  *before = 0;
  for (size_t i = 0; i < c->boxes; i++) {
    eda_box b = c->box[i].box;
    far = larger_magnitude(larger_magnitude(far, b.x0), b.x1);
    far = larger_magnitude(larger_magnitude(far, b.y0), b.y1);
    *before = MAX(*before, MAX(-b.x0, -b.y0));
  }
  return far;
}

/* ---- cells and polygons ---- */

static int cut_window(void *data, size_t i, opc_error *error) {
  maker *w = data;
  size_t k = w->first + i;
  int32_t x = w->extent.x0 + (int32_t)(k % w->columns) * w->window;
  int32_t y = w->extent.y0 + (int32_t)(k / w->columns) * w->window;
  return clips_cut(&w->cutter, (eda_box){x, y, x + w->window, y + w->window},
                   &w->clips[i], error);
}

typedef struct target {
  maker *work;
  int32_t cell, layer;
} target;

static int add_polygon(void *data, const eda_point *points, size_t n,
                       opc_error *error) {
  const target *t = data;
  return eda_layout_add_polygon(t->work->out, t->cell, t->layer, points, n,
                                error);
}

static int add_rest(maker *w, const clips *c, opc_error *error) {
  int code = OPC_OK;
  for (size_t k = 0; k < w->cutter.chip->layers && !code; k++) {
    target t = {w, w->top, w->layer[k]};
    const eda_polygon_taker take = {add_polygon, &t, SIZE_MAX};
    code = eda_polygons_without_holes(&c->rest[k], &take, error);
  }
  return code;
}

/* Create a cell with the name of the clip's drawn cell and a number. */
static int32_t name_cell(maker *w, const clip *c, opc_error *error) {
  const eda_chip *chip = w->cutter.chip;
  int32_t of =
      eda_layout_path(w->cutter.outline, chip->top, c->number, NULL, 0);
  for (size_t k = w->n_cells + 1;; k++) {
    g_autofree char *name = g_strdup_printf(
        "%.100s_M%zu", of < 0 ? "" : eda_layout_cell_name(chip->layout, of), k);
    if (eda_layout_find_cell(w->out, name) < 0)
      return eda_layout_cell(w->out, name, error);
  }
}

/* Create a cell with the shapes of a clip; *number receives its index in
   `cell`. */
static int add_cell(maker *w, const clip *c, uint32_t *number,
                    opc_error *error) {
  target t = {w, name_cell(w, c, error), 0};
  if (t.cell < 0) return error->code;
  const int32_t *at = g_bytes_get_data(c->shapes, NULL);
  int code = OPC_OK;
  for (size_t k = 0; k < w->cutter.chip->layers && !code; k++) {
    t.layer = w->layer[k];
    for (int32_t n; (n = *at++) > 0 && !code; at += 2 * n)
      code = add_polygon(&t, (const eda_point *)at, (size_t)n, error);
  }
  *number = (uint32_t)w->n_cells;
  EDA_PUSH(w->cell, w->n_cells, w->cell_capacity, t.cell);
  g_hash_table_insert(w->known, g_bytes_ref(c->shapes),
                      GSIZE_TO_POINTER(w->n_cells));
  return code;
}

static int add_clips(maker *w, const clips *c, opc_error *error) {
  int code = add_rest(w, c, error);
  for (size_t i = 0; i < c->count && !code; i++) {
    const clip *one = &c->clip[i];
    size_t found = GPOINTER_TO_SIZE(g_hash_table_lookup(w->known, one->shapes));
    uint32_t number = (uint32_t)found - 1;
    if (!found) code = add_cell(w, one, &number, error);
    if (!code)
      EDA_PUSH(w->put, w->n_put, w->put_capacity,
               (put){number, one->at, one->orientation});
  }
  return code;
}

static int cut_all(const opc_context *context, maker *w, opc_error *error) {
  size_t all = w->columns * w->rows;
  int code = OPC_OK;
  for (w->first = 0; w->first < all && !code; w->first += AT_ONCE) {
    size_t n = MIN(AT_ONCE, all - w->first);
    code = eda_try_all(context, n, cut_window, w, error);
    for (size_t i = 0; i < n; i++) {
      if (!code) code = add_clips(w, &w->clips[i], error);
      clips_clear(&w->clips[i], w->cutter.chip->layers);
    }
    if (!code && opc_cancelled(context))
      code = opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
  }
  return code;
}

/* ---- beginning and end ---- */

/* Return the layer of the chip's layout on which layer k was drawn; -1: none.
 */
static int32_t drawn_layer(const eda_chip *chip, size_t k) {
  const char *name = chip->layer[k];
  for (size_t i = 0; i < chip->segment.also_count; i++)
    if (!strcmp(chip->segment.also[2 * i], name))
      name = chip->segment.also[2 * i + 1];
  return eda_layout_find_layer(chip->layout, name);
}

/* Create the layout with its top cell and its layers, which keep their file
   layers. */
static void layout_open(maker *w, const eda_chip *chip, opc_error *error) {
  w->layer = eda_alloc(chip->layers, sizeof *w->layer);
  w->from = eda_alloc(chip->layers, sizeof *w->from);
  w->out = eda_layout_new(chip->grid, error);
  w->top = eda_layout_cell(
      w->out, eda_layout_cell_name(chip->layout, chip->top), error);
  for (size_t k = 0; k < chip->layers; k++) {
    int32_t drawn = w->from[k] = drawn_layer(chip, k);
    w->layer[k] = eda_layout_layer(w->out, chip->layer[k], error);
    if (drawn >= 0)
      eda_layout_set_file_layer(w->out, w->layer[k],
                                eda_layout_file_layer(chip->layout, drawn));
  }
}

static int layout_begin(maker *w, const eda_chip *chip, int drawn,
                        opc_error *error) {
  int32_t *from = eda_alloc(chip->layers, sizeof *from);
  size_t n = 0;
  layout_open(w, chip, error);
  for (size_t k = 0; k < chip->layers; k++) {
    from[n] = w->from[k];
    n += from[n] >= 0;
  }
  int32_t before = 0, m = 0, far = 0;
  if (!drawn) {
    m = find_moves(chip);
    far = find_boxes(chip, &before);
  }
  w->cutter.outline = outline_new(chip->layout, chip->top, from, n, most,
                                  chip->grid * MAX(m, before), error);
  free(from);
  if (!w->cutter.outline) return error->code;
  m = MAX(m, far) + 1;
  eda_box e = chip->extent;
  w->cutter.margin = m;
  w->extent = eda_box_grown(e, m);
  w->window = (int32_t)MIN(side / chip->grid, (double)(1 << 28));
  w->columns = (size_t)(((int64_t)e.x1 - e.x0 + 2 * m) / w->window + 1);
  w->rows = (size_t)(((int64_t)e.y1 - e.y0 + 2 * m) / w->window + 1);
  return OPC_OK;
}

int hierarchy_make(const opc_context *context, const eda_chip *chip, int drawn,
                   eda_layout **out, opc_error *error) {
  maker w = {.cutter.chip = chip};
  size_t arrays = 0;
  w.known = g_hash_table_new_full(g_bytes_hash, g_bytes_equal,
                                  (GDestroyNotify)g_bytes_unref, NULL);
  int code = layout_begin(&w, chip, drawn, error);
  w.cutter.drawn = drawn ? w.from : NULL;
  if (!code) code = cut_all(context, &w, error);
  if (!code)
    code = arrays_place(w.out, w.top, w.cell, w.put, w.n_put, &arrays, error);
  g_hash_table_destroy(w.known);
  eda_layout_free((eda_layout *)w.cutter.outline);
  free(w.layer);
  free(w.from);
  free(w.cell);
  free(w.put);
  *out = w.out;
  if (!code) return OPC_OK;
  eda_layout_free(w.out);
  *out = NULL;
  return code;
}
