/* SPDX-License-Identifier: BSD-3-Clause */
/* Polarised light, computed again with vectors in space and Fresnel's formulas
   in the angles; invalid optics. */
#include "vector.h"

#include <glib.h>
#include <math.h>
#include <string.h>

static const double immersion = 1.44, photoresist = 1.7;

static optics polarised(int polarisation) {
  return (optics){.wavelength = 193,
                  .na = 1.2,
                  .index = immersion,
                  .resist_index = photoresist,
                  .polarisation = polarisation,
                  .sigma = 0.8};
}

/* Compute the field in the resist of light with the polarisation j at (x, y) of
   the pupil. `a` and `b` are the angles to the axis over and in the resist:
   ts = 2 sin(b) cos(a) / sin(a + b), tp = ts / cos(a - b). */
static void field_of(double x, double y, const double j[2], double e[3]) {
  double r = hypot(x, y), u[2] = {x / r, y / r};
  double a = asin(1.2 * r / immersion), b = asin(1.2 * r / photoresist),
         o = asin(1.2 * r / 4);
  double s = (u[0] * j[1] - u[1] * j[0]) * 2 * sin(b) * cos(a) / sin(a + b);
  double p = (u[0] * j[0] + u[1] * j[1]) * 2 * sin(b) * cos(a) / sin(a + b) /
             cos(a - b);
  const double across[3] = {-u[1], u[0], 0},
               along[3] = {u[0] * cos(b), u[1] * cos(b), -sin(b)};
  for (int i = 0; i < 3; i++)
    e[i] = sqrt(cos(o) / cos(a)) * (across[i] * s + along[i] * p);
}

static void near(double a, double b) {
  if (!(fabs(a - b) <= 1e-12)) g_error("%.17g is not %.17g", a, b);
}

static void test_field(void) {
  static const double from[2] = {-0.48, 0.36}; /* direction (-0.8, 0.6) */
  static const double states[][2] = {[OPTICS_POLARISED_X] = {1, 0},
                                     [OPTICS_POLARISED_Y] = {0, 1},
                                     [OPTICS_TANGENTIAL] = {-0.6, -0.8},
                                     [OPTICS_RADIAL] = {-0.8, 0.6}};
  for (int k = OPTICS_UNPOLARISED; k <= OPTICS_RADIAL; k++) {
    optics o = polarised(k);
    int both = k == OPTICS_UNPOLARISED;
    g_assert_cmpuint(vector_parts(&o), ==, both ? 6 : 3);
    for (int i = 1; i < 50; i++) {
      double r = i / 50.0, x = r * cos(2.1 * i), y = r * sin(2.1 * i);
      double is[VECTOR_PARTS], want[3];
      vector_factors(&o, from, x, y, is);
      for (int part = 0; part < (both ? 2 : 1); part++) {
        field_of(x, y,
                 states[!both  ? k
                        : part ? OPTICS_POLARISED_Y
                               : OPTICS_POLARISED_X],
                 want);
        for (int d = 0; d < 3; d++)
          near(is[3 * part + d], want[d] * (both ? M_SQRT1_2 : 1));
      }
    }
  }
}

/* On the axis the field is that of normal incidence; the centre of the source
   counts as a point on the x axis. Scalar light has one part. */
static void test_axis(void) {
  static const double centre[2] = {0, 0};
  double t = 2 * immersion / (immersion + photoresist), e[VECTOR_PARTS];
  for (int k = OPTICS_POLARISED_X; k <= OPTICS_RADIAL; k++) {
    optics o = polarised(k);
    int along_y = k == OPTICS_POLARISED_Y || k == OPTICS_TANGENTIAL;
    vector_factors(&o, centre, 0, 0, e);
    near(e[along_y], t);
    near(e[!along_y], 0);
    near(e[2], 0);
    near(vector_clear(&o, centre), t * t);
  }
  optics o = polarised(OPTICS_SCALAR);
  g_assert_cmpuint(vector_parts(&o), ==, 1);
  vector_factors(&o, centre, 0.3, 0.4, e);
  near(e[0], 1);
}

/* Without a boundary (equal indices), the lens conserves energy: the square of
   the field is cos(o) / cos(a). */
static void test_energy(void) {
  optics o = polarised(OPTICS_UNPOLARISED);
  o.resist_index = immersion;
  for (int i = 1; i < 20; i++) {
    double r = i / 20.0, e[VECTOR_PARTS], sum = 0,
           from[2] = {r * cos(i), r * sin(i)};
    double a = asin(1.2 * r / immersion), b = asin(1.2 * r / 4);
    vector_factors(&o, from, from[0], from[1], e);
    for (int k = 0; k < VECTOR_PARTS; k++) sum += e[k] * e[k];
    near(sum, cos(b) / cos(a));
    near(vector_clear(&o, from), cos(b) / cos(a));
  }
}

static void test_odd(void) {
  static const int kinds[] = {OPTICS_UNPOLARISED, OPTICS_TANGENTIAL,
                              OPTICS_RADIAL};
  static const double from[2] = {0.5, 0};
  for (size_t k = 0; k < G_N_ELEMENTS(kinds); k++) {
    optics o = polarised(kinds[k]);
    double up[VECTOR_PARTS], down[VECTOR_PARTS];
    vector_factors(&o, from, 0.3, 0.7, up);
    vector_factors(&o, from, 0.3, -0.7, down);
    for (size_t part = 0; part < vector_parts(&o); part++) {
      g_assert_cmpfloat(fabs(up[part]), >, 0.01);
      near(up[part], vector_is_odd(&o, part) ? -down[part] : down[part]);
    }
  }
}

/* The clear field is 1 after normalisation; ratios of weights remain. */
static void test_normalise(void) {
  const double given[] = {0.1, 0, 0.25, 0.7, 0.2, 0.75};
  double points[6];
  optics o = polarised(OPTICS_RADIAL);
  memcpy(points, given, sizeof points);
  vector_normalise(&o, points, 2);
  near(points[2] * vector_clear(&o, points) +
           points[5] * vector_clear(&o, points + 3),
       1);
  near(points[5] / points[2], 3);
  o = polarised(OPTICS_SCALAR);
  memcpy(points, given, sizeof points);
  vector_normalise(&o, points, 2);
  g_assert_cmpmem(points, sizeof points, given, sizeof given);
}

/* ---- invalid optics ---- */

static double outside[] = {0.1, 0, 1, 0.8, 0.7, 1}, negative[] = {0, 0, -1},
              dark[] = {0, 0, 0}, waves[] = {0, 11}, many[OPTICS_TERMS + 1];

static void test_check(void) {
  static const struct {
    int source, polarisation;
    double na, index, resist_index, wavelength, sigma_in;
    unsigned given; /* bits of parameters */
    opc_reals points, zernike;
    const char *want; /* parameter and message; NULL: valid */
  } cases[] = {
      {.na = 0.75, .index = 1},
      {.na = 1, .index = 1},
      {.na = 1.01,
       .index = 1,
       .want = "na: 'na' of 1.01 is above the index of the medium, 1"},
      {.na = 1,
       .index = 1,
       .resist_index = 1.7,
       .polarisation = OPTICS_RADIAL,
       .want = "na: 'na' of 1 is not below the index of the medium, 1, as "
               "required for polarised light"},
      {.na = 1.2,
       .index = 1.44,
       .resist_index = 1.2,
       .polarisation = OPTICS_RADIAL,
       .want = "resist_index: 'resist_index' of 1.2 is not above the NA, 1.2"},
      {.na = 1.2,
       .index = 1.44,
       .resist_index = 1.7,
       .polarisation = OPTICS_UNPOLARISED},
      {.na = 0.5, .index = 1, .wavelength = 6}, /* 12 nm */
      {.na = 0.5,
       .index = 1,
       .wavelength = 5.9,
       .want = "wavelength: wavelength / na, the unit of an image's lengths, "
               "is 0.0118 um, expected 12 nm to 4 um: models would need images "
               "of 4.1e+06 points, 0.033 GB for each of about 40 kernels"},
      {.na = 0.1, .index = 1, .wavelength = 400},
      {.na = 0.1,
       .index = 1,
       .wavelength = 401,
       .want = "na: wavelength / na, the unit of an image's lengths, is 4.01 "
               "um, expected 12 nm to 4 um: models would need images of 5e+05 "
               "points, 0.004 GB for each of about 40 kernels"},
      {.na = 0.75,
       .index = 1,
       .given = 1 << OPTICS_OPENING,
       .want = "opening: 'opening' has no effect for a source 'circular'"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_ANNULAR,
       .want = "sigma_in: 'sigma_in' is required for a source 'annular'"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_ANNULAR,
       .sigma_in = 0.7,
       .given = 1 << OPTICS_SIGMA_IN},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_DIPOLE,
       .sigma_in = 0.8,
       .given = 1 << OPTICS_SIGMA_IN | 1 << OPTICS_ROTATION,
       .want = "sigma_in: 'sigma_in' of 0.8 is not below sigma, 0.8"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_QUADRUPOLE,
       .sigma_in = 0.2,
       .given = 1 << OPTICS_SIGMA_IN | 1 << OPTICS_OPENING,
       .want = "opening: 'opening' has no effect for a source 'quadrupole'"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_LIST,
       .given = 1 << OPTICS_SIGMA,
       .want = "sigma: 'sigma' has no effect for a source 'points'"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_LIST,
       .given = 1 << OPTICS_POINTS,
       .points = {outside, 2},
       .want = "points: 'points' has 2 numbers, expected x, y and weight of "
               "each point"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_LIST,
       .given = 1 << OPTICS_POINTS,
       .points = {outside, 3}},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_LIST,
       .given = 1 << OPTICS_POINTS,
       .points = {outside, 6},
       .want = "points: 'points': (0.8, 0.7) is outside the pupil, whose "
               "radius is 1"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_LIST,
       .given = 1 << OPTICS_POINTS,
       .points = {negative, 3},
       .want = "points: 'points': (0, 0) has the weight -1, expected at least "
               "0"},
      {.na = 0.75,
       .index = 1,
       .source = OPTICS_LIST,
       .given = 1 << OPTICS_POINTS,
       .points = {dark, 3},
       .want = "points: the weights of 'points' sum to 0, expected a positive "
               "finite number"},
      {.na = 0.75, .index = 1, .zernike = {waves, 1}},
      {.na = 0.75,
       .index = 1,
       .zernike = {waves, 2},
       .want = "zernike: 'zernike': term 2 is 11 waves, more than 10"},
      {.na = 0.75, .index = 1, .zernike = {many, OPTICS_TERMS}},
      {.na = 0.75,
       .index = 1,
       .zernike = {many, OPTICS_TERMS + 1},
       .want = "zernike: 'zernike' has 38 terms, expected 1 to 37"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error = {0};
    optics o = {
        .wavelength = cases[i].wavelength > 0 ? cases[i].wavelength : 193,
        .na = cases[i].na,
        .index = cases[i].index,
        .resist_index = cases[i].resist_index,
        .polarisation = cases[i].polarisation,
        .source = cases[i].source,
        .sigma = 0.8,
        .sigma_in = cases[i].sigma_in,
        .points = cases[i].points,
        .zernike = cases[i].zernike,
        .zernike_given = cases[i].zernike.count > 0};
    for (int k = 0; k < OPTICS_USES; k++)
      o.given[k] = (int)(cases[i].given >> k & 1);
    int code = optics_check(&o, &error);
    g_autofree char *is =
        g_strdup_printf("%s: %s", error.parameter, error.message);
    g_assert_cmpint(code, ==, cases[i].want ? OPC_INVALID : OPC_OK);
    if (cases[i].want) g_assert_cmpstr(is, ==, cases[i].want);
    near(o.cutoff, o.na / o.wavelength);
  }
  opc_error error;
  optics o = polarised(OPTICS_SCALAR);
  g_assert_cmpint(optics_check(&o, &error), ==, OPC_OK);
  o.resist_index_given = 1;
  g_assert_cmpint(optics_check(&o, &error), ==, OPC_INVALID);
  o = polarised(OPTICS_SCALAR);
  o.zernike_given = 1;
  g_assert_cmpint(optics_check(&o, &error), ==, OPC_INVALID);
}

/* The amplitude is a + b * mask; `mask` is 0 in features and 1 elsewhere. */
static void test_masks(void) {
  static const struct {
    int dark;
    double transmission, phase;
    double feature[2], background[2];
  } cases[] = {{0, 0, 180, {0, 0}, {1, 0}},
               {0, 6.25, 180, {-0.25, 0}, {1, 0}},
               {0, 6.25, -540, {-0.25, 0}, {1, 0}},
               {0, 25, 360, {0.5, 0}, {1, 0}},
               {0, 25, 90, {0, 0.5}, {1, 0}},
               {1, 25, -60, {1, 0}, {0.25, -0.43301270189221932}}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int layer = 0; layer < 3; layer++) {
      opc_error error;
      optics o = polarised(OPTICS_SCALAR);
      int k = layer == 1;
      double a[2], b[2];
      o.mask[k].dark = cases[i].dark;
      o.mask[k].transmission = cases[i].transmission;
      o.mask[k].phase = cases[i].phase;
      g_assert_cmpint(optics_check(&o, &error), ==, OPC_OK);
      optics_amplitudes(&o, layer, a, b);
      for (int part = 0; part < 2; part++) {
        near(a[part], cases[i].feature[part]);
        near(a[part] + b[part], cases[i].background[part]);
      }
      g_assert_cmpint(optics_real_masks(&o), ==, i < 4);
      optics_amplitudes(&o, !k, a, b);
      near(a[0] + b[0], 1);
      near(a[0], 0);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/vector/field", test_field);
  g_test_add_func("/vector/axis", test_axis);
  g_test_add_func("/vector/energy", test_energy);
  g_test_add_func("/vector/odd", test_odd);
  g_test_add_func("/vector/normalise", test_normalise);
  g_test_add_func("/vector/check", test_check);
  g_test_add_func("/vector/masks", test_masks);
  return g_test_run();
}
