/* SPDX-License-Identifier: BSD-3-Clause */
/* Imaging: its error against finer settings, and its time against that of the
   plain Fourier transforms that it needs, in one run. The field is rows of
   65 nm lines at 250 nm pitch. */
#include "bench/bench.h"
#include "core/imaging/fft.h"
#include "core/plugin/host.h"
#include "core/plugin/testing.h"

#include <fftw3.h>
#include <glib.h>
#include <math.h>
#include <sys/resource.h>

enum { RUNS = 5 };

static const opc_host *host;

static double now(void) { return (double)g_get_monotonic_time() / 1e6; }

static void must(int code, const opc_error *error) {
  if (code) g_error("%s", error->message);
}

/* ---- what is imaged ---- */

static opc_shapes rows_of_lines(double side) {
  size_t columns = (size_t)(side / 250), rows = (size_t)(side / 1800);
  opc_shapes s = {.count = columns * rows};
  s.start = g_new0(uint32_t, s.count + 1);
  s.points = g_new(opc_point, 4 * s.count);
  for (size_t k = 0; k < s.count; k++) {
    int i = (int)(k % columns), j = (int)(k / columns);
    int x = i * 250 + 92, y = j * 1800 + 100 + i % 7 * 13,
        h = 1400 - i % 5 * 31;
    opc_point p[4] = {{x, y}, {x + 65, y}, {x + 65, y + h}, {x, y + h}};
    for (int c = 0; c < 4; c++) s.points[4 * k + (size_t)c] = p[c];
    s.start[k + 1] = (uint32_t)(4 * (k + 1));
  }
  return s;
}

static opc_frame frame_of(double side) {
  return (opc_frame){-1000, -1000, side + 2000, side + 2000};
}

static opc_module *litho(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("litho.hopkins", parameters, &error);
  if (!m) g_error("%s", error.message);
  const opc_litho *l = m->plugin->operations;
  must(l->prepare(m->self, &error), &error);
  return m;
}

/* ---- time ---- */

typedef struct times {
  double layer, fft;
} times;

/* The transforms that a layer of that size needs, as whole planes. */
static double transforms(opc_frame f, const opc_module *m, size_t systems,
                         int fine) {
  const opc_litho *l = m->plugin->operations;
  double band = l->band(m->self), cutoff = 0.75 / 193;
  int raster = opc_fft_size(f.width * band * 3.1);
  int n = opc_fft_size(f.width * 0.85 * (2 * band + 2 * cutoff));
  size_t room =
      (size_t)fine * (size_t)(fine + 2) + (size_t)raster * (size_t)(raster + 2);
  float *a = fftwf_malloc(2 * room * sizeof(float));
  fftwf_complex *c = (fftwf_complex *)a;
  unsigned flags = FFTW_ESTIMATE;
  fftwf_plan plans[4] = {fftwf_plan_dft_r2c_2d(raster, raster, a, c, flags),
                         fftwf_plan_dft_2d(n, n, c, c, FFTW_BACKWARD, flags),
                         fftwf_plan_dft_r2c_2d(n, n, a, c, flags),
                         fftwf_plan_dft_c2r_2d(fine, fine, c, a, flags)};
  size_t repeats[4] = {1, systems, 1, 1};
  for (size_t i = 0; i < 2 * room; i++) a[i] = (float)(i % 17);
  double start = now();
  for (int p = 0; p < 4; p++)
    for (size_t k = 0; k < repeats[p]; k++) {
      for (size_t i = 0; i < 64; i++) a[i] = 1; /* keeps the values finite */
      fftwf_execute(plans[p]);
    }
  double time = now() - start;
  for (int p = 0; p < 4; p++) fftwf_destroy_plan(plans[p]);
  fftwf_free(a);
  return time;
}

static double layer(const opc_shapes *s, opc_frame f, const opc_module *m,
                    int *fine) {
  const opc_litho *l = m->plugin->operations;
  opc_spectrum mask;
  opc_field field;
  opc_error error;
  double start = now();
  must(host->imaging->mask_spectrum(host, s, 1, f, l->band(m->self), &mask,
                                    &error),
       &error);
  must(l->image(m->self, OPC_POLY, &mask, &field, &error), &error);
  double time = now() - start;
  *fine = field.nx;
  host->imaging->release_spectrum(host, &mask);
  host->imaging->release_field(host, &field);
  return time;
}

/* The best of RUNS, layer and transforms in turn. */
static times measure(double um, const opc_module *m, size_t systems,
                     int with_fft) {
  opc_shapes s = rows_of_lines(1000 * um);
  opc_frame f = frame_of(1000 * um);
  times best = {INFINITY, INFINITY};
  for (int i = 0; i < RUNS; i++) {
    int fine;
    best.layer = fmin(best.layer, layer(&s, f, m, &fine));
    if (with_fft) best.fft = fmin(best.fft, transforms(f, m, systems, fine));
  }
  g_free(s.start);
  g_free(s.points);
  return best;
}

static void bench_time(void) {
  g_autoptr(opc_module) m = litho("{}");
  /* As many as litho.hopkins says it takes, and the rest. */
  size_t systems = 13;
  opc_set_threads(1);
  times one = measure(80, m, systems, 1);
  bench_report("imaging.layer_80um.one_core", one.layer, "s", 0.40,
               BENCH_LOWER);
  bench_report("imaging.layer_80um.over_fft", one.layer / one.fft, "", 1.3,
               BENCH_LOWER);
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  bench_report("imaging.memory_80um", (double)usage.ru_maxrss / 1024, "MB", 400,
               BENCH_LOWER);
  double small = measure(10, m, systems, 0).layer / (12 * 12);
  double large = measure(150, m, systems, 0).layer / (152.0 * 152);
  bench_report("imaging.growth_10_to_150um", large / small, "", 1.2,
               BENCH_LOWER);
  opc_set_threads(2);
  times two = measure(80, m, systems, 0);
  bench_report("imaging.layer_80um.two_cores", two.layer, "s", 0.25,
               BENCH_LOWER);
  bench_report("imaging.two_threads_over_one", one.layer / two.layer, "", 1.8,
               BENCH_HIGHER);
}

/* ---- error ---- */

static double value_at(const opc_field *f, double x, double y) {
  double v;
  host->imaging->sample(f, &x, &y, 1, &v);
  return v;
}

/* The printed width of a vertical line around x at y. */
static double width_at(const opc_field *f, double x, double y) {
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

/* The print of the lines, with a resist calibrated to the same model. */
static opc_field print(const char *parameters, const opc_shapes *s, opc_frame f,
                       opc_field *intensity) {
  opc_error error;
  g_autoptr(opc_module) m = litho(parameters);
  g_autoptr(opc_module) r = opc_test_module("resist.threshold", "{}", &error);
  if (!r) g_error("%s", error.message);
  const opc_litho *l = m->plugin->operations;
  const opc_resist *resist = r->plugin->operations;
  must(resist->prepare(r->self, m, &error), &error);
  opc_spectrum mask;
  opc_field field;
  must(host->imaging->mask_spectrum(host, s, 1, f, l->band(m->self), &mask,
                                    &error),
       &error);
  must(l->image(m->self, OPC_POLY, &mask, intensity, &error), &error);
  must(l->image(m->self, OPC_POLY, &mask, &field, &error), &error);
  must(resist->print(r->self, OPC_POLY, &field, &error), &error);
  host->imaging->release_spectrum(host, &mask);
  return field;
}

static void bench_error(void) {
  opc_shapes s = rows_of_lines(6000);
  opc_frame f = frame_of(6000);
  opc_field exact, exact_print = print("{ error: 1e-5 }", &s, f, &exact);
  const struct {
    const char *name, *parameters;
    double intensity, cd;
  } settings[] = {{"default", "{}", 1.5e-3, 0.1},
                  {"sign_off", "{ error: 3e-4 }", 5e-4, 0.04},
                  {"finest", "{ error: 1e-4 }", 1e-4, 0.01}};
  for (size_t k = 0; k < G_N_ELEMENTS(settings); k++) {
    opc_field field, p = print(settings[k].parameters, &s, f, &field);
    double worst = 0, square = 0;
    for (int i = 0; i < field.nx * field.ny; i++)
      worst = fmax(worst,
                   fabs((double)field.coefficients[i] - exact.coefficients[i]));
    size_t n = 0;
    for (size_t i = 0; i < s.count; i++)
      for (int t = 1; t < 6; t++, n++) {
        const opc_point *q = s.points + 4 * i;
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
    host->imaging->release_field(host, &field);
    host->imaging->release_field(host, &p);
  }
  host->imaging->release_field(host, &exact);
  host->imaging->release_field(host, &exact_print);
  g_free(s.start);
  g_free(s.points);
}

int main(void) {
  host = opc_test_host();
  bench_error();
  bench_time();
  return bench_write("imaging");
}
