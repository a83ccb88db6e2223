/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/imaging/spline.h"

#include <math.h>

/* The nonzero B-splines of degree n at the fraction t of a cell, by the
   recurrence of Cox and de Boor; weight[0] belongs to the spline that ends
   first. */
static void recurrence(int degree, double t, double *weight) {
  double factorial = 1;
  for (int d = 2; d <= degree; d++) factorial *= d;
  weight[0] = 1 / factorial;
  for (int d = 1; d <= degree; d++) {
    weight[d] = weight[d - 1] * t;
    for (int i = d - 1; i > 0; i--)
      weight[i] = weight[i - 1] * (t + d - i) + weight[i] * (1 - t + i);
    weight[0] *= 1 - t;
  }
}

int opc_spline_weights(double x, double weight[OPC_SPLINE_TAPS]) {
  int cell = (int)x;
  cell -= x < cell;
  opc_spline_cell(x - cell, weight);
  return cell - 2;
}

/* The derivative of a B-spline is the difference of two of a degree less. */
void opc_spline_slopes(double x, double slope[OPC_SPLINE_TAPS]) {
  double below[OPC_SPLINE_TAPS - 1];
  recurrence(4, x - floor(x), below);
  slope[0] = -below[0];
  for (int i = 1; i < OPC_SPLINE_TAPS - 1; i++)
    slope[i] = below[i - 1] - below[i];
  slope[OPC_SPLINE_TAPS - 1] = below[OPC_SPLINE_TAPS - 2];
}

int opc_spline_step(double x, double weight[OPC_STEP_TAPS]) {
  double cell = floor(x);
  recurrence(OPC_RASTER_DEGREE + 1, x - cell, weight);
  return (int)cell - OPC_RASTER_DEGREE / 2;
}

int opc_spline_smoothing(double x, double weight[OPC_STEP_TAPS - 1]) {
  double cell = floor(x);
  recurrence(OPC_RASTER_DEGREE, x - cell, weight);
  return (int)cell - OPC_RASTER_DEGREE / 2;
}

double opc_spline_sampled(double f) {
  double c = 2 * M_PI * f;
  return (66 + 52 * cos(c) + 2 * cos(2 * c)) / 120;
}
