/* SPDX-License-Identifier: BSD-3-Clause */
/* The territories of a layout: the boxes of its placed cells, each of which
   gets a piece of the mask. */
#ifndef CORRECT_LAYOUT_OUTLINE_H
#define CORRECT_LAYOUT_OUTLINE_H

#include <eda/layout.h>

/* A placed cell on the grid. `way`: quarter turns counter-clockwise, after a
   mirror about x if 4 is added; `at`: where its low-low corner has come. */
typedef struct territory {
  eda_box box;
  eda_point at;
  uint32_t number; /* of the placement: the order among them */
  uint8_t way;
} territory;

/* A layout that has the cells of another one, of the same numbers, and in it
   only their boxes on the layers given, in its layer 0: of cells that draw
   something themselves, are no larger than `most` nm and lie in no such other
   one, and `beyond` nm around that. `top` is none. [any] */
eda_layout *outline_new(const eda_layout *layout, int32_t top,
                        const int32_t *layers, size_t n, double most,
                        double beyond, opc_error *error);

/* The territories that touch a window, in grid units, in the order of their
   placements; to be freed with free(). Those at other angles than right ones
   are none. [any] */
int outline_find(const eda_layout *outline, int32_t top, double grid,
                 const eda_box *window, territory **out, size_t *count,
                 opc_error *error);

/* A box of the mask as a cell placed there has it, and whether it has any
   area. */
eda_box territory_own(const territory *t, eda_box b);

#endif
