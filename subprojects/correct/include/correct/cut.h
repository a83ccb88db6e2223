/* SPDX-License-Identifier: BSD-3-Clause */
/* Extraction of single cells from a sheet, a layout made by library.sheet. */
#pragma once

#include <eda/gates.h>
#include <eda/layout.h>

/* A cell with its neighbours. Coordinates are relative to the cell, in grid
   steps. */
typedef struct cut_out {
  int32_t cell;
  eda_gates *gates; /* NULL: the cell has no transistor */
  uint8_t *own;     /* [gates], 1: gate of the cell, 0: of a neighbour; freed
                       with free() */
  eda_box box;      /* bounding box of the cell, enlarged by one grid step */
} cut_out;

/* Extract the cell of instance i in the sheet's top cell; *out is empty if the
   instance is a copy that library.sheet placed as a neighbour. Returns
   OPC_INVALID if library.sheet did not make the layout. The caller frees *out
   with correct_cut_clear(). */
OPC_EXPORT int correct_cut_cell(const eda_gates *sheet,
                                const eda_layout *layout, int32_t top, size_t i,
                                cut_out *out, opc_error *error);
OPC_EXPORT void correct_cut_clear(cut_out *out);

/* Return the SHA-256 checksum of a cell's edges and gates. The caller frees the
   text with g_free(). */
OPC_EXPORT char *correct_cut_sum(const eda_gates *cell);
