/* SPDX-License-Identifier: BSD-3-Clause */
/* How far a transistor's next length may go: what has been seen of the way to
   the wanted one. */
#ifndef SYNTHESIZER_NEWTON_TRUST_H
#define SYNTHESIZER_NEWTON_TRUST_H

enum { SHORT, LONG, ENDS };

/* A longer gate draws less, so that the length wanted lies between one that
   drew too much and one that drew too little. */
typedef struct trust {
  double at[ENDS];    /* mask lengths, grid steps */
  double error[ENDS]; /* log Ion there: above 0 at SHORT, below at LONG;
                         infinite where nothing printed, 0: no end is known */
  double radius;      /* the longest step, grid steps */
  int slow;           /* the last step did not do what was foreseen */
} trust;

/* What else has changed the transistor since the last print changes log Ion at
   the ends by `shift`, known to `noise`; an end that this may have moved across
   zero is dropped. A length that was lost stays lost until one beyond it
   prints, or is forgotten. */
void trust_drift(trust *t, double shift, double noise);

/* What was lost may have been so for another reason, as a short line end. */
void trust_forget_lost(trust *t);

/* A print of length x has that error; infinite: it is lost, too short or too
   long. An end on the wrong side of x is dropped. */
void trust_see(trust *t, double x, double error);

/* Whether a step by dx, which should have changed the size of the errors from
   `before` to `foreseen`, has done so: the radius follows. */
void trust_judge(trust *t, double dx, double before, double foreseen,
                 double now);

/* What of a step by dx from x may be done. */
double trust_step(const trust *t, double x, double dx);

/* Whether a bracket of two ends is known, and x within it. */
int trust_holds(const trust *t, double x);

#endif
