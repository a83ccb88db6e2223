/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of regulator.drc, with unit, source, and results at half and
   at double of the value. Values without a source were chosen on the cases
   below.

   Figures are moves, largest |Ion deviation| in %, shots and violations of
   flows/newton.yaml. With the present values:
     SRAM                                         6, 0.195,   917, 0
     NAND2_X1 of the NanGate library at scale 1.3 5, 0.040,    50, 0
     c432                                         6, 0.235,  8579, 1
   "None of the three" means that all their figures are unchanged to the last
   digit. Harder cases, at scale 1.3 unless stated:
     HEADS  c432, max_head 10 nm, want_extension 60 nm  16, 0.32,  8944, 1
     C2670  c2670                                        8, 0.33, 33418, 1
     SDFF   SDFFRS_X2 at scale 1.2, flows/dpb.yaml      22, 7.9,    525, 16
     DFF    DFF_X1 at scale 1.2                         11, 0.32,   246, 12
     OAI    OAI33_X1 at scale 1.2, flows/dpb.yaml       19, 4.9,    125, 0
     SMALL  c432 at scale 1.15, which hardly prints     19, 546,   7131, 332 */
#pragma once

#include <stdint.h>

static const struct {
  double usual, least, most, largest_step, spare, back;
  double pitch, rounding, wide, near_gate, most_sites, reach, inset;
  double half_patch, corner, into, flank_step;
  double steep, ahead;
  double of_gate, beside;
  uint32_t extend_until, smooth_until;
  int patience;
} tuned = {
    /* ---- moves of a mask edge: rules.c ---- */

    /* nm of printed image per nm of mask, before two measurements.
       Half, which moves too far: SRAM 12, 0.46, 933, 0. Twice: NAND2_X1 6,
       0.013, 50, 0; c432 7, 0.31, 8580, 1. */
    .usual = 0.8,

    /* nm per nm: bounds of the measured response; images that appear and vanish
       would result in any value. Least: half SRAM 6, 0.13, 911, 0; twice last
       digits and SRAM 916 shots. Most: half c432 6, 0.22, 8581, 1; twice no
       difference. */
    .least = 0.3,
    .most = 2,

    /* nm: largest move of an edge per iteration. Half: SRAM 6, 0.22, 907, 0;
       c432 5, 0.21, 8578, 1. Twice, which max_growth forbids: no difference. */
    .largest_step = 60,

    /* nm: margin beyond a limit, so that later moves of the synthesizer do not
       exceed the limit at once. Half: SRAM 909 shots, c432 0.23, 8586. Twice:
       SRAM 7, 0.24, 932, 0. */
    .spare = 1,

    /* nm: reduction per iteration of a shape that causes a violation. Half:
       c432 8, 0.21, 8579, 1. Twice: c432 5, 0.21, 8579, 2. */
    .back = 5,

    /* ---- sites: sites.c, repairs.c ---- */

    /* nm: distance of sites along lines and gaps; necks are as long as the
       optical resolution, about 100 nm. None of the three. Half: OAI 21, 11.9,
       C2670 1 violation more. Twice: OAI 21, 11.9, SDFF 21, 105, 531, 14. */
    .pitch = 60,

    /* nm: distance from corners, which print round, within which there are no
       sites. None of the three. Half: C2670 a shot more. Twice: C2670 10, 0.29,
       SDFF 22, 7.9, 523, 13. */
    .rounding = 100,

    /* nm: wider lines and gaps do not close and have no sites. Half: last
       digits of c432. Twice: none of the three; a violation more in c1908. */
    .wide = 250,

    /* nm: largest distance of a gate that a violation is assigned to. None of
       the three. Half: SDFF 21, 7.9, 534, 13. Twice: SDFF 28, 7.9, 524, 16. */
    .near_gate = 200,

    /* Largest number of sites along the edges of a layer; larger layers have
       sites at a larger distance. Limits time, and memory to 17 MB. */
    .most_sites = 1 << 19,

    /* nm: search distance of contours, and of repair shapes that cause a
       violation. Half: none of the three; DFF 11, 0.34, 248, 12. Twice: c432 6,
       0.44, 8579, 1 after one iteration more. */
    .reach = 150,

    /* Distance of the outer checked points from the corners, where the image is
       round, relative to the side of a contact. Half: SRAM 909 shots, c432
       8709. Twice, which is one point in the middle: SRAM 7, 0.23, 896, 0; c432
       8574. */
    .inset = 0.25,

    /* ---- repair shapes: repairs.c ---- */

    /* nm: extent of the repair shape of a line along the line, on either side.
       None of the three. Half: SDFF 21, 7.9, 530, 22. Twice: last digits of
       SDFF. */
    .half_patch = 40,

    /* nm: a repair shape includes a corner at this distance. None of the three.
       Half: 16 shots more of the SRAM by flows/dpb.yaml. Twice: DFF 243
       shots. */
    .corner = 20,

    /* nm: extension of the end of a repair shape in a concave corner into the
       shape, as the adjacent edge may have moved inwards; about the largest
       move of a synthesizer. No difference. */
    .into = 10,

    /* nm: move per iteration of the sides adjacent to one that cannot move
       further. Half: c432 6, 0.23, 8593, 1. Twice: c432 6, 0.36, 8579, 1. */
    .flank_step = 15,

    /* ---- line ends: ends.c ---- */

    /* Response of a line end to the width of its head on both flanks, relative
       to that of the tip. None of the three. Half: HEADS 12, 0.45, 8976. Twice:
       HEADS 12, 0.26, 8971. */
    .steep = 4,

    /* nm: a line end extends beyond the limit only if nothing prints within
       this distance before the line end, so that later moves do not merge both.
       None of the three; SDFF has one violation more at twice. */
    .ahead = 30,

    /* Iterations after which no line end extends beyond the limit, as the
       synthesizer would mistake the effect for that of a move. 1: SRAM
       0.14, c432 0.22, HEADS 6, 0.21, 8611. 6: c432 0.29 after one iteration
       more. */
    .extend_until = 3,

    /* ---- trims: trims.c ---- */

    /* nm: edges within this distance before a gate belong to the gate or the
       line end. None of the three. Half: SDFF 27, 7.8, 548, 50. Twice: C2670
       unchanged, SDFF 526 shots. */
    .of_gate = 100,

    /* nm: distance of the end of a stretch from contacts and gates. None of the
       three; last digits of SDFF. */
    .beside = 20,

    /* ---- jogs: smooth.c ---- */

    /* Largest number of smoothed jogs reverted for another one, so that
       smoothing terminates. No difference. */
    .patience = 1000,

    /* Iterations after which smoothed jogs stay even if the mask violates its
       rules, so that smoothing terminates. 12: c1908 by newton's `balanced`
       takes two iterations more on a mask that nothing else changes. */
    .smooth_until = 8,
};
