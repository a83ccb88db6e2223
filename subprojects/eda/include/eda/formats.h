/* SPDX-License-Identifier: BSD-3-Clause */
/* Common parts of several layout formats: layer numbers, and polygons without
   holes and with a limited number of points. */
#pragma once

#include <eda/gates.h>

OPC_C_BEGIN

/* A layer of a numbered format (GDSII, OASIS). */
typedef struct eda_layer_number {
  uint32_t layer, datatype;
} eda_layer_number;

/* Parse "9/0" or, if `any` is not NULL, "9" for every datatype (*any = 1);
   numbers up to `most`. Return 0 for any other text. [any] */
OPC_EXPORT int eda_layer_number_read(const char *text, uint32_t most,
                                     eda_layer_number *out, int *any);

/* Return the default layer number (datatype 0) of a layer of these gates: the
   first (poly) 9, the second (active) 1, contact 10, others from 11 on, in
   order. Drawn shapes of a corrected layer get this number plus
   EDA_DRAWN_NUMBER. [any] */
OPC_EXPORT uint32_t eda_gates_number(const eda_gates *gates, size_t layer);
enum { EDA_DRAWN_NUMBER = 100 };

/* Receiver of simple polygons; a code other than OPC_OK ends the work. */
typedef struct eda_polygon_taker {
  int (*polygon)(void *data, const eda_point *points, size_t n,
                 opc_error *error);
  void *data;
  size_t most; /* largest number of points of a polygon */
} eda_polygon_taker;

/* Pass a polygon of any size to `take`, dissected if it has more than
   take->most points. Points made on slanted edges are rounded. [any] */
OPC_EXPORT int eda_polygon_cut(const eda_point *points, size_t n,
                               const eda_polygon_taker *take, opc_error *error);

/* Pass merged shapes to `take`: polygons without holes unchanged, polygons with
   holes as rectangles. [any] */
OPC_EXPORT int eda_polygons_without_holes(const eda_shapes *shapes,
                                          const eda_polygon_taker *take,
                                          opc_error *error);

OPC_C_END
