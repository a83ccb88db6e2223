/* SPDX-License-Identifier: BSD-3-Clause */
/* The mask design algorithm of thesis figure 3.3, for one transistor: steps of
   its length (coarse), then of its width (fine), each kept up while the error
   falls and taken back when it rises. An error is a deviation in %, positive
   where the transistor has too much current; it falls with L and rises with W.
 */
#ifndef SYNTHESIZER_CONTROL_H
#define SYNTHESIZER_CONTROL_H

#include <eda/synthesizer.h>

enum { CONTROL_COARSE, CONTROL_FINE, CONTROL_SETTLED };

/* Why a transistor stays where it is. */
enum {
  CONTROL_WITHIN,
  CONTROL_GRID,
  CONTROL_BRIDGING,
  CONTROL_BIAS,
  CONTROL_MOVING,
  CONTROL_VERDICTS
};

typedef struct control {
  double error; /* of the last measurement, % */
  double rest;  /* when it came to its minimum */
  double by_l;  /* what a step of L was seen to change it by; 0: none */
  uint8_t phase;
  uint8_t verdict;
  uint8_t barred;    /* steps of L that the regulator took back, as vetoes */
  uint8_t reopened;  /* how often its neighbours moved it from its minimum */
  uint8_t rested;    /* `rest` is known */
  uint8_t exchanged; /* whether L was moved as W could go no further */
  int32_t l, w;      /* its last step */
  int32_t ceiling;   /* of its steps of W since it went past the minimum; 0 */
} control;

/* What holds for all transistors. */
typedef struct control_rules {
  double limit;     /* an error of no more than this is left alone, % */
  int32_t most;     /* steps of L, and of W if half of W is not less */
  int32_t widest;   /* step of W that widens, if they are proportional */
  int proportional; /* W by as much as the error asks for, not by one step */
} control_rules;

/* For a limit in %, a bound in nm, and a mask grid in nm. */
OPC_EXPORT control_rules correct_control_rules_for(double limit,
                                                   double max_bias, double grid,
                                                   int proportional);

/* A measured transistor. */
typedef struct control_input {
  double error;
  double width;  /* drawn, in grid steps */
  uint32_t veto; /* EDA_VETO_* */
} control_input;

/* The first correction: `steps` of L, or, for 0, one the way that lowers the
   error. Nothing if the error is within the limit. 1 if L moves. */
OPC_EXPORT int correct_control_first(const control_rules *r, control *c,
                                     const control_input *in, int32_t steps,
                                     int32_t *l);

/* The next step of L: 1, or 0 if it stays. */
OPC_EXPORT int correct_control_length(const control_rules *r, control *c,
                                      const control_input *in, int32_t *l,
                                      int32_t w);

/* The next step of W, of a transistor whose L is at its minimum: 1, or 0. To be
   called after correct_control_length, if that did not move L. */
OPC_EXPORT int correct_control_width(const control_rules *r, control *c,
                                     const control_input *in, int32_t *w);

OPC_EXPORT const char *correct_control_verdict(const control *c);

#endif
