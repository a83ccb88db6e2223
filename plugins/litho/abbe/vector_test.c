/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of polarised images of litho.abbe and litho.hopkins against closed
   forms of few beams and against a sum of plane waves in three dimensions. The
   sum shares no code with the models: vectors come from cross products,
   amplitudes in the resist from the continuity of fields. */
#include <complex.h>
#include <eda/gates.h>
#include <eda/litho.h>
#include <math.h>
#include <string.h>

#include "../image_test.h"

/* ---- images by the models ---- */

static eda_field image_of(const char *id, const char *parameters,
                          double defocus, const eda_box *boxes, size_t n,
                          eda_frame f) {
  g_autoptr(opc_module) m = prepared(id, parameters);
  return image_boxes(m, EDA_POLY, defocus, boxes, n, f);
}

/* Return the image of a line along y in the middle of a period. */
static eda_field grating(const char *id, const char *parameters, double defocus,
                         double width, double pitch) {
  int32_t x = (int32_t)lround(width * 5), y = (int32_t)lround(pitch * 10);
  eda_box line = {-x, 0, x, y};
  return image_of(id, parameters, defocus, &line, 1,
                  (eda_frame){-pitch / 2, 0, pitch, pitch});
}

/* Return the amplitude of order n of the grating. */
static double order(int n, double width, double pitch) {
  return n ? -sin(M_PI * n * width / pitch) / (M_PI * n) : 1 - width / pitch;
}

/* ---- images by plane waves ---- */

typedef struct scanner {
  double wavelength, na, index, resist, defocus;
} scanner;

typedef struct vector {
  double at[3];
} vector;

static vector cross(vector a, vector b) {
  return (vector){{a.at[1] * b.at[2] - a.at[2] * b.at[1],
                   a.at[2] * b.at[0] - a.at[0] * b.at[2],
                   a.at[0] * b.at[1] - a.at[1] * b.at[0]}};
}

static double dot(vector a, vector b) {
  return a.at[0] * b.at[0] + a.at[1] * b.at[1] + a.at[2] * b.at[2];
}

static vector unit(vector a) {
  double length = sqrt(dot(a, a));
  for (int i = 0; i < 3; i++) a.at[i] /= length;
  return a;
}

/* Return y of the solution of a x + b y = e, c x + d y = f. */
static double second(double a, double b, double c, double d, double e,
                     double f) {
  return (a * f - c * e) / (a * d - b * c);
}

/* Return the field in the resist of a beam that enters the pupil at (x, y),
   radius at most 1, polarised along j. */
static vector refracted(const scanner *s, double x, double y, vector j) {
  const vector axis = {{0, 0, 1}};
  double kx = s->na * x, ky = s->na * y, k2 = kx * kx + ky * ky;
  vector before = {{kx, ky, sqrt(s->index * s->index - k2)}};
  vector after = {{kx, ky, sqrt(s->resist * s->resist - k2)}};
  vector te = k2 > 0 ? unit(cross(axis, before)) : (vector){{0, 1, 0}};
  /* Energy is conserved through planes perpendicular to the axis on both sides
     of the lens. */
  double mask_z = sqrt(1 - k2 / 16), z = before.at[2], w = after.at[2];
  double lens = sqrt(mask_z / (z / s->index));
  double along = lens * dot(j, te), rest = lens * dot(j, cross(te, axis));
  /* Unknowns: reflected r, transmitted t. Tangential E and H are continuous. */
  double t = second(1, -1, -z, -w, -1, -z) * along;
  double u = second(-z / s->index, -w / s->resist, s->index, -s->resist,
                    -z / s->index, -s->index) *
             rest;
  vector tm = unit(cross(te, after)), e;
  for (int i = 0; i < 3; i++) e.at[i] = t * te.at[i] + u * tm.at[i];
  return e;
}

/* Return the number of polarisations of a source point and store them in j. */
static int polarisations(const char *name, double sx, double sy, vector j[2]) {
  vector out = {{sx, sy, 0}}, axis = {{0, 0, 1}};
  j[0] = (vector){{1, 0, 0}};
  j[1] = (vector){{0, 1, 0}};
  if (g_str_equal(name, "y")) j[0] = j[1];
  if (g_str_equal(name, "radial")) j[0] = unit(out);
  if (g_str_equal(name, "tangential")) j[0] = unit(cross(axis, out));
  return g_str_equal(name, "unpolarised") ? 2 : 1;
}

/* An order of a mask: frequency in 1/nm and amplitude. */
typedef struct beam {
  double fx, fy;
  double complex a;
} beam;

enum { PLACES = 40 };
typedef struct places {
  int count;
  double x[PLACES], y[PLACES], value[PLACES], clear;
} places;

/* Add the intensity of one source point at all places. */
static void add_point(const scanner *s, const char *name, double sx, double sy,
                      double weight, const beam *b, size_t n, places *p) {
  vector j[2];
  int states = polarisations(name, sx, sy, j);
  for (int i = 0; i < states; i++) {
    double complex e[PLACES][3] = {0};
    vector middle = refracted(s, sx, sy, j[i]);
    p->clear += weight * dot(middle, middle) / states;
    for (size_t k = 0; k < n; k++) {
      double x = b[k].fx * s->wavelength / s->na + sx;
      double y = b[k].fy * s->wavelength / s->na + sy;
      double sine2 = pow(s->na / s->index, 2) * (x * x + y * y);
      if (x * x + y * y > 1) continue;
      vector v = refracted(s, x, y, j[i]);
      double waves = s->defocus * s->index / s->wavelength * sqrt(1 - sine2);
      for (int q = 0; q < p->count; q++) {
        double complex a =
            b[k].a * cexp(2 * M_PI * I *
                          (b[k].fx * p->x[q] + b[k].fy * p->y[q] + waves));
        for (int c = 0; c < 3; c++) e[q][c] += a * v.at[c];
      }
    }
    for (int q = 0; q < p->count; q++)
      for (int c = 0; c < 3; c++)
        p->value[q] += weight / states * creal(e[q][c] * conj(e[q][c]));
  }
}

/* Return the larger number; INFINITY if `b` is NAN. */
static double larger(double a, double b) {
  return isnan(b) ? INFINITY : fmax(a, b);
}

static double worst_off(const places *p, const eda_field *f) {
  double worst = 0;
  for (int q = 0; q < p->count; q++)
    worst = larger(
        worst, fabs(value_at(f, p->x[q], p->y[q]) - p->value[q] / p->clear));
  return worst;
}

static const char *const polarised[] = {"unpolarised", "x", "y", "tangential",
                                        "radial"};

/* ---- tests ---- */

/* Test a rectangle with some source points, in air and in water. */
static void test_sum(void) {
  static const double source[][3] = {
      {0.31, 0.12, 1}, {-0.48, 0.2, 2}, {0.05, -0.55, 1}, {0.7, 0.6, 0.5}};
  static const struct {
    scanner s;
    const char *parameters;
  } cases[] = {{{193, 0.93, 1, 1.7, 0}, "na: 0.93"},
               {{193, 1.35, 1.437, 1.71, 0},
                "na: 1.35, index: 1.437, resist_index: 1.71"},
               {{193, 1.2, 1.437, 1.437, 70},
                "na: 1.2, index: 1.437, resist_index: 1.437, defocus: 70 nm"}};
  const eda_box b = {-1300, -1700, 900, 2300}; /* in units of 0.1 nm */
  const eda_frame f = {-350, -400, 700, 800};
  enum { MOST = 1000, REACH = 12 };
  static beam beams[MOST];
  size_t n = 0;
  for (int l = -REACH; l <= REACH; l++)
    for (int k = -REACH; k <= REACH; k++) {
      double w = (b.x1 - b.x0) * 0.1 / f.width;
      double h = (b.y1 - b.y0) * 0.1 / f.height;
      double part = (k ? sin(M_PI * k * w) / (M_PI * k) : w) *
                    (l ? sin(M_PI * l * h) / (M_PI * l) : h);
      double turn = k * (b.x0 + b.x1) * 0.1 / f.width +
                    l * (b.y0 + b.y1) * 0.1 / f.height;
      beams[n++] = (beam){k / f.width, l / f.height,
                          (k || l ? 0 : 1) - part * cexp(-M_PI * I * turn)};
    }
  for (size_t c = 0; c < G_N_ELEMENTS(cases); c++)
    for (size_t i = 0; i < G_N_ELEMENTS(polarised); i++) {
      places p = {.count = PLACES};
      for (int q = 0; q < PLACES; q++) {
        p.x[q] = fmod(211.3 * q, 700) - 350;
        p.y[q] = 20 * q - 400;
      }
      for (size_t s = 0; s < G_N_ELEMENTS(source); s++)
        add_point(&cases[c].s, polarised[i], source[s][0], source[s][1],
                  source[s][2], beams, n, &p);
      g_autofree char *parameters = g_strdup_printf(
          "{ %s, polarisation: %s, source: points, points: [0.31, 0.12, 1, "
          "-0.48, 0.2, 2, 0.05, -0.55, 1, 0.7, 0.6, 0.5] }",
          cases[c].parameters, polarised[i]);
      eda_field got = image_of("litho.abbe", parameters, 0, &b, 1, f);
      double worst = worst_off(&p, &got);
      g_test_message("%s, %s: %.2g off", cases[c].parameters, polarised[i],
                     worst);
      g_assert_cmpfloat(worst, <, 3e-5);
      eda_field_clear(&got);
    }
}

#define WATER "na: 1.35, index: 1.437, "
#define AIR "na: 0.93, "
#define RIM WATER "source: annular, sigma_in: 0.65, "

/* Test a grating with an extended source of 200,000 points. The image is the
   same for both halves of the source, so that one half suffices. */
static void test_disks(void) {
  if (opc_test_sanitized_skip()) return;
  static const struct {
    scanner s;
    const char *polarisation, *parameters;
    double sigma, sigma_in, width, pitch, reach;
  } cases[] = {
      {{193, 0.75, 1, 1.7, 0}, "unpolarised", "", 0.75, 0, 65, 250, 1e-4},
      {{193, 0.93, 1, 1.7, 60}, "unpolarised", AIR, 0.75, 0, 65, 200, 2e-4},
      {{193, 1.35, 1.437, 1.7, 0}, "tangential", RIM, .9, .65, 50, 190, 1e-4},
      {{193, 1.35, 1.437, 1.7, 0}, "radial", RIM, .9, .65, 50, 130, 1e-4},
  };
  enum { ACROSS = 500, REACH = 4 };
  for (size_t c = 0; c < G_N_ELEMENTS(cases); c++) {
    double width = cases[c].width, pitch = cases[c].pitch;
    beam beams[2 * REACH + 1];
    places p = {.count = 10};
    for (int k = -REACH; k <= REACH; k++)
      beams[k + REACH] = (beam){k / pitch, 0, order(k, width, pitch)};
    for (int q = 0; q < p.count; q++) p.x[q] = (q / 18.0 - 0.5) * pitch;
    for (int i = 0; i < ACROSS * ACROSS / 2; i++) {
      double x = (i % ACROSS + 0.5) * 2 / ACROSS - 1;
      int row = i / ACROSS;
      double y = (row + 0.5) * 2 / ACROSS - 1;
      double r = hypot(x, y) * cases[c].sigma;
      if (r > cases[c].sigma || r < cases[c].sigma_in) continue;
      add_point(&cases[c].s, cases[c].polarisation, x * cases[c].sigma,
                y * cases[c].sigma, 1, beams, 2 * REACH + 1, &p);
    }
    g_autofree char *parameters = g_strdup_printf(
        "{ %spolarisation: %s, sigma: %g, error: 5e-5 }", cases[c].parameters,
        cases[c].polarisation, cases[c].sigma);
    eda_field got =
        grating("litho.hopkins", parameters, cases[c].s.defocus, width, pitch);
    double worst = worst_off(&p, &got);
    g_test_message("%s: %.2g off", parameters, worst);
    g_assert_cmpfloat(worst, <, cases[c].reach);
    eda_field_clear(&got);
  }
}

/* ---- both models ---- */

static const eda_box shapes[] = {{-4000, -5400, -1800, 2400},
                                 {1200, 800, 5400, 3200},
                                 {2000, -4400, 4800, -1800}};
static const eda_frame wide = {-1000, -1000, 2000, 2000},
                       narrow = {-700, -700, 1400, 1400};

/* Return the largest difference of two images. `turned`: b is indexed with x
   and y exchanged. */
static double difference(const eda_field *a, const eda_field *b, int turned) {
  double worst = 0;
  for (int i = 0; i < 2000; i++) {
    double x = fmod(71.3 * i, 1400) - 700, y = 0.7 * i - 700;
    double other = turned ? value_at(b, y, x) : value_at(b, x, y);
    worst = larger(worst, fabs(value_at(a, x, y) - other));
  }
  return worst;
}

/* Compare both models for shapes without symmetry. For whole rings the
   remaining difference comes from the source points of litho.abbe (README), for
   other sources from the tables of litho.hopkins. */
static void test_models(void) {
  if (opc_test_sanitized_skip()) return;
  static const struct {
    const char *optics, *points, *kernels;
    double reach;
  } cases[] = {
      {"na: 0.93, polarisation: unpolarised", "120", "error: 1e-4", 5e-4},
      {WATER "polarisation: tangential, source: annular, sigma: 0.9, "
             "sigma_in: 0.6",
       "200", "error: 2e-4", 6e-4},
      {"na: 0.93, polarisation: x", "100", "kernels: 60", 3e-3},
      {WATER "polarisation: y, source: dipole, sigma: 0.9, sigma_in: 0.6",
       "200", "kernels: 40", 5e-3},
      {WATER "polarisation: unpolarised, source: quasar, sigma: 0.9, "
             "sigma_in: 0.6, rotation: 20 deg, defocus: 60 nm",
       "100", "kernels: 40", 6e-3},
  };
  for (size_t c = 0; c < G_N_ELEMENTS(cases); c++) {
    g_autofree char *a = g_strdup_printf("{ %s, points_across: %s }",
                                         cases[c].optics, cases[c].points);
    g_autofree char *h =
        g_strdup_printf("{ %s, %s }", cases[c].optics, cases[c].kernels);
    eda_field want = image_of("litho.abbe", a, 0, shapes, 3, wide);
    eda_field got = image_of("litho.hopkins", h, 0, shapes, 3, wide);
    double worst = difference(&want, &got, 0);
    g_test_message("%s: %g kernels, %.2g off litho.abbe", h,
                   opc_test_metric("kernels"), worst);
    g_assert_cmpfloat(worst, <, cases[c].reach);
    eda_field_clear(&want);
    eda_field_clear(&got);
  }
}

/* Test that models of one process share kernels only if their optics are
   equal. */
static void test_kept(void) {
  if (opc_test_sanitized_skip()) return;
  static const char *const light[] = {"", ", polarisation: unpolarised",
                                      ", polarisation: tangential",
                                      ", polarisation: tangential, "
                                      "resist_index: 1.437"};
  eda_field f[G_N_ELEMENTS(light)];
  for (size_t i = 0; i < G_N_ELEMENTS(light); i++) {
    g_autofree char *p = g_strdup_printf(
        "{ " WATER "source: annular, sigma_in: 0.5, error: 1e-3%s }", light[i]);
    f[i] = image_of("litho.hopkins", p, 0, shapes, 3, narrow);
    for (size_t j = 0; j < i; j++)
      g_assert_cmpfloat(difference(&f[i], &f[j], 0), >, 4e-3);
  }
  for (size_t i = 0; i < G_N_ELEMENTS(light); i++) eda_field_clear(&f[i]);
}

static const struct {
  const char *id, *rough; /* model and the allowed difference */
} models[] = {{"litho.abbe", "points_across: 20"},
              {"litho.hopkins", "error: 1e-3"}};

static void test_clear(void) {
  if (opc_test_sanitized_skip()) return;
  static const char *const sources[] = {
      "defocus: 80 nm", "source: annular, sigma_in: 0.5",
      "source: dipole, sigma_in: 0.5, rotation: 30 deg"};
  const eda_frame f = {0, 0, 400, 300};
  for (size_t m = 0; m < G_N_ELEMENTS(models); m++)
    for (size_t i = 0; i < G_N_ELEMENTS(sources); i++)
      for (size_t k = 0; k < G_N_ELEMENTS(polarised); k++) {
        if (m && k != (i == 2 ? 3 : i)) continue; /* skip slow cases */
        g_autofree char *p =
            g_strdup_printf("{ " WATER "polarisation: %s, %s, %s }",
                            polarised[k], sources[i], models[m].rough);
        eda_field got = image_of(models[m].id, p, 0, NULL, 0, f);
        g_assert_cmpfloat(fabs(value_at(&got, 12, 34) - 1), <,
                          m ? 1.5e-3 : 1e-5);
        eda_field_clear(&got);
      }
}

/* Test the limit of small NA, a scalar wave: NA and wavelength are a hundredth
   of the usual values. */
static void test_paraxial(void) {
  if (opc_test_sanitized_skip()) return;
  for (size_t m = 0; m < G_N_ELEMENTS(models); m++)
    for (size_t k = 0; k < G_N_ELEMENTS(polarised); k++)
      for (int steep = 0; steep < (m ? 1 : 2); steep++) {
        g_autofree char *p = g_strdup_printf(
            "{ wavelength: %s, na: %s, %s", steep ? "193 nm" : "1.93 nm",
            steep ? "0.75" : "0.0075", models[m].rough);
        g_autofree char *scalar = g_strconcat(p, " }", NULL);
        g_autofree char *light =
            g_strconcat(p, ", polarisation: ", polarised[k], " }", NULL);
        eda_field want = image_of(models[m].id, scalar, 0, shapes, 3, narrow);
        eda_field got = image_of(models[m].id, light, 0, shapes, 3, narrow);
        double off = difference(&want, &got, 0);
        /* The tables average the pupil over a cell of the source; here the
           source has fewer, larger cells. */
        double reach = m == 0 ? 1e-4 : k == 1 || k == 2 ? 4e-3 : 1.5e-3;
        g_test_message("%s %s: %.2g off a scalar image", models[m].id, light,
                       off);
        if (steep)
          g_assert_cmpfloat(off, >, 5e-3);
        else
          g_assert_cmpfloat(off, <, reach);
        eda_field_clear(&want);
        eda_field_clear(&got);
      }
}

/* Test the image after exchange of x and y for masks and polarisations. If x
   and y are exchanged for the mask only, the image of light polarised along x
   changes. */
static void test_turned(void) {
  if (opc_test_sanitized_skip()) return;
  eda_box other[3];
  for (int i = 0; i < 3; i++)
    other[i] =
        (eda_box){shapes[i].y0, shapes[i].x0, shapes[i].y1, shapes[i].x1};
  for (size_t m = 0; m < G_N_ELEMENTS(models); m++) {
    static const char *const sources[] = {
        "", "source: dipole, sigma_in: 0.5, rotation: 0 deg, ",
        "source: dipole, sigma_in: 0.5, rotation: 90 deg, "};
    for (int dipole = m ? 1 : 0; dipole < 2; dipole++) {
      g_autofree char *x =
          g_strdup_printf("{ na: 0.93, polarisation: x, %s%s }",
                          sources[dipole], models[m].rough);
      g_autofree char *y =
          g_strdup_printf("{ na: 0.93, polarisation: y, %s%s }",
                          sources[2 * dipole], models[m].rough);
      eda_field a = image_of(models[m].id, x, 0, shapes, 3, wide);
      eda_field b = image_of(models[m].id, y, 0, other, 3, wide);
      eda_field c = image_of(models[m].id, x, 0, other, 3, wide);
      g_assert_cmpfloat(difference(&a, &b, 1), <, m ? 1.5e-3 : 3e-5);
      g_assert_cmpfloat(difference(&a, &c, 1), >, 0.01);
      eda_field_clear(&a);
      eda_field_clear(&b);
      eda_field_clear(&c);
    }
  }
}

/* ---- few beams, in closed form ---- */

static void assert_image(const char *parameters, double width, double pitch,
                         double (*want)(double x, const void *data),
                         const void *data) {
  eda_field f = grating("litho.abbe", parameters, 0, width, pitch);
  for (double x = -pitch / 2; x < pitch / 2; x += pitch / 17)
    g_assert_cmpfloat(fabs(value_at(&f, x, 31) - want(x, data)), <, 3e-5);
  eda_field_clear(&f);
}

enum { TE, TM, BOTH };

typedef struct beams {
  double c0, c1, pitch, angle; /* amplitudes of the beams, pitch, and angle of
                                  the outer beam (or of both) in the resist */
  double lens;                 /* amplitude factor of a steep beam in the
                                  lens */
  int kind;
} beams;

/* Return the intensity of two beams; for TM only parallel field components
   interfere. */
static double two_beams(double x, const void *data) {
  const beams *b = data;
  double tm = cos(2 * b->angle), both = (1 + tm) / 2;
  double part = b->kind == TE ? 1 : b->kind == TM ? tm : both;
  return b->c0 * b->c0 + b->c1 * b->c1 +
         2 * b->c0 * b->c1 * part * cos(2 * M_PI * x / b->pitch);
}

/* Return the intensity of three beams; for TM the outer beams add along x and
   cancel along z in the middle. */
static double three_beams(double x, const void *data) {
  const beams *b = data;
  double u = 2 * M_PI * x / b->pitch, outer = 2 * b->c1 * b->lens;
  double te = pow(b->c0 + outer * cos(u), 2);
  double tm = pow(b->c0 + outer * cos(b->angle) * cos(u), 2) +
              pow(outer * sin(b->angle) * sin(u), 2);
  return b->kind == TE ? te : b->kind == TM ? tm : (te + tm) / 2;
}

static const struct {
  const char *name;
  int kind;
} kinds[] = {{"y", TE},
             {"tangential", TE},
             {"x", TM},
             {"radial", TM},
             {"unpolarised", BOTH}};

/* Test steep oblique light whose orders 0 and -1 have opposite angles. The
   index of the resist equals that of the medium, or makes the beams cross at a
   right angle, where TM light has no contrast. */
static void test_two_beams(void) {
  static const double width = 40, pitch = 100, na = 1.2, index = 1.437;
  double place = 193 / (2 * na * pitch), sine = na * place;
  double resists[] = {index, sine * M_SQRT2};
  for (size_t k = 0; k < G_N_ELEMENTS(kinds); k++)
    for (int i = 0; i < 2; i++) {
      /* In a resist of another index, the transmissions of TE and TM differ. */
      if (i && kinds[k].kind == BOTH) continue;
      beams b = {order(0, width, pitch),
                 order(1, width, pitch),
                 pitch,
                 asin(sine / resists[i]),
                 1,
                 kinds[k].kind};
      g_autofree char *p = g_strdup_printf(
          "{ na: %g, index: %g, resist_index: %.15g, polarisation: %s, source: "
          "points, points: [%.15g, 0, 1] }",
          na, index, resists[i], kinds[k].name, place);
      if (i && b.kind == TM) g_assert_cmpfloat(fabs(cos(2 * b.angle)), <, 1e-9);
      assert_image(p, width, pitch, two_beams, &b);
    }
}

/* Test light along the axis; the polarisation at the middle of the source is
   defined as that on the x axis. */
static void test_three_beams(void) {
  static const double width = 80, pitch = 200, na = 1.2, index = 1.437;
  double sine = 193 / pitch;
  for (size_t k = 0; k < G_N_ELEMENTS(kinds); k++) {
    beams b = {order(0, width, pitch),
               order(1, width, pitch),
               pitch,
               asin(sine / index),
               0,
               kinds[k].kind};
    b.lens = sqrt(cos(asin(sine / 4)) / cos(b.angle));
    g_autofree char *p = g_strdup_printf(
        "{ na: %g, index: %g, resist_index: %g, polarisation: %s, source: "
        "points, points: [0, 0, 1] }",
        na, index, index, kinds[k].name);
    assert_image(p, width, pitch, three_beams, &b);
  }
}

/* ---- messages ---- */

static void test_refused(void) {
  static const char *const cases[][2] = {
      {"{ polarisation: z }", "polarisation"},
      {"{ resist_index: 1.6 }", "resist_index"},
      {"{ polarisation: x, na: 1 }", "na"},
      {"{ polarisation: x, resist_index: 0.9 }", "resist_index"},
      {"{ polarisation: x, na: 1.3, index: 1.44, resist_index: 1.3 }",
       "resist_index"}};
  for (size_t m = 0; m < G_N_ELEMENTS(models); m++)
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
      opc_error error = {0};
      g_assert_null(opc_test_module(models[m].id, cases[i][0], &error));
      g_assert_nonnull(strstr(error.message, cases[i][1]));
    }
  /* The limit is 800 images; each point has six. */
  GString *many = g_string_new(
      "{ polarisation: unpolarised, source: points, "
      "points: [0, 0, 1");
  for (int i = 0; i < 133; i++) g_string_append(many, ", 0, 0.1, 1");
  g_string_append(many, "] }");
  opc_error error = {0};
  g_assert_null(opc_test_module("litho.hopkins", many->str, &error));
  g_assert_nonnull(strstr(error.message, "has 134 points, more than 133"));
  g_string_free(many, TRUE);
}

/* Test that a scalar image at a large NA, and no other image, causes a warning
   with a remedy. */
static void test_warned(void) {
  static const struct {
    const char *parameters;
    int warned;
  } cases[] = {{"na: 0.9", 0},
               {"na: 0.91", 1},
               {"na: 0.91, polarisation: unpolarised", 0}};
  for (size_t m = 0; m < G_N_ELEMENTS(models); m++)
    for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
      opc_error error = {0};
      g_autofree char *p =
          g_strdup_printf("{ %s, %s }", cases[i].parameters, models[m].rough);
      g_autoptr(opc_module) module = opc_test_module(models[m].id, p, &error);
      g_assert_nonnull(module);
      opc_test_forget();
      const eda_litho *litho = module->functions;
      g_assert_cmpint(litho->prepare(module->self, &error), ==, OPC_OK);
      const char *log = opc_test_log();
      g_assert_cmpint(strstr(log, "polarisation: unpolarised") != NULL, ==,
                      cases[i].warned);
    }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/vector/two-beams", test_two_beams);
  g_test_add_func("/vector/three-beams", test_three_beams);
  g_test_add_func("/vector/sum", test_sum);
  g_test_add_func("/vector/disks", test_disks);
  g_test_add_func("/vector/models", test_models);
  g_test_add_func("/vector/kept", test_kept);
  g_test_add_func("/vector/clear-field", test_clear);
  g_test_add_func("/vector/paraxial", test_paraxial);
  g_test_add_func("/vector/turned", test_turned);
  g_test_add_func("/vector/refused", test_refused);
  g_test_add_func("/vector/warned", test_warned);
  return g_test_run();
}
