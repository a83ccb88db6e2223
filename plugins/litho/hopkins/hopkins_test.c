/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of images against the definition: Hopkins' double sum over the
   frequencies of a small frame, with T integrated by strips. */
#include <complex.h>
#include <eda/gates.h>
#include <eda/litho.h>
#include <math.h>
#include <string.h>

#include "../image_test.h"

static const double wavelength = 193, na = 0.75, sigma = 0.75;
static const eda_frame frame = {-350, -400, 700, 800};

/* Find the part of a horizontal strip at y inside a disk. */
static void chord(double cx, double cy, double r, double y, double *from,
                  double *to) {
  double h = r * r - (y - cy) * (y - cy), half = h > 0 ? sqrt(h) : -1;
  *from = fmax(*from, cx - half);
  *to = half < 0 ? -INFINITY : fmin(*to, cx + half);
}

/* Return T(f1, f2), the common area of the source and both pupils; frequencies
   in units of the cutoff. */
static double cross_coefficient(double x1, double y1, double x2, double y2) {
  enum { STRIPS = 3000 };
  double area = 0;
  for (int i = 0; i < STRIPS; i++) {
    double y = sigma * ((i + 0.5) * 2 / STRIPS - 1);
    double from = -INFINITY, to = INFINITY;
    chord(0, 0, sigma, y, &from, &to);
    chord(-x1, -y1, 1, y, &from, &to);
    chord(-x2, -y2, 1, y, &from, &to);
    if (to > from) area += (to - from) * 2 * sigma / STRIPS;
  }
  return area / (M_PI * sigma * sigma);
}

/* Compute the intensity of an opaque rectangle at (x, y) by the double sum. */
static void image_direct(eda_box b, const double *x, const double *y, size_t n,
                         double *out) {
  enum { MOST = 200 };
  double fx[MOST], fy[MOST];
  double complex a[MOST];
  size_t orders = 0;
  double cutoff = na / wavelength;
  for (int l = -6; l <= 6; l++)
    for (int k = -6; k <= 6; k++) {
      double u = k / frame.width / cutoff, v = l / frame.height / cutoff;
      if (hypot(u, v) > 1 + sigma) continue;
      double side[2] = {
          k ? sin(M_PI * k * (b.x1 - b.x0) / frame.width) / (M_PI * k)
            : (b.x1 - b.x0) / frame.width,
          l ? sin(M_PI * l * (b.y1 - b.y0) / frame.height) / (M_PI * l)
            : (b.y1 - b.y0) / frame.height};
      double phase = -M_PI * (k * (b.x0 + b.x1) / frame.width +
                              l * (b.y0 + b.y1) / frame.height);
      g_assert_cmpuint(orders, <, MOST);
      fx[orders] = u;
      fy[orders] = v;
      a[orders++] = (k || l ? 0 : 1) - side[0] * side[1] * cexp(I * phase);
    }
  for (size_t i = 0; i < n; i++) out[i] = 0;
  for (size_t p = 0; p < orders; p++)
    for (size_t q = 0; q < orders; q++) {
      double t = cross_coefficient(fx[p], fy[p], fx[q], fy[q]);
      if (t == 0) continue;
      for (size_t i = 0; i < n; i++)
        out[i] +=
            creal(t * a[p] * conj(a[q]) *
                  cexp(2 * M_PI * I * cutoff *
                       ((fx[p] - fx[q]) * x[i] + (fy[p] - fy[q]) * y[i])));
    }
}

/* Compute the image with the model's own error, or with error `wanted` if
   positive. */
static void image_within(double wanted, const char *parameters,
                         const eda_shapes *shapes, eda_frame f,
                         eda_field *field) {
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("litho.hopkins", parameters, &error);
  g_assert_nonnull(m);
  const eda_litho *litho = m->functions;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  const opc_host *host = opc_test_host();
  eda_spectrum mask;
  g_assert_cmpint(eda_mask_spectrum(host->context, shapes, 1, f,
                                    litho->band(m->self), &mask, &error),
                  ==, OPC_OK);
  int code = wanted > 0 ? litho->image_fine(m->self, 0, &mask, 0, wanted, field,
                                            &error)
                        : litho->image(m->self, 0, &mask, field, &error);
  g_assert_cmpint(code, ==, OPC_OK);
  eda_spectrum_clear(&mask);
}

static void hopkins_image(const char *parameters, const eda_shapes *shapes,
                          eda_frame f, eda_field *field) {
  image_within(0, parameters, shapes, f, field);
}

static void test_definition(void) {
  enum { PLACES = 40 };
  eda_box b = {-130, -170, 90, 230};
  double x[PLACES], y[PLACES], want[PLACES], got[PLACES];
  GRand *random = g_rand_new_with_seed(3);
  for (int i = 0; i < PLACES; i++) {
    x[i] = g_rand_double_range(random, -350, 350);
    y[i] = g_rand_double_range(random, -400, 400);
  }
  g_rand_free(random);
  image_direct(b, x, y, PLACES, want);
  eda_point points[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  uint32_t start[] = {0, 4};
  eda_shapes shapes = {1, start, points, NULL};
  const struct {
    const char *parameters;
    double reach, fine;
  } cases[] = {{"{ kernels: 2 }", 1e-2, 0},
               {"{ error: 4e-3 }", 4e-3, 0},
               {"{}", 1.5e-3, 0},
               {"{ kernels: 2 }", 5e-4, 5e-4},
               {"{ error: 1e-4 }", 1e-4, 0}};
  double before = 1;
  for (size_t c = 0; c < G_N_ELEMENTS(cases); c++) {
    eda_field field;
    image_within(cases[c].fine, cases[c].parameters, &shapes, frame, &field);
    eda_field_sample(&field, x, y, PLACES, got);
    eda_field_clear(&field);
    double worst = 0, mean = 0;
    for (int i = 0; i < PLACES; i++) {
      worst = fmax(worst, fabs(got[i] - want[i]));
      mean += (got[i] - want[i]) / PLACES;
    }
    g_test_message("%s: largest error %.2g, mean %.2g", cases[c].parameters,
                   worst, mean);
    g_assert_cmpfloat(worst, <, cases[c].reach);
    g_assert_cmpfloat(worst, <, before);
    before = worst;
  }
}

/* Test a line as long as its frame. Its image is computed from T itself at any
   requested error. Compare with the definition, and for an attenuated mask with
   the kernels. */
static void test_lines(void) {
  if (opc_test_sanitized_skip()) return;
  enum { PLACES = 40 };
  eda_box b = {-130, -400, 90, 400};
  double x[PLACES], y[PLACES], want[PLACES], got[PLACES];
  for (int i = 0; i < PLACES; i++) {
    x[i] = -350 + 17.5 * i;
    y[i] = 13 * i - 300;
  }
  image_direct(b, x, y, PLACES, want);
  eda_point points[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  uint32_t start[] = {0, 4};
  eda_shapes shapes = {1, start, points, NULL};
  static const char shifting[] = "poly: { transmission: 6 % }";
  for (int attenuated = 0; attenuated < 2; attenuated++) {
    g_autofree char *rough =
        g_strdup_printf("{ kernels: 3, %s }", attenuated ? shifting : "");
    g_autofree char *best = g_strdup_printf("{ error: 5e-5, %s }", shifting);
    eda_field field;
    if (attenuated) {
      hopkins_image(best, &shapes, frame, &field);
      eda_field_sample(&field, x, y, PLACES, want);
      eda_field_clear(&field);
    }
    image_within(0.05, rough, &shapes, frame, &field);
    eda_field_sample(&field, x, y, PLACES, got);
    eda_field_clear(&field);
    for (int i = 0; i < PLACES; i++)
      g_assert_cmpfloat(fabs(got[i] - want[i]), <, attenuated ? 5e-5 : 1e-5);
  }
}

/* Test that accurate images leave the model unchanged, are equal for equal
   errors, and do not use the kernels fixed by the parameters. */
static void test_fine(void) {
  if (opc_test_sanitized_skip()) return;
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("litho.hopkins", "{ kernels: 4 }", &error);
  g_assert_nonnull(m);
  const eda_litho *litho = m->functions;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  eda_point points[] = {{-130, -170}, {90, -170}, {90, 230}, {-130, 230}};
  uint32_t start[] = {0, 4};
  eda_shapes shapes = {1, start, points, NULL};
  eda_spectrum mask;
  g_assert_cmpint(eda_mask_spectrum(opc_test_host()->context, &shapes, 1, frame,
                                    litho->band(m->self), &mask, &error),
                  ==, OPC_OK);
  /* The model's own image, accurate images in focus and at 80 nm, and all of
     these once more. */
  static const double wanted[] = {0, 3e-4, 1.5e-3, 3e-4, 1.5e-3};
  static const double defocus[] = {0, 0, 0, 80, 80};
  enum { KINDS = 5 };
  eda_field field[2 * KINDS];
  double off[KINDS] = {0};
  for (int i = 0; i < 2 * KINDS; i++) {
    int k = i % KINDS;
    int code = wanted[k] > 0
                   ? litho->image_fine(m->self, 0, &mask, defocus[k], wanted[k],
                                       &field[i], &error)
                   : litho->image(m->self, 0, &mask, &field[i], &error);
    g_assert_cmpint(code, ==, OPC_OK);
    const float *finest = field[k < 3 ? 1 : 3].coefficients;
    for (int n = 0; i >= KINDS && n < field[i].nx * field[i].ny; n++) {
      double now = field[i].coefficients[n];
      g_assert_true(now == field[k].coefficients[n]);
      off[k] = fmax(off[k], fabs(now - finest[n]));
    }
  }
  g_assert_cmpfloat(off[0], >, 1.8e-3); /* the model has 4 kernels */
  g_assert_cmpfloat(off[2], <, 1.8e-3);
  g_assert_cmpfloat(off[4], <, 1.8e-3);
  g_assert_cmpfloat(off[4], >, 0);
  eda_field none = {0};
  g_assert_cmpint(litho->image_fine(m->self, 0, &mask, 0, 0, &none, &error), ==,
                  OPC_INVALID);
  for (int i = 0; i < 2 * KINDS; i++) eda_field_clear(&field[i]);
  eda_spectrum_clear(&mask);
}

/* Test that image_optics computes the same bits as an instance with these
   optics, and refuses a radius of the source above 1. */
static void test_optics(void) {
  opc_error error;
  g_autoptr(opc_module) any = opc_test_module("litho.hopkins", "{}", &error);
  g_autoptr(opc_module) same =
      opc_test_module("litho.hopkins", "{ na: 0.7, sigma: 0.6 }", &error);
  const eda_litho *litho = any->functions;
  g_assert_cmpint(litho->prepare(same->self, &error), ==, OPC_OK);
  eda_point points[] = {{-130, -170}, {90, -170}, {90, 230}, {-130, 230}};
  uint32_t start[] = {0, 4};
  eda_shapes shapes = {1, start, points, NULL};
  eda_spectrum mask;
  g_assert_cmpint(eda_mask_spectrum(opc_test_host()->context, &shapes, 1, frame,
                                    litho->band(any->self), &mask, &error),
                  ==, OPC_OK);
  eda_field a = {0}, b = {0};
  g_assert_cmpint(
      litho->image_optics(any->self, 0, &mask, 0.7, 0.6, 40, 5e-4, &a, &error),
      ==, OPC_OK);
  g_assert_cmpint(litho->image_fine(same->self, 0, &mask, 40, 5e-4, &b, &error),
                  ==, OPC_OK);
  g_assert_cmpmem(a.coefficients, (size_t)(a.nx * a.ny) * sizeof(float),
                  b.coefficients, (size_t)(b.nx * b.ny) * sizeof(float));
  eda_field_clear(&a);
  eda_field_clear(&b);
  g_assert_cmpint(
      litho->image_optics(any->self, 0, &mask, NAN, 1.2, 0, 5e-4, &a, &error),
      ==, OPC_INVALID);
  eda_spectrum_clear(&mask);
}

/* Test that an accurate image has at most the error of the model's own image
   even if a larger error is requested. */
static void test_coarse(void) {
  if (opc_test_sanitized_skip()) return;
  static const char *const parameters[] = {"{}", "{ error: 3e-4 }",
                                           "{ kernels: 60 }"};
  eda_point points[] = {{-130, -170}, {90, -170}, {90, 230}, {-130, 230}};
  uint32_t start[] = {0, 4};
  eda_shapes shapes = {1, start, points, NULL};
  for (size_t k = 0; k < G_N_ELEMENTS(parameters); k++) {
    eda_field best, own, fine;
    hopkins_image("{ error: 5e-5 }", &shapes, frame, &best);
    hopkins_image(parameters[k], &shapes, frame, &own);
    image_within(0.09, parameters[k], &shapes, frame, &fine);
    double off[2] = {0};
    for (int n = 0; n < best.nx * best.ny; n++) {
      double value = best.coefficients[n];
      off[0] = fmax(off[0], fabs(own.coefficients[n] - value));
      off[1] = fmax(off[1], fabs(fine.coefficients[n] - value));
    }
    g_assert_cmpfloat(off[1], <, 1.3 * off[0]);
    eda_field_clear(&best);
    eda_field_clear(&own);
    eda_field_clear(&fine);
  }
}

/* Test that the clear field is 1 for an empty mask. */
static void test_clear(void) {
  eda_shapes none = {0};
  eda_field field;
  hopkins_image("{ error: 3e-4 }", &none, frame, &field);
  double x = 12, y = 34, value;
  eda_field_sample(&field, &x, &y, 1, &value);
  eda_field_clear(&field);
  g_assert_cmpfloat(fabs(value - 1), <, 5e-4);
}

/* Test a grating too fine for two beams: the image is constant, a quarter of
   the clear field for lines of half the period. */
static void test_too_fine(void) {
  eda_point points[] = {{0, 0}, {25, 0}, {25, 400}, {0, 400}};
  uint32_t start[] = {0, 4};
  eda_shapes line = {1, start, points, NULL};
  eda_field field;
  hopkins_image("{ error: 1e-4 }", &line, (eda_frame){0, 0, 50, 400}, &field);
  double x[] = {0, 10, 33}, y[] = {0, 100, 321}, value[3];
  eda_field_sample(&field, x, y, 3, value);
  eda_field_clear(&field);
  for (int i = 0; i < 3; i++) g_assert_cmpfloat(fabs(value[i] - 0.25), <, 2e-4);
}

/* Test that the image follows the mask when the mask is moved or mirrored. */
static void test_symmetry(void) {
  eda_point points[] = {{-130, -170}, {90, -170}, {90, 100},
                        {0, 100},     {0, 230},   {-130, 230}};
  eda_point mirrored[6];
  for (int i = 0; i < 6; i++)
    mirrored[i] = (eda_point){-points[5 - i].y, -points[5 - i].x};
  uint32_t start[] = {0, 6};
  eda_shapes a = {1, start, points, NULL}, b = {1, start, mirrored, NULL};
  eda_frame f = {-450, -450, 900, 900};
  eda_field fields[2];
  hopkins_image("{}", &a, f, &fields[0]);
  hopkins_image("{}", &b, f, &fields[1]);
  for (int i = 0; i < 50; i++) {
    double x = 17.3 * i - 400, y = 300 - 11.1 * i, p, q, mx = -y, my = -x;
    eda_field_sample(&fields[0], &x, &y, 1, &p);
    eda_field_sample(&fields[1], &mx, &my, 1, &q);
    g_assert_cmpfloat(fabs(p - q), <, 2e-5);
  }
  for (int k = 0; k < 2; k++) eda_field_clear(&fields[k]);
}

/* Return the image of a line and a block, moved by x and optionally mirrored,
   in a frame so wide that the spectrum is processed in strips. */
static eda_field wide_image(double x, double y, int mirror) {
  const double w = 14000, h = 900;
  eda_box boxes[] = {{2000, 100, 2065, 700}, {2300, 250, 2700, 420}};
  eda_point points[8];
  for (int b = 0; b < 2; b++) {
    eda_box q = boxes[b];
    int32_t x0 = q.x0 + (int32_t)x, x1 = q.x1 + (int32_t)x;
    if (mirror) {
      x0 = (int32_t)w - q.x1 - (int32_t)x;
      x1 = (int32_t)w - q.x0 - (int32_t)x;
    }
    int32_t y0 = q.y0 + (int32_t)y, y1 = q.y1 + (int32_t)y;
    points[4 * b] = (eda_point){x0, y0};
    points[4 * b + 1] = (eda_point){x1, y0};
    points[4 * b + 2] = (eda_point){x1, y1};
    points[4 * b + 3] = (eda_point){x0, y1};
  }
  uint32_t start[] = {0, 4, 8};
  eda_shapes shapes = {2, start, points, NULL};
  eda_field field;
  hopkins_image("{ error: 5e-4 }", &shapes, (eda_frame){0, 0, w, h}, &field);
  return field;
}

static void test_moved(void) {
  eda_field as_is = wide_image(0, 0, 0), moved = wide_image(7411, 53, 0),
            mirrored = wide_image(7411, 53, 1);
  double least = 1;
  for (int i = 0; i < 400; i++) {
    double x = 1700 + 3.7 * i, y = 13 + 2.1 * i, p, q, r;
    double mx = x + 7411, my = y + 53, rx = 14000 - mx;
    eda_field_sample(&as_is, &x, &y, 1, &p);
    eda_field_sample(&moved, &mx, &my, 1, &q);
    eda_field_sample(&mirrored, &rx, &my, 1, &r);
    g_assert_cmpfloat(fabs(p - q), <, 5e-5);
    g_assert_cmpfloat(fabs(p - r), <, 5e-5);
    least = fmin(least, p);
  }
  g_assert_cmpfloat(least, <, 0.5);
  eda_field_clear(&as_is);
  eda_field_clear(&moved);
  eda_field_clear(&mirrored);
}

/* Compare plane kernels with radial kernels for a disk and a ring, 1 pm out of
   focus; images on both sides of the focus are equal. */
static void test_general(void) {
  if (opc_test_sanitized_skip()) return; /* plane_test runs plane kernels */
  eda_point points[] = {{-130, -170}, {90, -170}, {90, 230}, {-130, 230}};
  uint32_t start[] = {0, 4};
  eda_shapes shapes = {1, start, points, NULL};
  const char *sources[] = {"{ error: 8e-4 }",
                           "{ error: 8e-4, source: annular, sigma_in: 0.4 }"};
  const opc_host *host = opc_test_host();
  for (size_t i = 0; i < G_N_ELEMENTS(sources); i++) {
    opc_error error;
    g_autoptr(opc_module) m =
        opc_test_module("litho.hopkins", sources[i], &error);
    g_assert_nonnull(m);
    const eda_litho *litho = m->functions;
    g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
    eda_spectrum mask;
    eda_field field[4];
    const double defocus[] = {0, 1e-3, 120, -120};
    g_assert_cmpint(eda_mask_spectrum(host->context, &shapes, 1, frame,
                                      litho->band(m->self), &mask, &error),
                    ==, OPC_OK);
    for (int k = 0; k < 4; k++)
      g_assert_cmpint(
          litho->image_at(m->self, 0, &mask, defocus[k], &field[k], &error), ==,
          OPC_OK);
    double general = 0, sides = 0, blur = 0;
    for (int k = 0; k < field[0].nx * field[0].ny; k++) {
      double v[4];
      for (int f = 0; f < 4; f++) v[f] = field[f].coefficients[k];
      general = fmax(general, fabs(v[1] - v[0]));
      sides = fmax(sides, fabs(v[2] - v[3]));
      blur = fmax(blur, fabs(v[2] - v[0]));
    }
    g_test_message(
        "general path: deviation %.2g; difference of the two sides %.2g",
        general, sides);
    g_assert_cmpfloat(general, <, 2e-3);
    g_assert_cmpfloat(sides, <, 1e-4);
    g_assert_cmpfloat(blur, >, 0.02);
    eda_spectrum_clear(&mask);
    for (int k = 0; k < 4; k++) eda_field_clear(&field[k]);
  }
}

/* Return the image of a vertical line in the middle of a period, on a grid of
   0.1 nm. */
static eda_field line_image(const char *parameters, int layer, double width,
                            double period) {
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("litho.hopkins", parameters, &error);
  if (!m) g_error("%s", error.message);
  const eda_litho *litho = m->functions;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  const opc_host *host = opc_test_host();
  int32_t x = (int32_t)lround(5 * width), top = 4000;
  eda_point points[] = {{-x, 0}, {x, 0}, {x, top}, {-x, top}};
  uint32_t start[] = {0, 4};
  eda_shapes line = {1, start, points, NULL};
  eda_spectrum mask;
  eda_field field;
  eda_frame f = {-period / 2, 0, period, 400};
  g_assert_cmpint(eda_mask_spectrum(host->context, &line, 0.1, f,
                                    litho->band(m->self), &mask, &error),
                  ==, OPC_OK);
  g_assert_cmpint(litho->image(m->self, layer, &mask, &field, &error), ==,
                  OPC_OK);
  eda_spectrum_clear(&mask);
  return field;
}

/* Return the amplitude of order k of the grating. */
static double order(int k, double width, double period) {
  return k ? -sin(M_PI * k * width / period) / (M_PI * k) : 1 - width / period;
}

/* Test an isolated line against the double sum along one axis, with T by
   strips. */
static void test_line(void) {
  if (opc_test_sanitized_skip()) return;
  enum { REACH = 10, SIDE = 2 * REACH + 1 };
  static const double width = 65, period = 1490;
  const struct {
    const char *parameters;
    double reach;
  } cases[] = {
      {"{}", 1.5e-3}, {"{ error: 3e-4 }", 3e-4}, {"{ error: 1e-4 }", 1e-4}};
  static double t[SIDE][SIDE];
  double unit = 1 / period / (na / wavelength);
  g_assert_cmpfloat((REACH + 1) * unit, >, 1 + sigma);
  for (int i = 0; i < SIDE; i++)
    for (int j = 0; j <= i; j++)
      t[i][j] = t[j][i] =
          cross_coefficient((i - REACH) * unit, 0, (j - REACH) * unit, 0);
  for (size_t c = 0; c < G_N_ELEMENTS(cases); c++) {
    eda_field f = line_image(cases[c].parameters, 0, width, period);
    double worst = 0;
    for (double x = -period / 2; x < period / 2; x += 13) {
      double want = 0;
      for (int i = -REACH; i <= REACH; i++)
        for (int j = -REACH; j <= REACH; j++)
          want += t[i + REACH][j + REACH] * order(i, width, period) *
                  order(j, width, period) *
                  cos(2 * M_PI * (i - j) * x / period);
      worst = fmax(worst, fabs(value_at(&f, x, 77) - want));
    }
    g_test_message("%s: an isolated line is %.2g off", cases[c].parameters,
                   worst);
    g_assert_cmpfloat(worst, <, cases[c].reach);
    eda_field_clear(&f);
  }
}

/* Test a source that fills the pupil with lines so fine that orders interfere
   with order 0 only. Each wave is damped as by incoherent light (Goodman,
   Fourier Optics, 6.4). The intensities of the orders add a constant. */
static void test_incoherent(void) {
  static const double width = 60, period = 180;
  double d = wavelength / na / period;
  double otf = 2 / M_PI * (acos(d / 2) - d / 2 * sqrt(1 - d * d / 4));
  double c0 = order(0, width, period), c1 = order(1, width, period);
  eda_field f = line_image("{ sigma: 1, error: 3e-4 }", 0, width, period);
  for (double x = -90; x < 90; x += 7) {
    double want = c0 * c0 + 2 * otf * c1 * c1 +
                  4 * otf * c0 * c1 * cos(2 * M_PI * x / period);
    g_assert_cmpfloat(fabs(value_at(&f, x, 31) - want), <, 5e-4);
  }
  eda_field_clear(&f);
}

/* Test a small source: the image of an isolated edge is the squared sine
   integral. */
static void test_coherent(void) {
  double cutoff = na / wavelength, si = 0, worst = 0;
  /* The odd orders next to the cutoff are equally far from the cutoff. */
  double length = 2 * round(8000 * cutoff) / cutoff;
  eda_field f =
      line_image("{ sigma: 0.01, error: 1e-3 }", 0, length / 2, length);
  for (int x = 0; x <= 400; x++) {
    double dark = 0.5 - si / M_PI;
    worst = fmax(worst, fabs(value_at(&f, x - length / 4, 100) - dark * dark));
    for (int i = 0; i < 20; i++) {
      double a = 2 * M_PI * cutoff * (x + (i + 0.5) / 20);
      si += sin(a) / a * 2 * M_PI * cutoff / 20;
    }
  }
  g_test_message("a coherent edge is %.2g off", worst);
  g_assert_cmpfloat(worst, <, 0.01);
  eda_field_clear(&f);
}

/* Test the complementary mask, dark with clear lines, against three beams of
   known amplitudes. */
static void test_tone(void) {
  static const double width = 110, period = 300;
  const char *p = "{ sigma: 0.1, error: 1e-4, active: { tone: dark } }";
  double c0 = order(0, width, period), c1 = order(1, width, period);
  eda_field clear = line_image(p, 0, width, period);
  eda_field dark = line_image(p, 1, width, period);
  for (double x = -150; x < 150; x += 11) {
    double e = c0 + 2 * c1 * cos(2 * M_PI * x / period);
    g_assert_cmpfloat(fabs(value_at(&clear, x, 3) - e * e), <, 5e-4);
    g_assert_cmpfloat(fabs(value_at(&dark, x, 3) - (1 - e) * (1 - e)), <, 5e-4);
  }
  eda_field_clear(&clear);
  eda_field_clear(&dark);
}

static void test_refused(void) {
  opc_error error;
  g_assert_null(opc_test_module("litho.hopkins", "{ na: 1.2 }", &error));
  g_assert_null(opc_test_module("litho.hopkins", "{ sigma: 0 }", &error));
  g_assert_null(opc_test_module("litho.hopkins", "{ error: 4e-5 }", &error));
  g_assert_null(
      opc_test_module("litho.hopkins", "{ kernels: 24, error: 1e-3 }", &error));
  g_assert_nonnull(strstr(error.message, "exclude each other"));
  g_assert_null(opc_test_module(
      "litho.hopkins", "{ source: dipole, sigma_in: 0.5, kernels: 121 }",
      &error));
  g_assert_nonnull(strstr(error.message, "at most 120"));
  g_assert_null(
      opc_test_module("litho.hopkins", "{ wavelength: 193 }", &error));
  GString *many = g_string_new("{ source: points, points: [0, 0, 1");
  for (int i = 0; i < 800; i++) g_string_append(many, ", 0, 0.1, 1");
  g_string_append(many, "] }");
  g_assert_null(opc_test_module("litho.hopkins", many->str, &error));
  g_assert_nonnull(strstr(error.message, "has 801 points, more than 800"));
  g_string_free(many, TRUE);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/hopkins/definition", test_definition);
  g_test_add_func("/hopkins/lines", test_lines);
  g_test_add_func("/hopkins/fine", test_fine);
  g_test_add_func("/hopkins/optics", test_optics);
  g_test_add_func("/hopkins/coarse", test_coarse);
  g_test_add_func("/hopkins/clear-field", test_clear);
  g_test_add_func("/hopkins/too-fine", test_too_fine);
  g_test_add_func("/hopkins/symmetry", test_symmetry);
  g_test_add_func("/hopkins/moved", test_moved);
  g_test_add_func("/hopkins/general", test_general);
  g_test_add_func("/hopkins/line", test_line);
  g_test_add_func("/hopkins/incoherent", test_incoherent);
  g_test_add_func("/hopkins/coherent", test_coherent);
  g_test_add_func("/hopkins/tone", test_tone);
  g_test_add_func("/hopkins/refused", test_refused);
  return g_test_run();
}
