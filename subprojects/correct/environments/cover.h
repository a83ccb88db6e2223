/* SPDX-License-Identifier: BSD-3-Clause */
/* Covering of selected boxes of a layout, called places, by few clips. */
#pragma once

#include <eda/geometry.h>

/* Rectangle around some places. */
typedef struct clip {
  eda_box box;
  size_t first, count; /* positions in cover.place */
} clip;

/* All clips. */
typedef struct cover {
  clip *clip;
  size_t count, capacity;
  uint32_t *place; /* numbers of the places, clip by clip */
} cover;

/* Cover n places, each extended by `reach`, by clips. Each place belongs to one
   clip. Recursive bisection reduces the total area of the clips. The sides of a
   clip are at most `most`, unless a single place is larger. The result depends
   on the arguments only. Callable from any thread. */
void cover_make(const eda_box *places, size_t n, int32_t reach, int32_t most,
                cover *out);
/* Free the arrays. */
void cover_clear(cover *cover);
