/* SPDX-License-Identifier: BSD-3-Clause */
/* Tuned constants of regulator.drc, with unit and source. Values without a
   source were chosen on the SRAM cell, cells of the NanGate library and
   ISCAS'85 circuits at scales of 1.15 to 1.3. tuning.md lists the effect of
   half and twice each value. */
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
    /* ---- displacements of a mask edge: rules.c ---- */

    /* Displacement of a printed edge per displacement of the mask edge, nm per
       nm, until two measurements determine the response. */
    .usual = 0.8,

    /* Bounds of the measured response, nm per nm. Where a printed feature
       appears or vanishes, the measured response has no meaning. */
    .least = 0.3,
    .most = 2,

    /* Largest displacement of an edge per iteration, nm. */
    .largest_step = 60,

    /* Margin beyond a required value, nm, so that the next displacements by the
       synthesizer do not violate the rule again. */
    .spare = 1,

    /* Reduction per iteration of a shape that causes a violation, nm. */
    .back = 5,

    /* ---- sites: sites.c, repairs.c ---- */

    /* Distance between sites along lines and gaps, nm. A pinched part of a line
       is as long as the optical resolution, about 100 nm. */
    .pitch = 60,

    /* Smallest distance of sites from corners, nm, because corners print
       rounded. */
    .rounding = 100,

    /* Lines and gaps wider than this, nm, have no sites: wide lines do not
       pinch and wide gaps do not bridge. */
    .wide = 250,

    /* A violation belongs to the nearest gate within this distance, nm. */
    .near_gate = 200,

    /* Largest number of sites along the edges of a layer; limits time, and
       memory to 17 MB. Longer edges increase the distance between sites. */
    .most_sites = 1 << 19,

    /* Largest search distance, nm, for a contour, and for a repair shape that
       causes a violation. */
    .reach = 150,

    /* Three points are checked on each side of a contact. Distance of the outer
       points from the corners, where the image is rounded, as a fraction of the
       side. At 0.5, all three points are in the middle. */
    .inset = 0.25,

    /* ---- repair shapes: repairs.c ---- */

    /* Half of the length of a line's repair shape along the line, nm. */
    .half_added = 40,

    /* A repair shape extends to a corner within this distance, nm. */
    .corner = 20,

    /* Extension of a repair shape beyond a concave corner into the drawn shape,
       nm, because the synthesizer may have displaced the adjacent edge inwards.
       About the largest displacement by a synthesizer. */
    .into = 10,

    /* Outward displacement per iteration, nm, of the two sides adjacent to a
       side of a contact that is at its limit. */
    .flank_step = 15,

    /* ---- line ends: ends.c ---- */

    /* Response of the printed line end to the widening of the head on both
       flanks, divided by the response to a displacement of the tip. */
    .steep = 4,

    /* A line end extends beyond the required extension only if nothing prints
       within this distance in front, nm, so that later displacements do not
       merge the line end with another shape. */
    .ahead = 30,

    /* Iterations after which no line end extends beyond the required extension,
       because the synthesizer would attribute the effect to its own
       displacements. */
    .extend_until = 3,

    /* ---- trims: trims.c ---- */

    /* Smallest distance of a trimmed edge from a gate, and largest depth of a
       trim, nm. */
    .of_gate = 100,

    /* Smallest distance along the edge from a trim to contacts and gates, nm.
     */
    .beside = 20,

    /* ---- jogs: smooth.c ---- */

    /* Largest number of bumps that are restored because their removal created a
       notch, so that smoothing terminates. */
    .patience = 1000,

    /* Iterations after which smoothings are kept even if the mask violates its
       rules there, so that smoothing terminates. */
    .smooth_until = 8,
};
