/* SPDX-License-Identifier: BSD-3-Clause */
/* Compression of placements into arrays. */
#pragma once

#include <eda/layout.h>

/* Placement of a cell; `orientation` as in territory. */
typedef struct put {
  uint32_t cell;
  eda_point at;
  uint8_t orientation;
} put;

/* Place n cells in `top`; put.cell is an index into `cell`. Equidistant
   placements in a row, and equal rows above each other, become arrays. `puts`
   is sorted in place. *arrays receives the number of placed arrays and single
   instances. Call on the main thread. */
int arrays_place(eda_layout *layout, int32_t top, const int32_t *cell,
                 put *puts, size_t n, size_t *arrays, opc_error *error);
