/* SPDX-License-Identifier: BSD-3-Clause */
/* The length along a gate's width: how it prints, and which parts of the mask's
   edges, moved by whole steps, make it flat. */
#ifndef SYNTHESIZER_NEWTON_SHAPE_H
#define SYNTHESIZER_NEWTON_SHAPE_H

#include <eda/synthesizer.h>

#include "jog.h"
#include "response.h"

/* A gate's width in parts, and by how many grid steps the mask is longer in
   each. Without parts all are 0. */
typedef struct shape {
  int16_t by[EDA_PARTS];
} shape;

/* How a gate prints along its width: the length less its mean, nm, at SAMPLES
   places of each part, from the LOW end on. */
enum { SAMPLES = 3 };
typedef struct ripple {
  int count; /* of places; 0: not known */
  double off[SAMPLES * EDA_PARTS];
} ripple;

/* The parts of a gate: part k from edge[k] to edge[k + 1], grid steps from the
   LOW end of its box. Those from `first` to before `last` lie in the gate;
   there may be one before it and one after it, where the poly goes past the
   active. */
typedef struct parts {
  int count, first, last; /* 0: the gate is too narrow */
  double edge[EDA_PARTS + 1];
  double share[EDA_PARTS + 1]; /* what a step up to there adds to the length */
} parts;

parts parts_of(const eda_gates *gates, size_t i, const sides *edges);

/* Parts that keep `least` clear of a jog, or end where it lies: `at`, grid
   steps from the LOW end of the gate's box; NAN: there is none. */
parts parts_beside(const parts *p, const sides *edges, double at, double least);

/* As the loop has it: neighbours that move alike are one. */
void shape_write(const parts *p, const shape *s, eda_part out[EDA_PARTS]);

/* What it adds to the gate's length, grid steps. */
double shape_value(const parts *p, const shape *s);

/* The ripple of a print; no parts where it cannot be seen. */
ripple ripple_of(const eda_feedback *f, size_t i, const parts *p);

/* What it becomes when the mask goes from one shape to the other; `gain` is nm
   of print for a grid step of the mask. */
ripple ripple_after(const parts *p, const ripple *now, const shape *from,
                    const shape *to, double gain, double blur);

/* How far inwards, grid steps, from the end of the width that lies `from` steps
   out of where it is drawn, the print is shorter than drawn by `least`, nm
   (below 0), or more; at most `most`. */
int32_t thin_end(const eda_feedback *f, size_t i, int high, int32_t from,
                 int32_t most, double least);

/* log of the current of such a gate over that of a straight one of the same
   mean length; `slope` is d log I / d L, 1/nm. */
double ripple_excess(const ripple *r, double slope);

/* What of the area a nm^2 of mean square ripple costs: by so much are L and W
   too large that give such a gate its drawn Ion and Ioff. */
double ripple_cost(double drawn, const curve *of_type);

/* The shape for which the squared ripple, nm^2 as a mean over the gate, and
   `price` (of the same unit) for each step of the edges come to the least.
   `leak` is the slope of log Ioff, 1/nm: what leaks counts most. What is
   `blocked` gets no longer. */
shape shape_flat(const parts *p, const ripple *now, const shape *from,
                 double leak, double gain, double blur, double price,
                 int blocked);

#endif
