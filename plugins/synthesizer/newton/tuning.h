/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of synthesizer.newton, with unit and source. Values without a
   source were chosen on the cells of the NanGate library and the ISCAS'85
   circuits at scale 1.3. tuning.md has the effect of half and double of each
   constant; tools/tuned-constants measures these effects and writes that
   table. */
#pragma once

#include <stdint.h>

static const struct {
  double thin_end[2], slope[2], gain_bound, doubt[2], least_doubt, many,
      doubt_of_many;
  double trust[2], longest, open_step;
  double still, unforeseen, late, coupling, noise_floor;
  double odd_limit, odd_surprise, unanswered;
  double coarse, worthwhile, mean_part, patience;
  double blur, short_end, past_end, before_end;
  double smooth, firm, local, tail, near_jog, leak, leaks;
  uint32_t shapes[3], settled[3], polish, rest;
} tuned = {
    /* ---- the first estimate of a response ---- */

    /* d log I / d log L of Ion and Ioff, if no simulation determines a slope. A
       long channel has -1; -15 is that of PTM 65 nm at L 65 nm. */
    .slope = {-1, -15},

    /* Largest factor by which the first simulations change the response to L of
       all transistors of a type. */
    .gain_bound = 2.5,

    /* Relative uncertainty of a first response to L and to W. */
    .doubt = {0.3, 0.1},

    /* Least relative uncertainty of a response: the response changes with the
       mask. */
    .least_doubt = 0.15,

    /* Least number of transistors of a type that separates a common factor from
       individual ones, and the relative uncertainty of each response to L after
       that. */
    .many = 16,
    .doubt_of_many = 0.15,

    /* ---- moves ---- */

    /* Thin poly (target: balanced): excess of log Ioff of a gate and of the
       strips at an end of its width at which the gate loses those strips; and
       log Ioff of a strip beyond the end above which the gate does not extend
       there. */
    .thin_end = {0.7, 2.5},

    /* Factor around the first estimate within which a response to L and to W
       stays. The response to W is geometry and well known. */
    .trust = {4, 1.5},

    /* nm: initial trust radius of L (trust.c adapts the radius). */
    .longest = 20,

    /* nm: increase of L per iteration of a line that does not print. */
    .open_step = 5,

    /* ---- influences on a transistor besides its moves ---- */

    /* nm: a move of a line end larger than this changes its transistor. */
    .still = 2,

    /* Relative uncertainty of the predicted effect of the first move of line
       ends on log Ion. */
    .unforeseen = 0.15,

    /* Largest effect on log Ion of a line end that moves later. */
    .late = 0.01,

    /* Effect of neighbours on log Ion, relative to the mean move (root mean
       square) of all transistors. Measured at 193 nm, NA 0.75: at most a
       tenth. */
    .coupling = 0.1,

    /* Uncertainty of log Ion in each simulation. */
    .noise_floor = 1e-4,

    /* ---- changes by other causes: is_foreign ---- */

    /* Least significant change of log Ion, as a part of `limit`. */
    .odd_limit = 0.5,

    /* Least significant change of log Ion, as a multiple of the expected
       uncertainty; added to odd_limit. */
    .odd_surprise = 2,

    /* If less than the reciprocal of this of a predicted change occurs, the
       radius shrinks or the bracket is bisected. */
    .unanswered = 10,

    /* ---- selection of moves ---- */

    /* W corrects the error that jogs leave beyond so many times `tolerance`. */
    .coarse = 10,

    /* A move is made if the expected error is at most this part of the present
       one. */
    .worthwhile = 0.8,

    /* The loop ends if the mean error is below `limit` over this. */
    .mean_part = 10,

    /* Transistors that the regulator still moves follow for at most so many
       times `iterations`. */
    .patience = 2,

    /* ---- jogs: jog.c ---- */

    /* nm: the optics smooth a step along an edge as a Gaussian of this standard
       deviation, about a quarter of the resolution. This and the three
       constants below fit the effect of jogs on about a thousand gates at 193
       nm, NA 0.75. */
    .blur = 60,

    /* In units of blur. A line that ends within short_end of the gate is thin
       at its end and yields easily: its edges have half of their effect up to
       past_end beyond the gate. The edges of a line that continues have an
       effect only up to before_end before the end of the gate. */
    .short_end = 2,
    .past_end = 1 / 2.0,
    .before_end = 3,

    /* ---- flat edges: shape.c ---- */

    /* nm: standard deviation with which the optics smooth a part of the
       edges. */
    .smooth = 50,

    /* Tikhonov's term, relative to the response of a whole edge. */
    .firm = 0.15,

    /* Response of a part of 60 nm, relative to that of a whole edge; half is a
       price four times as high. */
    .local = 0.5,

    /* nm: least extension of the poly past the active for a part of its own;
       equal to the default of min_jog. */
    .tail = 40,

    /* Grid steps: a length error below this ends the search beside the ends of
       parts. Without that search some gates keep an Ion deviation of 0.9 %. */
    .near_jog = 0.02,

    /* Weight of a squared error of Ioff against one of Ion in the comparison of
       masks, until L alone continues. */
    .leak = 0.003,

    /* Logarithmic error of Ioff beyond which it is reported. */
    .leaks = 0.26,

    /* Iterations, by target, in which parts move, and after which W rests and L
       alone corrects Ion. */
    .shapes = {0, 2, 6},
    .settled = {0, 6, 9},

    /* Iterations after that until transistors within the limit rest, and then
       until those beyond it stop: resting transistors keep neighbours and
       regulator still. */
    .polish = 2,
    .rest = 3,
};
