/* SPDX-License-Identifier: BSD-3-Clause */
/* Trust region of the next L of a transistor, derived from the results of
   previous moves. */
#pragma once

enum { SHORT, LONG, ENDS };

/* Current falls with length, so the wanted length is between a length with too
   much current (SHORT) and a length with too little (LONG): the bracket. */
typedef struct trust {
  double at[ENDS];    /* mask lengths, grid steps */
  double error[ENDS]; /* error of log Ion at each end: above 0 at SHORT, below 0
                         at LONG; infinite: the mask did not print; 0: the end
                         is unknown */
  double radius;      /* trust radius: longest step, grid steps */
  int slow;           /* 1: the last step had too little effect */
} trust;

/* Add `shift`, the effect of other causes, to the errors at both ends. `noise`:
   uncertainty of `shift`. Drop an end whose error may have changed sign. An end
   that did not print remains until a length beyond it prints or
   trust_forget_lost is called. */
void trust_drift(trust *t, double shift, double noise);

/* Drop ends that did not print, as a short line end may have been the cause. */
void trust_forget_lost(trust *t);

/* Drop both ends: they were of another shape or width. */
void trust_forget(trust *t);

/* Make length x an end of the bracket. `error`: error of log Ion at x;
   INFINITY: x is too short to print; -INFINITY: too long. Drop the other end if
   it is on the wrong side of x. */
void trust_see(trust *t, double x, double error);

/* Adapt the radius to the result of a step by dx. `before`: error before the
   step; `foreseen`: error predicted after the step; `now`: measured error. */
void trust_judge(trust *t, double dx, double before, double foreseen,
                 double now);

/* Return the step to make instead of a step by dx from x: dx limited to the
   radius, or a bisection of the bracket if dx leaves the bracket. */
double trust_step(const trust *t, double x, double dx);

/* Return whether both ends of the bracket are known and x is between them. */
int trust_holds(const trust *t, double x);

/* Return whether x is between the ends of the bracket, or an end is unknown. */
int trust_permits(const trust *t, double x);
