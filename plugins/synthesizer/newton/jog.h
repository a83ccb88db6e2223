/* SPDX-License-Identifier: BSD-3-Clause */
/* Jogs: steps of one poly edge over a part of the width, which change L by a
   fraction of a grid step. */
#pragma once

#include <eda/gates.h>

/* Return the integral of the standard normal density from -infinity to z, with
   an error of at most 1e-7. */
double normal_distribution(double z);

/* The LOW and HIGH poly edge that move with a gate. Positions along W in grid
   steps from the box of the gate: ends of each edge (from, to); ends of the
   range in which the edges affect the gate (low, high). blur: standard
   deviation of the optical smoothing, grid steps. sides_weigh computes the
   effect of each edge up to its end `from`, and of the whole edge. */
typedef struct sides {
  int32_t from[2], to[2];
  double low, high, blur;
  double before[2], all[2];
} sides;

void sides_weigh(sides *s);

/* Compute the sides of all gates. */
void sides_find(const eda_gates *gates, sides *out);

/* A change of L in grid steps: `l` whole steps, and one more step of one edge
   over the first `jog` grid steps of that edge from its LOW end. */
typedef struct length {
  int32_t l, jog;
} length;

/* Return the edge that moves by the next step of L: HIGH (1) if l is even. */
int length_side(int32_t l);

/* Return the effective change of L, grid steps. */
double length_value(const sides *s, length x);

/* Return the effect of a step of both edges up to position `to`, relative to a
   step of the whole edges. `to` is limited to the ends of the edges. */
double length_share(const sides *s, double to);

/* Return the position of the jog, grid steps from the gate's box; NAN: none. */
double length_jog(const sides *s, length x);

/* Return the change of L, with or without a jog, whose effect is nearest to
   `value`, grid steps. The jog is at least `least` steps away from both ends of
   its edge. */
length length_nearest(const sides *s, double value, int32_t least);
