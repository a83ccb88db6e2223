/* SPDX-License-Identifier: BSD-3-Clause */
/* Added shapes of masks of cells, placed in a layout. */
#pragma once

#include <eda/chip.h>

/* Move each side of an added shape or cut-out that is one grid step beside a
   parallel mask edge onto this edge. In the cell, such a side is on the edge,
   but the drawn edges of the cell and of its placement are rounded to the grid
   separately. Do nothing for masks that were made in the layout. `moved`:
   displacements of all gates of a part of the layout. Callable from any
   thread. */
void align_boxes(const eda_chip *chip, const eda_gates *gates,
                 eda_moved *moved);
