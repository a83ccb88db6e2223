/* SPDX-License-Identifier: BSD-3-Clause */
/* The cells of a sheet, one by one, as gates of their own. */
#ifndef CORRECT_LIBRARY_CUT_H
#define CORRECT_LIBRARY_CUT_H

#include <eda/gates.h>
#include <eda/layout.h>

/* A cell with what stands around it, in coordinates of its own. */
typedef struct cut_out {
  int32_t cell;
  eda_gates *gates; /* NULL: the cell has no transistor */
  uint8_t *own;     /* 1: of the cell, 0: of a neighbour (free) */
  eda_box box;      /* around the cell's shapes */
} cut_out;

/* The cell of instance i of the sheet's top; a neighbour has no gates.
   OPC_INVALID if the gates are no sheet's. */
OPC_EXPORT int correct_cut_cell(const eda_gates *sheet,
                                const eda_layout *layout, int32_t top, size_t i,
                                cut_out *out, opc_error *error);
OPC_EXPORT void correct_cut_clear(cut_out *out);

/* The sum of how its edges were cut into fragments (g_free). */
OPC_EXPORT char *correct_cut_sum(const eda_gates *cell);

#endif
