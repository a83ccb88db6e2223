/* SPDX-License-Identifier: BSD-3-Clause */
/* Cells of a layout, segmented alone, and the transistors of the layout that
   are transistors of a cell. */
#pragma once

#include <eda/chip.h>

/* A cell; coordinates are those of the cell, in grid steps. */
typedef struct cell {
  int32_t number;     /* in the layout */
  eda_gates *gates;   /* shapes and transistors of the cell and its copies */
  eda_point corner;   /* lower left corner of its poly and active */
  size_t used, first; /* number of its matches; index of the first */
} cell;

/* A transistor of the layout that is transistor `gate` of a cell. */
typedef struct cell_match {
  uint32_t
      place; /* index of the transistor in the array `number` of cells_find */
  uint32_t gate; /* index of the transistor in cell.gates */
  uint32_t cell; /* index in cells */
  uint8_t flip;  /* EDA_FLIP_* of the placed cell */
} cell_match;

/* All cells with transistors, and the transistors of the layout that match
   them. */
typedef struct cells {
  cell *cell;
  cell_match *match; /* ordered by cell, then by place */
  size_t count, matches, capacity, match_capacity;
} cells;

/* Return a hash of the drawn L and W, the goal and the flavour of a gate: equal
   values result in equal masks in equal cells. Callable from any thread. */
uint32_t cells_kind(const eda_gates *gates, size_t i);

/* Find the cells that contain the n transistors gate[number[i]] of a chip, and
   segment each cell alone or, with `boundary`, among copies as in rows of
   cells. A cell is the outermost one below the top cell that draws poly or
   active. Omit transistors that are not drawn by a single cell, and cells in an
   orientation that the optics image differently. kind[i]: cells_kind of the
   transistor. `orientations`: number of equivalent orientations. `boundary`:
   layer of the boxes in which cells abut; NULL: no copies. The caller frees
   *out with cells_clear(), also after an error. Call on the main thread. */
int cells_find(const opc_context *context, const eda_chip *chip,
               const uint32_t *number, const uint32_t *kind, size_t n,
               int orientations, const char *boundary, cells *out,
               opc_error *error);
void cells_clear(cells *cells);

/* Return 1 for a transistor of the cell itself, 0 for one of a copy. */
int cells_is_own(const eda_gates *gates, size_t i);

/* Return a SHA-256 checksum of all shapes and transistors of a cell. The caller
   frees the text with g_free(). */
char *cells_sum(const eda_gates *cell);
