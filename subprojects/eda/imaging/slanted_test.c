/* SPDX-License-Identifier: BSD-3-Clause */
/* Masks with slanted edges, compared with the closed form of the Fourier
   integral of a polygon, a sum over its edges. */
#include <complex.h>
#include <eda/imaging.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>

#include "testing/testing.h"

static const opc_context *context; /* a context with several threads */

static double sinc(double x) {
  return fabs(x) < 1e-6 ? 1 - x * x / 6 : sin(x) / x;
}

/* Return the integral of exp(-i (u x + v y)) over polygons. By the divergence
   theorem, it equals the flux of the vector field (u, v) i exp(-i (u x + v y))
   / (u^2 + v^2) through the outlines. */
static double complex integral(const eda_shapes *s, double grid, eda_frame f,
                               double u, double v) {
  double complex sum = 0;
  double area = 0, square = u * u + v * v;
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p], n = s->start[p + 1]; i < n; i++) {
      eda_point a = s->points[i],
                b = s->points[i + 1 < n ? i + 1 : s->start[p]];
      double ax = a.x * grid - f.x0, ay = a.y * grid - f.y0;
      double dx = ((double)b.x - a.x) * grid, dy = ((double)b.y - a.y) * grid;
      area += (ax * dy - ay * dx) / 2;
      sum += (u * dy - v * dx) * sinc((u * dx + v * dy) / 2) *
             cexp(-I * (u * (ax + dx / 2) + v * (ay + dy / 2)));
    }
  return square > 0 ? I * sum / square : area;
}

static double worst_coefficient(const eda_shapes *s, double grid, eda_frame f,
                                double band) {
  eda_spectrum got;
  opc_error error;
  g_assert_cmpint(eda_mask_spectrum(context, s, grid, f, band, &got, &error),
                  ==, OPC_OK);
  const float complex *a = (const float complex *)got.data;
  int half = (got.rows - 1) / 2;
  double worst = 0;
  for (int l = -half; l <= half; l++)
    for (int k = 0; k < got.columns; k++) {
      if (hypot(k / f.width, l / f.height) > band) continue;
      double complex want =
          (k || l ? 0 : 1) - integral(s, grid, f, 2 * M_PI * k / f.width,
                                      2 * M_PI * l / f.height) /
                                 (f.width * f.height);
      size_t at = (size_t)((l + got.rows) % got.rows) * (size_t)got.columns;
      worst = fmax(worst, cabs(want - a[at + (size_t)k]));
    }
  eda_spectrum_clear(&got);
  return worst;
}

typedef struct polygon {
  const char *name;
  size_t n;
  eda_point points[8];
} polygon;

static const polygon polygons[] = {
    {"triangle", 3, {{100, 100}, {900, 250}, {333, 777}}},
    {"right triangle", 3, {{100, 100}, {700, 100}, {100, 700}}},
    {"square on its corner",
     4,
     {{800, 300}, {1200, 700}, {800, 1100}, {400, 700}}},
    {"rotated rectangle", 4, {{200, 300}, {1000, 617}, {963, 710}, {163, 393}}},
    {"sliver", 3, {{50, 60}, {1800, 61}, {1799, 63}}},
    {"steep sliver", 4, {{500, 50}, {502, 50}, {503, 1500}, {502, 1500}}},
    {"octagon",
     8,
     {{400, 300},
      {600, 300},
      {700, 400},
      {700, 600},
      {600, 700},
      {400, 700},
      {300, 600},
      {300, 400}}},
    {"leaves the frame", 3, {{1500, -400}, {2900, 500}, {1700, 2600}}},
    {"covers the frame twice",
     4,
     {{-100, 0}, {4100, 500}, {3900, 3700}, {0, 3000}}},
    {"within a sample", 3, {{1000, 1000}, {1003, 1001}, {1001, 1004}}},
};

static void test_polygons(void) {
  eda_frame f = {13, -20, 2000, 1700};
  for (size_t i = 0; i < G_N_ELEMENTS(polygons); i++) {
    polygon p = polygons[i];
    uint32_t start[] = {0, (uint32_t)p.n};
    eda_shapes s = {1, start, p.points, NULL};
    double worst = worst_coefficient(&s, 1, f, 0.0068);
    g_test_message("%s: largest error of a coefficient %.2g", p.name, worst);
    g_assert_cmpfloat(worst, <, 1e-6);
  }
}

/* Test a slanted polygon with a hole, far from the origin, together with
   rectilinear polygons and with a grid other than 1 nm. */
static void test_hole(void) {
  eda_point points[] = {{0, 0},       {1600, 0},    {1600, 1200}, {0, 1200},
                        {800, 200},   {300, 700},   {1100, 1000}, {1700, 1300},
                        {1900, 1300}, {1900, 1500}, {1700, 1500}};
  for (size_t i = 0; i < G_N_ELEMENTS(points); i++) {
    points[i].x = 2 * points[i].x + 40000;
    points[i].y = 2 * points[i].y - 30000;
  }
  uint32_t start[] = {0, 4, 7, 11};
  uint8_t hole[] = {0, 1, 0};
  eda_shapes s = {3, start, points, hole};
  double worst =
      worst_coefficient(&s, 0.5, (eda_frame){5, 7, 2100, 1900}, 0.0068);
  g_test_message("largest error of a coefficient %.2g", worst);
  g_assert_cmpfloat(worst, <, 1e-6);
}

/* Results are bit-identical for any number of threads. */
static void test_threads(void) {
  polygon p = polygons[0];
  uint32_t start[] = {0, (uint32_t)p.n};
  eda_shapes s = {1, start, p.points, NULL};
  eda_frame f = {0, 0, 1000, 1000};
  eda_spectrum a[2];
  opc_error error;
  for (unsigned i = 0; i < 2; i++) {
    g_assert_cmpint(
        eda_mask_spectrum(i ? context : NULL, &s, 1, f, 0.0068, &a[i], &error),
        ==, OPC_OK);
  }
  size_t size = sizeof(float) * 2 * (size_t)a[0].columns * (size_t)a[0].rows;
  g_assert_cmpmem(a[0].data, size, a[1].data, size);
  for (int i = 0; i < 2; i++) eda_spectrum_clear(&a[i]);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  context = eda_test_context_new(4);
  g_test_add_func("/slanted/polygons", test_polygons);
  g_test_add_func("/slanted/hole", test_hole);
  g_test_add_func("/slanted/threads", test_threads);
  int failed = g_test_run();
  eda_test_context_free(context);
  return failed;
}
