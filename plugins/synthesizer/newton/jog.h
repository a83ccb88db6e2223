/* SPDX-License-Identifier: BSD-3-Clause */
/* A step of length over a part of the width. */
#ifndef SYNTHESIZER_NEWTON_JOG_H
#define SYNTHESIZER_NEWTON_JOG_H

#include <eda/gates.h>

/* Where the LOW and HIGH edge of the poly that move with a gate begin and end
   along W, and where what they do to the gate does; how far the print smooths
   that. In grid steps from the gate's box. */
typedef struct sides {
  int32_t from[2], to[2];
  double low, high, blur;
} sides;

/* Those of all gates. */
void sides_find(const eda_gates *gates, sides *out);

/* A length, in grid steps: whole ones, and one more over `jog` steps of the
   edge that takes it, from its LOW end on. */
typedef struct length {
  int32_t l, jog;
} length;

/* What a length is worth, as a number of steps. */
double length_value(const sides *s, length x);

/* The part of the whole length's effect that a step of both edges up to `to`
   has, grid steps from the gate's box; it is cut off where the edges end. */
double length_share(const sides *s, double to);

/* Where its jog lies, grid steps from the gate's box; NAN if it has none. */
double length_jog(const sides *s, length x);

/* The nearest there is to that value; the jog stays `least` steps away from
   both ends of its edge. */
length length_nearest(const sides *s, double value, int32_t least);

#endif
