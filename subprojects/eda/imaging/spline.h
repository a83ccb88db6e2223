/* SPDX-License-Identifier: BSD-3-Clause */
/* Centred uniform B-splines, the basis functions of masks and fields (Unser,
   Aldroubi, Eden, "B-spline signal processing", IEEE Trans. SP 41, 1993). */
#pragma once

#include <eda/imaging.h>
/* Degrees of the splines, and numbers of splines that are not 0 at a point
   (taps). */
enum {
  EDA_SPLINE_TAPS = 6, /* quintic B-splines, for fields */
  EDA_RASTER_DEGREE =
      9, /* for masks; a smoothed step has degree EDA_RASTER_DEGREE + 1 */
  EDA_STEP_TAPS = EDA_RASTER_DEGREE + 2
};

/* Polynomials of the quintic B-splines in a cell, by powers of the fraction of
   the cell: [power][spline]. */
static const double eda_spline_power[EDA_SPLINE_TAPS][EDA_SPLINE_TAPS] = {
    {1 / 120.0, 26 / 120.0, 66 / 120.0, 26 / 120.0, 1 / 120.0, 0},
    {-5 / 120.0, -50 / 120.0, 0, 50 / 120.0, 5 / 120.0, 0},
    {10 / 120.0, 20 / 120.0, -60 / 120.0, 20 / 120.0, 10 / 120.0, 0},
    {-10 / 120.0, 20 / 120.0, 0, -20 / 120.0, 10 / 120.0, 0},
    {5 / 120.0, -20 / 120.0, 30 / 120.0, -20 / 120.0, 5 / 120.0, 0},
    {-1 / 120.0, 5 / 120.0, -10 / 120.0, 10 / 120.0, -5 / 120.0, 1 / 120.0}};

/* Compute the quintic B-splines in a cell at the fraction t. */
static inline void eda_spline_cell(double t, double weight[EDA_SPLINE_TAPS]) {
  const double(*p)[EDA_SPLINE_TAPS] = eda_spline_power;
  for (int k = 0; k < EDA_SPLINE_TAPS; k++) weight[k] = p[5][k];
  for (int d = 4; d >= 0; d--)
    for (int k = 0; k < EDA_SPLINE_TAPS; k++)
      weight[k] = p[d][k] + t * weight[k];
}

/* Compute the values at x of the quintic B-splines centred on first .. first +
   5. Return first. The sum of the values is 1. */
static inline int eda_spline_weights(double x, double weight[EDA_SPLINE_TAPS]) {
  int cell = (int)x;
  cell -= x < cell;
  eda_spline_cell(x - cell, weight);
  return cell - 2;
}

/* Compute the derivatives at x of the B-splines of eda_spline_weights. The sum
   of the derivatives is 0. */
void eda_spline_slopes(double x, double slope[EDA_SPLINE_TAPS]);

/* Compute the differences at samples first .. first + EDA_STEP_TAPS - 1 of a
   unit step at x, smoothed by a B-spline of EDA_RASTER_DEGREE. Return first.
   The running sum of the differences is the smoothed step at the samples. */
int eda_spline_step(double x, double weight[EDA_STEP_TAPS]);

/* Compute the values at x of the B-splines of EDA_RASTER_DEGREE centred on
   samples first .. first + EDA_STEP_TAPS - 2. Return first. */
int eda_spline_smoothing(double x, double weight[EDA_STEP_TAPS - 1]);

/* Return the ratio of the spectrum of samples to the spectrum of quintic spline
   coefficients at f cycles per sample. With the B-spline b, this is the sum
   over j of b(j) cos(2 pi f j). */
double eda_spline_sampled(double f);
