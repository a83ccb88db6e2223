/* SPDX-License-Identifier: BSD-3-Clause */
/* Symmetry of the optics under rotation and mirroring. */
#pragma once

#include <eda/litho.h>

/* Set *ways to the number of orientations in which a prepared model images a
   shape equally, in poly and in active: 8, 4 (no exchange of x and y) or 1.
   Call on the main thread. */
OPC_EXPORT int correct_symmetry_find(const opc_context *context,
                                     const opc_module *litho, int *orientations,
                                     opc_error *error);
