/* SPDX-License-Identifier: BSD-3-Clause */
/* Mask design algorithm of thesis figure 3.3, for one transistor: steps of the
   gate length L (coarse phase), then of the gate width W (fine phase). A step
   that increases |error| is reverted. The error is the deviation of Ion from
   the target, %; Ion falls with L and rises with W. */
#pragma once

#include <eda/synthesizer.h>

/* Phase of a transistor. */
enum { CONTROL_COARSE, CONTROL_FINE, CONTROL_SETTLED };

/* Verdict: state of a transistor, or the reason why its steps ended. */
enum {
  CONTROL_WITHIN,   /* |error| is within the limit */
  CONTROL_GRID,     /* a step of the grid would increase |error| */
  CONTROL_BRIDGING, /* vetoed by the regulator */
  CONTROL_BIAS,     /* a bias has its largest value */
  CONTROL_MOVING,   /* not finished */
  CONTROL_VERDICTS
};

/* State of a transistor. */
typedef struct control {
  double error; /* error in the previous iteration, % */
  double rest;  /* error when the transistor left the coarse phase or restarted,
                   % */
  double by_l;  /* |change of the error| by the last step of L, % per grid step;
                   0: none */
  uint8_t phase;     /* CONTROL_COARSE, CONTROL_FINE, CONTROL_SETTLED */
  uint8_t verdict;   /* CONTROL_WITHIN .. CONTROL_MOVING */
  uint8_t barred;    /* vetoed directions of L, EDA_VETO_* */
  uint8_t reopened;  /* number of restarts after neighbours changed the error */
  uint8_t rested;    /* 1: `rest` is set */
  uint8_t exchanged; /* 1: L was displaced because W had reached its bound */
  int32_t l, w;      /* last step of L and of W, in grid steps; 0: none */
  int32_t ceiling;   /* largest |step of W| after an overshoot; 0: unlimited */
} control;

/* Limits of all transistors. Displacements are in grid steps. */
typedef struct control_rules {
  double limit;     /* largest accepted |error|, % */
  int32_t most;     /* largest |bias| of L and W; W also moves by at most half
                       the width */
  int32_t widest;   /* largest proportional step that widens a gate */
  int proportional; /* 1: steps of W are proportional to the error; 0: W moves
                       by one grid step */
} control_rules;

/* Return the rules for an error limit in %, a largest bias in nm and a mask
   grid in nm. */
OPC_EXPORT control_rules correct_control_rules_for(double limit,
                                                   double max_bias, double grid,
                                                   int proportional);

/* A measured transistor. */
typedef struct control_input {
  double error;  /* deviation of Ion from the target, % */
  double width;  /* drawn width, in grid steps */
  uint32_t veto; /* EDA_VETO_* */
} control_input;

/* Add the first correction to *l, the displacement of L in grid steps. The
   correction is `steps` or, if `steps` is 0, one step that reduces |error|.
   Return 1 if *l changed, 0 if |error| is within the limit. */
OPC_EXPORT int correct_control_first(const control_rules *r, control *c,
                                     const control_input *in, int32_t steps,
                                     int32_t *l);

/* Apply the next step to *l; `w` is the present displacement of W. Return 1 if
 *l changed, else 0. */
OPC_EXPORT int correct_control_length(const control_rules *r, control *c,
                                      const control_input *in, int32_t *l,
                                      int32_t w);

/* Apply the next step to *w if the transistor is in the fine phase. Call after
   correct_control_length returned 0. Return 1 if *w changed, else 0. */
OPC_EXPORT int correct_control_width(const control_rules *r, control *c,
                                     const control_input *in, int32_t *w);

/* Return the verdict as a static text for the table of transistors. */
OPC_EXPORT const char *correct_control_verdict(const control *c);
