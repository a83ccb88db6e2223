/* SPDX-License-Identifier: BSD-3-Clause */
/* Descent: in each iteration, a step of every transistor of a layout, which
   <correct/control.h> selects. Widths move only after all lengths have stopped,
   because the lengths of neighbours have the largest effect on a transistor.
   Until all lengths have stopped, the active layer need not be simulated again.
   In a refinement, widths do not wait, because few transistors move. */
#pragma once

#include <opcflow/plugin.h>

#include <correct/control.h>

typedef struct descent {
  control_rules rules;
  control *state;
  uint8_t *moved; /* [count], 1: the length of the gate moved in this
                     iteration */
  size_t count;
  int begun; /* 1: the first corrections have been made */
  int fine;  /* 1: widths may move */
  /* Return the deviation to be minimized of gate i, %; positive if L must
     increase. */
  double (*error)(const void *self, const eda_feedback *f, size_t i);
  /* Return the first correction of the length of gate i, in grid steps. 0 means
     one step in the direction that reduces the deviation. */
  int32_t (*first)(const void *self, const eda_feedback *f, size_t i);
  const void *self; /* first argument of `error` and `first` */
} descent;

/* Reset the state for `count` gates. Set rules, error, first and self before
   the call. */
void descent_reset(descent *d, size_t count);
/* Free the arrays. */
void descent_clear(descent *d);

/* Numbers of displaced lengths and widths in an iteration. */
typedef struct descent_moves {
  size_t lengths, widths;
  int changed; /* 1: a deviation changed although no transistor moved, for
                  example because the regulator moved a line end; the loop must
                  continue */
} descent_moves;

/* Perform one iteration: read the deviations from `f` and change `moves`.
   `lengths_only`: 1: widths do not move. Return the numbers of displaced
   lengths and widths. */
descent_moves descent_update(descent *d, const eda_feedback *f,
                             eda_moves *moves, int lengths_only);

/* Log the numbers of an iteration. Return 1 if no transistor moved and no
   deviation changed: the correction is finished. */
int descent_is_done(const opc_host *host, const eda_feedback *f,
                    const descent_moves *moves);

/* Return the verdict on a gate as a static text; NULL if the descent has no
   verdict on the gate. */
const char *descent_verdict(const descent *d, size_t gate);
