/* SPDX-License-Identifier: BSD-3-Clause */
/* Common part of extractors that slice gates (thesis eq. 2.1 to 2.4 and 3.2). A
   plugin may add parameters and weights of slices. */
#pragma once

#include <opcflow/plugin.h>

#include "contour.h"

/* First member of the instance of each extractor that slices gates. */
typedef struct slicer {
  const opc_host *host;
  const char *path; /* path of the device table */
  int64_t slices;
  int rule;
  double *place, *width; /* [slices]: centres and widths of slices, fractions of
                            the gate's width. With the rule `contour`, they are
                            used only if contour_slice fails. */
  contour *contour;      /* NULL for other rules than `contour` */
  eda_curves curves;
  contour_weight *weight; /* weight of a slice; if NULL, all weights are 1 */
  double reach;           /* decay length of the edge current, nm */
} slicer;

/* clang-format off */
#define SLICER_PARAMETERS                                                     \
  {.name = "devices", .type = OPC_FILE, .flags = OPC_REQUIRED,                \
   .summary = "device table: currents by length, or by length and width",     \
   OPC_FIELD(slicer, path)},                                                  \
  {.name = "slices", .type = OPC_INT,                                         \
   .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "12", .min = 1,             \
   .max = 10000, .summary = "number of slices across the width of a gate",    \
   OPC_FIELD(slicer, slices)},                                                \
  {.name = "rule", .type = OPC_CHOICE, .preset = "contour",                   \
   .choices = "contour|gauss|equal",                                          \
   .summary = "slices adapted to the contour of each gate, at "               \
              "Gauss-Legendre nodes, or of equal width",                      \
   OPC_FIELD(slicer, rule)},                                                  \
  {.name = "edge", .type = OPC_REAL, .unit = "nm", .preset = "30 nm",         \
   .flags = OPC_AT_LEAST | OPC_AT_MOST, .min = 1, .max = 1e6,                 \
   .summary = "decay length of the edge current, from the active edges "      \
              "inwards; used with device tables of several widths for gates " \
              "that are not rectangles",                                      \
   OPC_FIELD(slicer, reach)}
/* clang-format on */

/* Implement `check` and `clear` of opc_plugin (opcflow/plugin.h). */
int slicer_check(void *self, opc_error *error);
void slicer_clear(void *self);

/* Implement the functions of eda_extractor (eda/extractor.h). */
int slicer_prepare(void *self, opc_error *error);
size_t slicer_slicing(const void *self, const double **place,
                      const double **width);
void slicer_slice(const void *self, const eda_printed_gate *gate, double *place,
                  double *width);
int slicer_extract(const void *self, const eda_slices *in, eda_performance *out,
                   opc_error *error);
int slicer_range(const void *self, int type, double *shortest, double *longest);
double slicer_modelled(const void *self, int type, const char *flavour);
