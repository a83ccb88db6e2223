/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of synthesizer.epe, with unit and source. Values without a
   source were chosen on the SRAM cell, NAND2_X1 and c432 with fragments of 20
   nm. tuning.md lists the effect of half and twice each value, as measured by
   tools/tuned-constants. EPE and the number of shots change by several percent
   with any value, as the iteration with the least Ion deviation is kept. */
#pragma once

static const struct {
  double least_gain, most_gain, ignored, least_step, growth, lost, lost_cost;
  double enough, coupling_reach, jog_part;
  double window_step, window_reach, progress;
  int neighbours, descents, whole_after, drawn_after, still, patience;
} tuned = {
    /* ---- feedback: steer.c, couple.c ---- */

    /* Bounds of a measured gain: nm of printed edge per nm of mask. */
    .least_gain = 0.3,
    .most_gain = 5,

    /* Number of neighbouring sites on each side, around the polygon, from which
       a gain is measured. */
    .neighbours = 2,

    /* Grid steps: the sign of an error up to this value is not significant. */
    .ignored = 1,

    /* Grid steps: least value of the bound of a fragment's move. */
    .least_step = 0.5,

    /* Factor of that bound per iteration while the error keeps its sign. */
    .growth = 1.2,

    /* Assumed error of a site without an edge nearby, relative to `step`. */
    .lost = 2,

    /* nm: cost of a site without an edge nearby, equal to the search distance
       of edges. */
    .lost_cost = 100,

    /* Steps of conjugate gradients; more steps mainly add jogs. */
    .descents = 8,

    /* Relative squared residual at which conjugate gradients stop. */
    .enough = 1e-4,

    /* Distance at which the coupling is truncated, standard deviations. Twice
       the value takes four times the time. */
    .coupling_reach = 2,

    /* ---- mask rules: rules.c ---- */

    /* The rounding error of the grid is carried along an edge until the sum
       amounts to one grid step over the length blur / jog_part. */
    .jog_part = 4,

    /* Rounds after which an edge with a violation moves as one run, and after
       which the edge stays as drawn. */
    .whole_after = 6,
    .drawn_after = 12,

    /* Iterations without a move at which the loop stops. */
    .still = 4,

    /* The loop has converged if the cost has not decreased by this fraction
       within `patience` iterations. Rounding to the grid alone changes Ion by
       more from one iteration to the next. */
    .progress = 0.05,
    .patience = 20,

    /* ---- other doses: window.c ---- */

    /* nm: step and largest distance of the search for the contour of another
       dose in the level set. */
    .window_step = 4,
    .window_reach = 60,
};
