/* SPDX-License-Identifier: BSD-3-Clause */
/* Maximum intensity and slope of an image near each position, as smooth fields
   M and S. The mean < > extends over a Gaussian window of standard deviation
   R / 2, truncated at 2 R, for the radius R.

     M = <I^8>^(1/8)              smooth approximation of the maximum
     S = <|grad I|^2>^(1/2)       1/nm

   Both fields scale with the dose, as the true maximum and slope do. */
#pragma once

#include <eda/imaging.h>

/* Radii and grid. */
typedef struct local_settings {
  double radius, slope_radius; /* radii R of M and S, nm; slope_radius 0: slope
                                  at the position itself */
  double step;                 /* grid, nm */
} local_settings;

/* Compute the field a[1] M + a[2] S + a[3] M S of an image. The image is
   resampled in place to the grid of the settings, on which *out is computed.
   The caller clears *out. Return OPC_OK or an error. [any] */
int local_field(const opc_context *context, const local_settings *settings,
                const double a[4], eda_field *image, eda_field *out,
                opc_error *error);
