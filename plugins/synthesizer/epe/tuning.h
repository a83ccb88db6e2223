/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of synthesizer.epe, with unit and source. Values without a
   source were chosen on the SRAM cell, NAND2_X1 and c432 with fragments of 20
   nm. tuning.md lists the effect of half and twice each value. Any change of a
   value changes EPE and the number of shots by several percent, because the
   iteration with the smallest Ion deviation is kept. */
#pragma once

static const struct {
  double least_gain, most_gain, ignored, least_step, growth, lost, lost_cost;
  double enough, coupling_reach, jog_part;
  double window_step, window_reach, progress;
  int neighbours, descents, whole_after, drawn_after, still, patience;
} tuned = {
    /* ---- feedback: steer.c, couple.c ---- */

    /* Bounds of a measured gain, nm of printed edge per nm of mask. */
    .least_gain = 0.3,
    .most_gain = 5,

    /* Number of adjacent sites on each side from which a gain is measured. */
    .neighbours = 2,

    /* Largest error whose sign is not significant, grid steps. */
    .ignored = 1,

    /* Smallest value of the bound on the change of a fragment's shift, grid
       steps. */
    .least_step = 0.5,

    /* Factor by which this bound grows per iteration while the error keeps its
       sign. */
    .growth = 1.2,

    /* Assumed error of a site without an edge nearby, as a multiple of `step`.
     */
    .lost = 2,

    /* Cost of a site without an edge nearby, nm; equal to the search distance
       of edges. */
    .lost_cost = 100,

    /* Number of steps of conjugate gradients; more steps mainly add jogs. */
    .descents = 8,

    /* Relative squared residual at which conjugate gradients stop. */
    .enough = 1e-4,

    /* Distance at which the coupling is truncated, standard deviations. Twice
       the value increases the time fourfold. */
    .coupling_reach = 2,

    /* ---- mask rules: rules.c ---- */

    /* The rounding error of the grid is summed along an edge until the sum
       amounts to one grid step over the length blur / jog_part. */
    .jog_part = 4,

    /* Numbers of rounds of the loop in epe_settle after which an edge with a
       violation has one shift, and after which the edge stays as drawn. */
    .whole_after = 6,
    .drawn_after = 12,

    /* Number of iterations without a change after which the loop stops. */
    .still = 4,

    /* The loop has converged if the cost has not decreased by the fraction
       `progress` within `patience` iterations. Rounding to the grid alone
       changes Ion by more between two iterations. */
    .progress = 0.05,
    .patience = 20,

    /* ---- other doses: window.c ---- */

    /* Step and largest distance of the search for the contour at another dose
       in the level set, nm. */
    .window_step = 4,
    .window_reach = 60,
};
