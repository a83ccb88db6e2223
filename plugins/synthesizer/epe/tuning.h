/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of synthesizer.epe, with unit, source, and results at half
   and at double of the value. Values without a source were chosen on the cases
   below.

   Figures are the mean |EPE| in nm, the mean |Ion deviation| in %, and shots.
   The flow is flows/epe.yaml with fragments of 20 nm, min_width and min_space
   of 20 nm, min_edge of 10 nm, stiffness 0.1, 20 iterations and no regulator.
   With the present values: SRAM                                         0.749,
   0.55,  10760 NAND2_X1 of the NanGate library at scale 1.3 0.619, 0.60,    590
     c432                                         0.707, 0.476, 106635
     WINDOW c432, window.weight 0.5, assist 1     0.768, 0.404, 106842
   Three figures or pairs separated by ; refer to the first three cases. The
   flow keeps the iteration with the least Ion deviation, so any change moves
   EPE and shots by several percent. */
#pragma once

static const struct {
  double least_gain, most_gain, ignored, least_step, growth, lost, lost_cost;
  double enough, coupling_reach, jog_part;
  double window_step, window_reach;
  int neighbours, descents, whole_after, drawn_after, still;
} tuned = {
    /* ---- feedback: steer.c, couple.c ---- */

    /* nm of printed image per nm of mask: bounds of a measured gain. least:
       half 0.754, 0.54; 0.658, 0.38; 0.699, 0.466; twice 0.725, 0.55; 0.645,
       0.34; 0.682, 0.461. most: half 0.739, 0.59; 0.658, 0.50; 0.657, 0.419,
       109630; twice 0.733, 0.52; 0.705, 0.48; 0.706, 0.516. */
    .least_gain = 0.3,
    .most_gain = 5,

    /* Number of neighbouring sites on each side, around the polygon, from which
       a gain is measured. 1: 0.737, 0.56; 0.648, 0.24; 0.681, 0.413. 4: 0.738,
       0.49; 0.739, 0.48; 0.696, 0.471. */
    .neighbours = 2,

    /* Grid steps: smaller errors have no significant sign. Half: 0.769, 0.57;
       0.656, 0.41; 0.682, 0.471. Twice: 0.754, 0.55; 0.619, 0.60; 0.680,
       0.457. */
    .ignored = 1,

    /* Grid steps: least bound of the move of a fragment. Half: 0.723, 0.55;
       c432 0.681, 0.468. Twice: 0.722, 0.57; c432 0.685, 0.467. NAND2_X1 is
       unchanged. */
    .least_step = 0.5,

    /* Growth of that bound per iteration while the error keeps its sign. Half
       (0.6) shrinks the bound: 4.5, 1.5. Twice: SRAM 0.737, 0.57; c432 0.680,
       0.453; NAND2_X1 is unchanged. */
    .growth = 1.2,

    /* Factor of `step`: assumed error of a site without an edge nearby. Half:
       0.723, 0.73; 0.672, 0.44; 0.680, 0.438. Twice: 0.755, 0.57; 0.694, 0.27;
       0.686, 0.464. */
    .lost = 2,

    /* nm: cost of a site without an edge nearby, equal to the search distance
       of edges. All sites of the cases print: no difference. */
    .lost_cost = 100,

    /* Steps of conjugate gradients; more steps improve the errors less than
       they cost in jogs. Half: 0.786, 0.51, 10661; 0.691, 0.69, 555; 0.774,
       0.673, 102850. Twice: 0.722, 0.68, 10886; 0.595, 0.56, 612; 0.674, 0.510,
       110461 and 6 sites lost. */
    .descents = 8,

    /* Squared residual, relative, at which conjugate gradients stop. Half and
       twice: NAND2_X1 0.60, 576 shots; c432 0.475, 106850 at twice. */
    .enough = 1e-4,

    /* Standard deviations at which coupling is truncated. Half: 0.723, 0.47;
       0.626, 0.24, 477; c432 0.629, 0.805, 102776, largest EPE 22 nm. Twice, at
       four times the time: 0.699, 0.52; 0.729, 0.57; 0.679, 0.496. */
    .coupling_reach = 2,

    /* ---- the rules of the mask: rules.c ---- */

    /* The rounding error of the grid is carried along an edge until it amounts
       to one grid step over `blur` divided by this. Half: 0.742, 0.62, 9820;
       0.597, 0.44, 549; 0.695, 0.454, 97742. Twice: 0.719, 0.54, 10977; 0.636,
       0.39, 589; 0.708, 0.479, 109326. */
    .jog_part = 4,

    /* Rounds until edges that do not converge move as one run, and until
       violations stay as drawn. No difference: all converge earlier. */
    .whole_after = 6,
    .drawn_after = 12,

    /* Iterations without a move at which the loop stops. No difference. */
    .still = 4,

    /* ---- other doses: window.c ---- */

    /* nm: distance of samples of the level set in the search for the contour of
       another dose, and largest search distance. step: half WINDOW 0.706,
       0.428; twice 0.820, 0.456. reach: half WINDOW 0.739, 0.378; twice 0.748,
       0.421. */
    .window_step = 4,
    .window_reach = 60,
};
