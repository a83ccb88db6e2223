/* SPDX-License-Identifier: BSD-3-Clause */
/* Correction of all transistors of a layout at the same time, by
   correct/control.h. Widths are not displaced before no length moves: lengths
   of neighbours have the largest effect on a transistor, and until then the
   active layer needs no further simulation. */
#pragma once

#include <opcflow/plugin.h>

#include <correct/control.h>

typedef struct descent {
  control_rules rules;
  control *state;
  uint8_t *moved; /* [count], 1: the length moved in this iteration */
  size_t count;
  int begun; /* 1: the first corrections were made */
  int fine;  /* 1: widths may move */
  /* Return the deviation of gate i to be minimized, %. */
  double (*error)(const void *self, const eda_feedback *f, size_t i);
  /* Return the first correction of gate i, in grid steps of L; 0: one step. */
  int32_t (*first)(const void *self, const eda_feedback *f, size_t i);
  const void *self; /* first argument of both functions */
} descent;

/* Reset the state for `count` gates. Set rules, error, first and self before
   the call. */
void descent_reset(descent *d, size_t count);
void descent_clear(descent *d);

/* Numbers of displaced lengths and widths in an iteration. */
typedef struct descent_moves {
  size_t lengths, widths;
  int changed; /* 1: a deviation changed although no transistor moved, for
                  example by line ends; the loop continues */
} descent_moves;

/* Perform one iteration. `lengths_only`: 1: widths do not move. */
descent_moves descent_update(descent *d, const eda_feedback *f,
                             eda_moves *moves, int lengths_only);

/* Log an iteration. Return 1 if the correction is finished. */
int descent_is_done(const opc_host *host, const eda_feedback *f,
                    const descent_moves *moves);

/* Return the verdict on a gate, a static text; NULL for other gates. */
const char *descent_verdict(const descent *d, size_t gate);
