/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the traversal of a layout to the cells that draw transistors. */
#include <correct/units.h>

#include <glib.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Unit of checksums, nm: finer than any drawing grid, and coarse enough for the
   coordinates of cells of 10 mm. */
static const double finest = 0.01;

enum {
  DEEPEST = 500
}; /* a deeper hierarchy is a cycle of placements, which eda_layout_flatten
      reports */

typedef struct traversal {
  const eda_layout *layout;
  int32_t poly, active;
  signed char *below; /* [cells], 1: the cell or a cell below draws poly or
                         active; -1: neither does; 0: not known */
  units *out;
  opc_error *error;
} traversal;

/* ---- drawing cells ---- */

static int cell_draws(const traversal *w, int32_t cell) {
  size_t count = eda_layout_polygons(w->layout, cell), points;
  int32_t layer;
  for (size_t i = 0; i < count; i++) {
    (void)eda_layout_polygon(w->layout, cell, i, &points, &layer);
    if (layer == w->poly || layer == w->active) return 1;
  }
  return 0;
}

static int draws_below(traversal *w, int32_t cell, int depth) {
  if (w->below[cell] || depth > DEEPEST) return w->below[cell] > 0;
  int any = cell_draws(w, cell);
  size_t n = eda_layout_instances(w->layout, cell);
  for (size_t i = 0; i < n && !any; i++) {
    int32_t child;
    eda_placement p;
    (void)eda_layout_instance(w->layout, cell, i, &child, &p);
    any = draws_below(w, child, depth + 1);
  }
  w->below[cell] = any ? 1 : -1;
  return any;
}

static int places_drawing(traversal *w, int32_t cell) {
  size_t n = eda_layout_instances(w->layout, cell);
  for (size_t i = 0; i < n; i++) {
    int32_t child;
    eda_placement p;
    (void)eda_layout_instance(w->layout, cell, i, &child, &p);
    if (draws_below(w, child, 0)) return 1;
  }
  return 0;
}

/* ---- positions ---- */

/* Set *out to the orientation and origin of a placement. Returns OPC_INVALID
   for other orientations than the eight of `turn`. */
static int turn_of(const traversal *w, int32_t child, const eda_placement *p,
                   turn *out) {
  static const int cosine[] = {1, 0, -1, 0};
  double quarters = nearbyint(p->angle / 90), flip = p->mirror ? -1 : 1;
  if (fabs(p->angle - 90 * quarters) > 1e-9 ||
      fabs(p->magnification - 1) > 1e-12)
    return opc_fail(
        w->error, OPC_INVALID, NULL,
        "cell '%s' is placed with an angle of %g degrees and a magnification "
        "of %g, expected multiples of 90 degrees without magnification",
        eda_layout_cell_name(w->layout, child), p->angle, p->magnification);
  int quarter = (int)(((int64_t)quarters % 4 + 4) % 4);
  int c = cosine[quarter], s = cosine[(quarter + 3) % 4];
  *out = (turn){c,           (int32_t)(-s * flip), s, (int32_t)(c * flip),
                p->origin.x, p->origin.y};
  return OPC_OK;
}

static turn turn_compose(turn a, turn b) {
  return (turn){
      a.xx * b.xx + a.xy * b.yx,        a.xx * b.xy + a.xy * b.yy,
      a.yx * b.xx + a.yy * b.yx,        a.yx * b.xy + a.yy * b.yy,
      a.xx * b.dx + a.xy * b.dy + a.dx, a.yx * b.dx + a.yy * b.dy + a.dy};
}

static void units_add(units *out, placed_unit u) {
  if (out->count == out->capacity) {
    out->capacity = 2 * out->capacity + 64;
    out->unit = g_realloc_n(out->unit, out->capacity, sizeof u);
  }
  out->unit[out->count++] = u;
}

static int traverse_cell(traversal *w, int32_t cell, turn at, int depth);

static int traverse_instance(traversal *w, int32_t cell, size_t i, turn at,
                             int depth) {
  int32_t child;
  eda_placement p;
  turn one = {0};
  (void)eda_layout_instance(w->layout, cell, i, &child, &p);
  if (!draws_below(w, child, 0)) return OPC_OK;
  int code = turn_of(w, child, &p, &one);
  for (uint32_t c = 0; c < p.columns && !code; c++)
    for (uint32_t r = 0; r < p.rows && !code; r++) {
      turn there = one;
      there.dx += (int64_t)c * p.column_step.x + (int64_t)r * p.row_step.x;
      there.dy += (int64_t)c * p.column_step.y + (int64_t)r * p.row_step.y;
      code = traverse_cell(w, child, turn_compose(at, there), depth + 1);
    }
  return code;
}

static int traverse_cell(traversal *w, int32_t cell, turn at, int depth) {
  int is_unit = cell_draws(w, cell) && (depth > 0 || !places_drawing(w, cell));
  int code = OPC_OK;
  if (is_unit) units_add(w->out, (placed_unit){cell, at});
  if (is_unit || depth > DEEPEST) return OPC_OK;
  size_t n = eda_layout_instances(w->layout, cell);
  for (size_t i = 0; i < n && !code; i++)
    code = traverse_instance(w, cell, i, at, depth);
  return code;
}

/* Return an array with 1 for each cell that another cell places. The caller
   frees the array with g_free(). */
static char *placed_cells(const eda_layout *layout) {
  size_t cells = eda_layout_cells(layout);
  char *placed = g_malloc0(cells + 1);
  for (size_t c = 0; c < cells; c++) {
    size_t n = eda_layout_instances(layout, (int32_t)c);
    for (size_t i = 0; i < n; i++) {
      int32_t child;
      eda_placement p;
      (void)eda_layout_instance(layout, (int32_t)c, i, &child, &p);
      placed[child] = 1;
    }
  }
  return placed;
}

int correct_units_find(const eda_layout *layout, int32_t top, units *out,
                       opc_error *error) {
  static const turn nowhere = {1, 0, 0, 1, 0, 0};
  size_t cells = eda_layout_cells(layout);
  *out = (units){0};
  g_autofree signed char *below = g_malloc0(cells + 1);
  traversal w = {.layout = layout,
                 .poly = eda_layout_find_layer(layout, "poly"),
                 .active = eda_layout_find_layer(layout, "active"),
                 .below = below,
                 .out = out,
                 .error = error};
  if (eda_layout_is_derived(layout, w.poly) ||
      eda_layout_is_derived(layout, w.active))
    return opc_fail(error, OPC_INVALID, NULL,
                    "poly or active is an expression of layers, expected "
                    "layers of the file: cells are corrected one by one, but "
                    "an expression may combine shapes of several cells");
  if (top >= 0) return traverse_cell(&w, top, nowhere, 0);
  g_autofree char *placed = placed_cells(layout);
  int code = OPC_OK;
  for (size_t c = 0; c < cells && !code; c++)
    if (!placed[c]) code = traverse_cell(&w, (int32_t)c, nowhere, 0);
  return code;
}

/* ---- drawn shapes ---- */

static int by_name(const void *a, const void *b) {
  return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static void sum_update(GChecksum *sum, const void *data, size_t size) {
  g_checksum_update(sum, data, (gssize)size);
}

static int add_layer(GChecksum *sum, const eda_layout *layout, int32_t cell,
                     const char *name, opc_error *error) {
  eda_flat flat;
  eda_shapes merged = {0};
  int code = eda_layout_flatten(
      layout, cell, eda_layout_find_layer(layout, name), finest, &flat, error);
  if (!code) code = eda_boolean(EDA_OR, &flat.shapes, NULL, &merged, error);
  eda_flat_clear(&flat);
  if (!code && merged.count) {
    sum_update(sum, name, strlen(name) + 1);
    sum_update(sum, merged.start, (merged.count + 1) * sizeof *merged.start);
    sum_update(sum, merged.points,
               merged.start[merged.count] * sizeof *merged.points);
  }
  eda_shapes_clear(&merged);
  return code;
}

char *correct_units_sum(const eda_layout *layout, int32_t cell,
                        opc_error *error) {
  size_t layers = eda_layout_layers(layout);
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  g_autofree const char **names = g_new(const char *, layers + 1);
  int code = OPC_OK;
  for (size_t k = 0; k < layers; k++)
    names[k] = eda_layout_layer_name(layout, (int32_t)k);
  qsort(names, layers, sizeof *names, by_name);
  for (size_t k = 0; k < layers && !code; k++)
    code = add_layer(sum, layout, cell, names[k], error);
  return code ? NULL : g_strdup(g_checksum_get_string(sum));
}
