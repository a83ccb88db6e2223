/* SPDX-License-Identifier: BSD-3-Clause */
/* Printed length or width of a gate on its centre line, and image log slope at
   both edges. */
#include <eda/print.h>
#include <math.h>

#include "imaging/edge.h"

/* Search distance beyond the drawn gate, nm. */
static const double reach = 300;

static double log_slope(const eda_field *image, int axis, double x, double y,
                        double place) {
  double value, slope[2];
  x += axis == EDA_X ? place : 0;
  y += axis == EDA_X ? 0 : place;
  eda_field_gradient(image, &x, &y, 1, &value, &slope[EDA_X], &slope[EDA_Y]);
  return fabs(slope[axis]) / value;
}

eda_section eda_gate_section(const eda_gates *g, size_t i, int layer,
                             const eda_field *print, const eda_field *image) {
  eda_box b = g->box[i];
  double x = ((double)b.x0 + b.x1) / 2 * g->grid;
  double y = ((double)b.y0 + b.y1) / 2 * g->grid;
  int poly = layer == EDA_POLY, axis = poly ? g->axis[i] : !g->axis[i];
  double half = (poly ? g->length[i] : g->width[i]) / 2, end[2];
  eda_line line;
  eda_line_search search[2];
  eda_section none = {NAN, NAN, NAN};
  eda_line_make(print, axis, axis == EDA_X ? y : x, &line);
  if (!(eda_line_start(&line, axis == EDA_X ? x : y, &search[0], &search[1]) >
        0))
    return none;
  for (size_t side = 0; side < 2; side++) {
    double space = poly ? g->space[2 * i + side] / 2 : INFINITY;
    end[side] = eda_line_search_to(&search[side], half + fmin(reach, space));
  }
  if (isnan(end[0]) || isnan(end[1])) return none;
  return (eda_section){end[0] + end[1], log_slope(image, axis, x, y, -end[0]),
                       log_slope(image, axis, x, y, end[1])};
}
