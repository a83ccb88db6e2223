/* SPDX-License-Identifier: BSD-3-Clause */
/* Differences between two written masks. */
#pragma once

#include <eda/geometry.h>
#include <stdint.h>

/* Difference of a layer that exists in at least one mask. Areas in um^2. */
typedef struct mask_difference {
  uint32_t layer, datatype;
  double base, other; /* areas */
  double area;        /* area of the XOR */
  int64_t places;     /* number of polygons of the XOR */
  int64_t rectangles; /* rectangles of the XOR after fracturing */
} mask_difference;

/* Compare two GDSII files written by write.gds: polygons in one cell. Stores *n
   rows in *out, one for each layer of either file, sorted by layer number; free
   with free(). Returns 0; OPC_IO; or OPC_INVALID for a file that is damaged,
   contains other elements than polygons, or has another grid. [any] */
int masks_compare(const char *base, const char *other, mask_difference **out,
                  size_t *n, opc_error *error);
