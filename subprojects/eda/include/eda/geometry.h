/* SPDX-License-Identifier: BSD-3-Clause */
/* Flat geometry: points, boxes, polygons, and what can be done with them. */
#ifndef EDA_GEOMETRY_H
#define EDA_GEOMETRY_H

#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Integers in some unit (a layout's database unit, a mask's grid). */
typedef struct eda_point {
  int32_t x, y;
} eda_point;

typedef struct eda_box {
  int32_t x0, y0, x1, y1; /* x0 <= x1, y0 <= y1; empty if x0 > x1 */
} eda_box;

/* Boxes of somebody else's. */
typedef struct eda_boxes {
  const eda_box *box;
  size_t count;
} eda_boxes;

/* Boxes that become more: `box` is freed with free(). */
typedef struct eda_box_list {
  eda_box *box;
  size_t count, room;
} eda_box_list;

OPC_EXPORT void eda_box_list_add(eda_box_list *list, eda_box box);

/* The least box around n points; empty for none. [any] */
OPC_UNUSED static inline eda_box eda_bounds(const eda_point *points, size_t n) {
  eda_box b = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  size_t i;
  for (i = 0; i < n; i++) {
    if (points[i].x < b.x0) b.x0 = points[i].x;
    if (points[i].y < b.y0) b.y0 = points[i].y;
    if (points[i].x > b.x1) b.x1 = points[i].x;
    if (points[i].y > b.y1) b.y1 = points[i].y;
  }
  return b;
}

/* Polygons in plain arrays: polygon i has the points start[i] .. start[i+1]-1,
   in order, the last joined to the first. Merged shapes (what functions here
   return) do not overlap, have no collinear or repeated points, outlines
   counter-clockwise and holes clockwise, each hole a polygon of its own;
   `hole` tells which (NULL: none is). */
typedef struct eda_shapes {
  size_t count;
  uint32_t *start; /* count + 1, start[0] = 0; NULL if count = 0 */
  eda_point *points;
  uint8_t *hole;
} eda_shapes;

enum { EDA_OR = 0, EDA_AND = 1, EDA_NOT = 2, EDA_XOR = 3 };

/* All functions are [any].

   Shapes that are given may overlap, have any orientation and repeated or
   collinear points; a polygon's inside is where its winding number is not zero.
   Where `hole` is not NULL, the polygons must not cross themselves; holes count
   against the outlines. Coordinates stay within +-2^30, and edges are parallel
   to an axis; others are refused with OPC_INVALID and their coordinates. */

/* *out = a OP b, merged: polygons that touch along an edge become one, polygons
   that touch in a corner stay two. b may be NULL (EDA_OR: merge a). The
   order of the result depends on the geometry alone: by lowest, then
   leftmost point. *out is overwritten and the caller's, who clears it; it is
   empty on failure. OPC_FAILED if it would have more than 2^31 edges. */
OPC_EXPORT int eda_boolean(int op, const eda_shapes *a, const eda_shapes *b,
                           eda_shapes *out, opc_error *error);

/* All edges of merged shapes moved outwards by `by`, inwards if that is below
   0; *out is as of eda_boolean. Corners stay square; spaces or shapes of at
   most twice as much vanish. */
OPC_EXPORT int eda_shapes_grow(const eda_shapes *shapes, int32_t by,
                               eda_shapes *out, opc_error *error);

/* Move points, in place, so that edges that are off an axis by at most `most`
   lie along it: edges that follow one another so get the middle of their least
   and largest coordinate. Where they lead further away than `most` together,
   they are slanted, and stay. How many edges were straightened. */
OPC_EXPORT size_t eda_shapes_straighten(const eda_shapes *shapes, int32_t most);

/* Cut merged shapes into rectangles that do not overlap; of horizontal and
   vertical cuts, each polygon (with its holes) takes the way that gives
   fewer. The boxes come by lowest, then leftmost corner; *boxes is freed with
   free(), and NULL on failure. */
OPC_EXPORT int eda_fracture(const eda_shapes *shapes, eda_box **boxes,
                            size_t *count, opc_error *error);

/* Twice the area of merged shapes, holes subtracted, in the square of their
   unit. Of other shapes: twice the sum of their polygons' signed areas. */
OPC_EXPORT int64_t eda_area2(const eda_shapes *shapes);

/* Free the arrays, which come from eda_alloc, and zero the struct. */
OPC_EXPORT void eda_shapes_clear(eda_shapes *shapes);

#ifdef __cplusplus
}
#endif
#endif
