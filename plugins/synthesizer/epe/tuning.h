/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of synthesizer.epe, with unit and source. Values without a
   source were chosen on the SRAM cell, NAND2_X1 and c432 with fragments of 20
   nm. tuning.md has the effect of half and double of each constant;
   tools/tuned-constants measures these effects and writes that table. The flow
   keeps the iteration with the least Ion deviation, so any change moves EPE and
   shots by several percent. */
#pragma once

static const struct {
  double least_gain, most_gain, ignored, least_step, growth, lost, lost_cost;
  double enough, coupling_reach, jog_part;
  double window_step, window_reach, progress;
  int neighbours, descents, whole_after, drawn_after, still, patience;
} tuned = {
    /* ---- feedback: steer.c, couple.c ---- */

    /* nm of printed image per nm of mask: bounds of a measured gain. */
    .least_gain = 0.3,
    .most_gain = 5,

    /* Number of neighbouring sites on each side, around the polygon, from which
       a gain is measured. */
    .neighbours = 2,

    /* Grid steps: smaller errors have no significant sign. */
    .ignored = 1,

    /* Grid steps: least bound of the move of a fragment. */
    .least_step = 0.5,

    /* Growth of that bound per iteration while the error keeps its sign. A
       value below 1 shrinks the bound. */
    .growth = 1.2,

    /* Factor of `step`: assumed error of a site without an edge nearby. */
    .lost = 2,

    /* nm: cost of a site without an edge nearby, equal to the search distance
       of edges. */
    .lost_cost = 100,

    /* Steps of conjugate gradients; more steps improve the errors less than
       they cost in jogs. */
    .descents = 8,

    /* Squared residual, relative, at which conjugate gradients stop. */
    .enough = 1e-4,

    /* Standard deviations at which coupling is truncated. Twice the value takes
       four times the time. */
    .coupling_reach = 2,

    /* ---- the rules of the mask: rules.c ---- */

    /* The rounding error of the grid is carried along an edge until it amounts
       to one grid step over `blur` divided by this. */
    .jog_part = 4,

    /* Rounds until edges that do not converge move as one run, and until
       violations stay as drawn. */
    .whole_after = 6,
    .drawn_after = 12,

    /* Iterations without a move at which the loop stops. */
    .still = 4,

    /* The loop has converged if the cost has not fallen by this part within
       `patience` iterations. Rounding to the grid changes Ion by more from one
       iteration to the next. */
    .progress = 0.05,
    .patience = 20,

    /* ---- other doses: window.c ---- */

    /* nm: distance of samples of the level set in the search for the contour of
       another dose, and largest search distance. */
    .window_step = 4,
    .window_reach = 60,
};
