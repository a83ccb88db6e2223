/* SPDX-License-Identifier: BSD-3-Clause */
/* Slicing of a gate (rule `contour`): few slices that preserve the width, area
   and currents of the printed contour. */
#pragma once

#include <eda/curves.h>
#include <eda/extractor.h>

/* Smallest and largest number of slices. */
enum { CONTOUR_LEAST = 8, CONTOUR_MOST = 96 };

/* Return the weight of a slice at `edge` nm from the nearer active edge of a
   transistor of `width` nm. The weight is the current divided by the current of
   a wide slice of equal length (thesis eq. 3.2). */
typedef double contour_weight(const void *self, int type, int current,
                              double edge, double width);

/* State of the slicing. */
typedef struct contour contour;

/* Return a new state; free a state. */
contour *contour_new(void);
void contour_free(contour *c);

/* Find n slices of a gate: centres (place) and widths, [n], as fractions of the
   gate's width. If `weight` is NULL, all weights are 1; `self` is the first
   argument of `weight`. `reach`: decay length of the edge current, nm. Return 0
   if no n slices preserve width, area and currents. */
int contour_slice(const contour *c, const eda_curves *table, double reach,
                  contour_weight *weight, const void *self,
                  const eda_printed_gate *gate, size_t n, double *place,
                  double *width);
