/* SPDX-License-Identifier: BSD-3-Clause */
/* Dissection of a window's mask into the masks of territories, in the
   coordinates of their cells, and the mask outside of territories. A territory
   is the box of a placed cell (outline.h). */
#pragma once

#include <eda/chip.h>
#include <glib.h>

#include "outline.h"

/* Common settings of all windows. */
typedef struct cutter {
  const eda_chip *chip;
  const eda_layout *outline;
  const int32_t
      *drawn;     /* [layers of the chip], layers of the chip's layout, -1:
                     none; dissect their shapes. NULL: dissect the mask */
  int32_t margin; /* largest displacement of a mask edge, grid units */
} cutter;

/* Mask of a territory. `shapes`: for each layer, polygons as point count and
   points, terminated by a 0; all int32_t in cell coordinates. Equal masks have
   equal bytes. */
typedef struct clip {
  GBytes *shapes;
  eda_point at;        /* as in territory */
  uint32_t number;     /* as in territory */
  uint8_t orientation; /* as in territory */
} clip;

/* The mask of a window, divided into territories and the remainder. */
typedef struct clips {
  clip *clip; /* territories that begin in the core and are not empty */
  size_t count;
  eda_shapes *rest; /* [layers], mask in the core outside of territories */
} clips;

/* Dissect the window of a core. Callable from any thread. The caller frees *out
   with clips_clear(). */
int clips_cut(const cutter *by, eda_box core, clips *out, opc_error *error);
void clips_clear(clips *clips, size_t layers);
