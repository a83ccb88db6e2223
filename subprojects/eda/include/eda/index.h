/* SPDX-License-Identifier: BSD-3-Clause */
/* Spatial index of boxes: find the boxes near a place. The boxes are
   distributed over a grid of square cells; a search visits the cells that its
   window overlaps.

     eda_index *index = eda_index_new(boxes, n, reach);
     eda_finder f = eda_index_find(index, window);
     for (uint32_t i; eda_index_next(&f, &i);)
       use(boxes[i]);
     eda_index_free(index);

   A point is a box without extent, an edge a box without width. Other shapes
   are indexed by their bounding boxes, and the caller tests the candidates. */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

typedef struct eda_index eda_index;

/* Return an index of n boxes, which are copied; n below 2^32. `cell` is the
   side of a cell in the unit of the boxes, ideally about the size of a window.
   The side is enlarged where it would produce more than a few cells for each
   box or more than a few boxes for each cell. 0: as many cells as boxes. Empty
   boxes (x0 > x1) are never found. [any] */
OPC_EXPORT eda_index *eda_index_new(const eda_box *boxes, size_t n,
                                    int32_t cell);
/* Free an index (NULL: nothing). */
OPC_EXPORT void eda_index_free(eda_index *index);

/* A search; fields are private to eda. Needs no clearing and may be abandoned
   at any time. */
typedef struct eda_finder {
  const eda_index *index;
  eda_box window, cells; /* cells: columns x0 .. x1, rows y0 .. y1 */
  int32_t column, row;
  int64_t left, below; /* start of the cell */
  uint32_t at, end;
} eda_finder;

/* Start a search for the boxes that touch a window, edges and corners included.
   [any] */
OPC_EXPORT eda_finder eda_index_find(const eda_index *index, eda_box window);

/* Write the number of the next box; return 0 if there are no more. Each box is
   returned once, by the first cell in which it meets the window, row by row
   from below, within a cell by number. The order depends only on the boxes, the
   cell size and the window. [any] */
OPC_EXPORT int eda_index_next(eda_finder *finder, uint32_t *number);

OPC_C_END
