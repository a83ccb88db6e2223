/* SPDX-License-Identifier: BSD-3-Clause */
/* Simultaneous, vectorised cuts through a printed line. Only regular cuts are
   computed; for other cuts use the searches of edge.h. */
#pragma once

#include <eda/imaging.h>

/* Compute n cuts parallel to an axis (EDA_X, EDA_Y), at positions at[0 .. n -
   1] across the axis, nm. Write the distances (nm) from `middle` to the first
   sign change towards smaller and larger coordinates to distance[j]. Write NAN
   for an irregular cut. A cut is irregular if the field is not positive at the
   middle, changes its sign again within `half` of the middle, or does not
   change its sign. The search ends about two cells beyond `half`. */
void eda_cut_many(const eda_field *field, int axis, double middle, double half,
                  size_t n, const double *at, double (*distance)[2]);
