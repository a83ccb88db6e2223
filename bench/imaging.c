/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures the time of imaging, relative to the Fourier transforms alone in the
   same run. */
#include "bench/bench.h"
#include "bench/lines.h"
#include "imaging/fft.h"
#include "imaging/lanes.h"

#include <fftw3.h>
#include <glib.h>
#include <math.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { RUNS = 5 };

static const opc_host *host;

static double time_now(void) { return (double)g_get_monotonic_time() / 1e6; }

/* Return the processor time of all threads, which does not depend on other
   load. */
static double processor_time(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + (double)t.tv_nsec / 1e9;
}

/* ---- time ---- */

typedef struct times {
  double layer, fft;
} times;

/* Measure the Fourier transforms for a layer of that size, as full planes
   without other work. */
static double transforms(eda_frame f, const opc_module *m, size_t kernels,
                         int fine) {
  const eda_litho *l = m->functions;
  double band = l->band(m->self);
  int raster = eda_fft_size(f.width * band * 3.1);
  int n = eda_fft_size(f.width * 0.85 * (2 * band + 2 * LINES_CUTOFF));
  size_t capacity =
      (size_t)fine * (size_t)(fine + 2) + (size_t)raster * (size_t)(raster + 2);
  float *a = fftwf_malloc(2 * capacity * sizeof(float));
  fftwf_complex *c = (fftwf_complex *)a;
  unsigned flags = FFTW_ESTIMATE;
  fftwf_plan plans[4] = {fftwf_plan_dft_r2c_2d(raster, raster, a, c, flags),
                         fftwf_plan_dft_2d(n, n, c, c, FFTW_BACKWARD, flags),
                         fftwf_plan_dft_r2c_2d(n, n, a, c, flags),
                         fftwf_plan_dft_c2r_2d(fine, fine, c, a, flags)};
  size_t repeats[4] = {1, kernels, 1, 1};
  for (size_t i = 0; i < 2 * capacity; i++) a[i] = (float)(i % 17);
  double start = processor_time();
  for (int p = 0; p < 4; p++)
    for (size_t k = 0; k < repeats[p]; k++) {
      for (size_t i = 0; i < 64; i++)
        a[i] = 1; /* avoids infinite values in repeated transforms */
      fftwf_execute(plans[p]);
    }
  double time = processor_time() - start;
  for (int p = 0; p < 4; p++) fftwf_destroy_plan(plans[p]);
  fftwf_free(a);
  return time;
}

static double layer(const eda_shapes *s, eda_frame f, const opc_module *m,
                    double (*clock)(void), int *fine) {
  const eda_litho *l = m->functions;
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  double start = clock();
  lines_require(eda_mask_spectrum(host->context, s, 1, f, l->band(m->self),
                                  &mask, &error),
                &error);
  lines_require(l->image(m->self, EDA_POLY, &mask, &field, &error), &error);
  double time = clock() - start;
  *fine = field.nx;
  eda_spectrum_clear(&mask);
  eda_field_clear(&field);
  return time;
}

/* Measure the layer and the transforms alternately. Return the shortest times
   of RUNS runs. */
static times layer_measure(double um, const opc_module *m, size_t kernels) {
  eda_shapes s = lines_shapes(1000 * um);
  eda_frame f = lines_frame(1000 * um);
  times best = {INFINITY, INFINITY};
  for (int i = 0; i < RUNS; i++) {
    int fine;
    best.layer = fmin(best.layer, layer(&s, f, m, processor_time, &fine));
    best.fft = fmin(best.fft, transforms(f, m, kernels, fine));
  }
  g_free(s.start);
  g_free(s.points);
  return best;
}

/* Return the time per area of a large layer divided by that of a small layer:
   the median over alternate runs. The small layer is repeated for an equal
   time. The operations of the transforms alone grow with the logarithm of the
   frame: 1.45 times from 12 to 152 um. */
static double growth(double small, double large, const opc_module *m) {
  enum { TURNS = 7 };
  double ratio[TURNS], area[2] = {pow(small + 2, 2), pow(large + 2, 2)};
  eda_shapes s = lines_shapes(1000 * small), l = lines_shapes(1000 * large);
  int repeats = (int)(area[1] / area[0]) + 1, fine;
  for (int i = 0; i < TURNS; i++) {
    double sum = 0;
    for (int k = 0; k < repeats; k++)
      sum += layer(&s, lines_frame(1000 * small), m, processor_time, &fine);
    double other =
        layer(&l, lines_frame(1000 * large), m, processor_time, &fine);
    ratio[i] = other / area[1] / (sum / repeats / area[0]);
  }
  g_free(s.start);
  g_free(s.points);
  g_free(l.start);
  g_free(l.points);
  return bench_median(ratio, TURNS);
}

/* Measure one layer in each of two concurrent processes. */
static double two_processes(const eda_shapes *s, eda_frame f,
                            const opc_module *m) {
  double start = time_now();
  pid_t child[2];
  for (int i = 0; i < 2; i++) {
    child[i] = fork();
    if (child[i]) continue;
    int fine;
    layer(s, f, m, time_now, &fine);
    _exit(0);
  }
  for (int i = 0; i < 2; i++) waitpid(child[i], NULL, 0);
  return time_now() - start;
}

/* Measure the speed-up of two threads, and the limit of this machine: two
   concurrent processes relative to one process. Results are medians of
   alternate runs. The processes run first, while this process has a single
   thread. */
static void bench_threads(const opc_module *m) {
  enum { TURNS = 9 };
  eda_shapes s = lines_shapes(80000);
  eda_frame f = lines_frame(80000);
  double one[TURNS], two[TURNS], limit[TURNS], speed[TURNS];
  int fine;
  opc_set_threads(1);
  for (int i = 0; i < TURNS; i++) {
    double alone = layer(&s, f, m, time_now, &fine);
    limit[i] = 2 * alone / two_processes(&s, f, m);
  }
  opc_set_threads(2);
  for (int i = 0; i < TURNS; i++) {
    opc_set_threads(1);
    one[i] = layer(&s, f, m, time_now, &fine);
    opc_set_threads(2);
    two[i] = layer(&s, f, m, time_now, &fine);
    speed[i] = one[i] / two[i];
  }
  double ceiling = bench_median(limit, TURNS),
         ratio = bench_median(speed, TURNS);
  bench_report("imaging.layer_80um.two_cores", bench_median(two, TURNS), "s",
               0.25, BENCH_LOWER);
  bench_report("imaging.two_threads_over_one", ratio, "", 1.8, BENCH_HIGHER);
  bench_report("imaging.two_processes_over_one", ceiling, "", INFINITY,
               BENCH_HIGHER);
  bench_report("imaging.threads_over_processes", ratio / ceiling, "", 0.95,
               BENCH_HIGHER);
  g_free(s.start);
  g_free(s.points);
}

/* Measure a small defocused image, which needs other kernels. */
static void defocus_measure(const opc_module *m) {
  const eda_litho *l = m->functions;
  eda_shapes none = {0};
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  lines_require(eda_mask_spectrum(host->context, &none, 1, lines_frame(500),
                                  l->band(m->self), &mask, &error),
                &error);
  lines_require(l->image_at(m->self, EDA_POLY, &mask, 100, &field, &error),
                &error);
  eda_spectrum_clear(&mask);
  eda_field_clear(&field);
}

static void bench_prepare(void) {
  double best = INFINITY, resist = INFINITY, focus = INFINITY;
  for (int i = 0; i < RUNS; i++) {
    opc_error error;
    double start = processor_time();
    g_autoptr(opc_module) m = lines_litho("{}");
    best = fmin(best, processor_time() - start);
    start = processor_time();
    defocus_measure(m);
    focus = fmin(focus, processor_time() - start);
    g_autoptr(opc_module) r = opc_test_module("resist.threshold", "{}", &error);
    if (!r) g_error("%s", error.message);
    const eda_resist *operations = r->functions;
    start = processor_time();
    lines_require(operations->prepare(r->self, m, &error), &error);
    resist = fmin(resist, processor_time() - start);
  }
  bench_report("imaging.prepare.litho", best, "s", 0.03, BENCH_LOWER);
  bench_report("imaging.prepare.defocus", focus, "s", 0.15, BENCH_LOWER);
  bench_report("imaging.prepare.resist", resist, "s", 0.01, BENCH_LOWER);
}

static void bench_time(void) {
  g_autoptr(opc_module) m = lines_litho("{}");
  /* The number of kernels that litho.hopkins reports, and the residual. */
  size_t kernels = 13;
  opc_set_threads(1);
  times one = layer_measure(80, m, kernels);
  bench_report("imaging.layer_80um.one_core", one.layer, "s", 0.40,
               BENCH_LOWER);
  bench_report("imaging.layer_80um.over_fft", one.layer / one.fft, "", 1.3,
               BENCH_LOWER);
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  bench_report("imaging.memory_80um", (double)usage.ru_maxrss / 1024, "MB", 400,
               BENCH_LOWER);
  bench_report("imaging.growth_10_to_150um", growth(10, 150, m), "", 1.45,
               BENCH_LOWER);
  bench_threads(m);
  bench_prepare();
}

/* ---- time of each part ---- */

/* Return zeros: measures the time without the transfer function. */
static void no_transfer(const void *self, size_t s, const double *fx, double fy,
                        size_t n, float *out) {
  (void)self;
  (void)s;
  (void)fx;
  (void)fy;
  memset(out, 0, 2 * n * sizeof *out);
}

static double plain_sum(const eda_spectrum *mask, size_t count) {
  eda_kernels kernels = lines_kernels(&count, 1);
  eda_field field;
  opc_error error;
  kernels.transfer = no_transfer;
  double start = processor_time();
  lines_require(
      eda_coherent_sum(host->context, mask, &kernels, 0, &field, &error),
      &error);
  double time = processor_time() - start;
  eda_field_clear(&field);
  return time;
}

/* Measure the transforms that a sum over `kernels` kernels needs: along y for
   the columns within the band, and along x for all rows. The same code
   transforms one line again and again, which stays in the cache. */
static double plain_lines(eda_frame f, size_t kernels) {
  double band = (1 + LINES_SIGMA) * LINES_CUTOFF;
  int n = eda_lanes_size(f.width * 0.85 * (2 * band + 2 * LINES_CUTOFF));
  const eda_lanes_plan *plan = eda_lanes_plan_for(n);
  size_t points = (size_t)n + eda_lanes_capacity(plan);
  eda_lanes *a = eda_fft_alloc(points * sizeof *a);
  memset(a, 0, points * sizeof *a);
  size_t columns = 2 * (size_t)(f.width * band) + 1, rows = (size_t)n;
  size_t lines = (columns + rows) / EDA_LANES * kernels;
  double start = processor_time();
  for (size_t i = 0; i < lines; i++) eda_lanes_backward(plan, a, a + n);
  double time = processor_time() - start;
  eda_fft_free(a);
  return time;
}

/* Measure the parts of a layer of 60 um on one processor. Results are
   medians. */
static void bench_parts(void) {
  enum { PARTS = 6, TURNS = 9, SYSTEMS = 13 };
  static const char *const names[PARTS] = {"spectrum", "transfer", "fields",
                                           "final",    "resist",   "floor"};
  g_autoptr(opc_module) m = lines_litho("{ kernels: 12 }");
  opc_error error;
  g_autoptr(opc_module) r = opc_test_module("resist.threshold", "{}", &error);
  if (!r) g_error("%s", error.message);
  const eda_litho *l = m->functions;
  const eda_resist *resist = r->functions;
  lines_require(resist->prepare(r->self, m, &error), &error);
  eda_shapes s = lines_shapes(60000);
  eda_frame f = lines_frame(60000);
  double part[PARTS][TURNS];
  opc_set_threads(1);
  for (int i = 0; i < TURNS; i++) {
    eda_spectrum mask;
    eda_field field;
    double start = processor_time();
    lines_require(eda_mask_spectrum(host->context, &s, 1, f, l->band(m->self),
                                    &mask, &error),
                  &error);
    part[0][i] = processor_time() - start;
    start = processor_time();
    lines_require(l->image(m->self, EDA_POLY, &mask, &field, &error), &error);
    double image = processor_time() - start;
    double one = plain_sum(&mask, 1), all = plain_sum(&mask, SYSTEMS);
    double each = (all - one) / (SYSTEMS - 1);
    part[1][i] = image - all;
    part[2][i] = SYSTEMS * each;
    part[3][i] = one - each;
    start = processor_time();
    lines_require(resist->print(r->self, EDA_POLY, &field, &error), &error);
    part[4][i] = processor_time() - start;
    part[5][i] = plain_lines(f, SYSTEMS);
    eda_spectrum_clear(&mask);
    eda_field_clear(&field);
  }
  for (int p = 0; p < PARTS; p++) {
    g_autofree char *name = g_strdup_printf("imaging.part_60um.%s", names[p]);
    bench_report(name, bench_median(part[p], TURNS), "s", INFINITY,
                 BENCH_LOWER);
  }
  g_free(s.start);
  g_free(s.points);
}

/* ---- a clip of the contest ICCAD 2013 ---- */

static char *contest(const char *folder, const char *name) {
  const char *data = g_getenv("OPCFLOW_TEST_DATA");
  g_autofree char *beside = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "..",
                                             "shared", "data", NULL);
  return g_build_filename(data ? data : beside, "clips", folder, name, NULL);
}

static eda_shapes read_clip(const char *path) {
  g_autofree char *parameters = g_strdup_printf("{ file: '%s' }", path);
  opc_error error;
  g_autoptr(opc_module) m = opc_test_module("read.glp", parameters, &error);
  if (!m) g_error("%s", error.message);
  void *out[1];
  lines_require(opc_test_run(m, out, &error), &error);
  eda_flat flat;
  eda_shapes merged;
  int32_t layer = eda_layout_find_layer(out[0], "M1");
  int32_t top = eda_layout_top(out[0], &error);
  lines_require(eda_layout_flatten(out[0], top, layer, 1, &flat, &error),
                &error);
  lines_require(eda_boolean(EDA_OR, &flat.shapes, NULL, &merged, &error),
                &error);
  eda_flat_clear(&flat);
  opc_test_release(m, out);
  return merged;
}

/* Measure a clip in focus and defocused, with the 24 kernels of the contest for
   each. */
static void bench_clip(void) {
  g_autofree char *focus = contest("kernels/focus", "scales.txt");
  g_autofree char *defocus = contest("kernels/defocus", "scales.txt");
  g_autofree char *clip = contest("iccad2013", "M1_test1.glp");
  if (!g_file_test(clip, G_FILE_TEST_EXISTS)) return;
  g_autofree char *parameters =
      g_strdup_printf("{ focus: '%s', defocus: '%s' }", focus, defocus);
  opc_error error;
  g_autoptr(opc_module) m =
      opc_test_module("litho.kernels", parameters, &error);
  if (!m) g_error("%s", error.message);
  const eda_litho *l = m->functions;
  lines_require(l->prepare(m->self, &error), &error);
  eda_shapes shapes = read_clip(clip);
  double best = INFINITY;
  opc_set_threads(1);
  for (int i = 0; i < 20; i++) {
    eda_spectrum mask;
    eda_field field[2];
    double start = processor_time();
    lines_require(eda_mask_spectrum(host->context, &shapes, 1,
                                    (eda_frame){-512, -512, 2048, 2048},
                                    l->band(m->self), &mask, &error),
                  &error);
    for (int out = 0; out < 2; out++)
      lines_require(l->image_at(m->self, EDA_POLY, &mask, out ? 25 : 0,
                                &field[out], &error),
                    &error);
    best = fmin(best, processor_time() - start);
    eda_spectrum_clear(&mask);
    for (int out = 0; out < 2; out++) eda_field_clear(&field[out]);
  }
  bench_report("imaging.iccad_clip", best, "s", 0.01, BENCH_LOWER);
  eda_shapes_clear(&shapes);
}

int main(void) {
  host = opc_test_host();
  bench_time();
  bench_parts();
  bench_clip();
  return bench_write("imaging");
}
