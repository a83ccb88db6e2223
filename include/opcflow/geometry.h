/* SPDX-License-Identifier: BSD-3-Clause */
/* Flat geometry: points, boxes, polygons, and the services on them. */
#ifndef OPCFLOW_GEOMETRY_H
#define OPCFLOW_GEOMETRY_H

#include <opcflow/plugin.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Integers in some unit (a layout's database unit, a mask's grid). Frozen. */
typedef struct opc_point {
  int32_t x, y;
} opc_point;

typedef struct opc_box {
  int32_t x0, y0, x1, y1;    /* x0 <= x1, y0 <= y1; empty if x0 > x1 */
} opc_box;

/* Polygons in plain arrays: polygon i has the points start[i] .. start[i+1]-1,
   in order, the last joined to the first. Merged shapes (what the services
   return) do not overlap, have no collinear or repeated points, outlines
   counter-clockwise and holes clockwise, each hole a polygon of its own;
   `hole` tells which (NULL: none is). Frozen. The host allocates them;
   geometry->release frees the arrays and clears the struct. */
typedef struct opc_shapes {
  size_t count;
  uint32_t *start;           /* count + 1, start[0] = 0; NULL if count = 0 */
  opc_point *points;
  uint8_t *hole;
} opc_shapes;

enum { OPC_OR = 0, OPC_AND = 1, OPC_NOT = 2, OPC_XOR = 3 };

/* All [any]. Coordinates stay within +-2^30. Only rectilinear polygons for
   now: a polygon with a slanted edge is refused with OPC_INVALID and the
   coordinates of that edge. `shapes` given as input may overlap, have any
   orientation and repeated or collinear points; a polygon's inside is where
   its winding number is not zero. Where `hole` is not NULL, the polygons must
   not cross themselves; holes count against the outlines. */
struct opc_geometry_service {
  size_t size;

  /* a OP b, merged: polygons that touch along an edge become one, polygons
     that touch in a corner stay two. b may be NULL (OPC_OR: merge a). The
     order of the result depends on the geometry alone: by lowest, then
     leftmost point. */
  int (*boolean)(const opc_host *host, int op, const opc_shapes *a,
                 const opc_shapes *b, opc_shapes *out, opc_error *error);

  /* Cut merged shapes into rectangles that do not overlap; of horizontal and
     vertical cuts, each polygon (with its holes) takes the way that gives
     fewer. *boxes is freed with host->free. */
  int (*fracture)(const opc_host *host, const opc_shapes *shapes,
                  opc_box **boxes, size_t *count, opc_error *error);

  /* Twice the signed area, holes subtracted. */
  int64_t (*area2)(const opc_shapes *shapes);

  void (*release)(opc_shapes *shapes);
};

#ifdef __cplusplus
}
#endif
#endif
