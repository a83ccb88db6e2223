/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements territories by flattening boxes of cells. The order of a box's
   corners shows the orientation of the cell. */
#include "outline.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

/* ---- the outline ---- */

static int cell_draws(const eda_layout *layout, int32_t cell,
                      const int32_t *layers, size_t n) {
  size_t all = eda_layout_polygons(layout, cell);
  for (size_t i = 0; i < all; i++) {
    size_t points;
    int32_t layer;
    (void)eda_layout_polygon(layout, cell, i, &points, &layer);
    for (size_t k = 0; k < n; k++)
      if (layers[k] == layer) return 1;
  }
  return 0;
}

/* Compute the bounding box of a cell and all cells below. Return 0 if the box
   is empty. */
static int find_box(const eda_layout *layout, int32_t cell,
                    const int32_t *layers, size_t n, eda_box *box) {
  *box = (eda_box)EDA_BOX_EMPTY;
  for (size_t k = 0; k < n; k++) {
    opc_error error;
    eda_box b;
    if (eda_layout_bounds(layout, cell, layers[k], eda_layout_unit(layout), &b,
                          &error))
      return 0;
    if (b.x0 > b.x1) continue;
    if (b.x0 < box->x0) box->x0 = b.x0;
    if (b.y0 < box->y0) box->y0 = b.y0;
    if (b.x1 > box->x1) box->x1 = b.x1;
    if (b.y1 > box->y1) box->y1 = b.y1;
  }
  return box->x0 < box->x1 && box->y0 < box->y1;
}

static int copy_instances(const eda_layout *layout, int32_t cell,
                          eda_layout *out, opc_error *error) {
  size_t n = eda_layout_instances(layout, cell);
  int code = OPC_OK;
  for (size_t i = 0; i < n && !code; i++) {
    int32_t child;
    eda_placement p;
    (void)eda_layout_instance(layout, cell, i, &child, &p);
    code = eda_layout_add_instance(out, cell, child, &p, NULL, error);
  }
  return code;
}

eda_layout *outline_new(const eda_layout *layout, int32_t top,
                        const int32_t *layers, size_t n, double most,
                        double beyond, opc_error *error) {
  double unit = eda_layout_unit(layout);
  eda_layout *out = eda_layout_new(unit, error);
  if (!out) return NULL;
  int32_t by = (int32_t)ceil(beyond / unit);
  int32_t cells = (int32_t)eda_layout_cells(layout);
  int code = eda_layout_layer(out, "cells", error) < 0;
  for (int32_t c = 0; c < cells && !code; c++)
    code = eda_layout_cell(out, eda_layout_cell_name(layout, c), error) < 0;
  for (int32_t c = 0; c < cells && !code; c++) {
    eda_box b;
    if (c != top && cell_draws(layout, c, layers, n) &&
        find_box(layout, c, layers, n, &b) &&
        ((double)b.x1 - b.x0) * unit <= most &&
        ((double)b.y1 - b.y0) * unit <= most)
      code = eda_layout_add_box(out, c, 0, eda_box_grown(b, by), error);
    else
      code = copy_instances(layout, c, out, error);
  }
  if (!code) return out;
  eda_layout_free(out);
  return NULL;
}

/* ---- territories ---- */

/* Return the number of quarter turns from (1, 0) to (x, y); -1 for an angle
   that is not a multiple of 90 degrees. */
static int quarter_turns(int64_t x, int64_t y) {
  if ((x != 0) == (y != 0)) return -1;
  return x > 0 ? 0 : y > 0 ? 1 : x < 0 ? 2 : 3;
}

/* Set the territory of a box. p: corners after placement, counter-clockwise
   from the original lower left corner. Returns 0 if the angle is not a multiple
   of 90 degrees. */
static int territory_of(const eda_point *p, uint32_t number, territory *out) {
  int along = quarter_turns((int64_t)p[1].x - p[0].x, (int64_t)p[1].y - p[0].y);
  int up = quarter_turns((int64_t)p[3].x - p[0].x, (int64_t)p[3].y - p[0].y);
  if (along < 0 || up < 0 || (along + up) % 2 == 0) return 0;
  int mirror = up != (along + 1) % 4;
  *out = (territory){.box = eda_bounds(p, 4),
                     .at = p[0],
                     .number = number,
                     .orientation = (uint8_t)(along + 4 * mirror)};
  return 1;
}

int outline_find(const eda_layout *outline, int32_t top, double grid,
                 const eda_box *window, territory **out, size_t *count,
                 opc_error *error) {
  eda_flat flat;
  *count = 0;
  *out = NULL;
  int code =
      eda_layout_flatten_window(outline, top, 0, grid, window, &flat, error);
  if (code) return code;
  *out = eda_alloc(flat.shapes.count, sizeof **out);
  for (size_t i = 0; i < flat.shapes.count; i++)
    *count += (size_t)territory_of(flat.shapes.points + flat.shapes.start[i],
                                   flat.placement[i], *out + *count);
  eda_flat_clear(&flat);
  return OPC_OK;
}

eda_box territory_own(const territory *t, eda_box b) {
  eda_point p[2] = {{b.x0 - t->at.x, b.y0 - t->at.y},
                    {b.x1 - t->at.x, b.y1 - t->at.y}};
  for (int k = 0; k < 2; k++) {
    for (int turn = t->orientation % 4; turn > 0; turn--)
      p[k] = (eda_point){p[k].y, -p[k].x};
    if (t->orientation & 4) p[k].y = -p[k].y;
  }
  return eda_bounds(p, 2);
}
