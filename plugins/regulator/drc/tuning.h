/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of regulator.drc, with unit and source. Values without a
   source were chosen on the SRAM cell, cells of the NanGate library and
   ISCAS'85 circuits at scales of 1.15 to 1.3. tuning.md has the effect of half
   and double of each constant; tools/tuned-constants measures these effects and
   writes that table. */
#pragma once

#include <stdint.h>

static const struct {
  double usual, least, most, largest_step, spare, back;
  double pitch, rounding, wide, near_gate, most_sites, reach, inset;
  double half_added, corner, into, flank_step;
  double steep, ahead;
  double of_gate, beside;
  uint32_t extend_until, smooth_until;
  int patience;
} tuned = {
    /* ---- moves of a mask edge: rules.c ---- */

    /* nm of printed image per nm of mask, before two measurements. */
    .usual = 0.8,

    /* nm per nm: bounds of the measured response; images that appear and vanish
       would result in any value. */
    .least = 0.3,
    .most = 2,

    /* nm: largest move of an edge per iteration. */
    .largest_step = 60,

    /* nm: margin beyond a limit, so that later moves of the synthesizer do not
       exceed the limit at once. */
    .spare = 1,

    /* nm: reduction per iteration of a shape that causes a violation. */
    .back = 5,

    /* ---- sites: sites.c, repairs.c ---- */

    /* nm: distance of sites along lines and gaps; necks are as long as the
       optical resolution, about 100 nm. */
    .pitch = 60,

    /* nm: distance from corners, which print round, within which there are no
       sites. */
    .rounding = 100,

    /* nm: wider lines and gaps do not close and have no sites. */
    .wide = 250,

    /* nm: largest distance of a gate that a violation is assigned to. */
    .near_gate = 200,

    /* Largest number of sites along the edges of a layer; larger layers have
       sites at a larger distance. Limits time, and memory to 17 MB. */
    .most_sites = 1 << 19,

    /* nm: search distance of contours, and of repair shapes that cause a
       violation. */
    .reach = 150,

    /* Distance of the outer checked points from the corners, where the image is
       round, relative to the side of a contact. Twice the value is one point in
       the middle. */
    .inset = 0.25,

    /* ---- repair shapes: repairs.c ---- */

    /* nm: extent of the repair shape of a line along the line, on either
       side. */
    .half_added = 40,

    /* nm: a repair shape includes a corner at this distance. */
    .corner = 20,

    /* nm: extension of the end of a repair shape in a concave corner into the
       shape, as the adjacent edge may have moved inwards; about the largest
       move of a synthesizer. */
    .into = 10,

    /* nm: move per iteration of the sides adjacent to one that cannot move
       further. */
    .flank_step = 15,

    /* ---- line ends: ends.c ---- */

    /* Response of a line end to the width of its head on both flanks, relative
       to that of the tip. */
    .steep = 4,

    /* nm: a line end extends beyond the limit only if nothing prints within
       this distance before the line end, so that later moves do not merge
       both. */
    .ahead = 30,

    /* Iterations after which no line end extends beyond the limit, as the
       synthesizer would mistake the effect for that of a move. */
    .extend_until = 3,

    /* ---- trims: trims.c ---- */

    /* nm: edges within this distance before a gate belong to the gate or the
       line end. */
    .of_gate = 100,

    /* nm: distance of the end of a stretch from contacts and gates. */
    .beside = 20,

    /* ---- jogs: smooth.c ---- */

    /* Largest number of smoothed jogs reverted for another one, so that
       smoothing terminates. */
    .patience = 1000,

    /* Iterations after which smoothed jogs stay even if the mask violates its
       rules, so that smoothing terminates. */
    .smooth_until = 8,
};
