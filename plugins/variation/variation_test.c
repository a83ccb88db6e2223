/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the surrogate of the step against simulations at random conditions,
   with displaced mask shapes in place of displaced images, and the tables of
   the step. */
#include <eda/check.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tools/devel/testing.h"
#include "variation.h"

#define MODELS                                                              \
  "litho: { use: litho.hopkins, wavelength: 193 nm, na: 0.75, sigma: 0.75 " \
  "}, resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 "  \
  "nm } }, extractor: { use: extractor.plain, devices: '%s' }"

static opc_module *module_make(const char *id, const char *format, ...) {
  g_autofree char *devices = g_build_filename(
      g_getenv("OPCFLOW_SOURCE"), "data", "devices", "ptm65.yaml", NULL);
  g_autofree char *models = g_strdup_printf(MODELS, devices);
  opc_error error = {0};
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *more = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  int plain = !strcmp(id, "read.gds") || !strcmp(id, "segment.transistors");
  g_autofree char *map =
      plain ? g_strdup_printf("{ %s }", more)
            : g_strdup_printf("{ %s, fine: off, %s }", models, more);
  opc_module *m = opc_test_module(id, map, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

static void *run_step(opc_module *m, const char *input, const void *object) {
  void *outputs[1] = {NULL};
  opc_error error = {0};
  if (input) opc_test_input(m, input, (void *)object);
  if (opc_test_run(m, outputs, &error)) g_error("%s", error.message);
  return outputs[0];
}

/* ---- simulation of a condition ---- */

/* Factor of the grid on which masks are displaced: 0.01 nm for a grid of 1. */
enum { FACTOR = 100, LAYERS = 2 };

/* Simulate and measure at displaced masks, z in the units of the variables. */
static void condition_simulate(const variation *v, const double z[VARIABLES],
                               eda_measurement *out) {
  const eda_gates *g = v->gates;
  eda_printer p;
  opc_error error = {0};
  eda_field print[LAYERS];
  eda_printer_init(&p, v->host->context, g, v->with.litho, v->with.resist,
                   v->with.margin);
  g_assert_false(eda_printer_prepare(&p, &error));
  p.grid /= FACTOR;
  for (int k = 0; k < LAYERS; k++) {
    const double *own = z + (k ? ACTIVE_DOSE : POLY_DOSE);
    eda_shapes shapes, moved;
    eda_spectrum spectrum;
    g_assert_false(
        eda_boolean(EDA_OR, &v->mask->shapes[k], NULL, &shapes, &error));
    for (size_t i = 0; i < shapes.start[shapes.count]; i++) {
      eda_point *q = &shapes.points[i];
      q->x = q->x * FACTOR + (k ? (int32_t)lround(z[OVERLAY_X] / p.grid) : 0);
      q->y = q->y * FACTOR + (k ? (int32_t)lround(z[OVERLAY_Y] / p.grid) : 0);
    }
    g_assert_false(eda_shapes_grow(&shapes, (int32_t)lround(own[2] / p.grid),
                                   &moved, &error));
    g_assert_false(eda_printer_spectrum(&p, &moved, &spectrum, &error));
    eda_field light;
    if (p.litho.functions.image_at(&p.litho, k, &spectrum, own[1], &light,
                                   &error))
      g_error("%s", error.message);
    print[k] = eda_field_scaled(&light, 1 + own[0] / 100);
    g_assert_false(eda_printer_develop(&p, k, &print[k], &error));
    eda_field_clear(&light);
    eda_spectrum_clear(&spectrum);
    eda_shapes_clear(&moved);
    eda_shapes_clear(&shapes);
  }
  g_assert_false(
      eda_measure(v->host->context, g, print, v->with.extractor, out, &error));
  for (int k = 0; k < LAYERS; k++) eda_field_clear(&print[k]);
  eda_printer_clear(&p);
}

/* Compare the surrogate with simulations at n normally distributed
   conditions. */
static void surrogate_compare(const variation *v, uint32_t n) {
  const surrogate *s = &v->surrogate;
  double *features = eda_alloc(s->terms, sizeof *features);
  double rms[3] = {0}, spread = 0, count = (double)n * (double)v->gates->count;
  eda_measurement m;
  eda_measurement_init(&m, v->gates->count);
  for (uint32_t k = 0; k < n; k++) {
    double z[VARIABLES], u[VARIABLES];
    for (uint32_t i = 0; i < VARIABLES; i++) {
      z[i] = v->sigma[i] * normal_at(99, 50, k, i);
      u[i] = z[i] / (variation_range * v->sigma[i]);
    }
    condition_simulate(v, z, &m);
    surrogate_features(s, u, features);
    for (size_t i = 0; i < v->gates->count; i++) {
      double l = surrogate_at(s, features, LENGTH, i);
      double off = surrogate_at(s, features, LENGTH_OFF, i);
      double w = surrogate_at(s, features, WIDTH, i);
      double drawn = v->gates->length[i];
      double ion = curves_at(&v->curves, i, ION, drawn + l) + w;
      double ioff = curves_at(&v->leakage, i, IOFF, drawn + off) + w;
      double want = log(m.performance.ion[i] / v->design.ion[i]);
      rms[0] += pow(100 * (ion - want), 2);
      spread += pow(100 * want, 2);
      want = log(m.performance.ioff[i] / v->design.ioff[i]);
      rms[1] += pow(M_LOG10E * (ioff - want), 2);
      rms[2] += pow(drawn + l - m.performance.leq_ion[i], 2);
    }
  }
  for (int k = 0; k < 3; k++) rms[k] = sqrt(rms[k] / count);
  g_test_message(
      "%u conditions: rms of Ion %.4f %% (spread %.2f %%), log10 "
      "Ioff %.5f, L %.4f nm",
      n, rms[0], sqrt(spread / count), rms[1], rms[2]);
  g_assert_cmpfloat(sqrt(spread / count), >, 2);
  g_assert_cmpfloat(rms[0], <, 0.3);
  g_assert_cmpfloat(rms[1], <, 0.02);
  g_assert_cmpfloat(rms[2], <, 0.1);
  eda_measurement_clear(&m);
  free(features);
}

/* ---- the step ---- */

/* Check relations between the tables. */
static void check_tables(void) {
  double sum = 0;
  for (size_t i = 0; i < opc_test_rows("sources"); i++)
    sum += opc_test_number("sources", "ion_n", i);
  g_assert_cmpuint(opc_test_rows("sources"), ==, SOURCES);
  g_assert_cmpfloat(sum, >, 0.8); /* the rest is from interactions */
  g_assert_cmpfloat(sum, <, 1.1);
  for (size_t i = 0; i < 4; i++) {
    double low = opc_test_number("yield", "low", i);
    double yield = opc_test_number("yield", "yield", i);
    g_assert_true(low <= yield && yield <= opc_test_number("yield", "high", i));
    g_assert_true(opc_test_number("yield", "yield", 3) <= yield);
  }
  double all = 0;
  for (size_t i = 0; i < opc_test_rows("histograms"); i++)
    all += opc_test_number("histograms", "chips", i);
  g_assert_cmpfloat(all, >, 3 * 99.7); /* three figures; 0.1 % at each end */
  g_assert_cmpfloat(opc_test_metric("images_poly"), <=, 40);
  g_assert_cmpfloat(opc_test_metric("surrogate_ion"), <, 0.3);
}

static opc_module *run_sample(const char *more, const eda_mask *mask) {
  opc_test_forget();
  opc_module *m = module_make("variation", "%s", more);
  void *chips = run_step(m, "mask", mask);
  opc_test_release(m, &chips);
  return m;
}

static void test_sample(void) {
  if (opc_test_sanitized_skip()) return;
  opc_module *loop =
      module_make("correct",
                  "synthesizer: { use: synthesizer.dpb }, max_iterations: 6, "
                  "regulator: { use: regulator.drc, min_extension: 40 nm }");
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  opc_module *m = run_sample("chips: 2000", mask);
  surrogate_compare(m->self, 6);
  check_tables();
  double yield = opc_test_metric("yield"), q = opc_test_metric("leakage_q99");
  double sigma = opc_test_metric("ion_p_sigma");
  opc_test_module_free(m);
  /* The same chips in another run. */
  opc_test_module_free(run_sample("chips: 2000", mask));
  g_assert_true(opc_test_metric("yield") == yield);
  g_assert_true(opc_test_metric("leakage_q99") == q);
  /* Without the dose, the variation is smaller. */
  m = run_sample("chips: 2000, seed: 2, dose: 0 %, edges.sigma: 0 nm", mask);
  opc_test_module_free(m);
  g_assert_cmpuint(opc_test_rows("sources"), ==, SOURCES - 3);
  g_assert_cmpfloat(opc_test_metric("ion_p_sigma"), <, sigma);
  void *outputs[1] = {mask};
  opc_test_release(loop, outputs);
  opc_test_module_free(loop);
}

/* Return the row of a table whose column `name` is `text`. */
static size_t row_of(const char *table, const char *name, const char *text) {
  for (size_t i = 0; i < opc_test_rows(table); i++)
    if (!strcmp(opc_test_text(table, name, i), text)) return i;
  g_error("table '%s' has no row '%s'", table, text);
}

/* Test the delays of chips against the sizes in the tables of these chips, and
   the yield against a normal distribution. The arc in the SDF file has the
   derivatives of the path, and is compared with the table of the path. */
static void test_delays(void) {
  enum { TABLES = 30, MOST_GATES = 64 };
  if (opc_test_sanitized_skip()) return;
  opc_module *loop =
      module_make("correct",
                  "synthesizer: { use: synthesizer.dpb }, max_iterations: 6, "
                  "regulator: { use: regulator.drc, min_extension: 40 nm }");
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  const eda_performance *after = &mask->after;
  size_t n = mask->gates->count;
  g_assert_cmpuint(n, <=, MOST_GATES);
  eda_delay_term term[MOST_GATES];
  for (size_t i = 0; i < n; i++)
    term[i] = (eda_delay_term){(uint32_t)i, {20 + (float)i, -9, 4}};
  eda_delay_path path = {.delay = {50, n, term}, .from = "a", .to = "z"};
  eda_delay_arc arc = {{50, n, term}, "INV", "U1", "A", "Y", 1};
  eda_delays d = {.name = "top",
                  .gates = mask->gates,
                  .size = {after->leq_ion, after->weq, after->area},
                  .drawn = 50,
                  .paths = 1,
                  .path = &path,
                  .arcs = 1,
                  .arc = &arc};
  void *none[1] = {NULL};
  opc_error error = {0};
  opc_test_forget();
  opc_module *m =
      module_make("variation",
                  "chips: 20000, tables: %d, clock: 52 ps, sdf: x.sdf", TABLES);
  opc_test_input(m, "mask", mask);
  opc_test_input(m, "delays", &d);
  if (opc_test_run(m, none, &error)) g_error("%s", error.message);
  double mean = opc_test_metric("delay_mean");
  double sigma = opc_test_metric("delay_sigma");
  const variation *own = m->self;
  g_assert_cmpfloat(sigma, >, 1);
  for (size_t chip = 0; chip < TABLES; chip++) {
    g_autofree char *name = g_strdup_printf("chip%zu", chip + 1);
    double sum = 50;
    for (size_t i = 0; i < n; i++) {
      double l = opc_test_number(name, "leq_ion", i);
      double w = opc_test_number(name, "weq", i);
      double a = mask->gates->length[i] * mask->gates->width[i] *
                 (1 + opc_test_number(name, "area_after", i) / 100);
      sum += (20 + (double)i) * log(l / after->leq_ion[i]) -
             9 * log(w / after->weq[i]) +
             4 * log(a / w / (after->area[i] / after->weq[i]));
    }
    const eda_samples *chips = none[0];
    for (size_t i = 0; i < n; i++) {
      const eda_performance *p = &chips->of[chip];
      double ion = opc_test_number(name, "ion_after", i) / 100;
      g_assert_true(p->leq_ion[i] == opc_test_number(name, "leq_ion", i));
      g_assert_true(p->weq[i] == opc_test_number(name, "weq", i));
      g_assert_cmpfloat(fabs(p->ion[i] / own->design.ion[i] - 1 - ion), <,
                        1e-9);
    }
    double got = opc_test_number("chips", "delay", chip);
    if (!(fabs(got - sum) < 0.03 * sigma))
      g_error("chip %zu: %g is not %g (sigma %g)", chip, got, sum, sigma);
  }
  double yield = opc_test_metric("yield_delay");
  double want = 50 * erfc((mean - 52) / sigma / sqrt(2));
  if (!(fabs(yield - want) < 3)) g_error("%g is not %g", yield, want);
  size_t row = row_of("yield", "limit", "longest path");
  g_assert_true(opc_test_number("yield", "yield", row) == yield);
  double one = opc_test_number("paths", "mean", 0);
  double of_path = opc_test_number("paths", "sigma", 0);
  if (!(fabs(one - mean) < 0.05 * sigma && fabs(of_path / sigma - 1) < 0.05))
    g_error("%g, %g are not %g, %g", one, of_path, mean, sigma);
  g_autofree char *file = g_build_filename(opc_test_folder(), "x.sdf", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(file, &text, NULL, NULL));
  const char *first = strstr(text, "(IOPATH A Y (");
  g_assert_nonnull(first);
  double least = atof(first + strlen("(IOPATH A Y ("));
  if (!(fabs(least - (one - 3 * of_path)) < 2e-3))
    g_error("%g: %s", least, text);
  opc_test_release(m, none);
  opc_test_module_free(m);
  /* Delays of other gates are refused. */
  d.gates = NULL;
  m = module_make("variation", "chips: 2000");
  opc_test_input(m, "mask", mask);
  opc_test_input(m, "delays", &d);
  g_assert_cmpint(opc_test_run(m, none, &error), ==, OPC_INVALID);
  g_assert_nonnull(strstr(error.message, "give 'circuit'"));
  opc_test_module_free(m);
  void *outputs[1] = {mask};
  opc_test_release(loop, outputs);
  opc_test_module_free(loop);
}

/* If a line end barely covers the active, the leakage under overlay is not a
   polynomial: the step fails. */
static void test_line_end(void) {
  if (opc_test_sanitized_skip()) return;
  opc_module *loop = module_make(
      "correct", "synthesizer: { use: synthesizer.dpb }, max_iterations: 0");
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  opc_module *m = module_make("variation", "chips: 2000, overlay: 8 nm");
  void *none[1];
  opc_error error = {0};
  opc_test_input(m, "mask", mask);
  g_assert_cmpint(opc_test_run(m, none, &error), ==, OPC_FAILED);
  if (!strstr(error.message, "reduce the standard deviations"))
    g_error("%s", error.message);
  opc_test_module_free(m);
  void *outputs[1] = {mask};
  opc_test_release(loop, outputs);
  opc_test_module_free(loop);
}

/* Values of `mismatch` in a wrong unit: the leakage of all chips would be 0 or
   infinite. Without `delays`, `clock` and `sdf` would be ignored. */
static void test_run_refused(void) {
  static const char *const bad[][2] = {
      {"mismatch: { vt: 4 V }", "mismatch.vt"},
      {"mismatch: { vt: 4 mV, swing: 0.1 mV }", "mismatch.vt"},
      {"mismatch: { vt: 4 mV, ion: 1600 }", "mismatch.vt"},
      {"clock: 1 ns", "clock"},
      {"sdf: a.sdf", "sdf"}};
  opc_module *loop = module_make(
      "correct", "synthesizer: { use: synthesizer.dpb }, max_iterations: 0");
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  for (size_t k = 0; k < G_N_ELEMENTS(bad); k++) {
    g_autofree char *more = g_strdup_printf("chips: 2000, %s", bad[k][0]);
    opc_module *m = module_make("variation", more);
    void *none[1];
    opc_error error = {0};
    opc_test_input(m, "mask", mask);
    g_assert_cmpint(opc_test_run(m, none, &error), ==, OPC_INVALID);
    g_assert_cmpstr(error.parameter, ==, bad[k][1]);
    opc_test_module_free(m);
  }
  void *outputs[1] = {mask};
  opc_test_release(loop, outputs);
  opc_test_module_free(loop);
}

static void module_refuse(const char *more, const char *why) {
  g_autofree char *devices = g_build_filename(
      g_getenv("OPCFLOW_SOURCE"), "data", "devices", "ptm65.yaml", NULL);
  g_autofree char *models = g_strdup_printf(MODELS, devices);
  g_autofree char *map = g_strdup_printf("{ %s, %s }", models, more);
  opc_error error = {0};
  g_assert_null(opc_test_module("variation", map, &error));
  if (!strstr(error.message, why))
    g_error("'%s' does not say '%s'", error.message, why);
}

static void test_refused(void) {
  module_refuse("dose: 30 %", "'dose' is 30 %, expected less than 25 %");
  module_refuse("edges.hurst: 1.1", "edges.hurst");
  module_refuse("chips: 10", "chips");
  module_refuse("edges.sigma: 1 um", "edges.sigma");
  module_refuse("file: a.jpg", ".png, .svg or .pdf");
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/variation/sample", test_sample);
  g_test_add_func("/variation/delays", test_delays);
  g_test_add_func("/variation/line-end", test_line_end);
  g_test_add_func("/variation/refused", test_refused);
  g_test_add_func("/variation/run/refused", test_run_refused);
  return g_test_run();
}
