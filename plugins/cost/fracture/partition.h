/* SPDX-License-Identifier: BSD-3-Clause */
/* Minimum partition of polygons into rectangles. */
#pragma once

#include <eda/geometry.h>

/* Partition merged shapes into rectangles without overlap. Polygons of at most
   512 points without holes get the smallest number of rectangles, and no
   rectangle narrower than `sliver` where possible; with `sliver` 0, any width
   is allowed. Other polygons are cut by eda_fracture. The caller frees *boxes
   with free(). Returns the codes of eda_fracture. */
int partition(const eda_shapes *shapes, int32_t sliver, eda_box **boxes,
              size_t *count, opc_error *error);
