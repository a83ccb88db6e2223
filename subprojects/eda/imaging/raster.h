/* SPDX-License-Identifier: BSD-3-Clause */
/* The raster that masks are laid on: coverage, smoothed by a B-spline of
   EDA_RASTER_DEGREE and sampled exactly. It is kept as differences in both
   directions until eda_raster_sum adds them up. */
#ifndef EDA_RASTER_H
#define EDA_RASTER_H

#include <eda/imaging.h>

enum { EDA_RASTER_MARGIN = 6 };

typedef struct eda_raster {
  double dx, dy;     /* the steps, nm; sample (0, 0) at the frame's corner */
  int nx, ny;        /* the period */
  int columns, rows; /* with what reaches beyond it on both sides */
  double *step;      /* rows * columns; sample (0, 0) is at
                        [EDA_RASTER_MARGIN, EDA_RASTER_MARGIN] */
} eda_raster;

/* Lay all shapes on a raster of nx x ny samples; eda_raster_clear it. */
void eda_raster_lay(const opc_context *context, const eda_shapes *shapes,
                    double grid, eda_frame frame, int nx, int ny,
                    eda_raster *out);

/* Lay down a slanted edge from (ax, ay) to (bx, by), in steps from sample
   (0, 0), the inside on its left; only what falls into rows low .. high - 1 of
   the array. Exact but for rounding. */
void eda_raster_slanted(const eda_raster *raster, double ax, double ay,
                        double bx, double by, int low, int high);

/* The samples of rows [y][x] of the period, as single precision. */
void eda_raster_sum(const opc_context *context, eda_raster *raster, float *out);

void eda_raster_clear(eda_raster *raster);

/* The Fourier transform of the smoothing at f cycles per sample. */
double eda_raster_transform(double f);

#endif
