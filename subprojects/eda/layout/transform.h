/* SPDX-License-Identifier: BSD-3-Clause */
/* Geometric transforms of placements. */
#pragma once

#include <eda/layout.h>
#include <glib.h>
#include <math.h>

/* (x, y) -> (xx x + xy y + dx, yx x + yy y + dy). For rotations by right angles
   and magnification 1, all numbers are integers far below 2^53, so results are
   exact. */
typedef struct transform {
  double xx, xy, yx, yy, dx, dy;
} transform;

/* Compute cosine and sine of `angle` (degrees). The result is exact within 1e-9
   degrees of a right angle. */
static inline void rotation_of(double angle, double *cosine, double *sine) {
  static const double right[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  double quarters = nearbyint(angle / 90);
  if (fabs(angle - 90 * quarters) < 1e-9) {
    int q = ((int)fmod(quarters, 4) + 4) % 4;
    *cosine = right[q][0];
    *sine = right[q][1];
  } else {
    double radians = fmod(angle, 360) * (G_PI / 180);
    *cosine = cos(radians);
    *sine = sin(radians);
  }
}

/* Return the transform of a placement without its translation. */
static inline transform transform_of(const eda_placement *p) {
  double c, s, flip = p->mirror ? -1 : 1;
  rotation_of(p->angle, &c, &s);
  c *= p->magnification;
  s *= p->magnification;
  return (transform){c, -s * flip, s, c * flip, 0, 0};
}

/* Return the transform that applies `in`, translates by (x, y), then applies
   `out`. */
static inline transform transform_compose(const transform *out,
                                          const transform *in, double x,
                                          double y) {
  return (transform){
      out->xx * in->xx + out->xy * in->yx, out->xx * in->xy + out->xy * in->yy,
      out->yx * in->xx + out->yy * in->yx, out->yx * in->xy + out->yy * in->yy,
      out->xx * x + out->xy * y + out->dx, out->yx * x + out->yy * y + out->dy};
}
