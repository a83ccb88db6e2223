/* SPDX-License-Identifier: BSD-3-Clause */
/* Fields, compared with sums of waves, whose values, derivatives and diffusion
   are known in closed form. */
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "imaging/spline.h"

#include "testing/testing.h"

static const opc_context *context; /* a context with several threads */

enum { WAVES = 5, PLACES = 400 };

/* Numbers of periods along x and y. The shortest period is that of the
   intensity of a scanner with NA 0.75 at 193 nm: 129 nm. */
static const int wave[WAVES][2] = {{0, 0}, {3, 1}, {0, 5}, {-7, 4}, {8, 8}};
static const double amplitude[WAVES] = {0.4, 0.3, -0.2, 0.15, 0.1};
static const double phase[WAVES] = {0, 1, 2, 3, 4};
static const eda_frame frame = {-300, 120, 1500, 1700};

/* Compute value and derivatives after a diffusion of sigma. */
static void truth(double x, double y, double sigma, double out[3]) {
  out[0] = out[1] = out[2] = 0;
  for (int w = 0; w < WAVES; w++) {
    double u = 2 * M_PI * wave[w][0] / frame.width;
    double v = 2 * M_PI * wave[w][1] / frame.height;
    double a = amplitude[w] * exp(-(u * u + v * v) * sigma * sigma / 2);
    double angle = u * (x - frame.x0) + v * (y - frame.y0) + phase[w];
    out[0] += a * cos(angle);
    out[1] -= a * u * sin(angle);
    out[2] -= a * v * sin(angle);
  }
}

/* Return the field of the waves, from values at nodes; the number of nodes may
   be odd. */
static eda_field waves(int nx, int ny) {
  eda_field f = {.frame = frame, .nx = nx, .ny = ny};
  f.coefficients = eda_alloc((size_t)nx * (size_t)ny, sizeof(float));
  for (int j = 0; j < ny; j++)
    for (int i = 0; i < nx; i++) {
      double v[3];
      truth(frame.x0 + frame.width * i / nx, frame.y0 + frame.height * j / ny,
            0, v);
      f.coefficients[j * nx + i] = (float)v[0];
    }
  eda_field_from_samples(context, &f);
  return f;
}

/* Compute the largest errors of the value and of a derivative (1/nm). */
static void errors(const eda_field *f, double sigma, double worst[2]) {
  worst[0] = worst[1] = 0;
  for (int i = 0; i < PLACES; i++) {
    double x = frame.x0 + 13.37 * i - 1000, y = frame.y0 + 7.91 * i - 500;
    double got[3], want[3], value;
    truth(x, y, sigma, want);
    eda_field_gradient(f, &x, &y, 1, &got[0], &got[1], &got[2]);
    eda_field_sample(f, &x, &y, 1, &value);
    g_assert_cmpfloat(fabs(value - got[0]), <, 1e-12);
    worst[0] = fmax(worst[0], fabs(got[0] - want[0]));
    worst[1] =
        fmax(worst[1], fmax(fabs(got[1] - want[1]), fabs(got[2] - want[2])));
  }
}

static void test_gradient(void) {
  static const struct {
    int nx, ny;
    double value, slope;
  } grids[] = {
      {48, 54, 1e-4, 1e-5}, {101, 111, 2e-6, 3e-7}, {190, 214, 1e-6, 1e-7}};
  for (size_t i = 0; i < G_N_ELEMENTS(grids); i++) {
    eda_field f = waves(grids[i].nx, grids[i].ny);
    double worst[2];
    errors(&f, 0, worst);
    g_test_message("step %.1f nm: largest error %.2g, of the slope %.2g /nm",
                   frame.width / f.nx, worst[0], worst[1]);
    g_assert_cmpfloat(worst[0], <, grids[i].value);
    g_assert_cmpfloat(worst[1], <, grids[i].slope);
    double x = 3, y = 4, slope, all[3];
    eda_field_gradient(&f, &x, &y, 1, NULL, NULL, &slope);
    eda_field_gradient(&f, &x, &y, 1, &all[0], &all[1], &all[2]);
    g_assert_cmpfloat(slope, ==, all[2]);
    eda_field_clear(&f);
  }
}

static void test_diffuse(void) {
  static const double sigma[] = {0, 1, 10, 30, 100, 5000};
  for (size_t i = 0; i < G_N_ELEMENTS(sigma); i++) {
    eda_field f = waves(101, 112);
    opc_error error;
    double worst[2];
    g_assert_cmpint(eda_field_diffuse(context, &f, sigma[i], &error), ==,
                    OPC_OK);
    errors(&f, sigma[i], worst);
    g_test_message("diffusion %g nm: largest error %.2g", sigma[i], worst[0]);
    g_assert_cmpfloat(worst[0], <, 2e-6);
    g_assert_cmpint(eda_field_diffuse(context, &f, -1, &error), ==,
                    OPC_INVALID);
    g_assert_cmpint(eda_field_diffuse(context, &f, NAN, &error), ==,
                    OPC_INVALID);
    eda_field_clear(&f);
  }
}

static void test_resample(void) {
  eda_field f = waves(64, 72);
  opc_error error;
  double worst[2];
  static const double step[] = {16, 4.7, 20, 10, 24};
  for (size_t i = 0; i < G_N_ELEMENTS(step); i++) {
    g_assert_cmpint(eda_field_resample(context, &f, step[i], &error), ==,
                    OPC_OK);
    g_assert_cmpfloat(frame.width / f.nx, <=, step[i]);
    g_assert_cmpfloat(frame.height / f.ny, <=, step[i]);
    errors(&f, 0, worst);
    g_test_message("to %g nm: largest error %.2g", step[i], worst[0]);
    g_assert_cmpfloat(worst[0], <, step[i]> 20 ? 2e-5 : 5e-6);
  }
  /* The step is too coarse for the last two waves; the other waves are
     preserved. */
  g_assert_cmpint(eda_field_resample(context, &f, 110, &error), ==, OPC_OK);
  double mean = 0;
  for (int i = 0; i < f.nx * f.ny; i++) mean += f.coefficients[i];
  g_assert_cmpfloat(fabs(mean / (f.nx * f.ny) - amplitude[0]), <, 1e-6);
  g_assert_cmpint(eda_field_resample(context, &f, 1e-6, &error), ==,
                  OPC_INVALID);
  g_assert_cmpint(eda_field_resample(context, &f, 0, &error), ==, OPC_INVALID);
  eda_field_clear(&f);
}

/* Samples equal the values at the nodes. */
static void test_samples(void) {
  eda_field f = waves(71, 64), samples = f;
  size_t n = (size_t)f.nx * (size_t)f.ny;
  samples.coefficients = eda_alloc(n, sizeof(float));
  memcpy(samples.coefficients, f.coefficients, n * sizeof(float));
  eda_field_samples(context, &samples);
  for (size_t i = 0; i < n; i++) {
    double x = frame.x0 + frame.width * (double)(i % 71) / 71, v;
    int row = i / 71;
    double y = frame.y0 + frame.height * row / 64;
    eda_field_sample(&f, &x, &y, 1, &v);
    g_assert_cmpfloat(fabs(v - samples.coefficients[i]), <, 1e-6);
  }
  eda_field_clear(&f);
  eda_field_clear(&samples);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  context = eda_test_context_new(4);
  g_test_add_func("/fields/gradient", test_gradient);
  g_test_add_func("/fields/diffuse", test_diffuse);
  g_test_add_func("/fields/resample", test_resample);
  g_test_add_func("/fields/samples", test_samples);
  int failed = g_test_run();
  eda_test_context_free(context);
  return failed;
}
