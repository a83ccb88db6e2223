/* SPDX-License-Identifier: BSD-3-Clause */
/* Jogs so close together that the mask's own rules do not allow what is between
   them: shallow notches are filled, shallow bumps taken away. */
#ifndef OPCFLOW_REGULATOR_SMOOTH_H
#define OPCFLOW_REGULATOR_SMOOTH_H

#include "rules.h"

/* A notch or a bump, and the straight edge that is there instead, from `from` to
   `to`, with the shape on its left. */
typedef struct mend {
  opc_box box;
  opc_point from, to;
  uint8_t bump, stays;
} mend;

typedef struct smoothing {
  mend *at[OPC_MASKS];
  size_t n[OPC_MASKS], most[OPC_MASKS];
  int undone;              /* how often one made way for another */
} smoothing;

void smoothing_clear(smoothing *s);

/* Smooth the masks of a print, which have what was smoothed before. 0 if there is
   no memory. */
int smoothing_follow(smoothing *s, const opc_printed *p, const limits *rules);

/* What is added to the masks and what is taken away. 0 if there is no memory. */
int smoothing_boxes(const smoothing *s, box_list patch[OPC_MASKS],
                    box_list bite[OPC_MASKS]);

#endif
