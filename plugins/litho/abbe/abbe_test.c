/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of images against closed forms: gratings of few orders through source
   points and disks, the coherent edge, and aberrations of known effect. A
   second reference is litho.hopkins, which shares only the pupil with
   litho.abbe. */
#include <complex.h>
#include <eda/gates.h>
#include <eda/litho.h>
#include <math.h>
#include <string.h>

#include "../image_test.h"

static const opc_host *host;
static const double cutoff = 0.75 / 193;

/* Return the image of a vertical line of `width` at x = 0 in a grating of
   `pitch`. */
static eda_field grating(const char *parameters, double defocus, double width,
                         double pitch) {
  g_autoptr(opc_module) m = prepared("litho.abbe", parameters);
  int32_t x = (int32_t)lround(width * 5), y = (int32_t)lround(pitch * 10);
  eda_box line = {-x, 0, x, y};
  return image_boxes(m, EDA_POLY, defocus, &line, 1,
                     (eda_frame){-pitch / 2, 0, pitch, pitch});
}

/* Return the amplitude of order n of the grating of lines. */
static double order(int n, double width, double pitch) {
  return n ? -sin(M_PI * n * width / pitch) / (M_PI * n) : 1 - width / pitch;
}

/* Return the intensity at x of the orders from .. to; waves[i] is the phase of
   order from + i. */
static double beams(int from, int to, const double *waves, double x,
                    double width, double pitch) {
  double complex e = 0;
  for (int n = from; n <= to; n++)
    e += order(n, width, pitch) *
         cexp(2 * M_PI * I * (n * x / pitch + (waves ? waves[n - from] : 0)));
  return creal(e * conj(e));
}

static void assert_beams(const eda_field *f, int from, int to,
                         const double *waves, double width, double pitch) {
  for (double x = -pitch / 2; x < pitch / 2; x += pitch / 17)
    g_assert_cmpfloat(
        fabs(value_at(f, x, 31) - beams(from, to, waves, x, width, pitch)), <,
        3e-5);
}

/* Test lines along x and a medium in which the pupil limits the image. Orders
   outside the pupil are blocked in both directions. */
static void test_turned(void) {
  static const struct {
    const char *parameters;
    double pitch;
    int from, to;
  } cases[] = {{"{ source: points, points: [0, 0, 1] }", 300, -1, 1},
               {"{ source: points, points: [0, 0, 1], na: 1.35, index: 1.44 }",
                160, -1, 1},
               {"{ source: points, points: [0, 0, 1], na: 1.35, index: 1.44 }",
                300, -2, 2},
               {"{ source: points, points: [0, 0.5, 1] }", 300, -1, 0},
               {"{ source: points, points: [0, -0.5, 1] }", 300, 0, 1}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    double pitch = cases[i].pitch, width = 0.4 * pitch;
    int32_t half = (int32_t)lround(width * 5), all = (int32_t)(10 * pitch);
    g_autoptr(opc_module) m = prepared("litho.abbe", cases[i].parameters);
    eda_box line = {0, -half, all, half};
    eda_field f = image_boxes(m, EDA_POLY, 0, &line, 1,
                              (eda_frame){0, -pitch / 2, pitch, pitch});
    for (double y = -pitch / 2; y < pitch / 2; y += pitch / 37) {
      double want = beams(cases[i].from, cases[i].to, NULL, y, width, pitch);
      g_assert_cmpfloat(fabs(value_at(&f, 31, y) - want), <, 1e-4);
    }
    eda_field_clear(&f);
  }
}

/* ---- the mask ---- */

static eda_spectrum spectrum_of(opc_module *m, const eda_shapes *shapes,
                                eda_frame f) {
  const eda_litho *litho = m->functions;
  eda_spectrum s;
  opc_error error;
  g_assert_cmpint(litho->transform(m->self, shapes, 0.5, f, &s, &error), ==,
                  OPC_OK);
  g_assert_cmpfloat(s.band, ==, litho->band(m->self));
  return s;
}

static double complex coefficient(const eda_spectrum *s, int k, int l) {
  const float *c =
      s->data +
      2 * ((size_t)(l < 0 ? l + s->rows : l) * (size_t)s->columns + (size_t)k);
  return (double)c[0] + I * (double)c[1];
}

/* Return Fourier coefficient k of the indicator of the interval a .. b of a
   period. */
static double complex interval(int k, double a, double b) {
  return k ? (cexp(-2 * M_PI * I * k * b) - cexp(-2 * M_PI * I * k * a)) /
                 (-2 * M_PI * I * k)
           : b - a;
}

/* Test rectangles, including a hole and one across the border of the frame,
   against products of sincs. Coefficients beyond the band are zero. */
static void test_rectangles(void) {
  g_autoptr(opc_module) m = prepared("litho.abbe", "{}");
  const eda_frame f = {-300, -200, 1500, 2300};
  const eda_box box[3] = {/* on a grid of 0.5 nm */
                          {-100, 300, 1700, 3900},
                          {200, 500, 330, 2001},
                          {2200, -900, 2701, 11}};
  eda_point points[12];
  uint32_t start[] = {0, 4, 8, 12};
  uint8_t hole[] = {0, 1, 0};
  for (int i = 0; i < 3; i++) {
    eda_box b = box[i];
    eda_point p[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    for (int c = 0; c < 4; c++) points[4 * i + c] = p[hole[i] ? 3 - c : c];
  }
  eda_shapes shapes = {3, start, points, hole};
  eda_spectrum s = spectrum_of(m, &shapes, f);
  double worst = 0;
  int inside = 0, half = (s.rows - 1) / 2;
  for (int l = -half; l <= half; l++)
    for (int k = 0; k < s.columns; k++) {
      double complex want = !k && !l;
      for (int i = 0; i < 3; i++) {
        eda_box b = box[i];
        want -= (hole[i] ? -1 : 1) *
                interval(k, (b.x0 / 2.0 - f.x0) / f.width,
                         (b.x1 / 2.0 - f.x0) / f.width) *
                interval(l, (b.y0 / 2.0 - f.y0) / f.height,
                         (b.y1 / 2.0 - f.y0) / f.height);
      }
      int in = hypot(k / f.width, l / f.height) <= s.band;
      inside += in;
      worst = fmax(worst, cabs(coefficient(&s, k, l) - (in ? want : 0)));
    }
  g_test_message("%d coefficients, %.2g off", inside, worst);
  g_assert_cmpint(inside, >, 100);
  g_assert_cmpfloat(worst, <, 6e-8); /* single precision; largest value 1 */
  eda_spectrum_clear(&s);
}

/* Test a polygon without vertical edges against a sum of thin rows: exact along
   x, midpoint rule along y. */
static void test_polygon(void) {
  enum { CORNERS = 5, ROWS = 26000 };
  g_autoptr(opc_module) m = prepared("litho.abbe", "{}");
  const eda_frame f = {0, 0, 1000, 900};
  eda_point points[CORNERS] = {
      {700, 200}, {1500, 900}, {1100, 1500}, {500, 1500}, {200, 1000}};
  uint32_t start[] = {0, CORNERS};
  eda_shapes shapes = {1, start, points, NULL};
  eda_spectrum s = spectrum_of(m, &shapes, f);
  double worst = 0;
  for (int l = -4; l <= 4; l++)
    for (int k = 0; k <= 4; k++) {
      double complex want = !k && !l;
      for (int r = 0; r < ROWS; r++) {
        double y = 200 + 1300 * (r + 0.5) / ROWS, x[2] = {INFINITY, -INFINITY};
        for (int i = 0; i < CORNERS; i++) {
          eda_point a = points[i], b = points[(i + 1) % CORNERS];
          if ((a.y > y) == (b.y > y)) continue;
          double at = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
          x[0] = fmin(x[0], at);
          x[1] = fmax(x[1], at);
        }
        want -= interval(k, x[0] / 2 / f.width, x[1] / 2 / f.width) *
                cexp(-M_PI * I * l * y / f.height) * 650 / ROWS / f.height;
      }
      worst = fmax(worst, cabs(coefficient(&s, k, l) - want));
    }
  g_test_message("a polygon: %.2g off", worst);
  g_assert_cmpfloat(worst, <, 1e-7);
  eda_spectrum_clear(&s);
}

/* ---- points ---- */

static void test_three_beams(void) {
  eda_field f = grating("{ source: points, points: [0, 0, 1] }", 0, 110, 300);
  assert_beams(&f, -1, 1, NULL, 110, 300);
  eda_field_clear(&f);
}

/* Test oblique light that passes only the orders 0 and -1. Out of focus, their
   phases differ by the cosines of their angles. */
static void test_two_beams(void) {
  const char *p = "{ source: points, points: [0.6, 0, 3] }";
  eda_field f = grating(p, 0, 110, 300);
  assert_beams(&f, -1, 0, NULL, 110, 300);
  eda_field_clear(&f);
  double sine[] = {(0.6 - 1 / (300 * cutoff)) * 0.75, 0.6 * 0.75};
  double waves[2];
  for (int i = 0; i < 2; i++)
    waves[i] = 120 / 193.0 * (sqrt(1 - sine[i] * sine[i]) - 1);
  f = grating(p, 120, 110, 300);
  assert_beams(&f, -1, 0, waves, 110, 300);
  eda_field_clear(&f);
}

/* Test defocus in water; the parameter and the argument of the call each
   contribute a part. */
static void test_immersion(void) {
  double waves[] = {0, 0, 0}, s = 1.2 / 1.44 / (200 * 1.2 / 193);
  waves[0] = waves[2] = 1.44 * 90 / 193.0 * (sqrt(1 - s * s) - 1);
  eda_field f = grating(
      "{ na: 1.2, index: 1.44, defocus: 50 nm, "
      "source: points, points: [0, 0, 1] }",
      40, 90, 200);
  assert_beams(&f, -1, 1, waves, 90, 200);
  eda_field_clear(&f);
}

/* Test aberrations: tilt shifts the image, coma adds opposite phases to the
   orders +-1, spherical aberration equal phases. */
static void test_aberrations(void) {
  double r = 1 / (300 * cutoff), coma = 3 * pow(r, 3) - 2 * r;
  double spherical = 6 * pow(r, 4) - 6 * r * r + 1;
  const struct {
    const char *zernike;
    double waves[3];
  } cases[] = {
      {"0, 0.1", {-0.1 * r, 0, 0.1 * r}},
      {"0, 0, 0.1", {0, 0, 0}},
      {"0, 0, 0, 0.1", {0.1 * (2 * r * r - 1), -0.1, 0.1 * (2 * r * r - 1)}},
      {"0, 0, 0, 0, 0.1", {0.1 * r * r, 0, 0.1 * r * r}},
      {"0, 0, 0, 0, 0, 0, 0.1", {-0.1 * coma, 0, 0.1 * coma}},
      {"0, 0, 0, 0, 0, 0, 0, 0, 0.1", {0.1 * spherical, 0.1, 0.1 * spherical}},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *p =
        g_strdup_printf("{ source: points, points: [0, 0, 1], zernike: [%s] }",
                        cases[i].zernike);
    eda_field f = grating(p, 0, 110, 300);
    assert_beams(&f, -1, 1, cases[i].waves, 110, 300);
    eda_field_clear(&f);
  }
}

/* Test that intensities of points add by their weights. */
static void test_points_add(void) {
  eda_field f = grating(
      "{ source: points, points: "
      "[0.6, 0, 1, -0.6, 0, 2, 0.05, 0.3, 5] }",
      0, 110, 300);
  for (double x = -150; x < 150; x += 13)
    g_assert_cmpfloat(
        fabs(value_at(&f, x, 7) - (beams(-1, 0, NULL, x, 110, 300) +
                                   2 * beams(0, 1, NULL, x, 110, 300) +
                                   5 * beams(-1, 1, NULL, x, 110, 300)) /
                                      8),
        <, 3e-5);
  eda_field_clear(&f);
}

/* Test the weights of opposite points and of points without an opposite.
   Opposite points form the same image only in focus. */
static void test_opposite(void) {
  static const struct {
    const char *points;
    double left, right, middle; /* expected weights of light by direction */
    const char *logged;
  } cases[] = {
      {"0.6, 0, 1, -0.6, 0, 1", 0.5, 0.5, 0, "2 source points in opp"},
      {"0.6, 0, 1, -0.6, 0, 3", 0.75, 0.25, 0, "2 source points\n"},
      {"0.6, 0, 1, 0, 0, 2, -0.6, 0, 1", 0.25, 0.25, 0.5, "3 source points\n"},
      {"0.6, 0, 1, -0.05, 0, 1", 0, 0.5, 0.5, "2 source points\n"}};
  static const double pitch = 300, width = 110;
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++)
    for (int defocus = 0; defocus <= 120; defocus += 120) {
      if (defocus && cases[i].middle > 0) continue;
      g_autofree char *p =
          g_strdup_printf("{ source: points, points: [%s] }", cases[i].points);
      double waves[2], sine[] = {0.6 * 0.75 - 193 / pitch, 0.6 * 0.75};
      for (int k = 0; k < 2; k++)
        waves[k] = defocus / 193.0 * (sqrt(1 - sine[k] * sine[k]) - 1);
      opc_test_forget();
      eda_field f = grating(p, defocus, width, pitch);
      g_assert_nonnull(strstr(opc_test_log(), cases[i].logged));
      for (double x = -pitch / 2; x < pitch / 2; x += 11) {
        double want = cases[i].right * beams(-1, 0, waves, x, width, pitch) +
                      cases[i].left * beams(-1, 0, waves, -x, width, pitch) +
                      cases[i].middle * beams(-1, 1, NULL, x, width, pitch);
        g_assert_cmpfloat(fabs(value_at(&f, x, 7) - want), <, 3e-5);
      }
      eda_field_clear(&f);
    }
}

/* ---- disks ---- */

/* Return the common area of two disks of radii r1 and r2 at distance d. */
static double lens(double r1, double r2, double d) {
  if (d >= r1 + r2) return 0;
  double a = acos((d * d + r1 * r1 - r2 * r2) / (2 * d * r1));
  double b = acos((d * d + r2 * r2 - r1 * r1) / (2 * d * r2));
  return r1 * r1 * (a - sin(2 * a) / 2) + r2 * r2 * (b - sin(2 * b) / 2);
}

/* Test a pitch at which the order +1 passes for one part of the source, -1 for
   another, and neither for the remainder. With sigma 1 the contrast is that of
   incoherent light. */
static void check_lens(double sigma, const char *parameters, double reach) {
  double d = 1 / (200 * cutoff);
  double part = lens(sigma, 1, d) / (M_PI * sigma * sigma);
  double c0 = order(0, 80, 200), c1 = order(1, 80, 200);
  if (sigma == 1) /* the transfer function of incoherent light, Goodman 6.4 */
    g_assert_cmpfloat(
        fabs(part - 2 / M_PI * (acos(d / 2) - d / 2 * sqrt(1 - d * d / 4))), <,
        1e-12);
  eda_field f = grating(parameters, 0, 80, 200);
  double worst = 0;
  for (double x = -100; x < 100; x += 9)
    worst = fmax(worst, fabs(value_at(&f, x, 77) -
                             (c0 * c0 + 2 * part * c1 * c1 +
                              4 * part * c0 * c1 * cos(2 * M_PI * x / 200))));
  eda_field_clear(&f);
  g_test_message("sigma %g: %.2g off", sigma, worst);
  g_assert_cmpfloat(worst, <, reach);
}

static void test_disk(void) {
  check_lens(0.75, "{}", 3e-3);
  check_lens(0.75, "{ points_across: 200 }", 5e-4);
  check_lens(1, "{ sigma: 1, points_across: 200 }", 5e-4);
}

/* Test an edge in coherent light against the sine integral, whose overshoot is
   18 %. */
static void test_edge(void) {
  g_autoptr(opc_module) m =
      prepared("litho.abbe", "{ source: points, points: [0, 0, 1] }");
  /* The odd orders next to the cutoff are equally far from the cutoff. */
  double length = 2 * round(120000 * cutoff) / cutoff, height = 300;
  eda_box half = {0, 0, (int32_t)lround(length * 5), 3000};
  eda_field f = image_boxes(m, EDA_POLY, 0, &half, 1,
                            (eda_frame){-length / 2, 0, length, height});
  double si = 0, before = 0;
  enum { STEPS = 20 }; /* steps of the integration, per nm */
  for (int x = 0; x <= 600; x++) {
    double e = 0.5 + si / M_PI, dark = 0.5 - si / M_PI;
    g_assert_cmpfloat(fabs(value_at(&f, -x, 100) - e * e), <, 5e-4);
    g_assert_cmpfloat(fabs(value_at(&f, x, 100) - dark * dark), <, 5e-4);
    before = fmax(before, e);
    for (int i = 0; i < STEPS; i++) {
      double t = 2 * M_PI * cutoff * (x + (i + 0.5) / STEPS);
      si += sin(t) / t * 2 * M_PI * cutoff / STEPS;
    }
  }
  g_assert_cmpfloat(fabs(before - 1.08949), <, 1e-4);
  eda_field_clear(&f);
}

/* ---- masks ---- */

static void test_clear(void) {
  static const char *const sources[] = {
      "{}", "{ sigma: 1, defocus: 150 nm }",
      "{ source: annular, sigma_in: 0.5, zernike: [0.3, 0, 0, 0, 0.2] }",
      "{ source: dipole, sigma: 0.9, sigma_in: 0.6, rotation: 45 deg }",
      "{ source: quasar, sigma: 0.9, sigma_in: 0.6, rotation: 45 deg }"};
  for (size_t i = 0; i < G_N_ELEMENTS(sources); i++) {
    g_autoptr(opc_module) m = prepared("litho.abbe", sources[i]);
    eda_field f =
        image_boxes(m, EDA_POLY, 0, NULL, 0, (eda_frame){0, 0, 400, 300});
    g_assert_cmpfloat(fabs(value_at(&f, 12, 34) - 1), <, 1e-5);
    eda_field_clear(&f);
  }
}

/* Test that the amplitudes of a mask and of its complement add up to 1. */
static void test_complement(void) {
  const char *p =
      "{ source: points, points: [0, 0, 1], active: { tone: dark } }";
  g_autoptr(opc_module) m = prepared("litho.abbe", p);
  eda_box line = {-550, 0, 550, 3000};
  eda_frame frame = {-150, 0, 300, 300};
  eda_field f = image_boxes(m, EDA_ACTIVE, 0, &line, 1, frame);
  double c0 = order(0, 110, 300), c1 = order(1, 110, 300);
  for (double x = -150; x < 150; x += 11) {
    double e = c0 + 2 * c1 * cos(2 * M_PI * x / 300);
    g_assert_cmpfloat(fabs(value_at(&f, x, 3) - (1 - e) * (1 - e)), <, 3e-5);
  }
  eda_field_clear(&f);
}

/* Test attenuated masks: drawn shapes transmit 6 % at several phases. */
static void test_attenuated(void) {
  double complex t = sqrt(0.06);
  for (int i = 0; i < 2; i++) {
    double phase = i ? 180 : 130;
    g_autofree char *p = g_strdup_printf(
        "{ source: points, points: [0, 0, 1], poly: { transmission: 6 %%, "
        "phase: %g deg } }",
        phase);
    double complex a = t * cexp(I * M_PI * phase / 180);
    eda_field f = grating(p, 0, 110, 300);
    for (double x = -150; x < 150; x += 11) {
      double complex e =
          order(0, 110, 300) + 2 * order(1, 110, 300) * cos(2 * M_PI * x / 300);
      e = a + (1 - a) * e;
      g_assert_cmpfloat(fabs(value_at(&f, x, 3) - creal(e * conj(e))), <, 3e-5);
    }
    eda_field_clear(&f);
  }
}

/* Test that a layer after active is imaged with the tone of poly, and active
   with its own tone. */
static void test_layers(void) {
  g_autoptr(opc_module) m =
      prepared("litho.abbe",
               "{ source: points, points: [0, 0, 1], active: { tone: dark } }");
  const eda_box line = {-550, 0, 550, 3000};
  eda_field f[3];
  for (int layer = 0; layer < 3; layer++)
    f[layer] =
        image_boxes(m, layer, 0, &line, 1, (eda_frame){-150, 0, 300, 300});
  for (double x = -150; x < 150; x += 11)
    g_assert_cmpfloat(value_at(&f[2], x, 3), ==, value_at(&f[0], x, 3));
  g_assert_cmpfloat(value_at(&f[1], 0, 3), >, value_at(&f[0], 0, 3) + 0.1);
  for (int layer = 0; layer < 3; layer++) eda_field_clear(&f[layer]);
}

/* ---- symmetries ---- */

static const eda_box two[] = {{-1300, -1700, 900, -300},
                              {100, 300, 1500, 2300}};
static const eda_frame frame = {-350, -400, 700, 800};

static void test_shift(void) {
  g_autoptr(opc_module) m = prepared("litho.abbe",
                                     "{ points_across: 12, defocus: 60 nm, "
                                     "zernike: [0, 0, 0, 0, 0, 0, 0.05] }");
  eda_box moved[2];
  for (int i = 0; i < 2; i++)
    moved[i] = (eda_box){two[i].x0 + 137, two[i].y0 - 211, two[i].x1 + 137,
                         two[i].y1 - 211};
  eda_field a = image_boxes(m, EDA_POLY, 0, two, 2, frame);
  eda_field b = image_boxes(m, EDA_POLY, 0, moved, 2, frame);
  for (int i = 0; i < 60; i++) {
    double x = 11.3 * i - 340, y = 390 - 12.7 * i;
    g_assert_cmpfloat(
        fabs(value_at(&a, x, y) - value_at(&b, x + 13.7, y - 21.1)), <, 3e-5);
  }
  eda_field_clear(&a);
  eda_field_clear(&b);
}

static void test_defocus(void) {
  g_autoptr(opc_module) m = prepared("litho.abbe", "{ points_across: 12 }");
  g_autoptr(opc_module) given =
      prepared("litho.abbe", "{ points_across: 12, defocus: -100 nm }");
  eda_field focus = image_boxes(m, EDA_POLY, 0, two, 2, frame);
  eda_field above = image_boxes(m, EDA_POLY, 100, two, 2, frame);
  eda_field below = image_boxes(given, EDA_POLY, 0, two, 2, frame);
  double change = 0;
  for (int i = 0; i < 60; i++) {
    double x = 11.3 * i - 340, y = 390 - 12.7 * i;
    g_assert_cmpfloat(fabs(value_at(&above, x, y) - value_at(&below, x, y)), <,
                      3e-5);
    change =
        fmax(change, fabs(value_at(&focus, x, y) - value_at(&above, x, y)));
  }
  g_assert_cmpfloat(change, >, 0.02);
  eda_field_clear(&focus);
  eda_field_clear(&above);
  eda_field_clear(&below);
}

/* ---- Hopkins ---- */

/* Return the largest absolute difference of two images. */
static double difference(const eda_field *a, const eda_field *b) {
  double worst = 0;
  for (int i = 0; i < 400; i++) {
    double x = 350 - fmod(1.7 * 211.3 * i, 700), y = 2 * i - 400;
    worst = fmax(worst, fabs(value_at(a, x, y) - value_at(b, x, y)));
  }
  return worst;
}

static void test_hopkins(void) {
  g_autoptr(opc_module) hopkins = prepared("litho.hopkins", "{ kernels: 530 }");
  eda_field want = image_boxes(hopkins, EDA_POLY, 0, two, 2, frame);
  double first = 0, last = 0;
  for (int across = 9; across <= 144; across *= 2) {
    g_autofree char *p = g_strdup_printf("{ points_across: %d }", across);
    g_autoptr(opc_module) abbe = prepared("litho.abbe", p);
    eda_field got = image_boxes(abbe, EDA_POLY, 0, two, 2, frame);
    last = difference(&want, &got);
    if (across == 9) first = last;
    g_test_message("%3d points across: %.2g off litho.hopkins", across, last);
    g_assert_cmpfloat(last, <, 0.25 / across + 3e-4);
    eda_field_clear(&got);
  }
  g_assert_cmpfloat(last, <, 5e-4);
  g_assert_cmpfloat(last, <, first / 5);
  eda_field_clear(&want);
}

static void test_refused(void) {
  static const struct {
    const char *parameters, *at;
  } cases[] = {
      {"{ na: 1.1 }", "na"},
      {"{ na: 1.35, index: 1.3 }", "na"},
      {"{ source: annular }", "sigma_in"},
      {"{ source: annular, sigma_in: 0.75 }", "sigma_in"},
      {"{ sigma_in: 0.2 }", "sigma_in"},
      {"{ source: annular, sigma_in: 0.2, opening: 20 deg }", "opening"},
      {"{ rotation: 20 deg }", "rotation"},
      {"{ source: points }", "points"},
      {"{ source: points, points: [] }", "points"},
      {"{ source: points, points: [0, 0] }", "points"},
      {"{ source: points, points: [0, 0, -1] }", "points"},
      {"{ source: points, points: [0, 0, 0] }", "points"},
      {"{ source: points, points: [0.8, 0.7, 1] }", "points"},
      {"{ source: points, points: [0, 0, 1], sigma: 0.5 }", "sigma"},
      {"{ source: points, points: [0, 0, 1], points_across: 5 }",
       "points_across"},
      {"{ points: [0, 0, 1] }", "points"},
      {"{ zernike: [] }", "zernike"},
      {"{ zernike: [0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0,0,0, "
       "0,0,0,0,0,0,0,0,0,0, 0,0,0,0,0,0,0,0] }",
       "zernike"},
      {"{ sigma: 1.1 }", "sigma"},
      {"{ sigma: 0 }", "sigma"},
      {"{ index: 0.9 }", "index"},
      {"{ poly: { transmission: 120 % } }", "poly.transmission"},
  };
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error = {0};
    g_assert_null(opc_test_module("litho.abbe", cases[i].parameters, &error));
    g_test_message("%s", error.message);
    g_autofree char *at = g_strdup_printf("'%s'", cases[i].at);
    g_assert_nonnull(strstr(error.message, at));
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  host = opc_test_host();
  g_test_add_func("/abbe/rectangles", test_rectangles);
  g_test_add_func("/abbe/polygon", test_polygon);
  g_test_add_func("/abbe/three-beams", test_three_beams);
  g_test_add_func("/abbe/two-beams", test_two_beams);
  g_test_add_func("/abbe/immersion", test_immersion);
  g_test_add_func("/abbe/aberrations", test_aberrations);
  g_test_add_func("/abbe/points-add", test_points_add);
  g_test_add_func("/abbe/opposite", test_opposite);
  g_test_add_func("/abbe/disk", test_disk);
  g_test_add_func("/abbe/edge", test_edge);
  g_test_add_func("/abbe/clear-field", test_clear);
  g_test_add_func("/abbe/complement", test_complement);
  g_test_add_func("/abbe/attenuated", test_attenuated);
  g_test_add_func("/abbe/layers", test_layers);
  g_test_add_func("/abbe/shift", test_shift);
  g_test_add_func("/abbe/defocus", test_defocus);
  g_test_add_func("/abbe/turned", test_turned);
  g_test_add_func("/abbe/hopkins", test_hopkins);
  g_test_add_func("/abbe/refused", test_refused);
  return g_test_run();
}
