/* SPDX-License-Identifier: BSD-3-Clause */
/* gamma of thesis eq. 3.2 as a table: against the distance from the nearer
   active edge and the width of the transistor, for each type and current.
   Linear between its points, constant beyond them. */
#ifndef OPCFLOW_EXTRACTOR_WEIGHTS_H
#define OPCFLOW_EXTRACTOR_WEIGHTS_H

#include <eda/curves.h>

/* value[i * edges + j] at width[i] and edge[j], nm, both increasing. Without
   widths: 1 everywhere. */
typedef struct grid {
  size_t widths, edges;
  double *width, *edge, *value;
} grid;

typedef struct weights {
  grid grid[2][EDA_CURRENTS]; /* [type][current] */
} weights;

/* Read a file with the columns type (n, p), current (ion, ioff), width (nm),
   edge (nm) and gamma. Of each type and current it has all widths with all
   edges, or nothing. */
int weights_read(const char *path, const char *parameter, weights *out,
                 opc_error *error);
void weights_clear(weights *w);

double grid_at(const grid *g, double edge, double width);

#endif
