/* SPDX-License-Identifier: BSD-3-Clause */
/* The spectrum of a mask in closed form, from its edges. */
#ifndef OPCFLOW_ABBE_TRANSFORM_H
#define OPCFLOW_ABBE_TRANSFORM_H

#include <eda/imaging.h>

/* As eda_mask_spectrum, without a raster. [any] */
int transform_mask(const opc_context *context, const eda_shapes *shapes,
                   double grid, eda_frame frame, double band, eda_spectrum *out,
                   opc_error *error);

#endif
