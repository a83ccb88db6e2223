/* SPDX-License-Identifier: BSD-3-Clause */
/* Extraction of the cells of a sheet as separate gates. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>

/* A cell with its environment, in coordinates of its own. */
typedef struct cut_out {
  int32_t cell;
  eda_gates *gates; /* NULL: the cell has no transistor */
  uint8_t *own;     /* [gates], 1: gate of the cell, 0: of a neighbour; freed
                       with free() */
  eda_box box;      /* bounding box of the cell */
} cut_out;

/* Extract the cell of instance i of the sheet's top cell; neighbours have no
   gates. Returns OPC_INVALID if the layout was not made by library.sheet. The
   caller frees *out with correct_cut_clear(). */
OPC_EXPORT int correct_cut_cell(const eda_gates *sheet,
                                const eda_layout *layout, int32_t top, size_t i,
                                cut_out *out, opc_error *error);
OPC_EXPORT void correct_cut_clear(cut_out *out);

/* Return the checksum of a cell's fragments and gates. The caller frees the
   text with g_free(). */
OPC_EXPORT char *correct_cut_sum(const eda_gates *cell);
