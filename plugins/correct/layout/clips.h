/* SPDX-License-Identifier: BSD-3-Clause */
/* The mask of a window, cut up: what lies in territories, as their cells have
   it, and what lies between them. */
#ifndef CORRECT_LAYOUT_CLIPS_H
#define CORRECT_LAYOUT_CLIPS_H

#include <eda/chip.h>
#include <glib.h>

#include "outline.h"

/* What all windows are cut by. */
typedef struct cutter {
  const eda_chip *chip;
  const eda_layout *outline;
  int32_t margin; /* grid units: no edge of the mask is further from where it is
                     drawn */
} cutter;

/* Of a territory. `shapes`: of each layer the number of polygons, of points of
   each, and the points, all int32_t, as its cell has them: equal bytes are
   equal masks. */
typedef struct clip {
  GBytes *shapes;
  eda_point at;
  uint32_t number;
  uint8_t way;
} clip;

typedef struct clips {
  clip *clip; /* of territories that begin in the core and have any mask */
  size_t count;
  eda_shapes *rest; /* [layers]: what lies in the core and in no territory */
} clips;

/* Cut the window of a core. [any] */
int clips_cut(const cutter *by, eda_box core, clips *out, opc_error *error);
void clips_clear(clips *clips, size_t layers);

#endif
