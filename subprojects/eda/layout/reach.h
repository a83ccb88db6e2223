/* SPDX-License-Identifier: BSD-3-Clause */
/* Extents of a layer in each cell, for finding shapes in a window without
   traversing shapes outside. */
#pragma once

#include <eda/index.h>

#include "layout/layout.h"
#include "layout/transform.h"

/* A bounding box in coordinates of a cell; empty if x0 > x1. Coordinates may be
   infinite after an overflow. */
typedef struct extent {
  double x0, y0, x1, y1;
} extent;

/* Extents of the shapes or texts of one layer; arrays indexed by cell. */
typedef struct reach {
  extent *below; /* extent of each cell including all cells below */
  /* Spatial indices of a cell's own items (shapes in the order of the sheet, or
     texts) and of its instances; NULL for few items. */
  eda_index **own, **instances;
} reach;

/* Return the extents of a layer, computed on the first request. The result is
   valid until the layout changes. [any] */
const reach *eda_layout_reach(const eda_layout *layout, int32_t layer,
                              bool texts);

/* Return whether an extent contains no point; return whether two extents share
   a point. */
static inline bool extent_empty(extent e) { return e.x0 > e.x1; }
static inline bool extents_touch(extent a, extent b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

/* Convert an extent to the smallest enclosing box, limited to 32-bit
   coordinates. */
eda_box extent_box(extent e);

/* Return the bounding box of the window after the inverse of the transform. */
extent extent_back(const transform *t, extent window);

/* Return the extent of the first member, or of all members, of an instance. */
extent extent_of_first(const reach *r, const instance *in);
extent extent_of_all(const reach *r, const instance *in);

/* Return the extent of shape i of a sheet. */
extent extent_of_shape(const sheet *s, size_t i);

/* The numbers from `from` to `to` - 1. */
typedef struct span {
  uint32_t from, to;
} span;

/* Return the rows of an array, or the columns of row `row`, whose members may
   touch a window. `first` is the extent of the first member. */
span extent_rows(const eda_placement *p, extent first, extent window);
span extent_columns(const eda_placement *p, extent first, extent window,
                    uint32_t row);
