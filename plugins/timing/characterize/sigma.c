/* SPDX-License-Identifier: BSD-3-Clause */
/* Standard deviations of delays and slews by line edges, which differ from one
   transistor to the next. */
#include <math.h>
#include <stdlib.h>

#include "characterize.h"

/* Intervals of the integral over the width. */
enum { INTERVALS = 2000 };

/* The mean length along the width has the variance 2 sigma^2 times the mean of
   exp(-(|x - y| / length)^(2 hurst)) over all pairs x, y, because the two edges
   are independent. For the distance r the share of pairs is
   2 (w - r) / w^2 dr. */
double edges_sigma(const line_edges *e, double length, double width) {
  double sum = 0;
  for (int i = 0; i < INTERVALS; i++) {
    double share = (i + 0.5) / INTERVALS;
    sum += (1 - share) * exp(-pow(share * width / e->length, 2 * e->hurst)) *
           2 / INTERVALS;
  }
  return e->sigma * sqrt(2 * sum) / length;
}

/* A change of the mean length changes the length for the current and that for
   the capacitance. */
void arc_sigma(const line_edges *e, const eda_timing_cell *c,
               const eda_timing_arc *a, double *delay, double *slew) {
  size_t n = c->slews * c->loads;
  double *change = eda_alloc(c->bundles * EDA_SIZES, sizeof *change);
  double *row = eda_alloc(4 * c->slews, sizeof *row);
  double *d0 = row, *s0 = d0 + c->slews, *d = s0 + c->slews, *s = d + c->slews;
  for (size_t i = 0; i < n; i++) delay[i] = slew[i] = 0;
  for (size_t i = 0; i < c->devices; i++) {
    const eda_timing_device *t = &c->device[i];
    double *own = change + t->bundle * EDA_SIZES;
    own[EDA_SIZE_L] = own[EDA_SIZE_C] =
        t->share * edges_sigma(e, t->length, t->width);
    for (size_t k = 0; k < c->loads; k++) {
      double load = c->at_load[k];
      eda_timing_at(c, a, load, load, NULL, d0, s0);
      eda_timing_at(c, a, load, load, change, d, s);
      for (size_t j = 0; j < c->slews; j++) {
        delay[j * c->loads + k] += pow(d[j] - d0[j], 2);
        slew[j * c->loads + k] += pow(s[j] - s0[j], 2);
      }
    }
    own[EDA_SIZE_L] = own[EDA_SIZE_C] = 0;
  }
  for (size_t i = 0; i < n; i++) {
    delay[i] = sqrt(delay[i]);
    slew[i] = sqrt(slew[i]);
  }
  free(change);
  free(row);
}
