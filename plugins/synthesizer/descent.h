/* SPDX-License-Identifier: BSD-3-Clause */
/* All transistors of a layout by control.h, at the same time. Widths wait until
   no length moves: the neighbours' lengths are most of what changes a
   transistor from outside, and the active is not printed so long. */
#ifndef SYNTHESIZER_DESCENT_H
#define SYNTHESIZER_DESCENT_H

#include <opcflow/plugin.h>

#include <correct/control.h>

typedef struct descent {
  control_rules rules;
  control *state;
  uint8_t *moved; /* whether the length did, in this iteration */
  size_t count;
  int begun; /* first corrections are made */
  int fine;  /* widths move */
  /* The deviation of gate i that is to be lowered, %. */
  double (*error)(const void *self, const eda_feedback *f, size_t i);
  /* Its first correction, in grid steps of L. */
  int32_t (*first)(const void *self, const eda_feedback *f, size_t i);
  const void *self; /* for both */
} descent;

/* Start anew with so many gates; rules, error, first and self are set. */
void descent_reset(descent *d, size_t count);
void descent_clear(descent *d);

/* How many lengths and widths were moved. */
typedef struct descent_moves {
  size_t lengths, widths;
  int changed; /* an error is not what it was: go on, though nothing moves
                  (line ends did) */
} descent_moves;

/* One iteration. `lengths_only`: no width moves yet. */
descent_moves descent_update(descent *d, const eda_feedback *f,
                             eda_moves *moves, int lengths_only);

/* Log an iteration; whether it was the last one. */
int descent_is_done(const opc_host *host, const eda_feedback *f,
                    const descent_moves *moves);

const char *descent_verdict(const descent *d, size_t gate);

#endif
