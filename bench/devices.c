/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures transistors from contours: the time for 14,000 transistors, also
   relative to that of 60 samples of the same fields for each transistor. If
   test data exist, also measures the error of 12 slices relative to many
   slices, on drawn masks. */
#include <eda/eda.h>
#include <glib.h>
#include <math.h>
#include <string.h>
#include <time.h>

#include "bench/bench.h"
#include "core/plugin/host.h"
#include "tools/devel/testing.h"

enum { RUNS = 5, SAMPLES = 60, FIGURES = 6 };

static const opc_host *host;

/* Return the processor time of this process, independent of other load. */
static double time_now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void require_good(int code, const opc_error *error) {
  if (code) g_error("%s", error->message);
}

static opc_module *module_make(const char *id, const char *parameters) {
  opc_error error;
  opc_module *m = opc_test_module(id, parameters, &error);
  if (!m) g_error("%s", error.message);
  return m;
}

static const char *setting(const char *name, const char *preset) {
  const char *value = g_getenv(name);
  return value ? value : preset;
}

/* ---- prints ---- */

typedef struct models {
  opc_module *litho, *resist;
} models;

static models models_make(void) {
  models m = {module_make("litho.hopkins",
                          "{ wavelength: 193 nm, na: 0.75, sigma: 0.75 }"),
              module_make("resist.threshold",
                          "{ anchor: { line: 65 nm, pitch: 250 nm } }")};
  const eda_litho *litho = m.litho->functions;
  const eda_resist *resist = m.resist->functions;
  opc_error error;
  require_good(litho->prepare(m.litho->self, &error), &error);
  require_good(resist->prepare(m.resist->self, m.litho, &error), &error);
  return m;
}

/* Transistors of a layout and the simulated image of the uncorrected mask. */
typedef struct chip {
  opc_module *segment;
  const eda_gates *gates;
  eda_field print[2]; /* poly, active */
} chip;

static void print_layer(const models *m, const eda_gates *g, int layer,
                        eda_field *out) {
  const eda_litho *litho = m->litho->functions;
  const eda_resist *resist = m->resist->functions;
  const double margin = 1000;
  eda_box b = g->extent;
  eda_frame f = {b.x0 * g->grid - margin, b.y0 * g->grid - margin,
                 (b.x1 - b.x0) * g->grid + 2 * margin,
                 (b.y1 - b.y0) * g->grid + 2 * margin};
  eda_spectrum mask;
  opc_error error;
  require_good(eda_mask_spectrum(host->context, &g->drawn[layer], g->grid, f,
                                 litho->band(m->litho->self), &mask, &error),
               &error);
  require_good(litho->image(m->litho->self, layer, &mask, out, &error), &error);
  eda_spectrum_clear(&mask);
  require_good(resist->print(m->resist->self, layer, out, &error), &error);
}

/* Prepare the chip of a layout. Returns 0 if the cell has no transistor. */
static int chip_make(const models *m, eda_layout *layout, const char *top,
                     chip *c) {
  g_autofree char *map = g_strdup_printf("{ top: '%s' }", top);
  c->segment = module_make("segment.transistors", map);
  opc_test_input(c->segment, "layout", layout);
  opc_error error;
  void *gates = NULL;
  int code = opc_test_run(c->segment, &gates, &error);
  if (code && strstr(error.message, "no transistor")) {
    opc_test_module_free(c->segment);
    return 0;
  }
  require_good(code, &error);
  c->gates = gates;
  for (int layer = 0; layer < 2; layer++)
    print_layer(m, c->gates, layer, &c->print[layer]);
  return 1;
}

static void chip_free(chip *c) {
  void *gates = (void *)c->gates;
  for (int layer = 0; layer < 2; layer++) eda_field_clear(&c->print[layer]);
  opc_test_release(c->segment, &gates);
  opc_test_module_free(c->segment);
}

/* ---- measuring ---- */

static opc_module *extractor(const char *more) {
  g_autofree char *devices = g_build_filename(
      setting("OPCFLOW_SOURCE", "."), "data", "devices", "ptm65.yaml", NULL);
  g_autofree char *map = g_strdup_printf("{ devices: '%s'%s }", devices, more);
  opc_module *m = module_make("extractor.plain", map);
  const eda_extractor *e = m->functions;
  opc_error error;
  require_good(e->prepare(m->self, &error), &error);
  return m;
}

/* Return all figures of a layout, FIGURES * count numbers, in the order of
   eda_performance. */
static double *layout_measure(const chip *c, const opc_module *extract,
                              uint32_t *flags) {
  size_t n = c->gates->count;
  double *figures = g_new(double, FIGURES *n);
  eda_measurement out;
  eda_measurement_init(&out, n);
  opc_error error;
  require_good(eda_measure(NULL, c->gates, c->print, extract, &out, &error),
               &error);
  for (size_t k = 0; k < FIGURES; k++)
    memcpy(figures + k * n, (&out.performance.ion)[k], n * sizeof *figures);
  memcpy(flags, out.flags, n * sizeof *flags);
  eda_measurement_clear(&out);
  return figures;
}

/* ---- time ---- */

/* Return a layout of 14,000 transistors: rows of lines that each cross two
   actives. */
static eda_layout *rows_of_gates(void) {
  enum { COLUMNS = 250, ROWS = 28 };
  opc_error error;
  eda_layout *l = eda_layout_new(1, &error);
  int32_t cell = eda_layout_cell(l, "ROWS", &error);
  static const char *const names[] = {"poly", "active", "nwell"};
  int32_t layer[3];
  for (int k = 0; k < 3; k++) layer[k] = eda_layout_layer(l, names[k], &error);
  for (int32_t j = 0; j < ROWS; j++) {
    int32_t y = j * 1900, end = COLUMNS * 250;
    eda_box n = {-100, y, end, y + 540}, p = {-100, y + 760, end, y + 1580};
    eda_box well = {-200, y + 650, end + 100, y + 1750};
    require_good(eda_layout_add_box(l, cell, layer[1], n, &error), &error);
    require_good(eda_layout_add_box(l, cell, layer[1], p, &error), &error);
    require_good(eda_layout_add_box(l, cell, layer[2], well, &error), &error);
    for (int32_t i = 0; i < COLUMNS; i++) {
      eda_box line = {i * 250, y - 100 - i % 5 * 5, i * 250 + 65,
                      y + 1680 + i % 7 * 5};
      require_good(eda_layout_add_box(l, cell, layer[0], line, &error), &error);
    }
  }
  return l;
}

static double chip_sample(const chip *c) {
  double start = time_now(), sum = 0;
  for (size_t i = 0; i < c->gates->count; i++) {
    eda_box b = c->gates->box[i];
    double x[SAMPLES], y[SAMPLES], value[SAMPLES];
    for (int k = 0; k < SAMPLES; k++) {
      x[k] = b.x0 + (b.x1 - b.x0) * k / 60.0;
      y[k] = b.y0 + (b.y1 - b.y0) * k / 60.0;
    }
    eda_field_sample(&c->print[EDA_POLY], x, y, SAMPLES, value);
    for (int k = 0; k < SAMPLES; k++) sum += value[k];
  }
  if (!isfinite(sum)) g_error("samples are not finite");
  return time_now() - start;
}

static void bench_time(const models *m) {
  static const struct {
    const char *name, *more;
    double reach;
  } rules[] = {{"contour", "", 0.10}, {"gauss", ", rule: gauss", 0.10}};
  eda_layout *layout = rows_of_gates();
  chip c;
  if (!chip_make(m, layout, "ROWS", &c)) g_error("no transistors");
  g_autofree uint32_t *flags = g_new(uint32_t, c.gates->count);
  for (size_t r = 0; r < G_N_ELEMENTS(rules); r++) {
    g_autoptr(opc_module) extract = extractor(rules[r].more);
    double best = INFINITY, samples = INFINITY;
    for (int i = 0; i < RUNS; i++) {
      double start = time_now();
      g_free(layout_measure(&c, extract, flags));
      best = fmin(best, time_now() - start);
      samples = fmin(samples, chip_sample(&c));
    }
    g_autofree char *time =
        g_strdup_printf("devices.%s_%zu_gates", rules[r].name, c.gates->count);
    g_autofree char *over =
        g_strdup_printf("devices.%s_over_%d_samples", rules[r].name, SAMPLES);
    bench_report(time, best, "s", rules[r].reach, BENCH_LOWER);
    bench_report(over, best / samples, "", INFINITY, BENCH_LOWER);
  }
  chip_free(&c);
  eda_layout_free(layout);
}

/* ---- error ---- */

enum { RULES = 3, CURRENTS = 2 };
static const char *const rule_names[RULES] = {"contour", "gauss", "equal"};

/* |Error| of Ion and Ioff of all gates, %, for each rule of extractor.plain
   (parameter `rule`) with 12 slices. */
typedef struct errors {
  opc_module *extract[RULES], *many;
  GArray *error[RULES][CURRENTS];
} errors;

static void errors_make(errors *e) {
  for (int r = 0; r < RULES; r++) {
    g_autofree char *more =
        g_strdup_printf(", rule: %s, slices: 12", rule_names[r]);
    e->extract[r] = extractor(more);
    for (int k = 0; k < CURRENTS; k++)
      e->error[r][k] = g_array_new(FALSE, FALSE, sizeof(double));
  }
  e->many = extractor(", rule: gauss, slices: 1000");
}

static void errors_add(errors *e, const chip *c) {
  size_t n = c->gates->count;
  g_autofree uint32_t *flags = g_new(uint32_t, n);
  g_autofree double *want = layout_measure(c, e->many, flags);
  for (int r = 0; r < RULES; r++) {
    g_autofree double *got = layout_measure(c, e->extract[r], flags);
    for (size_t i = 0; i < CURRENTS * n; i++) {
      double error = 100 * fabs(got[i] / want[i] - 1);
      g_array_append_val(e->error[r][i / n], error);
    }
  }
}

static void errors_report(errors *e, const char *name) {
  static const char *const currents[CURRENTS] = {"ion", "ioff"};
  for (int r = 0; r < RULES; r++)
    for (int k = 0; k < CURRENTS; k++) {
      double *x = (double *)(void *)e->error[r][k]->data, mean = 0;
      size_t n = e->error[r][k]->len;
      bench_median(x, n); /* sorts */
      for (size_t i = 0; i < n; i++) mean += x[i] / (double)n;
      double reach = r || k ? INFINITY : 0.01;
      const struct {
        const char *what;
        double value;
      } figures[] = {
          {"mean", mean}, {"99", x[n * 99 / 100]}, {"max", x[n - 1]}};
      for (int f = 0; f < 3; f++) {
        g_autofree char *full =
            g_strdup_printf("%s.%s_12_%s_%s", name, rule_names[r], currents[k],
                            figures[f].what);
        bench_report(full, figures[f].value, "%", reach, BENCH_LOWER);
      }
      g_array_free(e->error[r][k], TRUE);
    }
  for (int r = 0; r < RULES; r++) opc_test_module_free(e->extract[r]);
  opc_test_module_free(e->many);
}

/* Report the errors for all cells with transistors (`top` NULL) or for the cell
   `top`; nothing if the file is missing. */
static void bench_error(const models *m, const char *name, const char *file,
                        const char *top) {
  g_autofree char *beside = g_build_filename(setting("OPCFLOW_SOURCE", "."),
                                             "..", "shared", "data", NULL);
  g_autofree char *path =
      g_build_filename(setting("OPCFLOW_TEST_DATA", beside), file, NULL);
  if (!g_file_test(path, G_FILE_TEST_EXISTS)) {
    g_printerr("%s: skipped, no '%s'\n", name, path);
    return;
  }
  g_autofree char *map = g_strdup_printf(
      "{ file: '%s', scale: 1.3, layers: { poly: 9/0, active: 1/0, "
      "contact: 10/0, nwell: 3/0 } }",
      path);
  g_autoptr(opc_module) reader = module_make("read.gds", map);
  opc_error error;
  void *layout = NULL;
  require_good(opc_test_run(reader, &layout, &error), &error);
  errors e;
  errors_make(&e);
  for (size_t k = 0; k < eda_layout_cells(layout); k++) {
    const char *cell = eda_layout_cell_name(layout, (int32_t)k);
    chip c;
    if ((top && strcmp(cell, top)) || !chip_make(m, layout, cell, &c)) continue;
    errors_add(&e, &c);
    chip_free(&c);
  }
  errors_report(&e, name);
  opc_test_release(reader, &layout);
}

int main(void) {
  host = opc_test_host();
  opc_set_threads(1);
  models m = models_make();
  bench_time(&m);
  bench_error(&m, "nangate45", "nangate45/NangateOpenCellLibrary.gds", NULL);
  bench_error(&m, "c432", "iscas85/c432/c432.gds", "c432");
  opc_test_module_free(m.litho);
  opc_test_module_free(m.resist);
  return bench_write("devices");
}
