/* SPDX-License-Identifier: BSD-3-Clause */
/* What layout files of several formats have in common: how layers are numbered,
   and polygons as files hold them, without holes and with few points. */
#ifndef EDA_FORMATS_H
#define EDA_FORMATS_H

#include <eda/gates.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A layer of a numbered format (GDSII, OASIS). */
typedef struct eda_layer_number {
  uint32_t layer, datatype;
} eda_layer_number;

/* "9/0" or, where `any` is not NULL, "9" for every datatype (*any = 1); numbers
   up to `most`. 0 if it is neither. [any] */
OPC_EXPORT int eda_layer_number_read(const char *text, uint32_t most,
                                     eda_layer_number *out, int *any);

/* The layer, of datatype 0, that a layer of these gates is written as where the
   flow says nothing: the first (poly) 9, the second (active) 1, contact 10,
   others from 11 on, in order. What is drawn on a corrected one goes
   EDA_DRAWN_NUMBER further. [any] */
OPC_EXPORT uint32_t eda_gates_number(const eda_gates *gates, size_t layer);
enum { EDA_DRAWN_NUMBER = 100 };

/* Where simple polygons go; a code other than OPC_OK ends the work. */
typedef struct eda_polygon_taker {
  int (*polygon)(void *data, const eda_point *points, size_t n,
                 opc_error *error);
  void *data;
  size_t most; /* points that one may have */
} eda_polygon_taker;

/* A polygon of any size, cut where it has more than take->most points; points
   that a cut makes on slanted edges are rounded. [any] */
OPC_EXPORT int eda_polygon_cut(const eda_point *points, size_t n,
                               const eda_polygon_taker *take, opc_error *error);

/* Merged shapes: polygons without holes as they are, those with holes as
   rectangles. [any] */
OPC_EXPORT int eda_polygons_without_holes(const eda_shapes *shapes,
                                          const eda_polygon_taker *take,
                                          opc_error *error);

#ifdef __cplusplus
}
#endif
#endif
