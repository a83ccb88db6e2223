/* SPDX-License-Identifier: BSD-3-Clause */
/* Functions for several layout formats: layer numbers, and conversion to
   polygons without holes and with a limited number of points. [any]: see
   opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>

OPC_C_BEGIN

/* A layer of a numbered format (GDSII, OASIS). */
typedef struct eda_layer_number {
  uint32_t layer, datatype;
} eda_layer_number;

/* Parse LAYER/DATATYPE ("9/0"), numbers up to `most`. If `any` is not NULL,
   also parse LAYER, which selects every datatype (*any = 1). Return 1; 0 for
   other texts. [any] */
OPC_EXPORT int eda_layer_number_read(const char *text, uint32_t most,
                                     eda_layer_number *out, int *any);

/* Return the default number (datatype 0) of a layer in output files: 9 for
   layer EDA_POLY, 1 for layer EDA_ACTIVE, 10 for "contact"; 11, 12, ... for
   other layers, in order. Drawn shapes of a corrected layer have this number +
   EDA_DRAWN_NUMBER. [any] */
OPC_EXPORT uint32_t eda_gates_number(const eda_gates *gates, size_t layer);
/* Difference between the layer numbers of drawn and of corrected shapes. */
enum { EDA_DRAWN_NUMBER = 100 };

/* Callback for polygons without holes. A code other than OPC_OK ends the
   conversion, which returns the code. */
typedef struct eda_polygon_taker {
  int (*polygon)(void *data, const eda_point *points, size_t n,
                 opc_error *error);
  void *data;
  size_t most; /* largest number of points of a polygon */
} eda_polygon_taker;

/* Pass a polygon of any size to `take`, dissected if it has more than
   take->most points. New points on slanted edges are rounded. Return OPC_FAILED
   if the polygon cannot be dissected, or the code of `take`. [any] */
OPC_EXPORT int eda_polygon_cut(const eda_point *points, size_t n,
                               const eda_polygon_taker *take, opc_error *error);

/* Pass merged shapes to `take`: polygons without holes as by eda_polygon_cut,
   polygons with holes dissected into rectangles. Polygons with holes need edges
   parallel to the axes. [any] */
OPC_EXPORT int eda_polygons_without_holes(const eda_shapes *shapes,
                                          const eda_polygon_taker *take,
                                          opc_error *error);

OPC_C_END
