/* SPDX-License-Identifier: BSD-3-Clause */
/* Symmetry of the optics under rotation and mirroring. */
#pragma once

#include <eda/litho.h>

/* Set *orientations to the number of orientations (rotations and reflections)
   that a prepared model images equally, in poly and in active: 8, 4 (without
   exchange of x and y) or 1. Call on the main thread. */
OPC_EXPORT int correct_symmetry_find(const opc_context *context,
                                     const opc_module *litho, int *orientations,
                                     opc_error *error);
