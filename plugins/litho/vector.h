/* SPDX-License-Identifier: BSD-3-Clause */
/* What the field of light does in a lens: vector imaging.

   A mask that is thin (Kirchhoff) leaves light its polarisation; so an order
   enters the pupil with that of its source point, j = (jx, jy). At the place p
   of the pupil, direction (c, s), light leaves for the wafer at sin(a) = NA |p|
   / index, and in the resist at sin(b) = NA |p| / resist_index. The lens turns
   the part along (c, s) with the ray and leaves the one across it (M.
   Mansuripur, J. Opt. Soc. Am. A 6, 786, 1989; D. G. Flagello, T. Milster, A.
   E. Rosenbluth, J. Opt. Soc. Am. A 13, 53, 1996):

     E = O [ ts (-s, c, 0) (-s jx + c jy)
           + tp (c cos b, s cos b, -sin b) (c jx + s jy) ]

   O = sqrt(cos(o) / cos(a)), sin(o) = NA |p| / 4 on the mask's side, keeps the
   energy of a beam that is refracted by a lens of reduction 4 (D. C. Cole, E.
   Barouch, U. Hollerbach, S. A. Orszag, Jpn. J. Appl. Phys. 31, 4110, 1992), ts
   and tp are Fresnel's amplitudes into the resist (M. Born, E. Wolf, Principles
   of Optics, 1.5.2). The intensity is |E|^2: the sum over x, y and z, and over
   what is not coherent.

   So the light of a source point makes some incoherent images, called parts,
   each through the pupil times a real factor. A scalar image has one, whose
   factor is 1. */
#ifndef OPCFLOW_LITHO_VECTOR_H
#define OPCFLOW_LITHO_VECTOR_H

#include "optics.h"

enum { VECTOR_PARTS = 6 };

/* How many parts each source point has: 1 (scalar), 3 (a component each), 6
   (for two polarisations that are not coherent). [any] */
size_t vector_parts(const optics *o);

/* The factors of all parts of the source point `from` at the pupil's (x, y), of
   radius 1 at most. [any] */
void vector_factors(const optics *o, const double from[2], double x, double y,
                    double out[VECTOR_PARTS]);

/* Whether a part's factor changes its sign with y, for a source point on the x
   axis; else it stays. Not of polarisations x and y. [any] */
int vector_is_odd(const optics *o, size_t part);

/* What source points at `from` add to the clear field, not yet normalised: the
   sum of the squared factors of undiffracted light. [any] */
double vector_clear(const optics *o, const double from[2]);

/* Scale the weights of source points (x, y, weight) so that the clear field,
   averaged over the source as it is weighted, is 1. Those of scalar light stay
   as they are. [any] */
void vector_normalise(const optics *o, double *points, size_t n);

#endif
