/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons as layout files hold them: without holes and, for some, with few
   points. Compiled into every writer. */
#ifndef OPCFLOW_WRITE_POLYGONS_H
#define OPCFLOW_WRITE_POLYGONS_H

#include <opcflow/opcflow.h>

/* Where the simple polygons go; an OPC_* code other than 0 ends the work. */
typedef struct polygon_taker {
  int (*polygon)(void *data, const opc_point *points, size_t n,
                 opc_error *error);
  void *data;
  size_t most; /* points that one may have */
} polygon_taker;

/* A polygon of any size, cut where it has more than take->most points; points
   that a cut makes on slanted edges are rounded. */
int polygon_cut(const opc_host *host, const opc_point *points, size_t n,
                const polygon_taker *take, opc_error *error);

/* Merged shapes: polygons without holes as they are, those with holes as
   rectangles. */
int polygons_without_holes(const opc_host *host, const opc_shapes *shapes,
                           const polygon_taker *take, opc_error *error);

#endif
