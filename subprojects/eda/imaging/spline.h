/* SPDX-License-Identifier: BSD-3-Clause */
/* Centred uniform B-splines, the local basis of masks and fields (Unser,
   Aldroubi, Eden, "B-spline signal processing", IEEE Trans. SP 41, 1993). */
#ifndef EDA_SPLINE_H
#define EDA_SPLINE_H

#include <eda/imaging.h>
enum {
  EDA_SPLINE_TAPS = 6,   /* fields: quintic */
  EDA_RASTER_DEGREE = 9, /* masks; their steps are of the degree above */
  EDA_STEP_TAPS = EDA_RASTER_DEGREE + 2
};

/* The quintic B-splines in a cell, each a polynomial of the fraction of it: by
   the power, then by the spline. */
static const double eda_spline_power[EDA_SPLINE_TAPS][EDA_SPLINE_TAPS] = {
    {1 / 120.0, 26 / 120.0, 66 / 120.0, 26 / 120.0, 1 / 120.0, 0},
    {-5 / 120.0, -50 / 120.0, 0, 50 / 120.0, 5 / 120.0, 0},
    {10 / 120.0, 20 / 120.0, -60 / 120.0, 20 / 120.0, 10 / 120.0, 0},
    {-10 / 120.0, 20 / 120.0, 0, -20 / 120.0, 10 / 120.0, 0},
    {5 / 120.0, -20 / 120.0, 30 / 120.0, -20 / 120.0, 5 / 120.0, 0},
    {-1 / 120.0, 5 / 120.0, -10 / 120.0, 10 / 120.0, -5 / 120.0, 1 / 120.0}};

/* Their values at the fraction t. */
static inline void eda_spline_cell(double t, double weight[EDA_SPLINE_TAPS]) {
  const double(*p)[EDA_SPLINE_TAPS] = eda_spline_power;
  for (int k = 0; k < EDA_SPLINE_TAPS; k++) weight[k] = p[5][k];
  for (int d = 4; d >= 0; d--)
    for (int k = 0; k < EDA_SPLINE_TAPS; k++)
      weight[k] = p[d][k] + t * weight[k];
}

/* The values at x of the quintic B-splines centred on first .. first + 5, and
   that first. They sum to 1. */
static inline int eda_spline_weights(double x, double weight[EDA_SPLINE_TAPS]) {
  int cell = (int)x;
  cell -= x < cell;
  eda_spline_cell(x - cell, weight);
  return cell - 2;
}

/* Their derivatives there. They sum to 0. */
void eda_spline_slopes(double x, double slope[EDA_SPLINE_TAPS]);

/* The steps, at samples first .. first + EDA_STEP_TAPS - 1, of a unit step at x
   that is smoothed by a B-spline of EDA_RASTER_DEGREE: their running sum is its
   value at the samples, 0 before them and 1 after. */
int eda_spline_step(double x, double weight[EDA_STEP_TAPS]);

/* The values at x of the B-splines of EDA_RASTER_DEGREE that are centred on
   samples first .. first + EDA_STEP_TAPS - 2. */
int eda_spline_smoothing(double x, double weight[EDA_STEP_TAPS - 1]);

/* sum over j of b(j) cos(2 pi f j): what the samples of a function have at
   frequency f, over what its coefficients have. */
double eda_spline_sampled(double f);

#endif
