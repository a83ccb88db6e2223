/* SPDX-License-Identifier: BSD-3-Clause */
/* The scanner of the scalar imaging models. Frequencies are in units of the
   cutoff, and so are places in the source, as the pupil has the radius 1. */
#include "optics.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- parameters that do not fit together ---- */

/* Which sources each of their parameters belongs to. */
static const struct {
  int parameter;
  const char *name;
  unsigned sources, needed; /* bits 1 << OPTICS_CIRCULAR ... */
} uses[] = {
    {OPTICS_SIGMA, "sigma", ~(1u << OPTICS_LIST), 0},
    {OPTICS_SIGMA_IN, "sigma_in",
     1u << OPTICS_ANNULAR | 1u << OPTICS_DIPOLE | 1u << OPTICS_QUADRUPOLE |
         1u << OPTICS_QUASAR,
     ~0u},
    {OPTICS_OPENING, "opening", 1u << OPTICS_QUASAR, 0},
    {OPTICS_ROTATION, "rotation",
     1u << OPTICS_DIPOLE | 1u << OPTICS_QUADRUPOLE | 1u << OPTICS_QUASAR, 0},
    {OPTICS_POINTS, "points", 1u << OPTICS_LIST, ~0u},
};

static int check_uses(const opc_host *host, const opc_value *values,
                      opc_error *error) {
  const opc_value *source = &values[OPTICS_SOURCE];
  for (size_t i = 0; i < sizeof uses / sizeof uses[0]; i++) {
    const opc_value *v = &values[uses[i].parameter];
    int used = uses[i].sources >> source->integer & 1;
    if (!used && v->type != OPC_ABSENT && v->given) {
      host->fail(host, error, OPC_INVALID, uses[i].name,
                 "'%s' means nothing for a source '%s'", uses[i].name,
                 source->text);
      return 0;
    }
    if (used && v->type == OPC_ABSENT && uses[i].needed) {
      host->fail(host, error, OPC_INVALID, uses[i].name,
                 "'%s' is needed for a source '%s'", uses[i].name,
                 source->text);
      return 0;
    }
  }
  return 1;
}

static int check_points(const opc_host *host, const opc_value *v,
                        opc_error *error) {
  double sum = 0;
  if (!v->count || v->count % 3) {
    host->fail(host, error, OPC_INVALID, "points",
               "'points' needs x, y and weight of each point, not %zu numbers",
               v->count);
    return 0;
  }
  for (size_t i = 0; i < v->count; i += 3) {
    const double *p = v->reals + i;
    if (!(hypot(p[0], p[1]) <= 1)) {
      host->fail(host, error, OPC_INVALID, "points",
                 "'points': (%g, %g) lies outside the pupil, whose radius is 1",
                 p[0], p[1]);
      return 0;
    }
    if (!(p[2] >= 0)) {
      host->fail(host, error, OPC_INVALID, "points",
                 "'points': (%g, %g) has the weight %g", p[0], p[1], p[2]);
      return 0;
    }
    sum += p[2];
  }
  if (sum > 0 && isfinite(sum)) return 1;
  host->fail(host, error, OPC_INVALID, "points",
             "'points' have weights that sum to %g", sum);
  return 0;
}

static int check(const opc_host *host, const opc_value *values, const optics *o,
                 opc_error *error) {
  if (o->na > o->index) {
    host->fail(host, error, OPC_INVALID, "na",
               "'na' of %g is above the index of the medium, %g", o->na,
               o->index);
    return 0;
  }
  if (!check_uses(host, values, error)) return 0;
  if (o->source == OPTICS_LIST)
    if (!check_points(host, &values[OPTICS_POINTS], error)) return 0;
  if (o->source != OPTICS_LIST && o->source != OPTICS_CIRCULAR &&
      o->sigma_in >= o->sigma) {
    host->fail(host, error, OPC_INVALID, "sigma_in",
               "'sigma_in' of %g is not below sigma, %g", o->sigma_in,
               o->sigma);
    return 0;
  }
  const opc_value *z = &values[OPTICS_ZERNIKE];
  if (z->type != OPC_ABSENT && (!z->count || z->count > OPTICS_TERMS)) {
    host->fail(host, error, OPC_INVALID, "zernike",
               "'zernike' has %zu terms, not 1 to %d", z->count, OPTICS_TERMS);
    return 0;
  }
  return 1;
}

/* ---- values ---- */

/* The amplitude of what passes `transmission` % of the light. */
static void amplitude(double transmission, double phase, double out[2]) {
  double a = sqrt(transmission / 100);
  /* Half turns are exact: such a mask is real. */
  double turn = remainder(phase, 360);
  out[0] = a * (fabs(turn) == 180 ? -1 : cos(turn * M_PI / 180));
  out[1] = fabs(turn) == 180 || turn == 0 ? 0 : a * sin(turn * M_PI / 180);
}

static void read_mask(const opc_value *tone, const opc_value *transmission,
                      const opc_value *phase, double background[2],
                      double feature[2]) {
  int dark_field = tone->integer == 1;
  double *clear = dark_field ? feature : background;
  clear[0] = 1;
  clear[1] = 0;
  amplitude(transmission->real, phase->real, dark_field ? background : feature);
}

int optics_create(const opc_host *host, const opc_value *values, optics *out,
                  opc_error *error) {
  const opc_value *v = values;
  *out = (optics){
      .wavelength = v[OPTICS_WAVELENGTH].real,
      .na = v[OPTICS_NA].real,
      .index = v[OPTICS_INDEX].real,
      .cutoff = v[OPTICS_NA].real / v[OPTICS_WAVELENGTH].real,
      .source = (int)v[OPTICS_SOURCE].integer,
      .sigma = v[OPTICS_SIGMA].real,
      .opening = v[OPTICS_OPENING].real,
      .rotation = v[OPTICS_ROTATION].real,
      .defocus = v[OPTICS_DEFOCUS].real,
  };
  if (v[OPTICS_SIGMA_IN].type != OPC_ABSENT)
    out->sigma_in = v[OPTICS_SIGMA_IN].real;
  if (v[OPTICS_POINTS].type != OPC_ABSENT) {
    out->points = v[OPTICS_POINTS].reals;
    out->n_points = v[OPTICS_POINTS].count / 3;
  }
  if (v[OPTICS_ZERNIKE].type != OPC_ABSENT) {
    out->zernike = v[OPTICS_ZERNIKE].reals;
    out->n_zernike = v[OPTICS_ZERNIKE].count;
  }
  read_mask(&v[OPTICS_POLY_TONE], &v[OPTICS_POLY_TRANSMISSION],
            &v[OPTICS_POLY_PHASE], out->background[0], out->feature[0]);
  read_mask(&v[OPTICS_ACTIVE_TONE], &v[OPTICS_ACTIVE_TRANSMISSION],
            &v[OPTICS_ACTIVE_PHASE], out->background[1], out->feature[1]);
  return check(host, values, out, error);
}

/* ---- the source ---- */

/* How deep (x, y) lies within the source: the distance from its border, or
   something nearer to zero of the same sign. */
static double depth(const optics *o, double x, double y) {
  double r = hypot(x, y);
  if (o->source == OPTICS_CIRCULAR) return o->sigma - r;
  double ring = fmin(o->sigma - r, r - o->sigma_in);
  if (o->source == OPTICS_ANNULAR) return ring;
  double turn = o->rotation * M_PI / 180;
  double u = x * cos(turn) + y * sin(turn), v = y * cos(turn) - x * sin(turn);
  /* The pole on the positive u axis stands for all. */
  if (o->source != OPTICS_DIPOLE && fabs(v) > fabs(u)) {
    double t = u;
    u = v;
    v = t;
  }
  u = fabs(u);
  if (o->source == OPTICS_QUASAR) {
    if (o->opening >= 90) return ring;
    double half = o->opening * M_PI / 360;
    return fmin(ring, u * sin(half) - fabs(v) * cos(half));
  }
  double radius = (o->sigma - o->sigma_in) / 2;
  return radius - hypot(u - (o->sigma + o->sigma_in) / 2, v);
}

/* Area and centroid of the part of a cell that lies within the source. */
static double covered(const optics *o, double x, double y, double side,
                      double *cx, double *cy) {
  enum { PARTS = 16 };
  double d = depth(o, x, y), reach = side * M_SQRT1_2, sum = 0;
  *cx = x;
  *cy = y;
  if (d >= reach) return side * side;
  if (d <= -reach) return 0;
  double part = side / PARTS, sx = 0, sy = 0;
  for (int j = 0; j < PARTS; j++)
    for (int i = 0; i < PARTS; i++) {
      double px = x - side / 2 + (i + 0.5) * part;
      double py = y - side / 2 + (j + 0.5) * part;
      double in = fmin(fmax(depth(o, px, py) / part + 0.5, 0), 1);
      sum += in;
      sx += in * px;
      sy += in * py;
    }
  if (sum <= 0) return 0;
  *cx = sx / sum;
  *cy = sy / sum;
  return sum * part * part;
}

static double *listed_points(const optics *o, size_t *n) {
  double *p = malloc(o->n_points * 3 * sizeof *p), sum = 0;
  *n = p ? o->n_points : 0;
  for (size_t i = 0; i < o->n_points; i++) sum += o->points[3 * i + 2];
  for (size_t i = 0; i < *n; i++) {
    p[3 * i] = o->points[3 * i];
    p[3 * i + 1] = o->points[3 * i + 1];
    p[3 * i + 2] = o->points[3 * i + 2] / sum;
  }
  return p;
}

double *optics_source_points(const optics *o, double spacing, size_t *n) {
  static const double most = 2048; /* cells from the middle to the rim */
  *n = 0;
  if (o->source == OPTICS_LIST) return listed_points(o, n);
  double radius = optics_source_radius(o);
  if (!(spacing > 0 && radius / spacing < most)) return NULL;
  int half = (int)ceil(radius / spacing);
  double *p = malloc((size_t)half * (size_t)half * 12 * sizeof *p), sum = 0;
  if (!p) return NULL;
  for (int j = -half; j < half; j++)
    for (int i = -half; i < half; i++) {
      double *to = p + 3 * *n;
      to[2] = covered(o, (i + 0.5) * spacing, (j + 0.5) * spacing, spacing,
                      &to[0], &to[1]);
      /* A centroid of border parts may be a hair outside. */
      double over = hypot(to[0], to[1]) / radius;
      if (over > 1) {
        to[0] /= over;
        to[1] /= over;
      }
      sum += to[2];
      *n += to[2] > 0;
    }
  for (size_t i = 0; i < *n; i++) p[3 * i + 2] /= sum;
  return p;
}

double optics_source_radius(const optics *o) {
  double radius = 0;
  if (o->source != OPTICS_LIST) return o->sigma;
  for (size_t i = 0; i < o->n_points; i++)
    radius = fmax(radius, hypot(o->points[3 * i], o->points[3 * i + 1]));
  return radius;
}

/* ---- the pupil ---- */

/* Fringe order: group g holds the angular orders m = g .. 0, cosine before
   sine, of the degree 2 g - m; Z37 is the first of group 6 there is. */
static void find_term(size_t index, int *group, int *m, int *sine) {
  if (index == OPTICS_TERMS - 1) {
    *group = 6;
    *m = *sine = 0;
    return;
  }
  int g = 0, i = (int)index;
  while ((g + 1) * (g + 1) <= i) g++;
  i -= g * g;
  *group = g;
  *m = g - i / 2;
  *sine = i % 2;
}

/* The radial polynomial over r^m, at r^2. */
static double radial(int group, int m, double r2) {
  static const double factorial[] = {1,       1,        2,        6,     24,
                                     120,     720,      5040,     40320, 362880,
                                     3628800, 39916800, 479001600};
  double sum = 0;
  for (int k = 0; k <= group - m; k++)
    sum = sum * r2 +
          (k % 2 ? -1 : 1) * factorial[2 * group - m - k] /
              (factorial[k] * factorial[group - k] * factorial[group - m - k]);
  return sum;
}

/* Waves. */
static double aberration(const optics *o, double x, double y) {
  double r2 = x * x + y * y, sum = 0;
  for (size_t i = 0; i < o->n_zernike; i++) {
    if (o->zernike[i] == 0) continue;
    int group, m, sine;
    find_term(i, &group, &m, &sine);
    double re = 1, im = 0; /* r^m exp(i m angle) */
    for (int k = 0; k < m; k++) {
      double t = re * x - im * y;
      im = re * y + im * x;
      re = t;
    }
    sum += o->zernike[i] * (sine ? im : re) * radial(group, m, r2);
  }
  return sum;
}

void optics_pupil(const optics *o, double defocus, double fx, double fy,
                  double *re, double *im) {
  double r2 = fx * fx + fy * fy, dz = o->defocus + defocus;
  *re = r2 <= 1;
  *im = 0;
  if (r2 > 1) return;
  double waves = 0;
  if (dz != 0) {
    double sine = o->na / o->index;
    waves = o->index * dz / o->wavelength *
            (sqrt(fmax(0, 1 - sine * sine * r2)) - 1);
  }
  if (o->n_zernike) waves += aberration(o, fx, fy);
  if (waves == 0) return;
  *re = cos(2 * M_PI * waves);
  *im = sin(2 * M_PI * waves);
}

int optics_is_radial(const optics *o) {
  if (o->source != OPTICS_CIRCULAR && o->source != OPTICS_ANNULAR) return 0;
  for (size_t i = 0; i < o->n_zernike; i++) {
    int group, m, sine;
    find_term(i, &group, &m, &sine);
    if (m && o->zernike[i] != 0) return 0;
  }
  return 1;
}

int optics_is_real(const optics *o) {
  if (o->defocus != 0) return 0;
  for (size_t i = 0; i < o->n_zernike; i++)
    if (o->zernike[i] != 0) return 0;
  return 1;
}

/* ---- the mask ---- */

int optics_real_mask(const optics *o, int layer) {
  return o->background[layer][1] == 0 && o->feature[layer][1] == 0;
}

void optics_amplitudes(const optics *o, int layer, double a[2], double b[2]) {
  for (int i = 0; i < 2; i++) {
    a[i] = o->feature[layer][i];
    b[i] = o->background[layer][i] - o->feature[layer][i];
  }
}
