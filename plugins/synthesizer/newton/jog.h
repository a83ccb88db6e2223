/* SPDX-License-Identifier: BSD-3-Clause */
/* Correction of length by a step over a part of the width. */
#pragma once

#include <eda/gates.h>

/* Positions along W, in grid steps from the box of the gate. LOW and HIGH edge
   of the poly that move with a gate: begin, end, begin and end of their effect,
   and the smoothing length of the optics. */
typedef struct sides {
  int32_t from[2], to[2];
  double low, high, blur;
} sides;

/* Compute the sides of all gates. */
void sides_find(const eda_gates *gates, sides *out);

/* A length in grid steps: whole steps, and one more over the first `jog` steps
   of the edge that takes the next one, from its LOW end on. */
typedef struct length {
  int32_t l, jog;
} length;

/* Return the effective length, as a number of steps. */
double length_value(const sides *s, length x);

/* Return the share of a step of both edges up to `to` (grid steps from the box
   of the gate) in the effect of the whole length; `to` is limited to the ends
   of the edges. */
double length_share(const sides *s, double to);

/* Return the position of the jog, grid steps from the box of the gate; NAN
   without a jog. */
double length_jog(const sides *s, length x);

/* Return the length nearest to `value`; the jog keeps `least` steps from both
   ends of its edge. */
length length_nearest(const sides *s, double value, int32_t least);
