/* SPDX-License-Identifier: BSD-3-Clause */
/* Size of a pattern file for a raster-scan mask writer, by a model of the MEBES
   format (README.md). */
#pragma once

#include <eda/geometry.h>

/* Array of copies, steps in grid units. A single mask has one copy. */
typedef struct mebes_array {
  int64_t columns, rows, step_x, step_y;
} mebes_array;

/* Sizes of the format (README.md). */
enum { MEBES_STRIPE = 1024, MEBES_SEGMENT = 32768, MEBES_BLOCK = 2048 };

/* Return the number of segments over an extent repeated as `array`. */
int64_t mebes_segments(eda_box extent, const mebes_array *array);

/* Return the size of a file of these rectangles, repeated as `array`, in bytes.
   The first segment and stripe begin at the lower left corner of `extent`. */
int64_t mebes_bytes(const eda_box *boxes, size_t count, eda_box extent,
                    const mebes_array *array);
