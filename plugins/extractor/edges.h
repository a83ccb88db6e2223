/* SPDX-License-Identifier: BSD-3-Clause */
/* What the edges of the active add to, or take from, the current of a slice
   (thesis 3.2.1, after a table of several widths): a rectangle of width W has
   that of a wide transistor, W j(L), and that of its two edges, which is what
   the table's current of W has more or less. It falls off from the edges with
   `decay`, so that it goes by the lengths that the gate has there. */
#ifndef OPCFLOW_EXTRACTOR_EDGES_H
#define OPCFLOW_EXTRACTOR_EDGES_H

#include <eda/curves.h>

typedef struct edges {
  eda_curves_width width;
  double decay[EDA_CURRENTS]; /* nm */
  double most[EDA_CURRENTS];  /* share at the edge; over the width it is 1 */
} edges;

/* Of a transistor of that type and width, nm. `reach`: the decay, nm, where
   that leaves every slice a current above 0; farther where the edges take more
   than lies within it. */
static inline edges edges_of(const eda_curves *c, int type, double width,
                             double reach) {
  edges e = {.width = eda_curves_among(c, width)};
  if (!(width > 0)) e.width.is_wide = 1;
  for (int k = 0; k < EDA_CURRENTS && !e.width.is_wide; k++) {
    double least = eda_curves_least_share(c, type, k, &e.width);
    /* 1 - (1 - least) most > 0 for any least. */
    e.decay[k] = fmax(reach, 2 * (1 - least) * width / least);
    double u = width / (2 * e.decay[k]);
    e.most[k] = u / -expm1(-u);
  }
  return e;
}

/* How much of the edges' current a slice at `edge` nm from the nearer one has,
   over the mean of all. */
static inline double edges_share(const edges *e, int k, double edge) {
  return e->most[k] * exp(-edge / e->decay[k]);
}

#endif
