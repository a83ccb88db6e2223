/* SPDX-License-Identifier: BSD-3-Clause */
/* Symmetry of the optics under rotation and mirroring. */
#pragma once

#include <eda/litho.h>

/* Set *orientations to the number of orientations (rotations and reflections)
   in which a prepared model images poly and active equally: 8, 4 (orientations
   without an exchange of x and y) or 1. Call on the main thread. */
OPC_EXPORT int correct_symmetry_find(const opc_context *context,
                                     const opc_module *litho, int *orientations,
                                     opc_error *error);
