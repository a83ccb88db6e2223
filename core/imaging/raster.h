/* SPDX-License-Identifier: BSD-3-Clause */
/* The raster that masks are laid on: coverage, smoothed by a B-spline of
   OPC_RASTER_DEGREE and sampled exactly. It is kept as differences in both
   directions until opc_raster_sum adds them up. */
#ifndef OPCFLOW_CORE_RASTER_H
#define OPCFLOW_CORE_RASTER_H

#include <opcflow/imaging.h>

enum { OPC_RASTER_MARGIN = 6 };

typedef struct opc_raster {
  double dx, dy;           /* the steps, nm; sample (0, 0) at the frame's corner */
  int nx, ny;              /* the period */
  int columns, rows;       /* with what reaches beyond it on both sides */
  double *step;            /* rows * columns; sample (0, 0) is at
                              [OPC_RASTER_MARGIN, OPC_RASTER_MARGIN] */
} opc_raster;

/* Lay all shapes on a raster of nx x ny samples; opc_raster_clear it. 0 if
   there is no memory. */
int opc_raster_lay(const opc_host *host, const opc_shapes *shapes, double grid,
                   opc_frame frame, int nx, int ny, opc_raster *out);

/* Lay down a slanted edge from (ax, ay) to (bx, by), in steps from sample
   (0, 0), the inside on its left; only what falls into rows low .. high - 1 of
   the array. Exact but for rounding. */
void opc_raster_slanted(const opc_raster *raster, double ax, double ay,
                        double bx, double by, int low, int high);

/* The samples of rows [y][x] of the period, as single precision. */
void opc_raster_sum(const opc_host *host, opc_raster *raster, float *out);

void opc_raster_clear(opc_raster *raster);

/* The Fourier transform of the smoothing at f cycles per sample. */
double opc_raster_transform(double f);

#endif
