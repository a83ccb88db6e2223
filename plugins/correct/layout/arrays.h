/* SPDX-License-Identifier: BSD-3-Clause */
/* Many placements as few arrays. */
#ifndef CORRECT_LAYOUT_ARRAYS_H
#define CORRECT_LAYOUT_ARRAYS_H

#include <eda/layout.h>

/* One of a cell: `way` as of a territory. */
typedef struct put {
  uint32_t cell;
  eda_point at;
  uint8_t way;
} put;

/* Place n cells, whose numbers in the layout are cell[put.cell], in `top`: all
   that stand in lines at equal distances, and such lines one above the other,
   as arrays. The order of `puts` does not matter, and is lost. *arrays: how
   many instances these are. [main] */
int arrays_place(eda_layout *layout, int32_t top, const int32_t *cell,
                 put *puts, size_t n, size_t *arrays, opc_error *error);

#endif
