/* SPDX-License-Identifier: BSD-3-Clause */
/* Polygons as GDSII can hold them: without holes and with few points. */
#ifndef OPCFLOW_GDS_POLYGONS_H
#define OPCFLOW_GDS_POLYGONS_H

#include <opcflow/opcflow.h>

/* Points of a polygon that fit one record, its first point twice. */
enum { GDS_MAX_POINTS = 8190 };

/* Where the simple polygons go; an OPC_* code other than 0 ends the work. */
typedef struct gds_taker {
  int (*polygon)(void *data, const opc_point *points, size_t n,
                 opc_error *error);
  void *data;
} gds_taker;

/* A polygon of any size, cut where it has more than GDS_MAX_POINTS points;
   points that a cut makes on slanted edges are rounded. */
int gds_cut(const opc_host *host, const opc_point *points, size_t n,
            const gds_taker *take, opc_error *error);

/* Merged shapes: polygons without holes as they are, those with holes as
   rectangles. */
int gds_without_holes(const opc_host *host, const opc_shapes *shapes,
                      const gds_taker *take, opc_error *error);

#endif
