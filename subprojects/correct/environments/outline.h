/* SPDX-License-Identifier: BSD-3-Clause */
/* Territories of a layout: boxes of placed cells that divide the mask. */
#pragma once

#include <eda/layout.h>

/* A placed cell on the grid. `orientation`: number of quarter turns
   counter-clockwise, plus 4 if the cell is first mirrored about x. `at`:
   placed position of the lower left corner of the cell's grown box. */
typedef struct territory {
  eda_box box;
  eda_point at;
  uint32_t number; /* number of the placement, as in eda_flat */
  uint8_t orientation;
} territory;

/* Return a layout whose cells have the numbers of the cells of `layout`. A cell
   other than `top` that draws on the n layers and is at most `most` nm wide and
   high has a box in layer 0 instead of its instances. The box is the bounding
   box of the cell and its subcells on these layers, grown by `beyond` nm. All
   other cells keep their instances. Return NULL and *error on failure. The
   caller frees the layout with eda_layout_free(). Callable from any thread. */
eda_layout *outline_new(const eda_layout *layout, int32_t top,
                        const int32_t *layers, size_t n, double most,
                        double beyond, opc_error *error);

/* Find the territories that touch a window, in grid units, in the order of
   their placements. Placements at angles other than multiples of 90 degrees are
   skipped. The caller frees *out with free(). Callable from any thread. */
int outline_find(const eda_layout *outline, int32_t top, double grid,
                 const eda_box *window, territory **out, size_t *count,
                 opc_error *error);

/* Convert a box of the mask to unrotated coordinates of the cell, relative to
   `at`. */
eda_box territory_own(const territory *t, eda_box b);
