/* SPDX-License-Identifier: BSD-3-Clause */
/* Spatial index of boxes: find the boxes that touch a window. The boxes are
   sorted into a grid of square cells; a search visits the cells under its
   window.

     eda_index *index = eda_index_new(boxes, n, reach);
     eda_finder f = eda_index_find(index, window);
     for (uint32_t i; eda_index_next(&f, &i);)
       use(boxes[i]);
     eda_index_free(index);

   Boxes may have zero width and height, for edges and points. For other shapes
   index the bounding boxes and test the found shapes. [any]:
   opcflow/plugin.h. */
#pragma once

#include <eda/geometry.h>

OPC_C_BEGIN

/* An index. */
typedef struct eda_index eda_index;

/* Return an index of n < 2^32 boxes, which are copied. `cell` is the side of a
   cell in the unit of the boxes, ideally the size of a window. For `cell` = 0,
   the side is chosen so that the index has about as many cells as boxes. The
   side is enlarged if there would be too many cells, or too many cells per box.
   Empty boxes (x0 > x1) are never found. [any] */
OPC_EXPORT eda_index *eda_index_new(const eda_box *boxes, size_t n,
                                    int32_t cell);
/* Free an index (NULL: do nothing). */
OPC_EXPORT void eda_index_free(eda_index *index);

/* A search; fields are private to eda. A search needs no release. */
typedef struct eda_finder {
  const eda_index *index;
  eda_box window, cells; /* cells: columns x0 .. x1, rows y0 .. y1 */
  int32_t column, row;
  int64_t left, below; /* lower left corner of the current cell */
  uint32_t at, end;
} eda_finder;

/* Start a search for boxes that touch a window, also in edges or corners.
   [any] */
OPC_EXPORT eda_finder eda_index_find(const eda_index *index, eda_box window);

/* Write the number of the next box and return 1; return 0 after the last box.
   Each box is found once, in the first visited cell that contains a part of the
   box within the window. Cells are visited row by row from below, boxes of a
   cell by number, which makes the order reproducible. [any] */
OPC_EXPORT int eda_index_next(eda_finder *finder, uint32_t *number);

/* ---- disjoint sets of numbers (union-find) ---- */

/* Return the smallest member of the set that contains i. parent[i] is a member
   of the same set with parent[i] <= i; they are equal only for the smallest
   member. The function shortens the path from i to the smallest member. */
OPC_UNUSED static inline uint32_t eda_set_root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

/* Unite the sets of a and b. */
OPC_UNUSED static inline void eda_sets_join(uint32_t *parent, uint32_t a,
                                            uint32_t b) {
  a = eda_set_root(parent, a);
  b = eda_set_root(parent, b);
  parent[a < b ? b : a] = a < b ? a : b;
}

OPC_C_END
