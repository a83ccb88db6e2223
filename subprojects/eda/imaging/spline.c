/* SPDX-License-Identifier: BSD-3-Clause */
/* B-splines by recurrence, and smoothed steps by polynomials. */
#include "imaging/spline.h"

#include <eda/simd.h>

#include <math.h>
#include <string.h>

/* Compute the non-zero B-splines of a degree at the fraction t of a cell by the
   recurrence of Cox and de Boor. weight[0] belongs to the leftmost B-spline. */
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

/* The derivative of a B-spline is the difference of two B-splines of the next
   lower degree. */
void eda_spline_slopes(double x, double slope[EDA_SPLINE_TAPS]) {
  double below[EDA_SPLINE_TAPS - 1];
  recurrence(4, x - floor(x), below);
  slope[0] = -below[0];
  for (int i = 1; i < EDA_SPLINE_TAPS - 1; i++)
    slope[i] = below[i - 1] - below[i];
  slope[EDA_SPLINE_TAPS - 1] = below[EDA_SPLINE_TAPS - 2];
}

enum { LANES = 16 };
typedef double lanes __attribute__((vector_size(LANES * sizeof(double))));

/* Coefficients of t^power of the B-splines of degree EDA_STEP_TAPS - 1 in a
   cell, times 10!: [power][spline]. */
static const double step_powers[EDA_STEP_TAPS][LANES] = {
    {1, 1013, 47840, 455192, 1310354, 1310354, 455192, 47840, 1013, 1, 0},
    {-10, -5010, -141060, -736260, -679560, 679560, 736260, 141060, 5010, 10,
     0},
    {45, 11025, 171000, 327600, -509670, -509670, 327600, 171000, 11025, 45, 0},
    {-120, -14040, -100080, 95760, 312480, -312480, -95760, 100080, 14040, 120,
     0},
    {210, 11130, 16800, -119280, 91140, 91140, -119280, 16800, 11130, 210, 0},
    {-252, -5292, 13608, 13608, -69552, 69552, -13608, -13608, 5292, 252, 0},
    {210, 1050, -8400, 16800, -9660, -9660, 16800, -8400, 1050, 210, 0},
    {-120, 360, 720, -5040, 10080, -10080, 5040, -720, -360, 120, 0},
    {45, -315, 900, -1260, 630, 630, -1260, 900, -315, 45, 0},
    {-10, 90, -360, 840, -1260, 1260, -840, 360, -90, 10, 0},
    {1, -10, 45, -120, 210, -252, 210, -120, 45, -10, 1}};
_Static_assert(EDA_STEP_TAPS == 11, "the table is of degree 10");

EDA_WIDE int eda_spline_step(double x, double weight[EDA_STEP_TAPS]) {
  int cell = (int)x;
  cell -= x < cell;
  double t = x - cell;
  lanes sum, power;
  memcpy(&sum, step_powers[EDA_STEP_TAPS - 1], sizeof sum);
  for (int d = EDA_STEP_TAPS - 2; d >= 0; d--) {
    memcpy(&power, step_powers[d], sizeof power);
    sum = power + t * sum;
  }
  sum *= 1 / 3628800.0;
  memcpy(weight, &sum, EDA_STEP_TAPS * sizeof *weight);
  return cell - EDA_RASTER_DEGREE / 2;
}

int eda_spline_smoothing(double x, double weight[EDA_STEP_TAPS - 1]) {
  double cell = floor(x);
  recurrence(EDA_RASTER_DEGREE, x - cell, weight);
  return (int)cell - EDA_RASTER_DEGREE / 2;
}

double eda_spline_sampled(double f) {
  double c = 2 * M_PI * f;
  return (66 + 52 * cos(c) + 2 * cos(2 * c)) / 120;
}
