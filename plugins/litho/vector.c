/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the field of polarised light behind a lens and in the resist. */
#include "vector.h"

#include <math.h>

/* Reduction of the lens, which is the same in all scanners since 1990. */
static const double reduction = 4;

enum { X, Y, Z, AXES };

size_t vector_parts(const optics *o) {
  switch (o->polarisation) {
    case OPTICS_SCALAR:
      return 1;
    case OPTICS_UNPOLARISED:
      return VECTOR_PARTS;
    default:
      return AXES;
  }
}

/* Find the polarisations of a source point, and return their number. The centre
   of the source has no direction and counts as a point on the x axis. */
static size_t find_states(const optics *o, const double from[2],
                          double j[2][2]) {
  double r = hypot(from[0], from[1]);
  double c = r > 0 ? from[0] / r : 1, s = r > 0 ? from[1] / r : 0;
  const double states[][2] = {[OPTICS_POLARISED_X] = {1, 0},
                              [OPTICS_POLARISED_Y] = {0, 1},
                              [OPTICS_TANGENTIAL] = {-s, c},
                              [OPTICS_RADIAL] = {c, s}};
  int both = o->polarisation == OPTICS_UNPOLARISED;
  const double *first = states[both ? OPTICS_POLARISED_X : o->polarisation];
  for (int i = 0; i < 2; i++) {
    j[0][i] = first[i] * (both ? M_SQRT1_2 : 1);
    j[1][i] = states[OPTICS_POLARISED_Y][i] * M_SQRT1_2;
  }
  return both ? 2 : 1;
}

/* Return the cosine of a ray from its sine. */
static double cosine(double sine) { return sqrt(fmax(0, 1 - sine * sine)); }

void vector_factors(const optics *o, const double from[2], double x, double y,
                    double out[VECTOR_PARTS]) {
  if (o->polarisation == OPTICS_SCALAR) {
    out[0] = 1;
    return;
  }
  double r = hypot(x, y), c = r > 0 ? x / r : 1, s = r > 0 ? y / r : 0;
  double sine = o->na * r, above = o->index, below = o->resist_index;
  double a = cosine(sine / above), b = cosine(sine / below);
  double lens = sqrt(cosine(sine / reduction) / a), j[2][2];
  double across = lens * 2 * above * a / (above * a + below * b);
  double along = lens * 2 * above * a / (below * a + above * b);
  size_t states = find_states(o, from, j);
  for (size_t i = 0; i < states; i++) {
    double te = across * (c * j[i][1] - s * j[i][0]);
    double tm = along * (c * j[i][0] + s * j[i][1]);
    double *e = out + AXES * i;
    e[X] = -s * te + c * b * tm;
    e[Y] = c * te + s * b * tm;
    e[Z] = -sine / below * tm;
  }
}

int vector_is_odd(const optics *o, size_t part) {
  int along_y = o->polarisation == OPTICS_TANGENTIAL || part / AXES;
  return (part % AXES == Y) != along_y;
}

double vector_clear(const optics *o, const double from[2]) {
  double factor[VECTOR_PARTS], sum = 0;
  vector_factors(o, from, from[0], from[1], factor);
  for (size_t i = 0; i < vector_parts(o); i++) sum += factor[i] * factor[i];
  return sum;
}

void vector_normalise(const optics *o, double *points, size_t n) {
  if (o->polarisation == OPTICS_SCALAR) return;
  double sum = 0;
  for (size_t i = 0; i < n; i++)
    sum += points[3 * i + 2] * vector_clear(o, points + 3 * i);
  for (size_t i = 0; i < n; i++) points[3 * i + 2] /= sum;
}
