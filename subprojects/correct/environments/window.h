/* SPDX-License-Identifier: BSD-3-Clause */
/* Shapes of a mask by classes. */
#pragma once

#include <eda/chip.h>

/* Distance of two clips on a sheet, and clear field around clips that contain
   their environment, nm; larger than any mask rule. */
#define CLASSES_GAP 500.0

/* Make the mask of a chip, or its drawn shapes, as a layout of cells and
   arrays; see eda_mask_access. (hierarchy.c) */
int hierarchy_make(const opc_context *context, const eda_chip *chip, int drawn,
                   eda_layout **out, opc_error *error);

/* Allocate figures and flags of a flat mask; copy those of a class to gate i.
   (window.c) */
void window_begin(eda_mask *to);
void window_put(const eda_mask *from, size_t class, eda_mask *to, size_t i);

/* Side of a sheet without environments, nm: as a window of hierarchy.c. */
#define PARTS_SIDE 30000.0

/* Visit the classes of a mask on sheets; see eda_mask_each_class. (parts.c) */
int parts_visit(const eda_mask *mask, double reach, eda_mask_visit *visit,
                void *data, opc_error *error);
