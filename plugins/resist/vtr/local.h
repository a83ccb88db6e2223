/* SPDX-License-Identifier: BSD-3-Clause */
/* Maximum intensity and slope of an image in the neighbourhood of each place,
   as smooth fields. The neighbourhood of radius R is a Gaussian window of
   standard deviation R / 2, cut off at 2 R; < > is the mean over it.

     M = <I^8>^(1/8)              a soft maximum: exact for a constant
     S = <|grad I|^2>^(1/2)       1/nm

   Both scale with the dose, as the true ones do. */
#ifndef OPCFLOW_VTR_LOCAL_H
#define OPCFLOW_VTR_LOCAL_H

#include <eda/imaging.h>

typedef struct local_settings {
  double radius, slope_radius; /* nm; a slope_radius of 0: at the place */
  double step;                 /* grid, nm */
} local_settings;

/* The field a[1] M + a[2] S + a[3] M S of an image, which is resampled to the
   grid of the settings; *out gets the same grid, to be cleared. [any] */
int local_field(const opc_context *context, const local_settings *settings,
                const double a[4], eda_field *image, eda_field *out,
                opc_error *error);

#endif
