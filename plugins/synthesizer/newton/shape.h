/* SPDX-License-Identifier: BSD-3-Clause */
/* Printed length along the width of a gate (ripple), and moves of parts of the
   mask edges by whole grid steps (shape) that make the length uniform. */
#pragma once

#include <eda/synthesizer.h>

#include "jog.h"
#include "response.h"

/* Moves of the parts of both poly edges: additional mask length in each part,
   grid steps. */
typedef struct shape {
  int16_t by[EDA_PARTS];
} shape;

/* Printed length minus its mean over the width, nm, at SAMPLES positions in
   each part, from the LOW end on. */
enum { SAMPLES = 3 };
typedef struct ripple {
  int count; /* number of valid positions; 0: unknown ripple */
  double off[SAMPLES * EDA_PARTS];
} ripple;

/* Division of a gate along W. Part k extends from edge[k] to edge[k + 1], grid
   steps from the LOW end of the box. Parts `first` to `last` - 1 are in the
   gate; one part before and one after them may be on the poly past the active.
   */
typedef struct parts {
  int count, first, last; /* number of parts; 0: the gate is too narrow for
                             parts */
  double edge[EDA_PARTS + 1];
  double share[EDA_PARTS + 1]; /* change of the effective length by a step of
                                  both poly edges up to edge[k] */
} parts;

/* Divide gate i. Poly past the active is a separate part if it extends by at
   least `min_jog`, nm. */
parts parts_of(const eda_gates *gates, size_t i, const sides *edges,
               double min_jog);

/* Return the parts with each end within `least` grid steps of a jog moved to
   the jog or to the distance `least`. `at`: position of the jog, grid steps
   from the LOW end of the box; NAN: no jog. An end at which the shape `of` has
   no step remains. */
parts parts_beside(const parts *p, const sides *edges, double at, double least,
                   const shape *of);

/* Write a shape as eda_moves.part; adjacent parts with equal steps are
   merged. */
void shape_write(const parts *p, const shape *s, eda_part out[EDA_PARTS]);

/* Return the change of the effective length by a shape, grid steps. */
double shape_value(const parts *p, const shape *s);

/* Return whether a shape moves all parts by the same steps. */
int shape_is_straight(const parts *p, const shape *s);

/* The ends of parts at which shape `s` has a step move from those of `from` to
   those of `to`. Return the sum of the |changes of length|, grid steps. */
double shape_shift(const parts *from, const parts *to, const shape *s);

/* Return the ripple of a simulated gate; count 0: the gate does not print. */
ripple ripple_of(const eda_feedback *f, size_t i, const parts *p);

/* Return the ripple expected after a change of the mask from shape `from` to
   shape `to`. `gain`: nm of printed length per grid step; `blur`: grid steps.
   */
ripple ripple_after(const parts *p, const ripple *now, const shape *from,
                    const shape *to, double gain, double blur);

/* Add the effect of a step by `gain` nm of an edge from `from` to `to`, grid
   steps from the LOW end of the box. */
void ripple_add(const parts *p, ripple *r, double from, double to, double gain,
                double blur);

/* Return the width, grid steps, of the strip at an end of the width in which
   printed minus drawn length is below `least` (nm, negative). The strip extends
   inwards from `from` steps outside of the drawn end; `high`: 1: HIGH end, 0:
   LOW end. The result is at most `most`. */
int32_t width_thin_end(const eda_feedback *f, size_t i, int high, int32_t from,
                       int32_t most, double least);

/* Return log(current / current of a gate of uniform length with the same mean).
   `slope`: d log I / d L, 1/nm. */
double ripple_excess(const ripple *r, double slope);

/* Return the relative increase of the gate area per nm^2 of mean square ripple
   after L and W have restored Ion and Ioff. `drawn`: drawn L, nm. */
double ripple_cost(double drawn, const curve *of_type);

/* Return the shape that minimizes the mean square ripple, nm^2, plus `price`,
   nm^2, for each jog. `leak`: d log Ioff / d L, 1/nm; parts that leak more have
   a larger weight. `blocked`: 1: no part becomes longer. */
shape shape_flat(const parts *p, const ripple *now, const shape *from,
                 double leak, double gain, double blur, double price,
                 int blocked);
