/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of the errors caused by the margin and by the number of kernels, for
   lines in a wide frame and for all kinds of sources and masks. */
#include <eda/gates.h>
#include <eda/litho.h>
#include <math.h>
#include <string.h>

#include "tools/devel/testing.h"

/* Test long lines in the middle of a frame with a margin of clear field. A
   margin four times as wide changes the image by at most the stated error. */
static void test_margin(void) {
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("litho.hopkins", "{ error: 1e-4 }", &error);
  g_assert_nonnull(m);
  const eda_litho *litho = m->functions;
  g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
  enum { LINES = 16, LONG = 4700, PLACES = 2000 };
  eda_point points[4 * LINES];
  uint32_t start[LINES + 1] = {0};
  for (int i = 0; i < LINES; i++) {
    int x = 300 * i;
    eda_point p[] = {{x, 0}, {x + 130, 0}, {x + 130, LONG}, {x, LONG}};
    memcpy(points + 4 * i, p, sizeof p);
    start[i + 1] = (uint32_t)(4 * (i + 1));
  }
  eda_shapes shapes = {LINES, start, points, NULL};
  const double wanted[] = {2e-3, 1e-3, 4e-4};
  double x[PLACES], y[PLACES], value[2][PLACES];
  for (int i = 0; i < PLACES; i++) {
    x[i] = fmod(1.7 * 311.3 * i, LONG);
    y[i] = fmod(77.7 * i, LONG);
  }
  for (int k = 0; k < 3; k++) {
    double margin = eda_margin(litho->band(m->self), wanted[k]), worst = 0;
    for (int wide = 0; wide < 2; wide++) {
      double by = (wide ? 4 : 1) * margin;
      eda_frame f = {-by, -by, LONG + 2 * by, LONG + 2 * by};
      eda_spectrum mask;
      eda_field field;
      g_assert_cmpint(eda_mask_spectrum(opc_test_host()->context, &shapes, 1, f,
                                        litho->band(m->self), &mask, &error),
                      ==, OPC_OK);
      g_assert_cmpint(litho->image(m->self, 0, &mask, &field, &error), ==,
                      OPC_OK);
      eda_field_sample(&field, x, y, PLACES, value[wide]);
      eda_spectrum_clear(&mask);
      eda_field_clear(&field);
    }
    for (int i = 0; i < PLACES; i++)
      worst = fmax(worst, fabs(value[1][i] - value[0][i]));
    g_test_message("%g nm for %g: %.2g", margin, wanted[k], worst);
    g_assert_cmpfloat(worst, <, wanted[k]);
    g_assert_cmpfloat(worst, >, wanted[k] / 5);
  }
}

/* Test that the requested error is reached with a usable number of kernels, in
   bounded time, for all masks and optics. */
static void test_reached(void) {
  if (opc_test_sanitized_skip()) return;
  /* At every NA, the patterns have frequencies at the rims of the pupils. */
  static const struct {
    const char *parameters;
    double error;
  } cases[] = {
      {"{ active: { tone: dark }, poly: { transmission: 6 % } }", 1.5e-3},
      {"{ poly: { transmission: 6 %, phase: 90 deg } }", 1.5e-3},
      {"{ sigma: 0.05 }", 1.5e-3},
      {"{ sigma: 0.99, na: 0.2 }", 1.5e-3},
      {"{ sigma: 1, na: 1.35, index: 1.44, error: 5e-4 }", 5e-4},
      {"{ source: annular, sigma: 0.8, sigma_in: 0.5 }", 1.5e-3},
      {"{ source: annular, sigma: 0.9, sigma_in: 0.85, error: 5e-4 }", 5e-4},
      {"{ defocus: 150 nm, error: 1e-3 }", 1e-3},
      {"{ error: 6e-5 }", 6e-5},
      {"{ na: 0.7, error: 1e-4 }", 1e-4},
      {"{ na: 0.8, error: 1e-4 }", 1e-4}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error;
    opc_test_forget();
    g_autoptr(opc_module) m =
        opc_test_module("litho.hopkins", cases[i].parameters, &error);
    if (!m) g_error("%s", error.message);
    const eda_litho *litho = m->functions;
    g_assert_cmpint(litho->prepare(m->self, &error), ==, OPC_OK);
    g_assert_cmpint(strstr(opc_test_log(), "scalar") != NULL, ==,
                    strstr(cases[i].parameters, "na: 1.35") != NULL);
    double kernels = opc_test_metric("kernels"), off = opc_test_metric("error");
    g_test_message("%s: %g kernels, error %.2g", cases[i].parameters, kernels,
                   off);
    g_assert_cmpfloat(kernels, <=, 200);
    g_assert_cmpfloat(off, <=, cases[i].error);
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/hopkins/margin", test_margin);
  g_test_add_func("/hopkins/reached", test_reached);
  return g_test_run();
}
