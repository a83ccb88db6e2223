/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of regulator.drc, with unit and source. Values without a
   source were chosen on the SRAM cell, cells of the NanGate library and
   ISCAS'85 circuits at scales of 1.15 to 1.3. tuning.md lists the effect of
   half and twice each value, as measured by tools/tuned-constants. */
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

    /* nm per nm: assumed move of a printed edge per move of the mask edge until
       two measurements determine the response. */
    .usual = 0.8,

    /* nm per nm: bounds of the measured response, which has no meaning where a
       printed feature appears or vanishes. */
    .least = 0.3,
    .most = 2,

    /* nm: largest move of an edge per iteration. */
    .largest_step = 60,

    /* nm: margin beyond a required value, so that the next moves of the
       synthesizer do not violate the rule again. */
    .spare = 1,

    /* nm: reduction per iteration of a shape that causes a violation. */
    .back = 5,

    /* ---- sites: sites.c, repairs.c ---- */

    /* nm: distance between sites along lines and gaps. A pinched part of a line
       is as long as the optical resolution, about 100 nm. */
    .pitch = 60,

    /* nm: least distance of sites from corners, which print rounded. */
    .rounding = 100,

    /* nm: wider lines do not pinch and wider gaps do not bridge: no sites. */
    .wide = 250,

    /* nm: a violation is assigned to the nearest gate within this distance. */
    .near_gate = 200,

    /* Largest number of sites along the edges of a layer; limits time, and
       memory to 17 MB. With more edges the sites are further apart. */
    .most_sites = 1 << 19,

    /* nm: largest distance at which a contour, or a repair shape that causes a
       violation, is searched. */
    .reach = 150,

    /* Three points are checked on each side of a contact. Distance of the outer
       two from the corners, where the image is rounded, relative to the length
       of the side. At 0.5 all three are in the middle. */
    .inset = 0.25,

    /* ---- repair shapes: repairs.c ---- */

    /* nm: half of the length of the repair shape of a line along the line. */
    .half_added = 40,

    /* nm: a repair shape extends to a corner within this distance. */
    .corner = 20,

    /* nm: extension of a repair shape beyond a concave corner into the drawn
       shape, as the synthesizer may have moved the adjacent edge inwards. About
       the largest move of a synthesizer. */
    .into = 10,

    /* nm: outward move per iteration of the two sides adjacent to a side of a
       contact that cannot move further. */
    .flank_step = 15,

    /* ---- line ends: ends.c ---- */

    /* Response of the printed line end to the extension of the head on both
       flanks, relative to the response to a move of the tip. */
    .steep = 4,

    /* nm: a line end extends beyond the required extension only if nothing
       prints within this distance before the line end, so that later moves do
       not merge the line end with another shape. */
    .ahead = 30,

    /* Iterations after which no line end extends beyond the required extension:
       the synthesizer would attribute the effect to its own moves. */
    .extend_until = 3,

    /* ---- trims: trims.c ---- */

    /* nm: least distance of a trimmed edge to a gate; largest depth of a trim.
     */
    .of_gate = 100,

    /* nm: distance along the edge from the end of a trim to contacts, gates. */
    .beside = 20,

    /* ---- jogs: smooth.c ---- */

    /* Largest number of removed bumps that are restored because of a notch
       beside them, so that smoothing terminates. */
    .patience = 1000,

    /* Iterations after which smoothings stay even if the mask violates its
       rules there, so that smoothing terminates. */
    .smooth_until = 8,
};
