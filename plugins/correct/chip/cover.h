/* SPDX-License-Identifier: BSD-3-Clause */
/* Few clips of a layout that show chosen places with all that is around them.
 */
#ifndef CORRECT_CHIP_COVER_H
#define CORRECT_CHIP_COVER_H

#include <eda/geometry.h>

/* A rectangle around some of the places. */
typedef struct clip {
  eda_box box;
  size_t first, count; /* of cover.place */
} clip;

typedef struct cover {
  clip *clip;
  size_t count, room;
  uint32_t *place; /* numbers of the places, clip by clip */
} cover;

/* Clips that each show some of n places and `reach` around them, every place
   once: of all ways to halve them again and again, the one of the least area,
   as far as no side is longer than `most`, but for a place that is so itself.
   What they are depends on nothing but that. [any] */
void cover_make(const eda_box *places, size_t n, int32_t reach, int32_t most,
                cover *out);
void cover_clear(cover *cover);

#endif
