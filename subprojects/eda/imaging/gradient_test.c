/* SPDX-License-Identifier: BSD-3-Clause */
/* The gradient of an image, compared with differences of images. The intensity
   is a quadratic function of the mask spectrum, so a central difference equals
   the derivative for any step. */
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "testing/testing.h"

static const opc_context *context; /* a context with several threads */
static const eda_frame frame = {-200, 100, 1600, 1200};

/* Pupils of radius 0.004 / nm, centred at s * (0.001, 0.0005) / nm, with a
   phase that is neither even nor odd. */
static void pupil(const void *self, size_t s, const double *fx, double fy,
                  size_t n, float *out) {
  (void)self;
  double y = fy + 0.0005 * (double)s;
  for (size_t i = 0; i < n; i++) {
    double x = fx[i] + 0.001 * (double)s, phase = 400 * x + 9e4 * x * y;
    int in = x * x + y * y <= 0.004 * 0.004;
    out[2 * i] = (float)(in ? cos(phase) : 0);
    out[2 * i + 1] = (float)(in ? sin(phase) : 0);
  }
}

static const double weights[] = {0.5, 0.3, 0.2};
/* Phase-shifting features on a grey field. */
static const eda_kernels kernels = {.count = 3,
                                    .weight = weights,
                                    .band = 0.0065,
                                    .intensity_band = 0.008,
                                    .transfer = pupil,
                                    .offset = {0.3, 0.1},
                                    .scale = {0.5, -0.4}};

static eda_spectrum spectrum_of(const eda_box *b, size_t n) {
  eda_point points[16];
  uint32_t start[5] = {0};
  for (size_t i = 0; i < n; i++) {
    const eda_point p[] = {{b[i].x0, b[i].y0},
                           {b[i].x1, b[i].y0},
                           {b[i].x1, b[i].y1},
                           {b[i].x0, b[i].y1}};
    memcpy(points + 4 * i, p, sizeof p);
    start[i + 1] = (uint32_t)(4 * i + 4);
  }
  eda_shapes shapes = {.count = n, .start = start, .points = points};
  eda_spectrum s;
  opc_error error;
  g_assert_false(
      eda_mask_spectrum(context, &shapes, 1, frame, 0.007, &s, &error));
  return s;
}

/* Return the integral of weight * intensity over the nodes of `weight`. */
static double integral(const eda_spectrum *mask, const eda_field *weight) {
  eda_field image;
  opc_error error;
  double sum = 0;
  g_assert_false(eda_coherent_sum(context, mask, &kernels, 8, &image, &error));
  double dx = frame.width / weight->nx, dy = frame.height / weight->ny;
  for (int j = 0; j < weight->ny; j++)
    for (int i = 0; i < weight->nx; i++) {
      double x = frame.x0 + i * dx, y = frame.y0 + j * dy, v;
      eda_field_sample(&image, &x, &y, 1, &v);
      sum += v * (double)weight->coefficients[j * weight->nx + i];
    }
  eda_field_clear(&image);
  return sum * dx * dy;
}

static void test_difference(void) {
  static const eda_box shapes[] = {{0, 200, 150, 1000}, {400, 500, 900, 620}};
  /* Boxes of whole cells around nodes. */
  static const eda_box added[] = {
      {195, 395, 245, 595}, {1005, 305, 1205, 355}, {-195, 1105, 105, 1205}};
  enum { NX = 160, NY = 120 };
  eda_spectrum mask = spectrum_of(shapes, G_N_ELEMENTS(shapes));
  eda_spectrum clear = spectrum_of(NULL, 0);
  eda_field weight = {frame, NX, NY, eda_alloc(NX * NY, sizeof(float))};
  eda_field gradient;
  opc_error error;
  GRand *r = g_rand_new_with_seed(7);
  for (int i = 0; i < NX * NY; i++)
    weight.coefficients[i] = (float)g_rand_double_range(r, -1, 1);
  g_rand_free(r);
  g_assert_false(eda_coherent_gradient(context, &mask, &kernels, &weight,
                                       &gradient, &error));
  g_assert_cmpint(gradient.nx, ==, NX);
  size_t n = 2 * (size_t)mask.columns * (size_t)mask.rows;
  for (size_t k = 0; k < G_N_ELEMENTS(added); k++) {
    eda_spectrum bar = spectrum_of(&added[k], 1), more = mask, less = mask;
    more.data = g_memdup2(mask.data, n * sizeof *mask.data);
    less.data = g_memdup2(mask.data, n * sizeof *mask.data);
    for (size_t i = 0; i < n; i++) {
      float by = bar.data[i] - clear.data[i];
      more.data[i] += by;
      less.data[i] -= by;
    }
    double want = (integral(&more, &weight) - integral(&less, &weight)) / 2;
    double sum = 0, most = 0;
    for (int y = 0; y < NY; y++)
      for (int x = 0; x < NX; x++) {
        double at_x = frame.x0 + 10 * x, at_y = frame.y0 + 10 * y;
        double g = (double)gradient.coefficients[y * NX + x];
        if (at_x > added[k].x0 && at_x < added[k].x1 && at_y > added[k].y0 &&
            at_y < added[k].y1)
          sum += 100 * g, most += 100 * fabs(g);
      }
    g_test_message("%g, by differences %g", sum, want);
    g_assert_cmpfloat(fabs(sum - want), <, 0.01 * most);
    g_assert_cmpfloat(fabs(want), >, 0.02 * most);
    eda_spectrum_clear(&bar);
    g_free(more.data);
    g_free(less.data);
  }
  eda_field_clear(&gradient);
  free(weight.coefficients);
  eda_spectrum_clear(&mask);
  eda_spectrum_clear(&clear);
}

static void test_refused(void) {
  eda_spectrum mask = spectrum_of(NULL, 0);
  float none[20 * 20] = {0};
  eda_field weight = {frame, 20, 20, none}, out;
  opc_error error;
  g_assert_cmpint(
      eda_coherent_gradient(context, &mask, &kernels, &weight, &out, &error),
      ==, OPC_INVALID);
  g_assert_null(out.coefficients);
  eda_spectrum_clear(&mask);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  context = eda_test_context_new(4);
  g_test_add_func("/gradient/difference", test_difference);
  g_test_add_func("/gradient/refused", test_refused);
  int code = g_test_run();
  eda_test_context_free(context);
  return code;
}
