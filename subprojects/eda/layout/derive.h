/* SPDX-License-Identifier: BSD-3-Clause */
/* Flattening of derived layers: layers that are expressions of other layers. */
#pragma once

#include "layout/layout.h"

/* Smallest number of a layer that eda_layout_select made from an expression. */
enum { EDA_SELECTED = 1 << 30 };

/* Return the text of the expression of a layer; NULL for other layers. [any] */
const char *derived_text(const eda_layout *layout, int32_t layer);

/* Return whether the shapes of a layer depend on the layer `on`. [any] */
int eda_layout_depends(const eda_layout *layout, int32_t layer, int32_t on);

/* Implement the functions eda_layout_flatten_window, eda_layout_bounds and
   eda_layout_flat_bytes for a derived layer. [any] */
int derived_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                    double grid, const eda_box *window, eda_flat *out,
                    opc_error *error);
int derived_bounds(const eda_layout *layout, int32_t top, int32_t layer,
                   double grid, eda_box *box, opc_error *error);
double derived_bytes(const eda_layout *layout, int32_t top, int32_t layer);
