/* SPDX-License-Identifier: BSD-3-Clause */
/* Printed length along the width of a gate (ripple), and moves of parts of the
   mask edges by whole grid steps (shape) that make the length uniform. */
#pragma once

#include <eda/synthesizer.h>

#include "jog.h"
#include "response.h"

/* Additional mask length, grid steps, in each part of the width. */
typedef struct shape {
  int16_t by[EDA_PARTS];
} shape;

/* Printed length minus its mean over the width, nm, at SAMPLES positions in
   each part, from the LOW end on. */
enum { SAMPLES = 3 };
typedef struct ripple {
  int count; /* number of positions; 0: unknown */
  double off[SAMPLES * EDA_PARTS];
} ripple;

/* Division of a gate along W. Part k extends from edge[k] to edge[k + 1], grid
   steps from the LOW end of the box. Parts `first` to `last` - 1 are in the
   gate; one part before and one after them may be on the poly past the active.
   */
typedef struct parts {
  int count, first, last; /* count 0: the gate is too narrow */
  double edge[EDA_PARTS + 1];
  double share[EDA_PARTS + 1]; /* change of the effective length by a step of
                                  both poly edges up to edge[k] */
} parts;

parts parts_of(const eda_gates *gates, size_t i, const sides *edges);

/* Return the parts with ends moved to the position of a jog, or at least
   `least` away from it. `at`: position, grid steps from the LOW end of the box;
   NAN: no jog. */
parts parts_beside(const parts *p, const sides *edges, double at, double least);

/* Write a shape as eda_moves.part; neighbours of equal steps are merged. */
void shape_write(const parts *p, const shape *s, eda_part out[EDA_PARTS]);

/* Return the change of the effective length by a shape, grid steps. */
double shape_value(const parts *p, const shape *s);

/* Return the ripple of a simulated gate; count 0: the gate does not print. */
ripple ripple_of(const eda_feedback *f, size_t i, const parts *p);

/* Return the ripple expected after a change of the mask from shape `from` to
   shape `to`. `gain`: nm of printed length per grid step; `blur`: grid steps.
   */
ripple ripple_after(const parts *p, const ripple *now, const shape *from,
                    const shape *to, double gain, double blur);

/* Return over how many grid steps inwards, at most `most`, printed minus drawn
   length is below `least` (nm, negative). The count starts `from` steps outside
   of the HIGH (`high`) or LOW end of the drawn width. */
int32_t width_thin_end(const eda_feedback *f, size_t i, int high, int32_t from,
                       int32_t most, double least);

/* Return log(current / current without ripple) of a gate at the same mean
   length. `slope`: d log I / d L, 1/nm. */
double ripple_excess(const ripple *r, double slope);

/* Return the relative increase of the gate area per nm^2 of mean square ripple
   after L and W have restored Ion and Ioff. `drawn`: drawn L, nm. */
double ripple_cost(double drawn, const curve *of_type);

/* Return the shape that minimizes the mean square ripple, nm^2, plus `price`,
   nm^2, for each jog. `leak`: d log Ioff / d L, 1/nm; parts that leak more have
   a larger weight. If `blocked`, no part becomes longer. */
shape shape_flat(const parts *p, const ripple *now, const shape *from,
                 double leak, double gain, double blur, double price,
                 int blocked);
