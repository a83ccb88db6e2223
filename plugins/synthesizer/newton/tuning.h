/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of synthesizer.newton, with unit and source. Values without a
   source were chosen on the cells of the NanGate library and the ISCAS'85
   circuits at scale 1.3. tuning.md lists the effect of half and twice each
   value, as measured by tools/tuned-constants. Targets (plain, balanced, full):
   see the parameter `target`. */
#pragma once

#include <stdint.h>

static const struct {
  double thin_end[2], doubt[2], least_doubt, many;
  double trust[2], longest;
  double still, coupling, noise_floor;
  double odd_limit, odd_surprise, unanswered;
  double coarse, worthwhile;
  double blur, short_end, past_end, before_end;
  double smooth, firm, local, near_jog, leak, leaks;
  uint32_t shapes[3], settled, tries;
} tuned = {
    /* ---- the first estimate of a response ---- */

    /* Relative uncertainty of an initial response to L and to W. */
    .doubt = {0.3, 0.1},

    /* Smallest relative uncertainty of a response; above 0, because the
       response changes with the mask. Also the relative uncertainty of other
       predicted effects on log Ion: of moves of parts of edges, and of moves of
       line ends in the first iteration. */
    .least_doubt = 0.15,

    /* Least number of transistors of a type for which a common factor of their
       responses to L is fitted. */
    .many = 16,

    /* ---- moves ---- */

    /* Target balanced: a gate whose error of log Ioff exceeds the first value
       loses the strips at the ends of its width whose error exceeds the same
       value. A gate is not widened over strips that exceed the second value. */
    .thin_end = {0.7, 2.5},

    /* Largest factor between a response and its initial estimate, for L and for
       W; also the largest common factor of the first moves for L. The response
       to W is geometric and well known. */
    .trust = {4, 1.5},

    /* nm: initial trust radius of L (trust.c adapts the radius). A line that
       has never printed changes by a quarter of the value in each iteration. */
    .longest = 20,

    /* ---- influences on a transistor besides its moves ---- */

    /* nm: largest move of a line end that has no effect on the transistor. */
    .still = 2,

    /* Effect of neighbours on log Ion, relative to the root mean square of the
       predicted changes of log Ion of all transistors. Measured at 193 nm, NA
       0.75: at most 0.1. */
    .coupling = 0.1,

    /* Uncertainty of log Ion caused by the simulation itself. */
    .noise_floor = 1e-4,

    /* ---- changes by other causes: is_foreign ---- */

    /* Least significant change of log Ion, relative to `ion_limit`. */
    .odd_limit = 0.5,

    /* Least significant change of log Ion, as a multiple of the expected
       uncertainty; added to odd_limit. */
    .odd_surprise = 2,

    /* If a change is smaller than the predicted change by more than this
       factor, the trust radius is reduced or the bracket is bisected. */
    .unanswered = 10,

    /* ---- selection of moves ---- */

    /* W corrects an error that remains after jogs if it exceeds both
       `ion_limit` and this multiple of `tolerance`. */
    .coarse = 10,

    /* A move is made if the expected error is at most this fraction of the
       present error. The method stops when all errors are below this fraction
       of `ion_limit`; the rest, 0.1 % of Ion, is a reserve for moves of
       neighbours and for the accurate simulation. */
    .worthwhile = 0.8,

    /* ---- jogs: jog.c ---- */

    /* nm: standard deviation of the Gaussian by which the optics smooth a step
       of an edge, about a quarter of the resolution. `blur` and the next three
       constants are fitted to the effect of jogs on about 1,000 gates at 193
       nm, NA 0.75. */
    .blur = 60,

    /* The effect of an edge on the gate falls to half at a position along W. If
       the poly ends within short_end * blur of the gate, the position is blur *
       past_end beyond the end of the gate, else blur / before_end inside. */
    .short_end = 2,
    .past_end = 1 / 2.0,
    .before_end = 3,

    /* ---- flat edges: shape.c ---- */

    /* nm: standard deviation as `blur`, for moves of parts of both edges. */
    .smooth = 50,

    /* Tikhonov regularization, relative to the response of a whole edge. */
    .firm = 0.15,

    /* Response of a part of 60 nm, relative to that of a whole edge. Half of
       the value quadruples the cost of a jog. */
    .local = 0.5,

    /* Grid steps: length error at which the search for jogs at and beside the
       ends of parts stops. Without the search some gates keep an Ion deviation
       of 0.9 %. */
    .near_jog = 0.02,

    /* Weight of the squared errors of log Ioff and of log area, relative to
       that of log Ion, until only L moves. Without the weight of the area, a
       gate whose line end leaks becomes wider without end. */
    .leak = 0.003,

    /* Error of log Ioff above which the verdict reports Ioff. */
    .leaks = 0.26,

    /* By target (plain, balanced, full): last iteration in which parts move.
     */
    .shapes = {0, 2, 4},

    /* Iteration after which only L moves and corrects Ion. After 6 iterations
       the mean error of Ioff was an eighth (balanced) to a third (full) larger.
     */
    .settled = 7,

    /* Number of moves after `settled` that may leave a transistor no better
       than its best mask. */
    .tries = 3,
};
