/* SPDX-License-Identifier: BSD-3-Clause */
/* Trust region of the next L of a transistor, from results of moves. */
#pragma once

enum { SHORT, LONG, ENDS };

/* Current falls with length, so the wanted length is between a length with too
   much current (SHORT) and a length with too little (LONG): the bracket. */
typedef struct trust {
  double at[ENDS];    /* mask lengths, grid steps */
  double error[ENDS]; /* error of log Ion: above 0 at SHORT, below 0 at LONG;
                         infinite: did not print; 0: end unknown */
  double radius;      /* trust radius: longest step, grid steps */
  int slow;           /* 1: the last step had too little effect */
} trust;

/* Add to the errors at both ends the effect `shift` of other causes, which has
   the uncertainty `noise`. Drop an end whose error may have changed sign. An
   end that did not print remains until a length beyond it prints or
   trust_forget_lost is called. */
void trust_drift(trust *t, double shift, double noise);

/* Drop ends that did not print, as a short line end may have been the cause. */
void trust_forget_lost(trust *t);

/* Make length x with its error an end of the bracket; INFINITY: too short to
   print, -INFINITY: too long. Drop the other end if it is on the wrong side of
   x. */
void trust_see(trust *t, double x, double error);

/* Adapt the radius to the result of a step by dx: the error before the step,
   the error predicted after it, and the error found. */
void trust_judge(trust *t, double dx, double before, double foreseen,
                 double now);

/* Return the step to make instead of a step by dx from x: limited to the
   radius, or half of the bracket if dx leaves it. */
double trust_step(const trust *t, double x, double dx);

/* Return whether both ends of the bracket are known and x is between them. */
int trust_holds(const trust *t, double x);
