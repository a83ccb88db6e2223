/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures imaging: the error relative to finer settings, and the time relative
   to the Fourier transforms alone, in one run. The layout consists of rows of
   65 nm lines at 250 nm pitch. */
#include "bench/bench.h"
#include "core/plugin/host.h"
#include "imaging/fft.h"
#include "imaging/lanes.h"
#include "tools/devel/testing.h"

#include <eda/eda.h>
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

static void require_good(int code, const opc_error *error) {
  if (code) g_error("%s", error->message);
}

/* ---- masks ---- */

static eda_shapes rows_of_lines(double side) {
  size_t columns = (size_t)(side / 250), rows = (size_t)(side / 1800);
  eda_shapes s = {.count = columns * rows};
  s.start = g_new0(uint32_t, s.count + 1);
  s.points = g_new(eda_point, 4 * s.count);
  for (size_t k = 0; k < s.count; k++) {
    int i = (int)(k % columns), j = (int)(k / columns);
    int x = i * 250 + 92, y = j * 1800 + 100 + i % 7 * 13,
        h = 1400 - i % 5 * 31;
    eda_point p[4] = {{x, y}, {x + 65, y}, {x + 65, y + h}, {x, y + h}};
    for (int c = 0; c < 4; c++) s.points[4 * k + (size_t)c] = p[c];
    s.start[k + 1] = (uint32_t)(4 * (k + 1));
  }
  return s;
}

static eda_frame frame_of(double side) {
  return (eda_frame){-1000, -1000, side + 2000, side + 2000};
}

static opc_module *litho(const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module("litho.hopkins", parameters, &error);
  if (!m) g_error("%s", error.message);
  const eda_litho *l = m->functions;
  require_good(l->prepare(m->self, &error), &error);
  return m;
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
  double band = l->band(m->self), cutoff = 0.75 / 193;
  int raster = eda_fft_size(f.width * band * 3.1);
  int n = eda_fft_size(f.width * 0.85 * (2 * band + 2 * cutoff));
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
  require_good(eda_mask_spectrum(host->context, s, 1, f, l->band(m->self),
                                 &mask, &error),
               &error);
  require_good(l->image(m->self, EDA_POLY, &mask, &field, &error), &error);
  double time = clock() - start;
  *fine = field.nx;
  eda_spectrum_clear(&mask);
  eda_field_clear(&field);
  return time;
}

/* Measure the layer and the transforms alternately. Return the shortest times
   of RUNS runs. */
static times layer_measure(double um, const opc_module *m, size_t kernels) {
  eda_shapes s = rows_of_lines(1000 * um);
  eda_frame f = frame_of(1000 * um);
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
  eda_shapes s = rows_of_lines(1000 * small), l = rows_of_lines(1000 * large);
  int repeats = (int)(area[1] / area[0]) + 1, fine;
  for (int i = 0; i < TURNS; i++) {
    double sum = 0;
    for (int k = 0; k < repeats; k++)
      sum += layer(&s, frame_of(1000 * small), m, processor_time, &fine);
    double other = layer(&l, frame_of(1000 * large), m, processor_time, &fine);
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
  eda_shapes s = rows_of_lines(80000);
  eda_frame f = frame_of(80000);
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
  require_good(eda_mask_spectrum(host->context, &none, 1, frame_of(500),
                                 l->band(m->self), &mask, &error),
               &error);
  require_good(l->image_at(m->self, EDA_POLY, &mask, 100, &field, &error),
               &error);
  eda_spectrum_clear(&mask);
  eda_field_clear(&field);
}

static void bench_prepare(void) {
  double best = INFINITY, resist = INFINITY, focus = INFINITY;
  for (int i = 0; i < RUNS; i++) {
    opc_error error;
    double start = processor_time();
    g_autoptr(opc_module) m = litho("{}");
    best = fmin(best, processor_time() - start);
    start = processor_time();
    defocus_measure(m);
    focus = fmin(focus, processor_time() - start);
    g_autoptr(opc_module) r = opc_test_module("resist.threshold", "{}", &error);
    if (!r) g_error("%s", error.message);
    const eda_resist *operations = r->functions;
    start = processor_time();
    require_good(operations->prepare(r->self, m, &error), &error);
    resist = fmin(resist, processor_time() - start);
  }
  bench_report("imaging.prepare.litho", best, "s", 0.03, BENCH_LOWER);
  bench_report("imaging.prepare.defocus", focus, "s", 0.15, BENCH_LOWER);
  bench_report("imaging.prepare.resist", resist, "s", 0.01, BENCH_LOWER);
}

static void bench_time(void) {
  g_autoptr(opc_module) m = litho("{}");
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

static const double cutoff = 0.75 / 193, sigma = 0.75;

/* Compute the transfer function of a point source on a ring: the shifted
   pupil. */
static void shifted_pupil(const void *self, size_t s, const double *fx,
                          double fy, size_t n, float *out) {
  const size_t *count = self;
  double angle = 2 * M_PI * (double)s / (double)*count;
  double x = sigma * cos(angle), y = fy / cutoff + sigma * sin(angle);
  for (size_t i = 0; i < n; i++) {
    double u = fx[i] / cutoff + x;
    out[2 * i] = u * u + y * y <= 1;
    out[2 * i + 1] = 0;
  }
}

/* Return zeros: measures the time without the transfer function. */
static void no_transfer(const void *self, size_t s, const double *fx, double fy,
                        size_t n, float *out) {
  (void)self;
  (void)s;
  (void)fx;
  (void)fy;
  memset(out, 0, 2 * n * sizeof *out);
}

enum { MOST_SYSTEMS = 64 };

static eda_kernels kernels_of(size_t *count, double scale) {
  static double weight[MOST_SYSTEMS];
  for (size_t i = 0; i < *count; i++) weight[i] = 1 / (double)*count;
  return (eda_kernels){.count = *count,
                       .weight = weight,
                       .band = (1 + sigma) * cutoff,
                       .intensity_band = 2 * cutoff * scale,
                       .transfer = shifted_pupil,
                       .self = count};
}

static double plain_sum(const eda_spectrum *mask, size_t count) {
  eda_kernels kernels = kernels_of(&count, 1);
  eda_field field;
  opc_error error;
  kernels.transfer = no_transfer;
  double start = processor_time();
  require_good(
      eda_coherent_sum(host->context, mask, &kernels, 0, &field, &error),
      &error);
  double time = processor_time() - start;
  eda_field_clear(&field);
  return time;
}

/* Measure the transforms of the fields alone, by the same code, in the cache:
   of the columns within the band along y, of all rows along x. Any sum of that
   many kernels needs them. */
static double plain_lines(eda_frame f, size_t kernels) {
  double band = (1 + sigma) * cutoff;
  int n = eda_lanes_size(f.width * 0.85 * (2 * band + 2 * cutoff));
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
  g_autoptr(opc_module) m = litho("{ kernels: 12 }");
  opc_error error;
  g_autoptr(opc_module) r = opc_test_module("resist.threshold", "{}", &error);
  if (!r) g_error("%s", error.message);
  const eda_litho *l = m->functions;
  const eda_resist *resist = r->functions;
  require_good(resist->prepare(r->self, m, &error), &error);
  eda_shapes s = rows_of_lines(60000);
  eda_frame f = frame_of(60000);
  double part[PARTS][TURNS];
  opc_set_threads(1);
  for (int i = 0; i < TURNS; i++) {
    eda_spectrum mask;
    eda_field field;
    double start = processor_time();
    require_good(eda_mask_spectrum(host->context, &s, 1, f, l->band(m->self),
                                   &mask, &error),
                 &error);
    part[0][i] = processor_time() - start;
    start = processor_time();
    require_good(l->image(m->self, EDA_POLY, &mask, &field, &error), &error);
    double image = processor_time() - start;
    double one = plain_sum(&mask, 1), all = plain_sum(&mask, SYSTEMS);
    double each = (all - one) / (SYSTEMS - 1);
    part[1][i] = image - all;
    part[2][i] = SYSTEMS * each;
    part[3][i] = one - each;
    start = processor_time();
    require_good(resist->print(r->self, EDA_POLY, &field, &error), &error);
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

/* ---- error ---- */

/* Compute an image by some source points within the band of a scanner.
   `raster`, `grid` and `nodes` are the refinements of the mask raster, of the
   grid of the fields, and of the grid of the result. The result is at least as
   fine as the fields require. */
static eda_field image_sampled(const eda_shapes *s, eda_frame f, int raster,
                               int grid, int nodes) {
  size_t count = 16;
  eda_kernels kernels = kernels_of(&count, grid ? 4 : 1);
  eda_spectrum mask;
  eda_field field;
  opc_error error;
  require_good(
      eda_mask_spectrum(host->context, s, 1, f, kernels.band * (raster ? 3 : 1),
                        &mask, &error),
      &error);
  require_good(eda_coherent_sum(host->context, &mask, &kernels, nodes ? 8 : 32,
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
  require_good(
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
  eda_shapes s = rows_of_lines(6000);
  eda_frame f = frame_of(6000);
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
  g_autoptr(opc_module) m = litho(parameters);
  g_autoptr(opc_module) r = opc_test_module("resist.threshold", "{}", &error);
  if (!r) g_error("%s", error.message);
  const eda_litho *l = m->functions;
  const eda_resist *resist = r->functions;
  require_good(resist->prepare(r->self, m, &error), &error);
  eda_spectrum mask;
  eda_field field;
  require_good(eda_mask_spectrum(host->context, s, 1, f, l->band(m->self),
                                 &mask, &error),
               &error);
  require_good(l->image(m->self, EDA_POLY, &mask, intensity, &error), &error);
  require_good(l->image(m->self, EDA_POLY, &mask, &field, &error), &error);
  require_good(resist->print(r->self, EDA_POLY, &field, &error), &error);
  eda_spectrum_clear(&mask);
  return field;
}

/* The reference of all kernels deviates by 6e-5 from the double sum over T on
   these lines, so the goals are the stated errors and 6e-5. */
static void bench_error(void) {
  eda_shapes s = rows_of_lines(6000);
  eda_frame f = frame_of(6000);
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
  require_good(opc_test_run(m, out, &error), &error);
  eda_flat flat;
  eda_shapes merged;
  int32_t layer = eda_layout_find_layer(out[0], "M1");
  int32_t top = eda_layout_top(out[0], &error);
  require_good(eda_layout_flatten(out[0], top, layer, 1, &flat, &error),
               &error);
  require_good(eda_boolean(EDA_OR, &flat.shapes, NULL, &merged, &error),
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
  require_good(l->prepare(m->self, &error), &error);
  eda_shapes shapes = read_clip(clip);
  double best = INFINITY;
  opc_set_threads(1);
  for (int i = 0; i < 20; i++) {
    eda_spectrum mask;
    eda_field field[2];
    double start = processor_time();
    require_good(eda_mask_spectrum(host->context, &shapes, 1,
                                   (eda_frame){-512, -512, 2048, 2048},
                                   l->band(m->self), &mask, &error),
                 &error);
    for (int out = 0; out < 2; out++)
      require_good(l->image_at(m->self, EDA_POLY, &mask, out ? 25 : 0,
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
  bench_edges();
  bench_error();
  bench_clip();
  return bench_write("imaging");
}
