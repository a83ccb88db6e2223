/* SPDX-License-Identifier: BSD-3-Clause */
/* Contribution of the active edges to the current of a slice (thesis 3.2.1),
   for a device table of several widths. The current of a rectangle of width W
   and length L is W j(L) plus an edge current, with j(L) the current per width
   of a wide transistor. The edge current makes the sum equal to the table's
   current. The edge current per width decays exponentially with the distance
   from each edge and depends on the local length. */
#pragma once

#include <eda/curves.h>

/* Edge currents of a transistor, one for each of Ion and Ioff. */
typedef struct edges {
  eda_curves_width width;
  double decay[EDA_CURRENTS]; /* decay length, nm */
  double most[EDA_CURRENTS];  /* share at the edge; the mean over W is 1 */
} edges;

/* Return the edge currents of a transistor `width` nm wide. `reach`: decay
   length, nm; a longer decay length is used if a slice would otherwise have a
   negative current. */
static inline edges edges_of(const eda_curves *c, int type, double width,
                             double reach) {
  edges e = {.width = eda_curves_among(c, width)};
  if (!(width > 0)) e.width.is_wide = 1;
  for (int k = 0; k < EDA_CURRENTS && !e.width.is_wide; k++) {
    double least = eda_curves_least_share(c, type, k, &e.width);
    /* This bound keeps 1 - (1 - least) * most above 0. */
    e.decay[k] = fmax(reach, 2 * (1 - least) * width / least);
    double u = width / (2 * e.decay[k]);
    e.most[k] = u / -expm1(-u);
  }
  return e;
}

/* Return the share: the edge current per width at a distance of `edge` nm from
   the nearer edge, divided by the mean over the width. */
static inline double edges_share(const edges *e, int k, double edge) {
  return e->most[k] * exp(-edge / e->decay[k]);
}
