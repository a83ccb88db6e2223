/* SPDX-License-Identifier: BSD-3-Clause */
/* The cells that a layout is made of, and where it places them. */
#ifndef CORRECT_LIBRARY_UNITS_H
#define CORRECT_LIBRARY_UNITS_H

#include <eda/layout.h>

/* From a cell to what places it, in database units:
   (x, y) -> (xx x + xy y + dx, yx x + yy y + dy), one of eight orientations. */
typedef struct turn {
  int32_t xx, xy, yx, yy;
  int64_t dx, dy;
} turn;

typedef struct placed_unit {
  int32_t cell;
  turn at;
} placed_unit;

typedef struct units {
  placed_unit *unit; /* g_free */
  size_t count, room;
} units;

/* The outermost cells below `top` that draw poly or active themselves; those of
   all cells that no other places for -1. Such a top is one itself only if it
   places no other that does. OPC_INVALID if one is magnified, or turned by what
   is no right angle. */
OPC_EXPORT int correct_units_find(const eda_layout *layout, int32_t top,
                                  units *out, opc_error *error);

/* The sum of what a cell draws with all below it, merged, layer by layer: equal
   for equal shapes, whatever the file's unit and order (g_free). NULL and
   *error. */
OPC_EXPORT char *correct_units_sum(const eda_layout *layout, int32_t cell,
                                   opc_error *error);

#endif
