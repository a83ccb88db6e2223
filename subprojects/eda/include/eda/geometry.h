/* SPDX-License-Identifier: BSD-3-Clause */
/* Flat geometry: points, boxes, polygons and operations on them. [any]: see
   opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* A point with integer coordinates in some unit (database unit of a layout,
   grid of a mask). */
typedef struct eda_point {
  int32_t x, y;
} eda_point;

/* A box with sides parallel to the axes. */
typedef struct eda_box {
  int32_t x0, y0, x1, y1; /* x0 <= x1, y0 <= y1; empty if x0 > x1 */
} eda_box;

/* Boxes that the struct does not own. */
typedef struct eda_boxes {
  const eda_box *box;
  size_t count;
} eda_boxes;

/* A growing list of boxes; free `box` with free(). */
typedef struct eda_box_list {
  eda_box *box;
  size_t count, capacity;
} eda_box_list;

/* Append a box to a list. [any] */
OPC_EXPORT void eda_box_list_add(eda_box_list *list, eda_box box);

/* Initialiser of an empty box, for extension by eda_box_join. */
#define EDA_BOX_EMPTY \
  { INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN }

/* Extend a box to contain another one. [any] */
OPC_UNUSED static inline void eda_box_join(eda_box *all, eda_box b) {
  if (b.x0 < all->x0) all->x0 = b.x0;
  if (b.y0 < all->y0) all->y0 = b.y0;
  if (b.x1 > all->x1) all->x1 = b.x1;
  if (b.y1 > all->y1) all->y1 = b.y1;
}

/* Return a box with all sides moved outwards by `by`. [any] */
OPC_UNUSED static inline eda_box eda_box_grown(eda_box b, int32_t by) {
  eda_box grown = {b.x0 - by, b.y0 - by, b.x1 + by, b.y1 + by};
  return grown;
}

/* eda_boxes_touch: return whether two boxes share at least a point.
   eda_boxes_overlap: return whether two boxes share an area. [any] */
OPC_UNUSED static inline int eda_boxes_touch(eda_box a, eda_box b) {
  return a.x0 <= b.x1 && b.x0 <= a.x1 && a.y0 <= b.y1 && b.y0 <= a.y1;
}
OPC_UNUSED static inline int eda_boxes_overlap(eda_box a, eda_box b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

/* Return the Euclidean distance between the centres of two boxes. [any] */
OPC_EXPORT double eda_box_distance(eda_box a, eda_box b);

/* Return the bounding box of n points; empty for n = 0. [any] */
OPC_UNUSED static inline eda_box eda_bounds(const eda_point *points, size_t n) {
  eda_box b = EDA_BOX_EMPTY;
  size_t i;
  for (i = 0; i < n; i++) {
    if (points[i].x < b.x0) b.x0 = points[i].x;
    if (points[i].y < b.y0) b.y0 = points[i].y;
    if (points[i].x > b.x1) b.x1 = points[i].x;
    if (points[i].y > b.y1) b.y1 = points[i].y;
  }
  return b;
}

/* Polygons in plain arrays: polygon i has the points start[i] .. start[i+1]-1
   in order, the last joined to the first. Merged shapes (returned by the
   functions below) do not overlap and have no collinear or repeated points.
   Their outlines run counter-clockwise and their holes clockwise. Each hole is
   a polygon of its own, marked in `hole` (NULL: no holes). */
typedef struct eda_shapes {
  size_t count;
  uint32_t *start; /* [count + 1], start[0] = 0; NULL if count = 0 */
  eda_point *points;
  uint8_t *hole;
} eda_shapes;

/* Return whether n points are the corners of a rectangle, in order. [any] */
OPC_EXPORT int eda_is_box(const eda_point *points, size_t n);

/* Return the bounding box of polygon i. [any] */
OPC_EXPORT eda_box eda_shape_box(const eda_shapes *shapes, size_t i);

/* eda_shapes_of_boxes: return `n` polygons of four corners, all zero; the
   caller frees them by eda_shapes_clear. eda_shapes_set_box: set polygon i to
   the corners of a box, counter-clockwise from the lower left corner. Set the
   polygons in ascending order of i. */
OPC_EXPORT eda_shapes eda_shapes_of_boxes(size_t n);
OPC_EXPORT void eda_shapes_set_box(eda_shapes *shapes, size_t i, eda_box box);

/* Operations of eda_boolean; EDA_NOT: the area of a without that of b. */
enum { EDA_OR = 0, EDA_AND = 1, EDA_NOT = 2, EDA_XOR = 3 };

/* The functions below are [any] and have these rules.

   Input shapes may overlap, have any orientation and repeated or collinear
   points; the inside of a polygon is where its winding number is not zero. If
   `hole` is not NULL, the polygons must not intersect themselves, and holes are
   subtracted from the outlines. Coordinates must be within +-2^30 and edges
   parallel to an axis; otherwise functions return OPC_INVALID and an error with
   the coordinates. */

/* Compute *out = a OP b, merged. Polygons that touch along an edge are joined;
   polygons that touch in a corner stay separate. b may be NULL (EDA_OR: merge
   a). The order of the result depends on the geometry only: by lowest, then
   leftmost point. *out is overwritten and empty on failure; the caller frees it
   by eda_shapes_clear. Return OPC_FAILED for more than 2^31 result edges. */
OPC_EXPORT int eda_boolean(int op, const eda_shapes *a, const eda_shapes *b,
                           eda_shapes *out, opc_error *error);

/* Move all edges of merged shapes outwards by `by`, inwards if `by` is
   negative; *out as in eda_boolean. Corners stay square. Growing closes spaces
   that are at most 2 |by| wide; shrinking removes parts of shapes that are at
   most 2 |by| wide. */
OPC_EXPORT int eda_shapes_grow(const eda_shapes *shapes, int32_t by,
                               eda_shapes *out, opc_error *error);

/* Move points in place so that edges that deviate from an axis by at most
   `most` become parallel to the axis. A chain of such edges moves to the middle
   between its smallest and largest coordinate. A chain with a larger total
   deviation counts as slanted and stays unchanged. Return the number of
   straightened edges. */
OPC_EXPORT size_t eda_shapes_straighten(const eda_shapes *shapes, int32_t most);

/* Dissect merged shapes into non-overlapping rectangles, by horizontal or
   vertical cuts, whichever yields fewer rectangles for a polygon and its holes.
   Boxes are ordered by lowest, then leftmost corner. Free *boxes with free();
   NULL on failure. */
OPC_EXPORT int eda_fracture(const eda_shapes *shapes, eda_box **boxes,
                            size_t *count, opc_error *error);

/* Return twice the area of merged shapes, holes subtracted, in the square of
   their unit. For other shapes: twice the sum of the signed areas of their
   polygons. */
OPC_EXPORT int64_t eda_area2(const eda_shapes *shapes);

/* Free the arrays (allocated by eda_alloc) and clear the struct. */
OPC_EXPORT void eda_shapes_clear(eda_shapes *shapes);

OPC_C_END
