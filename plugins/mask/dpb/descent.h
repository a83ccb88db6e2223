/* SPDX-License-Identifier: BSD-3-Clause */
/* All transistors of a layout by control.h, at the same time. Widths wait until
   no length moves: the neighbours' lengths are most of what changes a
   transistor from outside, and the active is not printed so long. */
#ifndef OPCFLOW_MASK_DESCENT_H
#define OPCFLOW_MASK_DESCENT_H

#include "control.h"

typedef struct descent descent;
struct descent {
  control_rules rules;
  control *state;
  uint8_t *moved;        /* whether the length did, in this iteration */
  size_t count;
  int begun;             /* first corrections are made */
  int fine;              /* widths move */
  /* The deviation of gate i that is to be lowered, %. */
  double (*error)(const void *self, const opc_feedback *f, size_t i);
  /* Its first correction, in grid steps of L. */
  int32_t (*first)(const void *self, const opc_feedback *f, size_t i);
  const void *self;
};

/* For so many gates; rules, error, first and self are set. 0 if there is no
   memory. What was there before is freed. */
int descent_begin(descent *d, size_t count);

/* How many lengths and widths were moved, each 0 if nothing is to be moved. */
typedef struct descent_moves {
  size_t lengths, widths;
  int changed;           /* an error is not what it was: go on, though nothing
                            moves (line ends did) */
} descent_moves;

descent_moves descent_update(descent *d, const opc_feedback *f,
                             opc_moves *moves, int lengths_only);

void descent_clear(descent *d);

#endif
