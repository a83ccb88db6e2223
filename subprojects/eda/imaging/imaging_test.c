/* SPDX-License-Identifier: BSD-3-Clause */
/* Spectra, compared with Fourier integrals of rectangles; images, compared with
   sums of plane waves; contours, compared with closed forms. */
#include "imaging/edge.h"

#include <complex.h>
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stddef.h>
#include <string.h>
#include <sys/resource.h>

#include "testing/testing.h"

static const opc_context *context; /* a context with several threads */

/* ---- spectra ---- */

/* Return the Fourier coefficient of the coverage of a rectangle. */
static double complex rectangle(eda_box b, double grid, eda_frame f, int k,
                                int l) {
  double complex side[2];
  double low[2] = {b.x0 * grid - f.x0, b.y0 * grid - f.y0};
  double high[2] = {b.x1 * grid - f.x0, b.y1 * grid - f.y0};
  double period[2] = {f.width, f.height};
  int order[2] = {k, l};
  for (int a = 0; a < 2; a++) {
    double complex w = -2 * M_PI * I * order[a] / period[a];
    side[a] = order[a] ? (cexp(w * high[a]) - cexp(w * low[a])) / w
                       : high[a] - low[a];
    side[a] /= period[a];
  }
  return side[0] * side[1];
}

static double worst_coefficient(const eda_shapes *shapes, const eda_box *boxes,
                                const double *sign, size_t n, double grid,
                                eda_frame f, double band) {
  eda_spectrum s;
  opc_error error;
  g_assert_cmpint(eda_mask_spectrum(context, shapes, grid, f, band, &s, &error),
                  ==, OPC_OK);
  double worst = 0;
  int half = (s.rows - 1) / 2;
  const float complex *a = (const float complex *)s.data;
  for (int l = -half; l <= half; l++)
    for (int k = 0; k < s.columns; k++) {
      double complex want = k || l ? 0 : 1;
      for (size_t i = 0; i < n; i++)
        want -= sign[i] * rectangle(boxes[i], grid, f, k, l);
      if (hypot(k / f.width, l / f.height) > band) want = 0;
      double complex got = a[(size_t)((l + s.rows) % s.rows) * s.columns + k];
      worst = fmax(worst, cabs(got - want));
    }
  eda_spectrum_clear(&s);
  return worst;
}

static void test_spectrum(void) {
  /* An L, a rectangle with a hole, and a shape that crosses the frame. */
  eda_point points[] = {{100, 100},   {700, 100},  {700, 300},   {300, 300},
                        {300, 900},   {100, 900},  {900, 500},   {1500, 500},
                        {1500, 1100}, {900, 1100}, {1000, 600},  {1000, 900},
                        {1300, 900},  {1300, 600}, {1900, 1200}, {2300, 1200},
                        {2300, 1900}, {1900, 1900}};
  uint32_t start[] = {0, 6, 10, 14, 18};
  uint8_t hole[] = {0, 0, 1, 0};
  eda_shapes shapes = {4, start, points, hole};
  eda_box boxes[] = {{100, 100, 700, 300},
                     {100, 300, 300, 900},
                     {900, 500, 1500, 1100},
                     {1000, 600, 1300, 900},
                     {1900, 1200, 2300, 1900}};
  double sign[] = {1, 1, 1, -1, 1};
  eda_frame f = {13, -20, 2000, 1700};
  double worst = worst_coefficient(&shapes, boxes, sign, 5, 1, f, 0.0068);
  g_test_message("largest error of a coefficient: %.2g", worst);
  g_assert_cmpfloat(worst, <, 1e-5);
  /* The same shapes in other units, moved by whole periods. */
  eda_point moved[18];
  for (int i = 0; i < 18; i++)
    moved[i] = (eda_point){2 * (points[i].x + 4000), 2 * (points[i].y - 1700)};
  shapes.points = moved;
  for (int i = 0; i < 5; i++)
    boxes[i] = (eda_box){2 * (boxes[i].x0 + 4000), 2 * (boxes[i].y0 - 1700),
                         2 * (boxes[i].x1 + 4000), 2 * (boxes[i].y1 - 1700)};
  worst = worst_coefficient(&shapes, boxes, sign, 5, 0.5,
                            (eda_frame){6.5, -10, 1000, 850}, 0.0068);
  g_assert_cmpfloat(worst, <, 1e-5);
}

/* Results are zeroed. */
static void test_bad_frame(void) {
  const eda_spectrum zero = {0};
  eda_shapes none = {0};
  eda_spectrum s;
  opc_error error;
  memset(&s, 1, sizeof s);
  int code = eda_mask_spectrum(context, &none, 1, (eda_frame){0, 0, 0, 100},
                               0.007, &s, &error);
  g_assert_cmpint(code, ==, OPC_INVALID);
  g_assert_cmpmem(&s, sizeof s, &zero, sizeof zero);
  memset(&s, 1, sizeof s);
  code = eda_mask_spectrum(context, &none, 1, (eda_frame){0, 0, 1e9, 1e9},
                           0.007, &s, &error);
  g_assert_cmpint(code, ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "too large"));
  g_assert_cmpmem(&s, sizeof s, &zero, sizeof zero);
}

/* ---- images ---- */

/* A pupil of radius 0.004 / nm, shifted by 0.001 * s along x. */
static void shifted_pupil(const void *self, size_t s, const double *fx,
                          double fy, size_t n, float *out) {
  (void)self;
  for (size_t i = 0; i < n; i++) {
    double x = fx[i] + 0.001 * (double)s;
    out[2 * i] = x * x + fy * fy <= 0.004 * 0.004 ? 1 : 0;
    out[2 * i + 1] = 0;
  }
}

static const double three_weights[] = {0.5, 0.3, 0.2};
static const eda_kernels three = {.count = 3,
                                  .weight = three_weights,
                                  .band = 0.006,
                                  .intensity_band = 0.008,
                                  .transfer = shifted_pupil};

/* Return the intensity by its definition, in double precision. */
static double direct(eda_box b, eda_frame f, double x, double y) {
  double intensity = 0;
  int kmax = (int)(0.007 * f.width), lmax = (int)(0.005 * f.height);
  for (int s = 0; s < 3; s++) {
    double complex field = 0;
    for (int l = -lmax; l <= lmax; l++)
      for (int k = -kmax; k <= kmax; k++) {
        double shifted = k / f.width + 0.001 * s, fy = l / f.height;
        if (shifted * shifted + fy * fy > 0.004 * 0.004) continue;
        double complex a = (k || l ? 0 : 1) - rectangle(b, 1, f, k, l);
        field += a * cexp(2 * M_PI * I *
                          (k * (x - f.x0) / f.width + fy * (y - f.y0)));
      }
    double absolute = cabs(field);
    intensity += three_weights[s] * absolute * absolute;
  }
  return intensity;
}

static void image_of(eda_box b, eda_frame f, eda_field *field) {
  eda_point points[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  uint32_t start[] = {0, 4};
  eda_shapes shape = {1, start, points, NULL};
  eda_spectrum s;
  opc_error error;
  g_assert_cmpint(eda_mask_spectrum(context, &shape, 1, f, 0.0065, &s, &error),
                  ==, OPC_OK);
  g_assert_cmpint(eda_coherent_sum(context, &s, &three, 0, field, &error), ==,
                  OPC_OK);
  eda_spectrum_clear(&s);
}

static void test_image(void) {
  eda_box b = {-150, -400, 90, 333};
  eda_frame f = {-803, -1000, 1700, 1900};
  eda_field field;
  image_of(b, f, &field);
  GRand *random = g_rand_new_with_seed(7);
  double worst = 0;
  for (int i = 0; i < 300; i++) {
    double x = g_rand_double_range(random, -400, 400);
    double y = g_rand_double_range(random, -2600, 600), got;
    eda_field_sample(&field, &x, &y, 1, &got);
    worst = fmax(worst, fabs(got - direct(b, f, x, y)));
  }
  g_test_message("largest error of intensity: %.2g", worst);
  g_assert_cmpfloat(worst, <, 3e-5);
  /* Lines through the field equal its samples. */
  for (int axis = 0; axis < 2; axis++) {
    double at = axis ? 61.5 : -213.25, value;
    eda_line line;
    eda_line_search down, up;
    eda_line_make(&field, axis, at, &line);
    for (int i = 0; i <= 80; i++) {
      double p = 12.5 * i - 700;
      double x = axis ? at : p, y = axis ? p : at;
      eda_field_sample(&field, &x, &y, 1, &value);
      g_assert_cmpfloat(fabs(eda_line_start(&line, p, &down, &up) - value), <,
                        1e-12);
    }
  }
  g_rand_free(random);
  eda_field_clear(&field);
}

/* Frames long enough for spectra in several strips. */
static void test_strips(void) {
  static const eda_frame frames[] = {{-803, -1000, 23000, 600},
                                     {-803, -1000, 600, 23000}};
  eda_box b = {-150, -700, -90, -633};
  for (size_t i = 0; i < G_N_ELEMENTS(frames); i++) {
    eda_field field;
    image_of(b, frames[i], &field);
    double worst = 0;
    for (int p = 0; p < 100; p++) {
      double x = -400 + 5.7 * p, y = -900 + 4.3 * p, got;
      eda_field_sample(&field, &x, &y, 1, &got);
      worst = fmax(worst, fabs(got - direct(b, frames[i], x, y)));
    }
    g_test_message("largest error of intensity: %.2g", worst);
    g_assert_cmpfloat(worst, <, 3e-5);
    eda_field_clear(&field);
  }
}

/* The pupil, shifted off axis by an eighth of the band and defocused: the field
   is complex. */
static void off_axis(const void *self, size_t s, const double *fx, double fy,
                     size_t n, float *out) {
  double band = *(const double *)self;
  (void)s;
  for (size_t i = 0; i < n; i++) {
    double u = fx[i] / band, v = fy / band,
           r = (u - 0.125) * (u - 0.125) + v * v;
    out[2 * i] = r < 0.75 ? (float)cos(3 * r) : 0;
    out[2 * i + 1] = r < 0.75 ? (float)sin(3 * r) : 0;
  }
}

/* Return the intensity of E, or of E + c times the field of the clear mask. */
static eda_field coherent(const eda_shapes *s, eda_frame f, float complex c) {
  static const double band = 0.0066, weight = 1;
  eda_kernels one = {.count = 1,
                     .weight = &weight,
                     .band = band,
                     .intensity_band = 2 * band,
                     .transfer = off_axis,
                     .self = &band,
                     .offset = {crealf(c), cimagf(c)},
                     .scale = {1, 0}};
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  g_assert_cmpint(eda_mask_spectrum(context, s, 1, f, band, &mask, &error), ==,
                  OPC_OK);
  g_assert_cmpint(eda_coherent_sum(context, &mask, &one, 0, &field, &error), ==,
                  OPC_OK);
  eda_spectrum_clear(&mask);
  return field;
}

/* Compute the complex field E from three intensities, |E|^2, |E + q|^2 and |E +
   iq|^2. q is the field of the clear mask, with |q| = 1. */
static void find_field(const eda_shapes *s, eda_frame f, const double *x,
                       const double *y, size_t n, double complex *out) {
  static const float complex add[3] = {0, 1, I};
  double *value[3];
  for (int k = 0; k < 3; k++) {
    eda_field field = coherent(s, f, add[k]);
    value[k] = g_new(double, n);
    eda_field_sample(&field, x, y, n, value[k]);
    eda_field_clear(&field);
  }
  for (size_t i = 0; i < n; i++) {
    double re = (value[1][i] - value[0][i] - 1) / 2;
    double im = (value[2][i] - value[0][i] - 1) / 2;
    out[i] = re + I * im; /* E q*, |q| = 1 */
  }
  for (int k = 0; k < 3; k++) g_free(value[k]);
}

/* Fields are linear: the fields blocked by two masks add up. */
static void test_linear(void) {
  enum { PLACES = 200 };
  eda_point points[] = {{300, 100}, {420, 100}, {420, 800}, {300, 800},
                        {520, 250}, {900, 250}, {900, 420}, {520, 420}};
  uint32_t start[] = {0, 4, 8};
  eda_shapes none = {0}, both = {2, start, points, NULL};
  eda_shapes first = {1, start, points, NULL},
             second = {1, start, points + 4, NULL};
  eda_frame f = {0, 0, 13000, 1100};
  double x[PLACES], y[PLACES], worst = 0, most = 0;
  for (int i = 0; i < PLACES; i++) {
    x[i] = 100 + 5.3 * i;
    y[i] = 50 + fmod(137.7 * i, 1000);
  }
  double complex clear[PLACES], a[PLACES], b[PLACES], all[PLACES];
  find_field(&none, f, x, y, PLACES, clear);
  find_field(&first, f, x, y, PLACES, a);
  find_field(&second, f, x, y, PLACES, b);
  find_field(&both, f, x, y, PLACES, all);
  for (int i = 0; i < PLACES; i++) {
    worst = fmax(worst, cabs(a[i] + b[i] - clear[i] - all[i]));
    most = fmax(most, fabs(cimag(all[i])));
  }
  g_test_message("fields are %.2g off, their imaginary part up to %.2g", worst,
                 most);
  g_assert_cmpfloat(worst, <, 5e-5);
  g_assert_cmpfloat(most, >, 0.05);
}

/* Kernels R(f) exp(i order angle). For the first three kernels, R is real or
   the order is 0. The last two kernels have the same complex R. */
static const int orders[] = {0, 1, 2, 3, -3};
static const double spiral_weights[] = {0.4, 0.2, 0.1, 0.2, 0.1};

static void spiral(const void *self, size_t s, const double *fx, double fy,
                   size_t n, float *out) {
  const int *quarter = self;
  for (size_t i = 0; i < n; i++) {
    if (*quarter) g_assert_true(fx[i] >= 0 && fy >= 0);
    double r = hypot(fx[i], fy) / 0.006, angle = orders[s] * atan2(fy, fx[i]);
    double complex c = r <= 1 ? cexp(I * angle) * (1 - r * r / 2) : 0;
    if (s == 0 || s > 2) c *= cexp(I * 2 * r);
    if (orders[s] && r == 0) c = 0;
    out[2 * i] = (float)creal(c);
    out[2 * i + 1] = (float)cimag(c);
  }
}

static eda_mirrored spiral_mirror(const void *self, size_t s) {
  (void)self;
  return (eda_mirrored){.kernel = s > 2 ? 7 - s : s,
                        .conjugate = s == 1 || s == 2,
                        .odd = orders[s] % 2 != 0};
}

/* Images from one quadrant of the transfer functions and their mirror symmetry
   equal images from all quadrants. */
static void test_mirrored(void) {
  const struct {
    double offset[2], scale[2];
  } masks[] = {{{0, 0}, {1, 0}}, {{-0.1, 0.2}, {0.9, -0.3}}};
  eda_point points[] = {{300, 100}, {420, 100}, {420, 800}, {300, 800},
                        {520, 250}, {900, 250}, {900, 420}, {520, 420}};
  uint32_t start[] = {0, 4, 8};
  eda_shapes shapes = {2, start, points, NULL};
  eda_spectrum mask;
  opc_error error;
  g_assert_cmpint(
      eda_mask_spectrum(context, &shapes, 1, (eda_frame){0, 0, 12100, 1900},
                        0.006, &mask, &error),
      ==, OPC_OK);
  for (size_t k = 0; k < G_N_ELEMENTS(masks); k++) {
    eda_field field[2];
    for (int quarter = 0; quarter < 2; quarter++) {
      eda_kernels all = {.count = G_N_ELEMENTS(orders),
                         .weight = spiral_weights,
                         .band = 0.006,
                         .intensity_band = 0.012,
                         .transfer = spiral,
                         .self = &quarter,
                         .mirror = quarter ? spiral_mirror : NULL};
      memcpy(all.offset, masks[k].offset, sizeof all.offset);
      memcpy(all.scale, masks[k].scale, sizeof all.scale);
      g_assert_cmpint(
          eda_coherent_sum(context, &mask, &all, 0, &field[quarter], &error),
          ==, OPC_OK);
    }
    double worst = 0;
    for (int i = 0; i < field[0].nx * field[0].ny; i++)
      worst = fmax(worst, fabs((double)field[0].coefficients[i] -
                               (double)field[1].coefficients[i]));
    g_test_message("mirrored kernels are %.2g off", worst);
    g_assert_cmpfloat(worst, <, 3e-6);
    for (int i = 0; i < 2; i++) eda_field_clear(&field[i]);
  }
  eda_spectrum_clear(&mask);
}

static void test_threads(void) {
  eda_box b = {-150, -400, 90, 333};
  eda_frame f = {-1000, -1000, 2100, 2200};
  eda_field one, other;
  const opc_context *several = context;
  context = NULL;
  image_of(b, f, &one);
  context = several;
  for (unsigned threads = 2; threads <= 4; threads++) {
    const opc_context *some = context = eda_test_context_new(threads);
    image_of(b, f, &other);
    context = several;
    eda_test_context_free(some);
    g_assert_cmpmem(one.coefficients, sizeof(float) * one.nx * one.ny,
                    other.coefficients, sizeof(float) * other.nx * other.ny);
    eda_field_clear(&other);
  }
  eda_field_clear(&one);
}

/* ---- contours ---- */

/* Return the spline through f(x, y) = cos + cos + level over one period in each
   direction. */
static eda_field waves(double level) {
  eda_field field = {.frame = {0, 0, 1000, 1000}, .nx = 40, .ny = 40};
  field.coefficients = eda_alloc(1600, sizeof(float));
  double scale = eda_spline_sampled(1.0 / 40);
  for (int j = 0; j < 40; j++)
    for (int i = 0; i < 40; i++)
      field.coefficients[40 * j + i] =
          (float)(level + (cos(M_PI * i / 20) + cos(M_PI * j / 20)) / scale);
  return field;
}

static double area_of(const double *p, size_t n) {
  double sum = 0;
  for (size_t i = 0; i < n; i++) {
    const double *a = p + 2 * i, *b = p + 2 * ((i + 1) % n);
    sum += a[0] * b[1] - a[1] * b[0];
  }
  return sum / 2;
}

static void test_contours(void) {
  /* The function has its minimum at the middle: a hole, traced clockwise. */
  eda_field field = waves(1.9);
  double *points;
  uint32_t *start;
  size_t count;
  opc_error error;
  eda_frame window = {250, 250, 500, 500};
  g_assert_cmpint(
      eda_contours(NULL, &field, window, 5, &points, &start, &count, &error),
      ==, OPC_OK);
  g_assert_cmpuint(count, ==, 2); /* border of the window and the hole */
  double border = area_of(points, start[1]);
  const double *hole = points + 2 * start[1];
  size_t n = start[2] - start[1];
  if (border < 0) {
    border = area_of(hole, n);
    hole = points;
    n = start[1];
  }
  g_assert_cmpfloat(fabs(border - 250000), <, 1e-6);
  double want = 0; /* area where cos a + cos b < -1.9, by integration */
  for (int i = 0; i < 20000; i++) {
    double x = 250 + (i + 0.5) / 40, c = -1.9 - cos(M_PI * x / 500);
    if (c > -1) want += 2 * (500 - acos(c) * 500 / M_PI) / 40;
  }
  g_test_message("area of the hole %.3f, integral %.3f", -area_of(hole, n),
                 want);
  g_assert_cmpfloat(fabs(-area_of(hole, n) / want - 1), <, 0.003);
  for (size_t i = 0; i < n; i++) {
    double v =
        cos(M_PI * hole[2 * i] / 500) + cos(M_PI * hole[2 * i + 1] / 500);
    g_assert_cmpfloat(fabs(v + 1.9), <, 2e-5);
  }
  free(points);
  free(start);
  free(field.coefficients);
}

/* sin x sin y + level has saddle points where both sines are 0, in the middle
   of a square. Between the saddle points are 5 x 5 regions: 13 are positive,
   and 4 of the negative regions are inside. For a positive level, the positive
   regions are connected and have 4 holes. For a negative level, they are
   separate. */
static void test_saddles(void) {
  const eda_frame window = {-247.5, -247.5, 2000, 2000};
  double scale = eda_spline_sampled(1.0 / 40) * eda_spline_sampled(1.0 / 40);
  for (int sign = -1; sign <= 1; sign += 2) {
    eda_field field = waves(0);
    for (int j = 0; j < 40; j++)
      for (int i = 0; i < 40; i++)
        field.coefficients[40 * j + i] =
            (float)(1e-4 * sign +
                    sin(M_PI * i / 20) * sin(M_PI * j / 20) / scale);
    double *points;
    uint32_t *start;
    size_t count;
    opc_error error;
    g_assert_false(
        eda_contours(NULL, &field, window, 5, &points, &start, &count, &error));
    g_assert_cmpuint(count, ==, sign > 0 ? 1 + 4 : 13);
    free(points);
    free(start);
    free(field.coefficients);
  }
}

/* Contours that cross many strips are equal for any number of threads. Their
   area equals the area from a million samples. */
static void test_contours_in_strips(void) {
  eda_field field = waves(-0.3);
  eda_frame window = {-130, 70, 1900, 1700};
  double *points[2], area = 0, v, x, y;
  uint32_t *start[2];
  size_t count[2], inside = 0;
  opc_error error;
  for (int k = 0; k < 2; k++)
    g_assert_false(eda_contours(k ? context : NULL, &field, window, 3,
                                &points[k], &start[k], &count[k], &error));
  g_assert_cmpuint(count[0], ==, count[1]);
  size_t n = start[0][count[0]];
  g_assert_cmpmem(start[0], (count[0] + 1) * sizeof **start, start[1],
                  (count[1] + 1) * sizeof **start);
  g_assert_cmpmem(points[0], 2 * n * sizeof **points, points[1],
                  2 * n * sizeof **points);
  for (size_t i = 0; i < count[0]; i++)
    area += area_of(points[0] + 2 * (size_t)start[0][i],
                    start[0][i + 1] - start[0][i]);
  for (int i = 0; i < 1000000; i++) {
    int row = i / 1000;
    x = window.x0 + (i % 1000 + 0.5) * 1.9;
    y = window.y0 + (row + 0.5) * 1.7;
    eda_field_sample(&field, &x, &y, 1, &v);
    inside += v > 0;
  }
  g_test_message("%zu lines, area %.0f, by places %.0f", count[0], area,
                 (double)inside * 1.9 * 1.7);
  g_assert_cmpfloat(fabs(area / ((double)inside * 1.9 * 1.7) - 1), <, 2e-4);
  for (int k = 0; k < 2; k++) {
    free(points[k]);
    free(start[k]);
  }
  free(field.coefficients);
}

/* ---- memory ---- */

/* The memory forecast of an image, compared with the growth of a separate
   process that computes larger and larger images. */
static void test_forecast(void) {
#ifdef __SANITIZE_ADDRESS__
  g_test_skip("the sanitizer uses additional memory");
  return;
#endif
  if (!g_test_subprocess()) {
    g_test_trap_subprocess(NULL, 0, G_TEST_SUBPROCESS_INHERIT_STDERR);
    g_test_trap_assert_passed();
    return;
  }
  const eda_box box = {1000, 1000, 1130, 5000};
  struct rusage before, after;
  eda_field field;
  image_of(box, (eda_frame){0, 0, 8000, 8000}, &field);
  eda_field_clear(&field);
  getrusage(RUSAGE_SELF, &before);
  for (double side = 4e4; side < 2.5e5; side *= 1.5) {
    eda_frame f = {0, 0, side, side};
    image_of(box, f, &field);
    getrusage(RUSAGE_SELF, &after);
    double grown = 1024.0 * (double)(after.ru_maxrss - before.ru_maxrss);
    double forecast = eda_image_forecast(f, 0.0065).bytes;
    g_test_message("%g um: %g MB, forecast %g MB", side * 1e-3, grown * 1e-6,
                   forecast * 1e-6);
    /* The forecast assumes groups of four kernels, but the image has three. The
       scratch arrays of the threads, which are not in the forecast, amount to
       half of the smallest image. */
    g_assert_cmpfloat(forecast, <=, 1.3 * grown);
    g_assert_cmpfloat(forecast, >=, 0.7 * grown);
    eda_field_clear(&field);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  context = eda_test_context_new(4);
  g_test_add_func("/imaging/spectrum", test_spectrum);
  g_test_add_func("/imaging/bad-frame", test_bad_frame);
  g_test_add_func("/imaging/image", test_image);
  g_test_add_func("/imaging/strips", test_strips);
  g_test_add_func("/imaging/linear", test_linear);
  g_test_add_func("/imaging/mirrored", test_mirrored);
  g_test_add_func("/imaging/threads", test_threads);
  g_test_add_func("/imaging/contours", test_contours);
  g_test_add_func("/imaging/contours/saddles", test_saddles);
  g_test_add_func("/imaging/contours/strips", test_contours_in_strips);
  g_test_add_func("/imaging/forecast", test_forecast);
  int failed = g_test_run();
  eda_test_context_free(context);
  return failed;
}
