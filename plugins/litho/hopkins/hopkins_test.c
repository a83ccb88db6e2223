/* SPDX-License-Identifier: BSD-3-Clause */
/* Kernels against the definition: Hopkins' double sum over the frequencies of
   a small field, its cross coefficients by strips. */
#include "core/plugin/testing.h"

#include <complex.h>
#include <math.h>

static const double wavelength = 193, na = 0.75, sigma = 0.75;
static const opc_frame frame = {-350, -400, 700, 800};

/* The part of a horizontal strip at y within a disk. */
static void chord(double cx, double cy, double r, double y, double *from,
                  double *to) {
  double h = r * r - (y - cy) * (y - cy), half = h > 0 ? sqrt(h) : -1;
  *from = fmax(*from, cx - half);
  *to = half < 0 ? -INFINITY : fmin(*to, cx + half);
}

/* T(f1, f2): the source seen through both pupils, frequencies in units of the
   cutoff. */
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

/* The intensity of an opaque rectangle at the places (x, y), by the double
   sum. */
static void direct(opc_box b, const double *x, const double *y, size_t n,
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
      double side[2] = {k ? sin(M_PI * k * (b.x1 - b.x0) / frame.width) / (M_PI * k)
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
        out[i] += creal(t * a[p] * conj(a[q]) *
                        cexp(2 * M_PI * I * cutoff *
                             ((fx[p] - fx[q]) * x[i] + (fy[p] - fy[q]) * y[i])));
    }
}

static void image(const char *parameters, const opc_shapes *shapes,
                  opc_frame f, opc_field *field) {
  opc_error error;
  g_autoptr(opc_module) m = opc_test_module("litho.hopkins", parameters, &error);
  g_assert_nonnull(m);
  const opc_litho *litho = m->plugin->operations;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  const opc_host *host = opc_test_host();
  opc_spectrum mask;
  g_assert_cmpint(host->imaging->mask_spectrum(host, shapes, 1, f,
                                               litho->band(m->self), &mask,
                                               &error), ==, OPC_OK);
  g_assert_cmpint(litho->image(m->self, 0, &mask, field, &error), ==, OPC_OK);
  host->imaging->release_spectrum(host, &mask);
}

static void test_definition(void) {
  enum { PLACES = 40 };
  opc_box b = {-130, -170, 90, 230};
  double x[PLACES], y[PLACES], want[PLACES], got[PLACES];
  GRand *random = g_rand_new_with_seed(3);
  for (int i = 0; i < PLACES; i++) {
    x[i] = g_rand_double_range(random, -350, 350);
    y[i] = g_rand_double_range(random, -400, 400);
  }
  g_rand_free(random);
  direct(b, x, y, PLACES, want);
  opc_point points[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  uint32_t start[] = {0, 4};
  opc_shapes shapes = {1, start, points, NULL};
  const struct {
    const char *parameters;
    double reach;
  } cases[] = {{"{ kernels: 4 }", 1e-2},
               {"{ error: 3e-3 }", 3e-3},
               {"{}", 1.5e-3},
               {"{ error: 5e-4 }", 5e-4},
               {"{ error: 1e-4 }", 1e-4}};
  double before = 1;
  for (size_t c = 0; c < G_N_ELEMENTS(cases); c++) {
    opc_field field;
    image(cases[c].parameters, &shapes, frame, &field);
    opc_test_host()->imaging->sample(&field, x, y, PLACES, got);
    opc_test_host()->imaging->release_field(opc_test_host(), &field);
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

/* Nothing on the mask: the clear field is 1. */
static void test_clear(void) {
  opc_shapes none = {0};
  opc_field field;
  image("{ error: 1e-4 }", &none, frame, &field);
  double x = 12, y = 34, value;
  opc_test_host()->imaging->sample(&field, &x, &y, 1, &value);
  opc_test_host()->imaging->release_field(opc_test_host(), &field);
  g_assert_cmpfloat(fabs(value - 1), <, 5e-4);
}

/* A grating finer than two beams can image is a constant: dark lines of half
   the period give a quarter of the clear field. */
static void test_too_fine(void) {
  opc_point points[] = {{0, 0}, {25, 0}, {25, 400}, {0, 400}};
  uint32_t start[] = {0, 4};
  opc_shapes line = {1, start, points, NULL};
  opc_field field;
  image("{ error: 1e-4 }", &line, (opc_frame){0, 0, 50, 400}, &field);
  double x[] = {0, 10, 33}, y[] = {0, 100, 321}, value[3];
  opc_test_host()->imaging->sample(&field, x, y, 3, value);
  opc_test_host()->imaging->release_field(opc_test_host(), &field);
  for (int i = 0; i < 3; i++)
    g_assert_cmpfloat(fabs(value[i] - 0.25), <, 2e-4);
}

/* The image does not change when the mask is moved or mirrored with it. */
static void test_symmetry(void) {
  opc_point points[] = {{-130, -170}, {90, -170}, {90, 100}, {0, 100},
                        {0, 230}, {-130, 230}};
  opc_point mirrored[6];
  for (int i = 0; i < 6; i++)
    mirrored[i] = (opc_point){-points[5 - i].y, -points[5 - i].x};
  uint32_t start[] = {0, 6};
  opc_shapes a = {1, start, points, NULL}, b = {1, start, mirrored, NULL};
  opc_frame f = {-450, -450, 900, 900};
  opc_field fields[2];
  image("{}", &a, f, &fields[0]);
  image("{}", &b, f, &fields[1]);
  for (int i = 0; i < 50; i++) {
    double x = 17.3 * i - 400, y = 300 - 11.1 * i, p, q, mx = -y, my = -x;
    opc_test_host()->imaging->sample(&fields[0], &x, &y, 1, &p);
    opc_test_host()->imaging->sample(&fields[1], &mx, &my, 1, &q);
    g_assert_cmpfloat(fabs(p - q), <, 2e-5);
  }
  for (int k = 0; k < 2; k++)
    opc_test_host()->imaging->release_field(opc_test_host(), &fields[k]);
}

/* The general way against the radial one, in focus but for a picometre, for a
   disk and a ring; and the same on both sides of the focus. */
static void test_general(void) {
  opc_point points[] = {{-130, -170}, {90, -170}, {90, 230}, {-130, 230}};
  uint32_t start[] = {0, 4};
  opc_shapes shapes = {1, start, points, NULL};
  const char *sources[] = {"{ error: 2e-4 }",
                           "{ error: 2e-4, source: annular, sigma_in: 0.4 }"};
  const opc_host *host = opc_test_host();
  for (size_t i = 0; i < G_N_ELEMENTS(sources); i++) {
    opc_error error;
    g_autoptr(opc_module) m = opc_test_module("litho.hopkins", sources[i], &error);
    g_assert_nonnull(m);
    const opc_litho *litho = m->plugin->operations;
    g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
    opc_spectrum mask;
    opc_field field[4];
    const double defocus[] = {0, 1e-3, 120, -120};
    g_assert_cmpint(host->imaging->mask_spectrum(host, &shapes, 1, frame,
                                                 litho->band(m->self), &mask,
                                                 &error), ==, OPC_OK);
    for (int k = 0; k < 4; k++)
      g_assert_cmpint(litho->image_at(m->self, 0, &mask, defocus[k], &field[k],
                                      &error), ==, OPC_OK);
    double general = 0, sides = 0, blur = 0;
    for (int k = 0; k < field[0].nx * field[0].ny; k++) {
      double v[4];
      for (int f = 0; f < 4; f++) v[f] = field[f].coefficients[k];
      general = fmax(general, fabs(v[1] - v[0]));
      sides = fmax(sides, fabs(v[2] - v[3]));
      blur = fmax(blur, fabs(v[2] - v[0]));
    }
    g_test_message("general way: %.2g off; the two sides differ by %.2g",
                   general, sides);
    g_assert_cmpfloat(general, <, 2e-3);
    g_assert_cmpfloat(sides, <, 1e-4);
    g_assert_cmpfloat(blur, >, 0.02);
    host->imaging->release_spectrum(host, &mask);
    for (int k = 0; k < 4; k++) host->imaging->release_field(host, &field[k]);
  }
}

static void test_refused(void) {
  opc_error error;
  g_assert_null(opc_test_module("litho.hopkins", "{ na: 1.2 }", &error));
  g_assert_null(opc_test_module("litho.hopkins", "{ sigma: 0 }", &error));
  g_assert_null(opc_test_module("litho.hopkins", "{ wavelength: 193 }", &error));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/hopkins/definition", test_definition);
  g_test_add_func("/hopkins/clear-field", test_clear);
  g_test_add_func("/hopkins/too-fine", test_too_fine);
  g_test_add_func("/hopkins/symmetry", test_symmetry);
  g_test_add_func("/hopkins/general", test_general);
  g_test_add_func("/hopkins/refused", test_refused);
  return g_test_run();
}
