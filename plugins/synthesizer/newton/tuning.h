/* SPDX-License-Identifier: BSD-3-Clause */
/* All tuned constants of synthesizer.newton, each with its unit and where its
   value comes from. Where no source is named, we chose the value on the cells
   of the NanGate library and the ISCAS'85 circuits at scale 1.3. tuning.md has
   the effect of half and double of each constant; tools/tuned-constants
   measures these effects and writes that table. */
#ifndef SYNTHESIZER_NEWTON_TUNING_H
#define SYNTHESIZER_NEWTON_TUNING_H

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

    /* d log I / d log L of Ion and Ioff, where no print determines a slope. A
       long channel has -1; -15 is that of PTM 65 nm at L 65 nm. */
    .slope = {-1, -15},

    /* The factor by which the first prints may change the response to L of all
       transistors of a type. */
    .gain_bound = 2.5,

    /* How uncertain a first response to L and to W is, as a part of it. */
    .doubt = {0.3, 0.1},

    /* No response gets less uncertain than this part: it changes with the mask.
     */
    .least_doubt = 0.15,

    /* So many transistors of a type separate a common factor from their own
       ones; and how uncertain each response to L is then, as a part of it. */
    .many = 16,
    .doubt_of_many = 0.15,

    /* ---- moves ---- */

    /* Where the poly is thin (target: balanced): by so much log Ioff of a gate
       and of the strips at an end of its width is too large when those strips
       are given up; and log Ioff of a strip beyond the end when the gate gets
       wider elsewhere. */
    .thin_end = {0.7, 2.5},

    /* A response to L, and to W, stays within this factor of its first
       estimate. That to W is geometry and well known. */
    .trust = {4, 1.5},

    /* nm: the longest step of L at first; the results of moves lengthen and
       shorten it (trust.c). */
    .longest = 20,

    /* nm: how much wider a line gets at a time that does not print at all. */
    .open_step = 5,

    /* ---- influences on a transistor besides its moves ---- */

    /* nm: a line end that moves further changes its transistor. */
    .still = 2,

    /* The effect of the first move of line ends on log Ion is predicted; this
       part of it is left open. */
    .unforeseen = 0.15,

    /* Largest effect on log Ion of a line end that moves later. */
    .late = 0.01,

    /* The effect of neighbours on log Ion, as a part of the mean move (root
       mean square) of all transistors. Measured at 193 nm, NA 0.75: a tenth at
       most. */
    .coupling = 0.1,

    /* The uncertainty that each print of log Ion has. */
    .noise_floor = 1e-4,

    /* ---- odd prints: is_odd, is_foreign ---- */

    /* A change of log Ion counts from this part of `limit` on. */
    .odd_limit = 0.5,

    /* It counts where it is more than so many times the surprise expected. */
    .odd_surprise = 2,

    /* If less than one part in so many of a predicted change arrives, the
       radius shrinks, or the bracket is halved. */
    .unanswered = 10,

    /* ---- which moves are made ---- */

    /* W corrects the error that jogs leave beyond so many times `tolerance`. */
    .coarse = 10,

    /* A move is made if at most this part of the error is expected to be left.
     */
    .worthwhile = 0.8,

    /* The loop ends where the mean error is below `limit` over this. */
    .mean_part = 10,

    /* Transistors that the regulator still moves follow it for so many times
       `iterations`. */
    .patience = 2,

    /* ---- jogs: jog.c ---- */

    /* nm: along an edge the print smooths a step of it as a Gaussian of this
       standard deviation, some quarter of the resolution. This and the three
       below fit the effect of jogs on some thousand gates at 193 nm, NA 0.75.
     */
    .blur = 60,

    /* In units of blur: a line that ends within short_end of the gate is thin
       at its end and gives way easily, so that its edges matter, by half, as
       far as past_end beyond the gate; a line that goes on holds, and its edges
       matter only as far as before_end before the gate's end. */
    .short_end = 2,
    .past_end = 1 / 2.0,
    .before_end = 3,

    /* ---- flat edges: shape.c ---- */

    /* nm: how a print smooths a part of the edges. */
    .smooth = 50,

    /* Tikhonov's term, as a part of the response of a whole edge. */
    .firm = 0.15,

    /* The response of a part of 60 nm, as a part of that of a whole edge; half
       is a price four times as high. */
    .local = 0.5,

    /* nm: the poly goes at least so far past the active for a part of its own.
       As min_jog's default. */
    .tail = 40,

    /* Grid steps: a length nearer than this is not searched for beside the ends
       of parts. Without that search some gates stay 0.9 % of Ion off. */
    .near_jog = 0.02,

    /* The weight of a squared error of Ioff against one of Ion until L alone
       goes on, by which masks are compared. */
    .leak = 0.003,

    /* Ioff further off than this (a factor's logarithm) is reported. */
    .leaks = 0.26,

    /* Prints, by target, in which parts move, and after which W rests and L
       goes on for Ion alone. */
    .shapes = {0, 2, 6},
    .settled = {0, 6, 9},

    /* Prints after that until all that is within the limit rests, and after
       that in which those beyond it still move: what rests keeps its neighbours
       and the regulator still. */
    .polish = 2,
    .rest = 3,
};

#endif
