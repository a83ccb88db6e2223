/* SPDX-License-Identifier: BSD-3-Clause */
/* Vector imaging: the field of polarised light in a lens.

   A thin mask (Kirchhoff) preserves polarisation, so an order enters the pupil
   with the polarisation of its source point, j = (jx, jy). Light from position
   p of the pupil, in direction (c, s), has the angle a over the wafer and b in
   the resist: sin(a) = NA |p| / index; sin(b) = NA |p| / resist_index. The lens
   rotates the component along (c, s) with the ray and preserves the component
   across it (M. Mansuripur, J. Opt. Soc. Am. A 6, 786, 1989; D. G. Flagello, T.
   Milster, A. E. Rosenbluth, J. Opt. Soc. Am. A 13, 53, 1996):

     E = O [ ts (-s, c, 0) (-s jx + c jy)
           + tp (c cos b, s cos b, -sin b) (c jx + s jy) ]

   O = sqrt(cos(o) / cos(a)), with sin(o) = NA |p| / 4 on the mask side,
   conserves the energy of a beam refracted by a lens of reduction 4 (D. C.
   Cole, E. Barouch, U. Hollerbach, S. A. Orszag, Jpn. J. Appl. Phys. 31, 4110,
   1992). ts and tp are Fresnel's amplitudes into the resist (M. Born, E. Wolf,
   Principles of Optics, 1.5.2). The intensity is |E|^2, summed over x, y and z
   and over incoherent polarisations.

   Hence the light of a source point forms several incoherent images, called
   parts, each through the pupil times a real factor. A scalar image has one
   part with the factor 1. */
#pragma once

#include "optics.h"

/* Largest number of parts into which polarised light is expanded. */
enum { VECTOR_PARTS = 6 };

/* Return the number of parts of each source point: 1 (scalar), 3 (one per
   component), 6 (two incoherent polarisations). [any] */
size_t vector_parts(const optics *o);

/* Compute the factors of all parts of the source point `from` at (x, y) of the
   pupil, radius at most 1. [any] */
void vector_factors(const optics *o, const double from[2], double x, double y,
                    double out[VECTOR_PARTS]);

/* Return 1 if the factor of a part is an odd function of y for a source point
   on the x axis; otherwise the factor is even. Not valid for polarisation along
   x or y. [any] */
int vector_is_odd(const optics *o, size_t part);

/* Return the contribution of a source point at `from` to the clear field before
   normalisation: the sum of the squared factors of undiffracted light. [any] */
double vector_clear(const optics *o, const double from[2]);

/* Scale the weights of source points (x, y, weight) so that the clear field,
   averaged over the weighted source, is 1. Weights for scalar light are
   unchanged. [any] */
void vector_normalise(const optics *o, double *points, size_t n);
