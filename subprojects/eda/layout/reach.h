/* SPDX-License-Identifier: BSD-3-Clause */
/* Extents of a layer in each cell, used to find the shapes in a window of a
   layout without a traversal of the shapes outside. */
#pragma once

#include <eda/index.h>

#include "layout/layout.h"
#include "layout/transform.h"

/* A box in the coordinates of a cell; empty if x0 > x1. A coordinate beyond the
   range of numbers is infinite. */
typedef struct extent {
  double x0, y0, x1, y1;
} extent;

/* Extents of the shapes or texts of a layer; arrays by cell. */
typedef struct reach {
  extent *below; /* extent of the cell and all cells below */
  /* Indices of the items of the cell itself (shapes in the order of the sheet,
     or texts) and of its instances; NULL for few. */
  eda_index **own, **instances;
} reach;

/* Return the extents of a layer, computed on first request and valid until the
   layout changes. [any] */
const reach *eda_layout_reach(const eda_layout *layout, int32_t layer,
                              bool texts);
void eda_reach_free(void *reach);

static inline bool extent_empty(extent e) { return e.x0 > e.x1; }

static inline bool extents_touch(extent a, extent b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

/* Convert an extent to a box, limited to the range of coordinates. */
eda_box extent_box(extent e);

/* extent_through returns the bounds of the transformed extent e; extent_back
   returns an extent whose transform covers the window. */
extent extent_through(const transform *t, extent e);
extent extent_back(const transform *t, extent window);

/* Return the extent of the shapes of an instance: of all members, or of the
   first one. */
extent extent_of_first(const reach *r, const instance *in);
extent extent_of_all(const reach *r, const instance *in);

/* Return the extent of item i of a cell. */
extent extent_of_shape(const sheet *s, size_t i);

/* from .. to - 1 */
typedef struct span {
  uint32_t from, to;
} span;

/* Return the rows of an array, or the columns of one row, whose members may
   touch a window; `first` is the extent of the first member. */
span extent_rows(const eda_placement *p, extent first, extent window);
span extent_columns(const eda_placement *p, extent first, extent window,
                    uint32_t row);
