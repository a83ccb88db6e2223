/* SPDX-License-Identifier: BSD-3-Clause */
/* What the steps that make gates share: layers of a layout, flat and merged on
   the mask grid, and their edges. */
#ifndef OPCFLOW_SEGMENT_LAYERS_H
#define OPCFLOW_SEGMENT_LAYERS_H

#include <eda/gates.h>
#include <eda/layout.h>

/* The cell of that name, NULL: the only one that no other places. */
int segment_top(const eda_layout *layout, const char *name, int32_t *top,
                opc_error *error);

/* A layer below the cell `top`, as drawn and merged; both are empty on
   failure. */
int segment_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                    double grid, eda_flat *flat, eda_shapes *merged,
                    opc_error *error);

/* Make a layer of the gates, whose shapes go to them. */
void segment_set_layer(eda_gates *gates, size_t layer, const char *name,
                       int corrected, eda_shapes *drawn);

/* One fragment an edge, of no transistor. */
void segment_cut_plain(eda_gates *gates, size_t layer);

#endif
