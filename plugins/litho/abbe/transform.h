/* SPDX-License-Identifier: BSD-3-Clause */
/* Closed form of a mask spectrum, computed from the edges of the mask. */
#pragma once

#include <eda/imaging.h>

/* Compute the spectrum of a mask; parameters as for eda_mask_spectrum
   (eda/imaging.h). Return OPC_OK or an error. [any] */
int transform_mask(const opc_context *context, const eda_shapes *shapes,
                   double grid, eda_frame frame, double band, eda_spectrum *out,
                   opc_error *error);
