/* SPDX-License-Identifier: BSD-3-Clause */
/* Rasterisation of slanted edges. The contribution of a slanted edge to a
   sample is an integral over y of a B-spline of y times a smoothed step at the
   x of the edge. Between two grid lines the integrand is a polynomial of degree
   EDA_RASTER_DEGREE + (EDA_RASTER_DEGREE + 1). Gauss-Legendre quadrature with
   EDA_RASTER_DEGREE + 1 nodes integrates such a polynomial exactly. */
#include "imaging/raster.h"
#include "imaging/spline.h"

#include <math.h>

enum { GAUSS = 10, Y_TAPS = EDA_STEP_TAPS - 1 };
_Static_assert(GAUSS == EDA_RASTER_DEGREE + 1, "nodes that integrate exactly");

/* Positive Gauss-Legendre nodes on [-1, 1], and their weights. */
static const double node[GAUSS / 2] = {0.14887433898163122, 0.43339539412924719,
                                       0.67940956829902441, 0.86506336668898451,
                                       0.97390652851717172};
static const double gauss[GAUSS / 2] = {
    0.29552422471475287, 0.26926671930999636, 0.21908636251598204,
    0.14945134915058059, 0.06667134430868814};

/* Add a part of an edge at (x, y) to the raster. The raster stores differences
   in x and y (raster.h). dy is the weighted height of the part, positive for
   upward edges. */
static void edge_deposit(const eda_raster *r, double x, double y, double dy,
                         int low, int high) {
  int j = (int)floor(y) - EDA_RASTER_DEGREE / 2 + EDA_RASTER_MARGIN;
  if (j >= high || j + EDA_STEP_TAPS <= low) return;
  double wx[EDA_STEP_TAPS], wy[Y_TAPS], before = 0;
  int i = eda_spline_step(x, wx) + EDA_RASTER_MARGIN;
  eda_spline_smoothing(y, wy);
  for (int b = 0; b <= Y_TAPS; b++) {
    double now = b < Y_TAPS ? wy[b] : 0, w = (before - now) * dy;
    before = now;
    if (j + b < low || j + b >= high) continue;
    double *row = r->step + (size_t)(j + b) * r->columns + i;
    for (int a = 0; a < EDA_STEP_TAPS; a++) row[a] += w * wx[a];
  }
}

/* Return the fraction of an edge, 0 to 1, at which the edge crosses grid line
   n. */
static double grid_crossing(double from, double length, double n) {
  return (n - from) / length;
}

/* Return the next grid line in the direction of the edge. */
static double next_line(double from, double length) {
  return length > 0 ? floor(from) + 1 : ceil(from) - 1;
}

void eda_raster_slanted(const eda_raster *raster, double ax, double ay,
                        double bx, double by, int low, int high) {
  double dx = bx - ax, dy = by - ay;
  double nx = next_line(ax, dx), ny = next_line(ay, dy);
  for (double from = 0; from < 1;) {
    double tx = grid_crossing(ax, dx, nx), ty = grid_crossing(ay, dy, ny);
    double to = fmin(1, fmin(tx, ty));
    if (tx <= to) nx += dx > 0 ? 1 : -1;
    if (ty <= to) ny += dy > 0 ? 1 : -1;
    if (to <= from) continue;
    double half = (to - from) / 2;
    for (int g = 0; g < GAUSS; g++) {
      int k = g % (GAUSS / 2);
      double t = from + half * (1 + (g == k ? node[k] : -node[k]));
      edge_deposit(raster, ax + t * dx, ay + t * dy, gauss[k] * half * dy, low,
                   high);
    }
    from = to;
  }
}
