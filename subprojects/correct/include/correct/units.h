/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells of a layout that draw transistors, and their placements. */
#pragma once

#include <eda/layout.h>

/* Transformation from a cell to its parent, in database units: (x, y) -> (xx x
   + xy y + dx, yx x + yy y + dy), one of eight orientations. */
typedef struct turn {
  int32_t xx, xy, yx, yy;
  int64_t dx, dy;
} turn;

typedef struct placed_unit {
  int32_t cell;
  turn at;
} placed_unit;

typedef struct units {
  placed_unit *unit; /* freed with g_free() */
  size_t count, capacity;
} units;

/* Find the outermost cells below the cell `top` (-1: below all top cells) that
   have poly or active shapes of their own. A top cell is included only if it
   places no cell with poly or active shapes. Returns OPC_INVALID if a placement
   is magnified or its angle is not a multiple of 90 degrees. The caller frees
   out->unit with g_free(). */
OPC_EXPORT int correct_units_find(const eda_layout *layout, int32_t top,
                                  units *out, opc_error *error);

/* Return a SHA-256 checksum of the merged shapes of a cell and all cells below,
   layer by layer, independent of the file's unit and the order of shapes. The
   caller frees the text with g_free(). Returns NULL and *error on failure. */
OPC_EXPORT char *correct_units_sum(const eda_layout *layout, int32_t cell,
                                   opc_error *error);
