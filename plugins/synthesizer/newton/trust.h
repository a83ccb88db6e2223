/* SPDX-License-Identifier: BSD-3-Clause */
/* Trust region of the next length of a transistor, from the results of previous
   moves. */
#pragma once

enum { SHORT, LONG, ENDS };

/* Current falls with length, so the wanted length is between one with too much
   and one with too little current. */
typedef struct trust {
  double at[ENDS];    /* mask lengths, grid steps */
  double error[ENDS]; /* log Ion there: above 0 at SHORT, below 0 at LONG;
                         infinite where nothing printed, 0: no end is known */
  double radius;      /* longest step, grid steps */
  int slow;           /* 1: the last step had less effect than predicted */
} trust;

/* Change log Ion at the ends by `shift`, an effect of other causes since the
   last iteration known to `noise`; drop an end that may have crossed zero. A
   length that did not print remains an end until a length beyond prints, or
   until trust_forget_lost. */
void trust_drift(trust *t, double shift, double noise);

/* Drop ends that did not print; another cause, such as a short line end, is
   possible. */
void trust_forget_lost(trust *t);

/* Add the error measured at length x. Infinite: the line did not print, too
   short or too long. Drop an end on the wrong side of x. */
void trust_see(trust *t, double x, double error);

/* Adapt the radius to the result of a step by dx that should have changed the
   size of the errors from `before` to `foreseen` and resulted in `now`. */
void trust_judge(trust *t, double dx, double before, double foreseen,
                 double now);

/* Return the part of a step by dx from x that the trust region allows. */
double trust_step(const trust *t, double x, double dx);

/* Return whether a bracket of two ends is known and contains x. */
int trust_holds(const trust *t, double x);
