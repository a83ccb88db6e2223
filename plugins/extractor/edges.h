/* SPDX-License-Identifier: BSD-3-Clause */
/* Contribution of the active edges to the current of a slice (thesis 3.2.1,
   with a device table of several widths). A rectangle of width W has the
   current of a wide transistor, W j(L), plus an edge current, the difference to
   the table's current at W. The edge current decays with `decay` from the edges
   and depends on the local gate length. */
#pragma once

#include <eda/curves.h>

typedef struct edges {
  eda_curves_width width;
  double decay[EDA_CURRENTS]; /* nm */
  double most[EDA_CURRENTS];  /* share at the edge; its mean over the width is
                                 1 */
} edges;

/* Return the edge currents of a transistor of that type and width, nm. The
   decay is `reach`, nm, or longer if that is necessary for a positive current
   of every slice. */
static inline edges edges_of(const eda_curves *c, int type, double width,
                             double reach) {
  edges e = {.width = eda_curves_among(c, width)};
  if (!(width > 0)) e.width.is_wide = 1;
  for (int k = 0; k < EDA_CURRENTS && !e.width.is_wide; k++) {
    double least = eda_curves_least_share(c, type, k, &e.width);
    /* Implies 1 - (1 - least) most > 0. */
    e.decay[k] = fmax(reach, 2 * (1 - least) * width / least);
    double u = width / (2 * e.decay[k]);
    e.most[k] = u / -expm1(-u);
  }
  return e;
}

/* Return the share of the edge current of a slice at `edge` nm from the nearer
   edge, relative to the mean. */
static inline double edges_share(const edges *e, int k, double edge) {
  return e->most[k] * exp(-edge / e->decay[k]);
}
