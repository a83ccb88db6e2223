/* SPDX-License-Identifier: BSD-3-Clause */
/* Correction of all transistors of a layout at the same time by
   correct/control.h. Widths wait until no length moves: lengths of neighbours
   have the largest effect on a transistor, and the active area is not imaged
   until then. */
#pragma once

#include <opcflow/plugin.h>

#include <correct/control.h>

typedef struct descent {
  control_rules rules;
  control *state;
  uint8_t *moved; /* 1 for each length moved in this iteration */
  size_t count;
  int begun; /* 1 after the first corrections */
  int fine;  /* 1 once widths may move */
  /* Return the deviation of gate i to be minimized, %. */
  double (*error)(const void *self, const eda_feedback *f, size_t i);
  /* Return the first correction of gate i, in grid steps of L. */
  int32_t (*first)(const void *self, const eda_feedback *f, size_t i);
  const void *self; /* first argument of both functions */
} descent;

/* Reset the state for `count` gates. The caller has set rules, error, first and
   self. */
void descent_reset(descent *d, size_t count);
void descent_clear(descent *d);

/* Numbers of moved lengths and widths. */
typedef struct descent_moves {
  size_t lengths, widths;
  int changed; /* 1: a deviation changed, so the loop continues although no
                  transistor moves (line ends moved) */
} descent_moves;

/* Perform one iteration and return the numbers of moves. `lengths_only`: widths
   do not move yet. */
descent_moves descent_update(descent *d, const eda_feedback *f,
                             eda_moves *moves, int lengths_only);

/* Log an iteration. Return 1 if it is the last one. */
int descent_is_done(const opc_host *host, const eda_feedback *f,
                    const descent_moves *moves);

const char *descent_verdict(const descent *d, size_t gate);
