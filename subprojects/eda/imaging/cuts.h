/* SPDX-License-Identifier: BSD-3-Clause */
/* Simultaneous cuts through a printed line: the cells of all cuts are tested
   together, vectorised. For regular cuts only; others use the searches of
   edge.h. */
#pragma once

#include <eda/imaging.h>

/* Compute cuts parallel to an axis, at at[0 .. n - 1] across the axis.
   distance[j] receives the distances from `middle` to the first sign changes,
   nm, towards smaller and larger coordinates. Both are NAN for irregular cuts:
   the field is not positive at the middle, changes its sign again within `half`
   of the middle, or has no change up to about two cells beyond. */
void eda_cut_many(const eda_field *field, int axis, double middle, double half,
                  size_t n, const double *at, double (*distance)[2]);
