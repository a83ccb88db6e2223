/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures the error of images and edges relative to images and edges with
   finer settings. */
#include "bench/bench.h"
#include "bench/lines.h"

#include <glib.h>
#include <math.h>

static const opc_host *host;

/* Compute an image by some source points within the band of a scanner.
   `raster`, `grid` and `nodes` are the refinements of the mask raster, of the
   grid of the fields, and of the grid of the result. The result is at least as
   fine as the fields require. */
static eda_field image_sampled(const eda_shapes *s, eda_frame f, int raster,
                               int grid, int nodes) {
  size_t count = 16;
  eda_kernels kernels = lines_kernels(&count, grid ? 4 : 1);
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  lines_require(
      eda_mask_spectrum(host->context, s, 1, f, kernels.band * (raster ? 3 : 1),
                        &mask, &error),
      &error);
  lines_require(eda_coherent_sum(host->context, &mask, &kernels, nodes ? 8 : 32,
                                 &field, &error),
                &error);
  eda_spectrum_clear(&mask);
  size_t n = (size_t)field.nx * (size_t)field.ny;
  for (size_t i = 0; i < n; i++) field.coefficients[i] -= 0.35f;
  return field;
}

/* Report the distance of the edges of a field from the edges of a finer
   field. */
static void compare_edges(const char *name, const eda_field *field,
                          const eda_field *fine, double reach) {
  eda_frame window = {0, 0, 6000, 6000};
  double *points, square = 0;
  uint32_t *start;
  size_t lines;
  opc_error error;
  lines_require(
      eda_contours(NULL, fine, window, 8, &points, &start, &lines, &error),
      &error);
  for (uint32_t i = 0; i < start[lines]; i++) {
    double v, w, dx, dy, *p = points + (size_t)2 * i;
    eda_field_gradient(fine, p, p + 1, 1, &w, &dx, &dy);
    eda_field_sample(field, p, p + 1, 1, &v);
    square += pow((v - w) / hypot(dx, dy), 2);
  }
  bench_report(name, sqrt(square / start[lines]), "nm", reach, BENCH_LOWER);
  free(points);
  free(start);
}

static void bench_edges(void) {
  static const struct {
    const char *name;
    int raster, grid, nodes;
  } cases[] = {{"imaging.edge_rms.raster", 0, 1, 1},
               {"imaging.edge_rms.field_grid", 1, 0, 1},
               {"imaging.edge_rms.interpolation", 1, 0, 0},
               {"imaging.edge_rms.all", 0, 0, 0}};
  eda_shapes s = lines_shapes(6000);
  eda_frame f = lines_frame(6000);
  eda_field fine = image_sampled(&s, f, 1, 1, 1);
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    eda_field field =
        image_sampled(&s, f, cases[i].raster, cases[i].grid, cases[i].nodes);
    compare_edges(cases[i].name, &field, &fine, 0.005);
    eda_field_clear(&field);
  }
  eda_field_clear(&fine);
  g_free(s.start);
  g_free(s.points);
}

static double value_at(const eda_field *f, double x, double y) {
  double v;
  eda_field_sample(f, &x, &y, 1, &v);
  return v;
}

/* Return the printed width of a vertical line around x at y. */
static double width_at(const eda_field *f, double x, double y) {
  double edge[2];
  for (int side = 0; side < 2; side++) {
    double in = x, out = x + (side ? 110 : -110);
    for (int i = 0; i < 40; i++) {
      double middle = (in + out) / 2;
      if (value_at(f, middle, y) > 0)
        in = middle;
      else
        out = middle;
    }
    edge[side] = in;
  }
  return edge[1] - edge[0];
}

/* Simulate the lines, with a resist calibrated to the same model. */
static eda_field lines_print(const char *parameters, const eda_shapes *s,
                             eda_frame f, eda_field *intensity) {
  opc_error error;
  g_autoptr(opc_module) m = lines_litho(parameters);
  g_autoptr(opc_module) r = opc_test_module("resist.threshold", "{}", &error);
  if (!r) g_error("%s", error.message);
  const eda_litho *l = m->functions;
  const eda_resist *resist = r->functions;
  lines_require(resist->prepare(r->self, m, &error), &error);
  eda_spectrum mask;
  eda_field field;
  lines_require(eda_mask_spectrum(host->context, s, 1, f, l->band(m->self),
                                  &mask, &error),
                &error);
  lines_require(l->image(m->self, EDA_POLY, &mask, intensity, &error), &error);
  lines_require(l->image(m->self, EDA_POLY, &mask, &field, &error), &error);
  lines_require(resist->print(r->self, EDA_POLY, &field, &error), &error);
  eda_spectrum_clear(&mask);
  return field;
}

/* The reference, the sum over all kernels, deviates by 6e-5 from Hopkins'
   double sum over the transmission cross coefficients on these lines. Each goal
   of the intensity is therefore the stated error plus 6e-5. */
static void bench_error(void) {
  eda_shapes s = lines_shapes(6000);
  eda_frame f = lines_frame(6000);
  eda_field exact,
      exact_print = lines_print("{ kernels: 2000 }", &s, f, &exact);
  const struct {
    const char *name, *parameters;
    double intensity, cd;
  } settings[] = {{"default", "{}", 1.56e-3, 0.1},
                  {"sign_off", "{ error: 5e-4 }", 5.6e-4, 0.04},
                  {"finest", "{ error: 1e-4 }", 1.6e-4, 0.012}};
  for (size_t k = 0; k < G_N_ELEMENTS(settings); k++) {
    eda_field field, p = lines_print(settings[k].parameters, &s, f, &field);
    double worst = 0, square = 0;
    for (int i = 0; i < field.nx * field.ny; i++)
      worst = fmax(worst,
                   fabs((double)field.coefficients[i] - exact.coefficients[i]));
    size_t n = 0;
    for (size_t i = 0; i < s.count; i++)
      for (int t = 1; t < 6; t++, n++) {
        const eda_point *q = s.points + 4 * i;
        double x = q[0].x + 32.5, y = q[0].y + (q[2].y - q[0].y) * t / 6.0;
        double d = width_at(&p, x, y) - width_at(&exact_print, x, y);
        square += d * d;
      }
    g_autofree char *intensity =
        g_strdup_printf("imaging.error.%s", settings[k].name);
    g_autofree char *cd =
        g_strdup_printf("imaging.cd_rms.%s", settings[k].name);
    bench_report(intensity, worst, "", settings[k].intensity, BENCH_LOWER);
    bench_report(cd, sqrt(square / (double)n), "nm", settings[k].cd,
                 BENCH_LOWER);
    eda_field_clear(&field);
    eda_field_clear(&p);
  }
  eda_field_clear(&exact);
  eda_field_clear(&exact_print);
  g_free(s.start);
  g_free(s.points);
}

int main(void) {
  host = opc_test_host();
  bench_edges();
  bench_error();
  return bench_write("accuracy");
}
