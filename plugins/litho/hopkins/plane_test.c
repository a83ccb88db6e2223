/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests of sources and pupils without symmetry against litho.abbe, which adds
   the images of source points one by one. */
#include <eda/gates.h>
#include <eda/litho.h>
#include <math.h>
#include <string.h>

#include "../image_test.h"

/* Return the image of shapes without symmetry: a line, a rectangle near its
   end, and a square. */
static eda_field image_of(const char *id, const char *parameters,
                          const eda_frame frame) {
  static const eda_point points[] = {{-200, -270}, {-90, -270}, {-90, 120},
                                     {-200, 120},  {60, 40},    {270, 40},
                                     {270, 160},   {60, 160},   {100, -220},
                                     {240, -220},  {240, -90},  {100, -90}};
  static const uint32_t start[] = {0, 4, 8, 12};
  const eda_shapes shapes = {3, (uint32_t *)start, (eda_point *)points, NULL};
  g_autoptr(opc_module) m = prepared(id, parameters);
  return image_shapes(m, EDA_POLY, 0, &shapes, 1, frame);
}

static double worst_difference(const eda_field *a, const eda_field *b) {
  double worst = 0, least = 1;
  for (double y = -400; y < 400; y += 13)
    for (double x = -400; x < 400; x += 13) {
      double p, q;
      eda_field_sample(a, &x, &y, 1, &p);
      eda_field_sample(b, &x, &y, 1, &q);
      worst = fmax(worst, fabs(p - q));
      least = fmin(least, p);
    }
  g_assert_cmpfloat(least, <, 0.3);
  return worst;
}

/* Listed points have pupils with sharp edges, which the tables blur, so the
   allowed error is 0.006. */
#define LISTED                                                              \
  "source: points, points: [0.31, 0.12, 1, -0.48, 0.2, 2, 0.05, -0.55, 1, " \
  "-0.35, -0.4, 1.5, 0.45, -0.2, 0.5, -0.1, 0.5, 1]"

static const eda_frame wide = {-1600, -1600, 3200, 3200};

/* Compare both models; the largest difference is below `reach`. */
static void models_compare(const char *optics, const char *kernels,
                           double reach) {
  g_autofree char *h = g_strdup_printf("{ %s, %s }", optics, kernels);
  g_autofree char *a = g_strdup_printf("{ %s }", optics);
  eda_field got = image_of("litho.hopkins", h, wide);
  eda_field want = image_of("litho.abbe", a, wide);
  double worst = worst_difference(&got, &want);
  g_test_message("%s: %.2g off litho.abbe", h, worst);
  g_assert_cmpfloat(worst, <, reach);
  eda_field_clear(&got);
  eda_field_clear(&want);
}

#define ABERRATED LISTED ", zernike: [0, 0, 0, 0, 0.02, 0.06, 0.05, 0.04]"

static void test_aberrated(void) {
  models_compare(ABERRATED, "kernels: 4", 1.6e-2);
}

static void test_sources(void) {
  if (opc_test_sanitized_skip()) return;
  models_compare("source: quasar, sigma: 0.85, sigma_in: 0.5, rotation: 20 deg",
                 "kernels: 6", 2.5e-3);
  models_compare(LISTED ", defocus: 120 nm", "error: 1e-3", 8e-3);
  models_compare(ABERRATED, "kernels: 6", 8e-3);
}

/* Test that the blur of a list of points agrees with the values that the
   warning states, and that other sources cause no warning. */
static void test_warned(void) {
  if (opc_test_sanitized_skip()) return;
  static const struct {
    eda_frame frame;
    const char *logged;
    double least, most;
  } cases[] = {{{-1600, -1600, 3200, 3200}, "0.6 %", 0.0055, 0.0065},
               {{-400, -400, 800, 800}, "2 to 3 %", 0.02, 0.03}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_test_forget();
    eda_field got = image_of("litho.hopkins", "{ " LISTED " }", cases[i].frame);
    g_assert_nonnull(strstr(opc_test_log(), cases[i].logged));
    eda_field want = image_of("litho.abbe", "{ " LISTED " }", cases[i].frame);
    double worst = worst_difference(&got, &want);
    g_test_message("a frame of %g nm: %.2g", cases[i].frame.width, worst);
    g_assert_cmpfloat(worst, >, cases[i].least);
    g_assert_cmpfloat(worst, <, cases[i].most);
    eda_field_clear(&got);
    eda_field_clear(&want);
  }
  opc_test_forget();
  g_autoptr(opc_module) m =
      prepared("litho.hopkins", "{ source: dipole, sigma_in: 0.5 }");
  g_assert_null(strstr(opc_test_log(), "single source points"));
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/plane/aberrated", test_aberrated);
  g_test_add_func("/plane/sources", test_sources);
  g_test_add_func("/plane/warned", test_warned);
  return g_test_run();
}
