/* SPDX-License-Identifier: BSD-3-Clause */
/* Printed length along the width of a gate, and the whole steps of parts of the
   mask edges that make the length uniform. */
#pragma once

#include <eda/synthesizer.h>

#include "jog.h"
#include "response.h"

/* Grid steps of additional mask length in each part of the width; all 0 without
   parts. */
typedef struct shape {
  int16_t by[EDA_PARTS];
} shape;

/* Printed length along the width minus its mean, nm, at SAMPLES places of each
   part, from the LOW end on. */
enum { SAMPLES = 3 };
typedef struct ripple {
  int count; /* number of places; 0: unknown */
  double off[SAMPLES * EDA_PARTS];
} ripple;

/* The parts of a gate: part k from edge[k] to edge[k + 1], grid steps from the
   LOW end of the box. Parts `first` to before `last` are in the gate; there may
   be one before and one after them, where the poly extends past the active. */
typedef struct parts {
  int count, first, last; /* 0: the gate is too narrow */
  double edge[EDA_PARTS + 1];
  double share[EDA_PARTS + 1]; /* effect of a step up to that edge on the
                                  length */
} parts;

parts parts_of(const eda_gates *gates, size_t i, const sides *edges);

/* Return parts that keep `least` clear of a jog at `at`, or end there; `at` in
   grid steps from the LOW end of the box of the gate; NAN: no jog. */
parts parts_beside(const parts *p, const sides *edges, double at, double least);

/* Write a shape in the form of the loop: neighbouring parts of equal steps are
   one. */
void shape_write(const parts *p, const shape *s, eda_part out[EDA_PARTS]);

/* Return the additional length of the gate, grid steps. */
double shape_value(const parts *p, const shape *s);

/* Return the ripple of a simulated gate; without parts if not measurable. */
ripple ripple_of(const eda_feedback *f, size_t i, const parts *p);

/* Return the ripple expected after a change of the mask from one shape to the
   other; `gain` is nm of printed length per grid step. */
ripple ripple_after(const parts *p, const ripple *now, const shape *from,
                    const shape *to, double gain, double blur);

/* Return the distance, in grid steps, from an end of the width inwards over
   which the printed length is shorter than drawn by `least` (nm, below 0) or
   more; at most `most`. The end is `from` steps outside of the drawn one. */
int32_t width_thin_end(const eda_feedback *f, size_t i, int high, int32_t from,
                       int32_t most, double least);

/* Return the logarithm of the current of a gate over that of a straight one
   with the same mean length; `slope` is d log I / d L, 1/nm. */
double ripple_excess(const ripple *r, double slope);

/* Return the relative area per nm^2 of mean square ripple: the increase of L
   and W that restores the drawn Ion and Ioff of such a gate. */
double ripple_cost(double drawn, const curve *of_type);

/* Return the shape that minimizes the mean squared ripple over the gate, nm^2,
   plus `price` (same unit) for each step of the edges. `leak` is the slope of
   log Ioff, 1/nm, by which leaking parts weigh more. With `blocked` no part
   gets longer. */
shape shape_flat(const parts *p, const ripple *now, const shape *from,
                 double leak, double gain, double blur, double price,
                 int blocked);
