/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of sources against areas and moments of their shapes, and of Zernike
   terms against tabulated forms and orthogonality. The tests of litho.abbe
   cover imaging. */
#include "optics.h"

#include <glib.h>
#include <math.h>
#include <stdlib.h>

static const optics air = {.wavelength = 193,
                           .na = 0.75,
                           .index = 1,
                           .cutoff = 0.75 / 193,
                           .sigma = 0.8,
                           .sigma_in = 0.4,
                           .opening = 40};

/* ---- sources ---- */

typedef struct moments {
  size_t n;
  double weight, x, y, xx, yy, xy, largest;
} moments;

static moments source_moments(const optics *o, double spacing) {
  moments m = {0};
  double *p = optics_source_points(o, spacing, &m.n);
  g_assert_nonnull(p);
  for (size_t i = 0; i < m.n; i++) {
    double x = p[3 * i], y = p[3 * i + 1], w = p[3 * i + 2];
    g_assert_cmpfloat(w, >, 0);
    m.weight += w;
    m.x += w * x;
    m.y += w * y;
    m.xx += w * x * x;
    m.yy += w * y * y;
    m.xy += w * x * y;
    m.largest = fmax(m.largest, hypot(x, y));
  }
  free(p);
  g_assert_cmpfloat(fabs(m.weight - 1), <, 1e-12);
  g_assert_cmpfloat(m.largest, <=, optics_source_radius(o) + 1e-12);
  return m;
}

/* Test the second moments of each shape against closed forms. */
static void test_moments(void) {
  double a = 0.8, b = 0.4, disk = (a - b) / 2, at = (a + b) / 2;
  double ring = (a * a + b * b) / 2; /* mean r^2 of an annulus */
  double half = 20 * M_PI / 180;
  double along = (1 + sin(2 * half) / (2 * half)) / 2; /* mean cos^2 */
  const struct {
    int source;
    double xx, yy;
  } cases[] = {
      {OPTICS_CIRCULAR, a * a / 4, a * a / 4},
      {OPTICS_ANNULAR, ring / 2, ring / 2},
      {OPTICS_DIPOLE, at * at + disk * disk / 4, disk * disk / 4},
      {OPTICS_QUADRUPOLE, at * at / 2 + disk * disk / 4,
       at * at / 2 + disk * disk / 4},
      {OPTICS_QUASAR, ring / 2, ring / 2},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (double turn = 0; turn < 80; turn += 30) {
      optics o = air;
      o.source = cases[i].source;
      o.rotation = turn;
      moments m = source_moments(&o, 0.02);
      double c = cos(turn * M_PI / 180), s = sin(turn * M_PI / 180);
      double xx = c * c * cases[i].xx + s * s * cases[i].yy;
      double xy = c * s * (cases[i].xx - cases[i].yy);
      g_assert_cmpfloat(fabs(m.x) + fabs(m.y), <, 1e-9);
      g_assert_cmpfloat(fabs(m.xx - xx), <, 3e-4);
      g_assert_cmpfloat(fabs(m.xy - xy), <, 3e-4);
    }
  /* One pole of the quasar, checked by its fourth moments. */
  optics o = air;
  o.source = OPTICS_QUASAR;
  size_t n;
  double sum = 0, *p = optics_source_points(&o, 0.02, &n);
  for (size_t i = 0; i < n; i++) {
    double x = fabs(p[3 * i]), y = fabs(p[3 * i + 1]);
    sum += p[3 * i + 2] * pow(fmax(x, y), 2);
  }
  g_assert_cmpfloat(fabs(sum - ring * along), <, 3e-4);
  free(p);
}

/* Test that a disk has one point for each cell that it touches, with weights by
   area; inner weights are equal. */
static void test_points(void) {
  optics o = air;
  o.source = OPTICS_CIRCULAR;
  size_t n;
  double *p = optics_source_points(&o, 0.05, &n);
  double cell = 0.05 * 0.05 / (M_PI * 0.8 * 0.8);
  size_t whole = 0;
  for (size_t i = 0; i < n; i++) {
    if (hypot(p[3 * i], p[3 * i + 1]) > 0.8 - 0.036) continue;
    g_assert_cmpfloat(fabs(p[3 * i + 2] / cell - 1), <, 1e-4);
    whole++;
  }
  g_assert_cmpuint(whole, >, 700);
  free(p);
  double listed[] = {0.1, 0.2, 3, -0.5, 0, 1};
  o.source = OPTICS_LIST;
  o.points = (opc_reals){listed, 6};
  p = optics_source_points(&o, 0.05, &n);
  g_assert_cmpuint(n, ==, 2);
  g_assert_cmpfloat(p[2], ==, 0.75);
  g_assert_cmpfloat(p[3], ==, -0.5);
  g_assert_cmpfloat(optics_source_radius(&o), ==, 0.5);
  free(p);
}

/* ---- the pupil ---- */

/* Return the phase in waves of a term of 0.01, divided by 0.01. */
static double term(int z, double x, double y) {
  double values[OPTICS_TERMS] = {0}, re, im;
  values[z - 1] = 0.01;
  optics o = air;
  o.zernike = (opc_reals){values, (size_t)z};
  optics_pupil(&o, 0, x, y, &re, &im);
  g_assert_cmpfloat(fabs(hypot(re, im) - 1), <, 1e-12);
  return atan2(im, re) / (2 * M_PI) / 0.01;
}

/* Return a term as written in the list of the University of Arizona; r and a
   are polar coordinates. */
static double written(int z, double r, double a) {
  double r2 = r * r;
  switch (z) {
    case 1:
      return 1;
    case 2:
      return r * cos(a);
    case 3:
      return r * sin(a);
    case 4:
      return 2 * r2 - 1;
    case 5:
      return r2 * cos(2 * a);
    case 6:
      return r2 * sin(2 * a);
    case 7:
      return (3 * r2 - 2) * r * cos(a);
    case 8:
      return (3 * r2 - 2) * r * sin(a);
    case 9:
      return 6 * r2 * r2 - 6 * r2 + 1;
    case 10:
      return r2 * r * cos(3 * a);
    case 11:
      return r2 * r * sin(3 * a);
    case 12:
      return (4 * r2 - 3) * r2 * cos(2 * a);
    case 13:
      return (4 * r2 - 3) * r2 * sin(2 * a);
    case 14:
      return (10 * r2 * r2 - 12 * r2 + 3) * r * cos(a);
    case 15:
      return (10 * r2 * r2 - 12 * r2 + 3) * r * sin(a);
    case 16:
      return 20 * pow(r2, 3) - 30 * r2 * r2 + 12 * r2 - 1;
    case 17:
      return r2 * r2 * cos(4 * a);
    case 25:
      return 70 * pow(r2, 4) - 140 * pow(r2, 3) + 90 * r2 * r2 - 20 * r2 + 1;
    case 26:
      return pow(r, 5) * cos(5 * a);
    case 36:
      return 252 * pow(r2, 5) - 630 * pow(r2, 4) + 560 * pow(r2, 3) -
             210 * r2 * r2 + 30 * r2 - 1;
    case 37:
      return 924 * pow(r2, 6) - 2772 * pow(r2, 5) + 3150 * pow(r2, 4) -
             1680 * pow(r2, 3) + 420 * r2 * r2 - 42 * r2 + 1;
    default:
      return NAN;
  }
}

static void test_written(void) {
  for (int z = 1; z <= OPTICS_TERMS; z++)
    for (int i = 0; i < 40; i++) {
      double r = (i + 0.5) / 40, a = 2.4 * i, want = written(z, r, a);
      if (isnan(want)) break;
      g_assert_cmpfloat(fabs(term(z, r * cos(a), r * sin(a)) - want), <, 1e-9);
    }
}

/* Test that different terms are orthogonal over the pupil. */
static void test_orthogonal(void) {
  enum { RINGS = 60, SPOKES = 24 };
  static double value[OPTICS_TERMS][RINGS * SPOKES];
  for (int z = 0; z < OPTICS_TERMS; z++)
    for (int i = 0; i < RINGS * SPOKES; i++) {
      int ring = i / SPOKES;
      double r = sqrt((ring + 0.5) / RINGS);
      double a = 2 * M_PI * (i % SPOKES) / SPOKES;
      value[z][i] = term(z + 1, r * cos(a), r * sin(a));
    }
  for (int p = 0; p < OPTICS_TERMS; p++)
    for (int q = 0; q <= p; q++) {
      double sum = 0;
      for (int i = 0; i < RINGS * SPOKES; i++)
        sum += value[p][i] * value[q][i] / (RINGS * SPOKES);
      if (p == q)
        g_assert_cmpfloat(sum, >, 0.045);
      else
        g_assert_cmpfloat(fabs(sum), <, 0.02);
    }
}

static void test_pupil(void) {
  double re, im;
  optics o = air;
  optics_pupil(&o, 0, 0.6, 0.81, &re, &im);
  g_assert_true(re == 0 && im == 0);
  optics_pupil(&o, 0, 0.6, 0.79, &re, &im);
  g_assert_true(re == 1 && im == 0);
  o.defocus = 30;
  optics_pupil(&o, -130, 0.6, 0.3, &re, &im);
  double s2 = 0.75 * 0.75 * 0.45;
  g_assert_cmpfloat(
      fabs(atan2(im, re) + 2 * M_PI * 100 / 193 * (sqrt(1 - s2) - 1)), <,
      1e-12);
  /* Compute the phase at the edge of a pupil that is as wide as the medium
     permits. */
  o = (optics){.wavelength = 193, .na = 1, .index = 1, .defocus = 40};
  optics_pupil(&o, 0, 0, -1, &re, &im);
  g_assert_cmpfloat(fabs(re - cos(2 * M_PI * 40 / 193)), <, 1e-12);
}

static void test_kinds(void) {
  double spherical[] = {0.1, 0, 0, 0.2, 0, 0, 0, 0, 0.3},
         coma[] = {0, 0, 0, 0, 0, 0, 0.1};
  double nothing[] = {0, 0};
  optics o = air;
  g_assert_true(optics_is_radial(&o) && optics_is_real(&o));
  o.defocus = 10;
  g_assert_true(optics_is_radial(&o) && !optics_is_real(&o));
  o = air;
  for (int p = OPTICS_SCALAR; p <= OPTICS_RADIAL; p++) {
    o.polarisation = p;
    g_assert_cmpint(optics_is_radial(&o), ==,
                    p != OPTICS_POLARISED_X && p != OPTICS_POLARISED_Y);
  }
  o = air;
  o.zernike = (opc_reals){spherical, 9};
  g_assert_true(optics_is_radial(&o) && !optics_is_real(&o));
  o.zernike = (opc_reals){coma, 7};
  g_assert_true(!optics_is_radial(&o) && !optics_is_real(&o));
  o.zernike = (opc_reals){nothing, 2};
  g_assert_true(optics_is_radial(&o) && optics_is_real(&o));
  o.source = OPTICS_QUASAR;
  g_assert_true(!optics_is_radial(&o) && optics_is_real(&o));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/optics/moments", test_moments);
  g_test_add_func("/optics/points", test_points);
  g_test_add_func("/optics/written", test_written);
  g_test_add_func("/optics/orthogonal", test_orthogonal);
  g_test_add_func("/optics/pupil", test_pupil);
  g_test_add_func("/optics/kinds", test_kinds);
  return g_test_run();
}
