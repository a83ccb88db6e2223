/* SPDX-License-Identifier: BSD-3-Clause */
/* Boxes by their place: which of many lie near one. The boxes are spread over a
   grid of square cells; a search looks at the cells that its window meets.

     eda_index *index = eda_index_new(boxes, n, reach);
     eda_finder f = eda_index_find(index, window);
     for (uint32_t i; eda_index_next(&f, &i);)
       use(boxes[i]);
     eda_index_free(index);

   A place is a box of no extent, an edge one of no width. What is not a box is
   looked for by its bounding box, and looked at again by who finds it. */
#ifndef EDA_INDEX_H
#define EDA_INDEX_H

#include <eda/geometry.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct eda_index eda_index;

/* An index of n boxes, which are copied; n below 2^32. `cell` is the side of a
   cell in the boxes' unit, best about as large as a window: it is enlarged
   where that would give more than a few cells for each box, or more than a few
   boxes for each cell. 0: as many cells as boxes. An empty box (x0 > x1) is
   never found. [any] */
OPC_EXPORT eda_index *eda_index_new(const eda_box *boxes, size_t n,
                                    int32_t cell);
/* NULL: nothing. */
OPC_EXPORT void eda_index_free(eda_index *index);

/* A search; the fields are eda's own. It needs no clearing and may be left at
   any time. */
typedef struct eda_finder {
  const eda_index *index;
  eda_box window, cells; /* cells: columns x0 .. x1, rows y0 .. y1 */
  int32_t column, row;
  int64_t left, below; /* of the cell: where it begins */
  uint32_t at, end;
} eda_finder;

/* Find the boxes that touch a window, be it in an edge or a corner. [any] */
OPC_EXPORT eda_finder eda_index_find(const eda_index *index, eda_box window);

/* The number of the next box; 0 if there are no more. Each comes once: by the
   first cell in which it meets the window, row by row from below, and in a cell
   by number. The order depends on nothing but the boxes, the cell and the
   window. [any] */
OPC_EXPORT int eda_index_next(eda_finder *finder, uint32_t *number);

#ifdef __cplusplus
}
#endif
#endif
