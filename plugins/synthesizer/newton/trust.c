/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the trust region: Newton's step is limited to a trust radius or,
   once two masks with errors of opposite sign are known, to the bracket between
   these masks. If a step has too little effect or leaves the bracket, the
   bracket is bisected (Numerical Recipes 9.4, rtsafe). */
#include "trust.h"

#include <math.h>

#include "tuning.h"

void trust_drift(trust *t, double shift, double noise) {
  for (int end = 0; end < ENDS; end++) {
    if (isinf(t->error[end])) continue;
    double sign = end == SHORT ? 1 : -1;
    t->error[end] = sign * fmax(sign * (t->error[end] + shift) - noise, 0);
  }
}

void trust_forget_lost(trust *t) {
  for (int end = 0; end < ENDS; end++)
    if (isinf(t->error[end])) t->error[end] = 0;
}

void trust_see(trust *t, double x, double error) {
  int end = error > 0 ? SHORT : LONG, other = !end;
  double sign = end == SHORT ? 1 : -1;
  if (t->error[other] != 0 && sign * (t->at[other] - x) <= 0)
    t->error[other] = 0;
  t->at[end] = x;
  t->error[end] = error;
}

void trust_forget(trust *t) { t->error[SHORT] = t->error[LONG] = 0; }

static int has_bracket(const trust *t) {
  return t->error[SHORT] != 0 && t->error[LONG] != 0;
}

/* Nocedal and Wright, Numerical Optimization, algorithm 4.1. */
void trust_judge(trust *t, double dx, double before, double foreseen,
                 double now) {
  double part = (before - now) / (before - foreseen);
  t->slow = part < 1 / tuned.unanswered;
  if (part > 0.75) t->radius = fmax(t->radius, 2 * fabs(dx));
  /* A neighbour may hide the effect of a jog. */
  if (t->slow && !has_bracket(t) && fabs(dx) >= 1) t->radius = fabs(dx) / 4;
}

/* Return the limit of a step from x towards an end of the bracket. The limit is
   the end itself or, if the mask there did not print, half of the way. */
static double trust_limit(const trust *t, int end, double x) {
  return isinf(t->error[end]) ? (x + t->at[end]) / 2 : t->at[end];
}

double trust_step(const trust *t, double x, double dx) {
  if (!has_bracket(t)) return fmin(fmax(dx, -t->radius), t->radius);
  if (!t->slow && trust_limit(t, SHORT, x) < x + dx &&
      x + dx < trust_limit(t, LONG, x))
    return dx;
  return (t->at[SHORT] + t->at[LONG]) / 2 - x;
}

int trust_holds(const trust *t, double x) {
  return has_bracket(t) && t->at[SHORT] <= x && x <= t->at[LONG];
}

int trust_permits(const trust *t, double x) {
  return !has_bracket(t) || (t->at[SHORT] < x && x < t->at[LONG]);
}
