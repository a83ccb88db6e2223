/* SPDX-License-Identifier: BSD-3-Clause */
/* Many cuts at once through what prints as a line: the cells of all of them are
   looked at together, in vectors. For the cuts that are as they should be; the
   others are left to the walks of edge.h. */
#ifndef EDA_CUTS_H
#define EDA_CUTS_H

#include <eda/imaging.h>

/* Cuts parallel to an axis, at at[0 .. n - 1] across it. distance[j] gets how
   far from `middle` the sign first changes, nm, towards smaller and larger
   coordinates. NAN, both, where this is not all there is to say: the field is
   not positive at the middle, changes its sign again within `half` of it, or
   has no change within about two cells more. */
void eda_cut_many(const eda_field *field, int axis, double middle, double half,
                  size_t n, const double *at, double (*distance)[2]);

#endif
