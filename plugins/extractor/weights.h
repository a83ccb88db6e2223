/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of gamma, the weight of a slice (thesis eq. 3.2), by distance from the
   nearer active edge and width of the transistor, for each type and current.
   Interpolation is linear, extrapolation constant. */
#pragma once

#include <eda/curves.h>

/* value[i * edges + j] is gamma at width[i] and edge[j], nm; width and edge
   increase. If `widths` is 0, gamma is 1 everywhere. */
typedef struct grid {
  size_t widths, edges;
  double *width, *edge, *value;
} grid;

/* All tables. */
typedef struct weights {
  grid grid[2][EDA_CURRENTS]; /* [type][current] */
} weights;

/* Read a file with the columns type (n, p), current (ion, ioff), width (nm),
   edge (nm) and gamma. The rows of a type and current form a complete grid of
   widths and edges. Return OPC_OK or an error that names `parameter`. */
int weights_read(const char *path, const char *parameter, weights *out,
                 opc_error *error);
/* Free the tables. */
void weights_clear(weights *w);

/* Return gamma at a distance of `edge` nm from the edge of a transistor `width`
   nm wide. */
double grid_at(const grid *g, double edge, double width);
