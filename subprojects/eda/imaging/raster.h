/* SPDX-License-Identifier: BSD-3-Clause */
/* Raster of a mask: the coverage, smoothed by a B-spline of EDA_RASTER_DEGREE
   and sampled without error. The raster stores differences in both directions,
   which eda_raster_sum adds up. */
#pragma once

#include <eda/imaging.h>

/* Number of samples stored beyond each side of a period. */
enum { EDA_RASTER_MARGIN = 6 };

/* A raster. */
typedef struct eda_raster {
  double dx, dy; /* grid steps, nm; sample (0, 0) is at the lower left corner of
                    the frame */
  int nx, ny;    /* numbers of samples in a period */
  int columns, rows; /* size of the array, including margins */
  double *step;      /* [rows][columns]; sample (0, 0) is at
                        [EDA_RASTER_MARGIN][EDA_RASTER_MARGIN] */
} eda_raster;

/* Rasterise all shapes on nx x ny samples; free *out with eda_raster_clear. */
void eda_raster_lay(const opc_context *context, const eda_shapes *shapes,
                    double grid, eda_frame frame, int nx, int ny,
                    eda_raster *out);

/* Add a slanted edge from (ax, ay) to (bx, by), in grid steps from sample (0,
   0), with the interior on the left. Only rows low .. high - 1 of the array are
   changed. Exact except for rounding. */
void eda_raster_slanted(const eda_raster *raster, double ax, double ay,
                        double bx, double by, int low, int high);

/* Write the samples [y][x] of one period, in single precision. */
void eda_raster_sum(const opc_context *context, eda_raster *raster, float *out);

/* Free the array. */
void eda_raster_clear(eda_raster *raster);

/* Return the Fourier transform of the smoothing B-spline at f cycles per
   sample. */
double eda_raster_transform(double f);
