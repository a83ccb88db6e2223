/* SPDX-License-Identifier: BSD-3-Clause */
/* All tuned constants of regulator.drc. Each has its unit, where its value
   comes from, and what half and twice of it do. Where no source is told, the
   value was chosen by us on the cases below.

   Figures are moves, largest |Ion deviation| in %, shots and violations of
   flows/newton.yaml. As it is:
     SRAM (the flow as it is)                     6, 0.195,   917, 0
     NAND2_X1 of the NanGate library at scale 1.3 5, 0.040,    50, 0
     c432                                         6, 0.235,  8579, 1
   "None of the three" means that all figures of these stay the same to the last
   digit. Then harder cases are named, at scale 1.3 if no other is told:
     HEADS  c432, max_head 10 nm, want_extension 60 nm  16, 0.32,  8944, 1
     C2670  c2670                                        8, 0.33, 33418, 1
     SDFF   SDFFRS_X2 at scale 1.2, flows/dpb.yaml      22, 7.9,    525, 16
     DFF    DFF_X1 at scale 1.2                         11, 0.32,   246, 12
     OAI    OAI33_X1 at scale 1.2, flows/dpb.yaml       19, 4.9,    125, 0
     SMALL  c432 at scale 1.15, which hardly prints     19, 546,   7131, 332 */
#ifndef REGULATOR_TUNING_H
#define REGULATOR_TUNING_H

#include <stdint.h>

static const struct {
  double usual, least, most, largest_step, spare, back;
  double pitch, rounding, wide, near_gate, most_sites, reach, inset;
  double half_patch, corner, into, flank_step;
  double steep, ahead;
  double of_gate, beside;
  uint32_t wishes_until, anew;
  int patience;
} tuned = {
    /* ---- how an edge of the mask is moved: rules.c ---- */

    /* nm of print for each nm of mask, taken before two prints tell it. Half,
       which moves too far: SRAM 12, 0.46, 933, 0. Twice: NAND2_X1 6, 0.013, 50,
       0; c432 7, 0.31, 8580, 1. */
    .usual = 0.8,

    /* nm for each nm: what two prints may tell at least and at most; prints
       that come and go tell any. Least: half SRAM 6, 0.13, 911, 0; twice last
       digits and SRAM 916 shots. Most: half c432 6, 0.22, 8581, 1; twice no
       case differs. */
    .least = 0.3,
    .most = 2,

    /* nm: an edge moves at most so far at a time. Half: SRAM 6, 0.22, 907, 0;
       c432 5, 0.21, 8578, 1. Twice, which max_growth forbids: no case differs.
     */
    .largest_step = 60,

    /* nm: what is aimed at beyond a limit, so that what the synthesizer moves
       later does not undo it at once. Half: SRAM 909 shots, c432 0.23, 8586.
       Twice: SRAM 7, 0.24, 932, 0. */
    .spare = 1,

    /* nm: how far goes back at a time what does harm. Half: c432 8, 0.21, 8579,
       1. Twice: c432 5, 0.21, 8579, 2. */
    .back = 5,

    /* ---- where the print is looked at: sites.c, repairs.c ---- */

    /* nm: lines and gaps are looked at so often along them; necks are as long
       as the optics resolve, some 100 nm. None of the three. Half: OAI
       21, 11.9, C2670 1 violation more. Twice: OAI 21, 11.9, SDFF 21, 105,
       531, 14. */
    .pitch = 60,

    /* nm: corners are round so far, and not looked at. None of the three. Half:
       C2670 a shot more. Twice: C2670 10, 0.29, SDFF 22, 7.9, 523, 13. */
    .rounding = 100,

    /* nm: wider lines and gaps do not close, and are not looked at. Half: last
       digits of c432. Twice: none of the three; a violation more in c1908. */
    .wide = 250,

    /* nm: a gate further away has no part in what is wrong. None of the three.
       Half: SDFF 21, 7.9, 534, 13. Twice: SDFF 28, 7.9, 524, 16. */
    .near_gate = 200,

    /* Places along all edges of a layer; they are further apart where there
       would be more. It bounds time, and memory to 17 MB. */
    .most_sites = 1 << 19,

    /* nm: how far a contour is looked for, and how near a patch is to blame for
       what fails. Half: none of the three; DFF 11, 0.34, 248, 12. Twice: c432
       6, 0.44, 8579, 1 for one print more. */
    .reach = 150,

    /* Of the side of a contact: its outer points lie so far from the corners,
       where the print is round. Half: SRAM 909 shots, c432 8709. Twice, which
       is one point in the middle: SRAM 7, 0.23, 896, 0; c432 8574. */
    .inset = 0.25,

    /* ---- patches: repairs.c ---- */

    /* nm: how far the patch of a line goes along it, on either side. None of
       the three. Half: SDFF 21, 7.9, 530, 22. Twice: last digits of SDFF. */
    .half_patch = 40,

    /* nm: a patch takes along a corner that is so near. None of the three.
       Half: 16 shots more of the SRAM by flows/dpb.yaml. Twice: DFF 243 shots.
     */
    .corner = 20,

    /* nm: the end of a patch in a concave corner goes on so far into the shape,
       as the edge that it meets there may have moved inwards: about what a
       synthesizer takes. No case differs. */
    .into = 10,

    /* nm: the sides beside one that may go no further go out so far at a time.
       Half: c432 6, 0.23, 8593, 1. Twice: c432 6, 0.36, 8579, 1. */
    .flank_step = 15,

    /* ---- line ends: ends.c ---- */

    /* How much further a line end prints for each nm that both flanks of its
       head go out, against a nm of its tip. None of the three. Half: HEADS 12,
       0.45, 8976. Twice: HEADS 12, 0.26, 8971. */
    .steep = 4,

    /* nm: a line end is made longer than it must be only where so much before
       it does not print: what moves later is not to join it. None of the three;
       SDFF has one violation more at twice. */
    .ahead = 30,

    /* Prints after which no line end is made longer than it must be, as the
       synthesizer would take the effect for that of its own moves. 1: SRAM
       0.14, c432 0.22, HEADS 6, 0.21, 8611. 6: c432 0.29 for one print more. */
    .wishes_until = 3,

    /* ---- edges that go back: trims.c ---- */

    /* nm: edges so near before a gate belong to it, or to its line end. None of
       the three. Half: SDFF 27, 7.8, 548, 50. Twice: C2670 as it is, SDFF 526
       shots. */
    .of_gate = 100,

    /* nm: beside contacts and gates a stretch ends so far off. None of the
       three; last digits of SDFF. */
    .beside = 20,

    /* ---- jogs: smooth.c ---- */

    /* How often one mend may make way for another, so that it comes to an end.
       No case differs. */
    .patience = 1000,

    /* Prints after which what was smoothed stays also where the mask breaks its
       rules, so that it comes to an end. 12: c1908 by newton's `balanced` takes
       two prints more of a mask that nobody else moves. */
    .anew = 8,
};

#endif
