/* SPDX-License-Identifier: BSD-3-Clause */
/* A polygon cut into as few rectangles as can be. */
#ifndef OPCFLOW_COST_PARTITION_H
#define OPCFLOW_COST_PARTITION_H

#include <eda/geometry.h>

/* Merged shapes as rectangles that do not overlap: polygons without holes of at
   most 512 points as few as can be without such as are narrower than `sliver`,
   where the shapes allow it (0: as few as can be); the others as eda_fracture
   does. *boxes is freed with free(). */
int partition(const eda_shapes *shapes, int32_t sliver, eda_box **boxes,
              size_t *count, opc_error *error);

#endif
