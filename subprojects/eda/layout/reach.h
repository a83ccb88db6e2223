/* SPDX-License-Identifier: BSD-3-Clause */
/* How far a layer reaches in each cell, so that a window of a layout is found
   without a walk over what lies outside of it. */
#ifndef EDA_LAYOUT_REACH_H
#define EDA_LAYOUT_REACH_H

#include <eda/index.h>

#include "layout/layout.h"
#include "layout/transform.h"

/* A box in a cell's coordinates; empty if x0 > x1. What is too large for
   numbers reaches everywhere. */
typedef struct extent {
  double x0, y0, x1, y1;
} extent;

/* Of a layer, shapes or texts; arrays by cell. */
typedef struct reach {
  extent *below; /* all that lies in the cell and below it */
  /* What the cell itself has, shapes as sheets count them or texts, and its
     instances; NULL where they are few. */
  eda_index **own, **instances;
} reach;

/* Made at the first question, for as long as the layout is not changed. [any]
 */
const reach *eda_layout_reach(const eda_layout *layout, int32_t layer,
                              bool texts);
void eda_reach_free(void *reach);

static inline bool extent_empty(extent e) { return e.x0 > e.x1; }

static inline bool extents_touch(extent a, extent b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}

/* The same as a box around it, as far as coordinates go. */
eda_box extent_box(extent e);

/* The extent of what a transform makes of one; of the window that a
   transform's results lie in. */
extent extent_through(const transform *t, extent e);
extent extent_back(const transform *t, extent window);

/* The extent of the shapes of an instance, all its members, or the first. */
extent extent_of_first(const reach *r, const instance *in);
extent extent_of_all(const reach *r, const instance *in);

/* Item i of what a cell has itself: its corners. */
extent extent_of_shape(const sheet *s, size_t i);

/* from .. to - 1 */
typedef struct span {
  uint32_t from, to;
} span;

/* The rows of an array whose members may touch a window, and the columns of a
   row; `first` is the extent of the first member. */
span extent_rows(const eda_placement *p, extent first, extent window);
span extent_columns(const eda_placement *p, extent first, extent window,
                    uint32_t row);

#endif
