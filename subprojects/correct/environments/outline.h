/* SPDX-License-Identifier: BSD-3-Clause */
/* Territories of a layout: boxes of placed cells that divide the mask. */
#pragma once

#include <eda/layout.h>

/* A placed cell on the grid. `orientation`: number of quarter turns
   counter-clockwise, plus 4 if the cell is first mirrored about x. `at`:
   position of the cell's lower left corner. */
typedef struct territory {
  eda_box box;
  eda_point at;
  uint32_t number; /* number of the placement, in order */
  uint8_t orientation;
} territory;

/* Return a layout whose cells have the numbers of the cells of `layout`. Each
   cell contains at most one box, in layer 0: the bounding box of its shapes on
   n layers, grown by `beyond` nm. A cell has a box if it draws shapes itself,
   is not larger than `most` nm and is not below another such cell; `top` has
   none. Returns NULL on failure. The caller frees the layout with
   eda_layout_free(). Callable from any thread. */
eda_layout *outline_new(const eda_layout *layout, int32_t top,
                        const int32_t *layers, size_t n, double most,
                        double beyond, opc_error *error);

/* Find the territories that touch a window, in grid units, in the order of
   their placements. Placements at angles other than multiples of 90 degrees are
   skipped. The caller frees *out with free(). Callable from any thread. */
int outline_find(const eda_layout *outline, int32_t top, double grid,
                 const eda_box *window, territory **out, size_t *count,
                 opc_error *error);

/* Return a box of the mask in the coordinates of the territory's cell. */
eda_box territory_own(const territory *t, eda_box b);
