/* SPDX-License-Identifier: BSD-3-Clause */
/* Shapes of a mask by classes. */
#pragma once

#include <eda/chip.h>

/* Distance of two clips on a sheet, and clear field around clips that contain
   their environment, nm; larger than any mask rule. */
#define CLASSES_GAP 500.0

/* Make the mask of a chip as a layout of cells and arrays; see
   eda_mask_access. (hierarchy.c) */
int hierarchy_make(const opc_context *context, const eda_chip *chip,
                   eda_layout **out, opc_error *error);
