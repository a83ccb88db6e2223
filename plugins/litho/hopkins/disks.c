/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the common area of three disks as an integral along the arcs of
   its border. */
#include "disks.h"

#include <math.h>

typedef struct disk {
  double x, y, r;
} disk;

enum { APART = -1, CUT = 0, WHOLE = 1, NOWHERE = 2 };

/* Find the part of the circle of disk a that is inside disk b. Return CUT for
   an arc with centre *middle and half angle *half, WHOLE for the entire circle,
   NOWHERE for no part, APART if the disks do not overlap. For two equal
   circles, only the circle with `first` is WHOLE. */
static int disk_cut(disk a, disk b, int first, double *middle, double *half) {
  double dx = b.x - a.x, dy = b.y - a.y, d = sqrt(dx * dx + dy * dy);
  if (d >= a.r + b.r) return APART;
  if (d < 1e-14 && fabs(a.r - b.r) < 1e-14) return first ? WHOLE : NOWHERE;
  if (d <= b.r - a.r) return WHOLE;
  if (d <= a.r - b.r) return NOWHERE;
  *middle = atan2(dy, dx);
  /* Rounding can exceed -1 .. 1 where circles touch. */
  double c = (d * d + a.r * a.r - b.r * b.r) / (2 * d * a.r);
  *half = acos(fmin(fmax(c, -1), 1));
  return CUT;
}

/* Return half the integral of x dy - y dx along an arc. */
static double arc_area(disk a, double from, double to) {
  return 0.5 * a.r *
         (a.r * (to - from) + a.x * (sin(to) - sin(from)) -
          a.y * (cos(to) - cos(from)));
}

double opc_common_area(double sigma, double r1, double r2, double angle) {
  const disk d[3] = {
      {0, 0, sigma}, {r1, 0, 1}, {r2 * cos(angle), r2 * sin(angle), 1}};
  double area = 0;
  for (int i = 0; i < 3; i++) {
    double middle[2], half[2];
    int cuts = 0, none = 0;
    for (int j = 0; j < 3; j++) {
      if (j == i) continue;
      int part = disk_cut(d[i], d[j], i < j, &middle[cuts], &half[cuts]);
      if (part == APART) return 0;
      none |= part == NOWHERE;
      cuts += part == CUT;
    }
    if (none) continue;
    if (cuts == 0) {
      area += arc_area(d[i], 0, 2 * M_PI);
    } else if (cuts == 1) {
      area += arc_area(d[i], middle[0] - half[0], middle[0] + half[0]);
    } else {
      for (int turn = -1; turn <= 1; turn++) {
        double shifted = middle[1] + 2 * M_PI * turn;
        double from = fmax(middle[0] - half[0], shifted - half[1]);
        double to = fmin(middle[0] + half[0], shifted + half[1]);
        if (to > from) area += arc_area(d[i], from, to);
      }
    }
  }
  return area;
}
