/* SPDX-License-Identifier: BSD-3-Clause */
/* What the extractors that slice a gate have in common (thesis eq. 2.1 to 2.4
   and 3.2): a plugin adds its own parameters, and its weight of a slice. */
#ifndef EXTRACT_SLICER_H
#define EXTRACT_SLICER_H

#include <opcflow/extract.h>

#include "contour.h"
#include "curves.h"

/* The state of an extractor begins with this. */
typedef struct slicer {
  const opc_host *host;
  const char *path;          /* of the device table */
  size_t slices;
  double *place, *width;     /* of every gate, or of those too broken to follow */
  contour *contour;          /* NULL: all gates are sliced alike */
  curves curves;
  contour_weight *weight;    /* NULL: 1 */
} slicer;

enum { SLICER_DEVICES, SLICER_SLICES, SLICER_RULE, SLICER_PARAMETERS };

/* Declarations of the parameters above, to be listed first. */
#define SLICER_DECLARATIONS                                                  \
  [SLICER_DEVICES] = {.name = "devices", .type = OPC_FILE,                   \
                      .flags = OPC_REQUIRED,                                 \
                      .summary = "device table: currents against length"},   \
  [SLICER_SLICES] = {.name = "slices", .type = OPC_INT,                      \
                     .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "12",    \
                     .min = 1, .max = 10000,                                 \
                     .summary = "slices across the width of a gate"},        \
  [SLICER_RULE] = {.name = "rule", .type = OPC_CHOICE, .preset = "contour",  \
                   .choices = "contour|gauss|equal",                         \
                   .summary = "slices that follow the contour, at "          \
                              "Gauss-Legendre nodes, or of equal width"}

/* A zeroed slicer from its parameters: 1; 0 and *error. */
int slicer_make(slicer *s, const opc_host *host, const opc_value *values,
                opc_error *error);
void slicer_clear(slicer *s);

/* The operations of an extractor. */
int slicer_prepare(void *self, opc_error *error);
size_t slicer_slicing(const void *self, const double **place,
                      const double **width);
void slicer_slice(const void *self, const opc_printed_gate *gate,
                  double *place, double *width);
int slicer_extract(const void *self, const opc_slices *in,
                   opc_performance *out, opc_error *error);

#endif
