/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the scanner of the imaging models. Frequencies and positions in
   the source are in units of the cutoff, so that the pupil has the radius 1. */
#include "optics.h"

#include <eda/gates.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- parameters that do not fit together ---- */

static const char *const sources[] = {"circular",   "annular", "dipole",
                                      "quadrupole", "quasar",  "points"};

/* For each parameter, the sources that use it. */
static const struct {
  const char *name;
  unsigned sources; /* set of bits 1 << OPTICS_CIRCULAR ... */
  int needed;
} uses[OPTICS_USES] = {
    [OPTICS_SIGMA] = {"sigma", ~(1u << OPTICS_LIST), 0},
    [OPTICS_SIGMA_IN] = {"sigma_in",
                         1u << OPTICS_ANNULAR | 1u << OPTICS_DIPOLE |
                             1u << OPTICS_QUADRUPOLE | 1u << OPTICS_QUASAR,
                         1},
    [OPTICS_OPENING] = {"opening", 1u << OPTICS_QUASAR, 0},
    [OPTICS_ROTATION] = {"rotation",
                         1u << OPTICS_DIPOLE | 1u << OPTICS_QUADRUPOLE |
                             1u << OPTICS_QUASAR,
                         0},
    [OPTICS_POINTS] = {"points", 1u << OPTICS_LIST, 1},
};

static int check_uses(const optics *o, opc_error *error) {
  for (size_t i = 0; i < OPTICS_USES; i++) {
    int used = uses[i].sources >> o->source & 1;
    if (!used && o->given[i])
      return opc_fail(error, OPC_INVALID, uses[i].name,
                      "'%s' has no effect for a source '%s'", uses[i].name,
                      sources[o->source]);
    if (used && uses[i].needed && !o->given[i])
      return opc_fail(error, OPC_INVALID, uses[i].name,
                      "'%s' is required for a source '%s'", uses[i].name,
                      sources[o->source]);
  }
  return OPC_OK;
}

static int check_points(const opc_reals *v, opc_error *error) {
  double sum = 0;
  if (!v->count || v->count % 3)
    return opc_fail(
        error, OPC_INVALID, "points",
        "'points' has %zu numbers, expected x, y and weight of each point",
        v->count);
  for (size_t i = 0; i < v->count; i += 3) {
    const double *p = v->values + i;
    if (!(hypot(p[0], p[1]) <= 1))
      return opc_fail(
          error, OPC_INVALID, "points",
          "'points': (%g, %g) is outside the pupil, whose radius is 1", p[0],
          p[1]);
    if (!(p[2] >= 0))
      return opc_fail(
          error, OPC_INVALID, "points",
          "'points': (%g, %g) has the weight %g, expected at least 0", p[0],
          p[1], p[2]);
    sum += p[2];
  }
  if (sum > 0 && isfinite(sum)) return OPC_OK;
  return opc_fail(
      error, OPC_INVALID, "points",
      "the weights of 'points' sum to %g, expected a positive finite number",
      sum);
}

/* Compute the amplitude, real and imaginary, for an intensity transmission in
   percent and a phase in degrees. */
static void mask_amplitude(double transmission, double phase, double out[2]) {
  double a = sqrt(transmission / 100);
  /* Compute phases of 0 and 180 degrees exactly, so that these masks are
     real. */
  double turn = remainder(phase, 360);
  out[0] = a * (fabs(turn) == 180 ? -1 : cos(turn * M_PI / 180));
  out[1] = fabs(turn) == 180 || turn == 0 ? 0 : a * sin(turn * M_PI / 180);
}

/* Limits of wavelength / NA, nm. All lengths of an image scale with wavelength
   / NA. The range includes extreme ultraviolet (6.7 nm, NA 0.56) and the g line
   (436 nm, NA 0.11). At both limits, the choice of kernels or the calibration
   of a resist takes about ten seconds; a factor of 2 beyond a limit, both take
   four times as long. */
static const double least_unit = 12, most_unit = 4000;

/* Largest |Zernike coefficient|, waves. Good lenses are below 0.05. Beyond the
   limit, the phase varies too fast for the nodes of the kernels. */
static const double most_waves = 10;

/* Check wavelength / NA, the unit of lengths. The message states the sizes of
   two images. The largest pattern for kernels has 4 x 8 units on a grid of 32
   nm. A line for the calibration of a resist has 4 um x 4 um with six samples
   per unit. */
static int check_unit(const optics *o, opc_error *error) {
  double unit = o->wavelength / o->na;
  if (unit >= least_unit && unit <= most_unit) return OPC_OK;
  double points =
      unit > most_unit ? 32 * pow(unit / 32, 2) : pow(4000 * 6 / unit, 2);
  return opc_fail(error, OPC_INVALID, unit > most_unit ? "na" : "wavelength",
                  "wavelength / na, the unit of an image's lengths, is %.3g "
                  "um, expected %g nm to %g um: models would need images of "
                  "%.2g points, %.2g GB for each of about 40 kernels",
                  unit * 1e-3, least_unit, most_unit * 1e-3, points,
                  points * 8e-9);
}

static int check_zernike(const optics *o, opc_error *error) {
  size_t terms = o->zernike.count;
  if (o->zernike_given && (!terms || terms > OPTICS_TERMS))
    return opc_fail(error, OPC_INVALID, "zernike",
                    "'zernike' has %zu terms, expected 1 to %d", terms,
                    OPTICS_TERMS);
  for (size_t i = 0; i < terms; i++)
    if (!(fabs(o->zernike.values[i]) <= most_waves))
      return opc_fail(error, OPC_INVALID, "zernike",
                      "'zernike': term %zu is %g waves, more than %g", i + 1,
                      o->zernike.values[i], most_waves);
  return OPC_OK;
}

/* Check NA and indices for polarised light, because a ray along a surface has
   no finite field. */
static int check_polarisation(const optics *o, opc_error *error) {
  if (o->polarisation == OPTICS_SCALAR)
    return o->resist_index_given ? opc_fail(error, OPC_INVALID, "resist_index",
                                            "'resist_index' has no effect for "
                                            "a 'polarisation' of 'scalar'")
                                 : OPC_OK;
  if (o->na >= o->index)
    return opc_fail(error, OPC_INVALID, "na",
                    "'na' of %g is not below the index of the medium, %g, as "
                    "required for polarised light",
                    o->na, o->index);
  if (o->na >= o->resist_index)
    return opc_fail(error, OPC_INVALID, "resist_index",
                    "'resist_index' of %g is not above the NA, %g",
                    o->resist_index, o->na);
  return OPC_OK;
}

int optics_check(optics *o, opc_error *error) {
  o->cutoff = o->na / o->wavelength;
  for (int i = 0; i < 2; i++) {
    int dark = o->mask[i].dark;
    double *clear = dark ? o->feature[i] : o->background[i];
    clear[0] = 1;
    clear[1] = 0;
    mask_amplitude(o->mask[i].transmission, o->mask[i].phase,
                   dark ? o->background[i] : o->feature[i]);
  }
  if (o->na > o->index)
    return opc_fail(error, OPC_INVALID, "na",
                    "'na' of %g is above the index of the medium, %g", o->na,
                    o->index);
  int code = check_polarisation(o, error);
  if (!code) code = check_unit(o, error);
  if (!code) code = check_uses(o, error);
  if (!code && o->source == OPTICS_LIST) code = check_points(&o->points, error);
  if (code) return code;
  if (o->given[OPTICS_SIGMA_IN] && o->sigma_in >= o->sigma)
    return opc_fail(error, OPC_INVALID, "sigma_in",
                    "'sigma_in' of %g is not below sigma, %g", o->sigma_in,
                    o->sigma);
  return check_zernike(o, error);
}

/* Largest NA for a scalar image without a warning. At this NA, two orders of
   the densest line cross at 2 asin(0.45 / 1.7) in a resist of index 1.7. The
   contrast is 0.86 for light polarised in the plane of the orders and 0.93 for
   unpolarised light. At NA 0.6, the contrast for unpolarised light is 0.97. */
static const double most_scalar = 0.9;

void optics_warn(const optics *o, const opc_host *host) {
  if (o->na > most_scalar && o->polarisation == OPTICS_SCALAR)
    host->log(host, OPC_LOG_WARNING,
              "NA %g: scalar images are accurate up to NA %g; beyond, "
              "polarisation changes contrast and thresholds: set "
              "'polarisation: unpolarised' or that of the scanner",
              o->na, most_scalar);
}

/* ---- the source ---- */

/* Return the signed distance of (x, y) from the border of the source, positive
   inside, or a lower bound of its magnitude with the same sign. */
static double source_depth(const optics *o, double x, double y) {
  double r = hypot(x, y);
  if (o->source == OPTICS_CIRCULAR) return o->sigma - r;
  double ring = fmin(o->sigma - r, r - o->sigma_in);
  if (o->source == OPTICS_ANNULAR) return ring;
  double turn = o->rotation * M_PI / 180;
  double u = x * cos(turn) + y * sin(turn), v = y * cos(turn) - x * sin(turn);
  /* The pole on the positive u axis represents all poles. */
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

/* Return the area of the part of a cell inside the source; (*cx, *cy) receives
   the centroid of that part. */
static double source_covered(const optics *o, double x, double y, double side,
                             double *cx, double *cy) {
  enum { PARTS = 16 };
  double d = source_depth(o, x, y), reach = side * M_SQRT1_2, sum = 0;
  *cx = x;
  *cy = y;
  if (d >= reach) return side * side;
  if (d <= -reach) return 0;
  double part = side / PARTS, sx = 0, sy = 0;
  for (int j = 0; j < PARTS; j++)
    for (int i = 0; i < PARTS; i++) {
      double px = x - side / 2 + (i + 0.5) * part;
      double py = y - side / 2 + (j + 0.5) * part;
      double in = fmin(fmax(source_depth(o, px, py) / part + 0.5, 0), 1);
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
  double *p = eda_alloc(o->points.count, sizeof *p), sum = 0;
  memcpy(p, o->points.values, o->points.count * sizeof *p);
  *n = o->points.count / 3;
  for (size_t i = 0; i < *n; i++) sum += p[3 * i + 2];
  for (size_t i = 0; i < *n; i++) p[3 * i + 2] /= sum;
  return p;
}

double *optics_source_points(const optics *o, double spacing, size_t *n) {
  static const double most = 2048; /* cells from the centre to the border */
  *n = 0;
  if (o->source == OPTICS_LIST) return listed_points(o, n);
  double radius = optics_source_radius(o);
  if (!(spacing > 0 && radius / spacing < most)) return NULL;
  int half = (int)ceil(radius / spacing);
  double *p = eda_alloc((size_t)half * (size_t)half * 12, sizeof *p), sum = 0;
  for (int j = -half; j < half; j++)
    for (int i = -half; i < half; i++) {
      double *to = p + 3 * *n;
      to[2] = source_covered(o, (i + 0.5) * spacing, (j + 0.5) * spacing,
                             spacing, &to[0], &to[1]);
      /* Rounding can place a centroid slightly outside. */
      double over = hypot(to[0], to[1]) / radius;
      if (over > 1) {
        to[0] /= over;
        to[1] /= over;
      }
      sum += to[2];
      *n += to[2] > 0;
    }
  for (size_t i = 0; i < *n; i++) p[3 * i + 2] /= sum;
  if (*n) return p;
  free(p);
  return NULL;
}

double optics_source_radius(const optics *o) {
  double radius = 0;
  if (o->source != OPTICS_LIST) return o->sigma;
  for (size_t i = 0; i < o->points.count; i += 3)
    radius = fmax(radius, hypot(o->points.values[i], o->points.values[i + 1]));
  return radius;
}

/* ---- the pupil ---- */

/* Find group, angular order and parity of a Zernike term in fringe order. Group
   g has the angular orders m = g .. 0 of degree 2 g - m, cosine before sine.
   Z37 is the only term of group 6. */
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

/* Return the radial polynomial divided by r^m, as a function of r^2. */
static double zernike_radial(int group, int m, double r2) {
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

/* Return the aberration at (x, y), waves. */
static double pupil_aberration(const optics *o, double x, double y) {
  double r2 = x * x + y * y, sum = 0;
  for (size_t i = 0; i < o->zernike.count; i++) {
    if (o->zernike.values[i] == 0) continue;
    int group, m, sine;
    find_term(i, &group, &m, &sine);
    double re = 1, im = 0; /* r^m exp(i m angle) */
    for (int k = 0; k < m; k++) {
      double t = re * x - im * y;
      im = re * y + im * x;
      re = t;
    }
    sum +=
        o->zernike.values[i] * (sine ? im : re) * zernike_radial(group, m, r2);
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
  if (o->zernike.count) waves += pupil_aberration(o, fx, fy);
  if (waves == 0) return;
  *re = cos(2 * M_PI * waves);
  *im = sin(2 * M_PI * waves);
}

int optics_is_radial(const optics *o) {
  if (o->polarisation == OPTICS_POLARISED_X ||
      o->polarisation == OPTICS_POLARISED_Y)
    return 0;
  if (o->source != OPTICS_CIRCULAR && o->source != OPTICS_ANNULAR) return 0;
  for (size_t i = 0; i < o->zernike.count; i++) {
    int group, m, sine;
    find_term(i, &group, &m, &sine);
    if (m && o->zernike.values[i] != 0) return 0;
  }
  return 1;
}

int optics_is_real(const optics *o) {
  if (o->defocus != 0) return 0;
  for (size_t i = 0; i < o->zernike.count; i++)
    if (o->zernike.values[i] != 0) return 0;
  return 1;
}

/* ---- the mask ---- */

int optics_real_masks(const optics *o) {
  for (int i = 0; i < 2; i++)
    if (o->background[i][1] != 0 || o->feature[i][1] != 0) return 0;
  return 1;
}

void optics_amplitudes(const optics *o, int layer, double a[2], double b[2]) {
  int mask = layer == EDA_ACTIVE;
  for (int i = 0; i < 2; i++) {
    a[i] = o->feature[mask][i];
    b[i] = o->background[mask][i] - o->feature[mask][i];
  }
}
