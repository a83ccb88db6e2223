/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests a correction for several doses and foci with the plugins of a real
   flow: process.window simulates the mask of one transistor at the same
   corners. */
#include <eda/print.h>
#include <glib.h>
#include <math.h>
#include <string.h>
#include <sys/resource.h>

#include "tests/data.h"
#include "tools/devel/testing.h"

enum { DOSES = 3, FOCI = 2, ALL = DOSES * FOCI };

static char *source(const char *name) {
  return g_build_filename(g_getenv("OPCFLOW_SOURCE"), name, NULL);
}

static opc_module *make_sample(const char *id, const char *mapping) {
  opc_error error = {0};
  opc_module *m = opc_test_module(id, mapping, &error);
  if (!m) g_error("%s %s: %s", id, mapping, error.message);
  return m;
}

/* Run a step with an input. Returns its first output. */
static void *run_step(opc_module *m, const char *input, void *object) {
  static void *outputs[4];
  opc_error error = {0};
  if (input) opc_test_input(m, input, object);
  opc_test_forget();
  if (opc_test_run(m, outputs, &error)) g_error("%s: %s", m->id, error.message);
  return outputs[0];
}

static void object_drop(opc_module *m, void *object) {
  void *outputs[4] = {object};
  opc_test_release(m, outputs);
  opc_test_module_free(m);
}

static double cell(const char *table, const char *name, size_t row) {
  const opc_column *c = opc_table_column(opc_test_table(table), name);
  g_assert_nonnull(c);
  return ((const double *)c->data)[row];
}

static char *models(void) {
  g_autofree char *devices = source("data/devices/ptm65.yaml");
  return g_strdup_printf(
      "margin: 1000 nm, litho: { use: litho.hopkins, wavelength: 193 nm, na: "
      "0.75, sigma: 0.75 }, resist: { use: resist.threshold, anchor: { line: "
      "65 "
      "nm, pitch: 250 nm } }, extractor: { use: extractor.plain, devices: '%s' "
      "}",
      devices);
}

/* The weighted mean of the currents over all corners equals the drawn current,
   within the loop's limit or one grid step. process.window computes the same
   currents. */
static void test_one(void) {
  g_autofree char *path = source("data/cells65/nmos.cif");
  g_autofree char *text = models();
  g_autofree char *read = g_strdup_printf(
      "{ file: '%s', layers: { poly: CP, active: CA, nimplant: "
      "CSN } }",
      path);
  g_autofree char *correct = g_strdup_printf(
      "{ %s, fine: off, synthesizer: { use: synthesizer.newton }, "
      "corners: { dose: [-3 %%, 0 %%, 3 %%], focus: [0 nm, 60 nm], "
      "free: true } }",
      text);
  g_autofree char *window = g_strdup_printf(
      "{ %s, dose: [-3 %%, 0 %%, 3 %%], defocus: [0 nm, 60 nm] }", text);
  opc_module *reader = make_sample("read.cif", read);
  void *layout = run_step(reader, NULL, NULL);
  opc_module *segments = make_sample("segment.transistors", "{}");
  void *gates = run_step(segments, "layout", layout);
  opc_module *loop = make_sample("correct", correct);
  eda_mask *mask = run_step(loop, "gates", gates);
  g_assert_cmpuint(mask->gates->count, ==, 1);
  double mean = 0, ion[ALL], leakage[ALL];
  for (size_t k = 0; k < ALL; k++) {
    ion[k] = cell("corners", "ion_n", k);
    leakage[k] = cell("corners", "leakage_n", k);
    mean += cell("corners", "weight", k) * log1p(ion[k] / 100);
  }
  g_test_message("mean %.4f %%, nominal %.3f %%, at +3 %% %.3f %%", 100 * mean,
                 ion[1], ion[2]);
  g_assert_cmpfloat(fabs(mean), <, 0.005);
  g_assert_cmpfloat(ion[1], <, -2);
  double nominal = eda_deviation(mask->after.ion[0], mask->design.ion[0]);
  g_assert_cmpfloat(fabs(nominal - ion[1]), <, 1e-4);
  opc_module *windows = make_sample("process.window", window);
  run_step(windows, "mask", mask);
  for (size_t k = 0; k < ALL; k++) {
    g_assert_cmpfloat(fabs(cell("performance_window", "ion_n", k) - ion[k]), <,
                      1e-3);
    g_assert_cmpfloat(
        fabs(cell("performance_window", "leakage_n", k) / leakage[k] - 1), <,
        1e-4);
  }
  opc_test_module_free(windows);
  object_drop(loop, mask);
  object_drop(segments, gates);
  object_drop(reader, layout);
}

/* A single value in place of a list is refused; the message shows the form of a
   list with its unit. */
static void test_unit(void) {
  opc_error error = {0};
  g_assert_null(
      opc_test_module("correct", "{ corners: { dose: 3 % } }", &error));
  g_assert_nonnull(strstr(error.message, "as in '[1 %, ...]'"));
}

/* Defaults at 248 nm, NA 0.7, where wavelength / NA is 354.3 nm: 11.658, 0.155
   and 0.078 times this value. Values that the flow sets are not changed,
   including multiples of another wavelength; lengths of unused features have no
   value. */
static void test_follows(void) {
  g_autofree char *devices = source("data/devices/ptm65.yaml");
  static const struct {
    const char *given, *expected[3], *silent;
  } cases[] = {
      {"",
       {"margin 4130 nm", "min_space 55 nm", "min_edge 28 nm"},
       "assist_width"},
      {"min_space: 40 nm, fine: off, ",
       {"margin 1377 nm", "min_mask_width 55 nm", "min_edge 28 nm"},
       "min_space"},
      {"assist: 1, margin: 5 um, ",
       {"assist_width 55 nm", "assist_distance 248 nm", "min_space 55 nm"},
       "margin"}};
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    g_autofree char *mapping = g_strdup_printf(
        "{ %slitho: { use: litho.hopkins, wavelength: 248 nm, na: 0.7 }, "
        "resist: { use: resist.threshold }, extractor: { use: "
        "extractor.plain, devices: '%s' }, synthesizer: { use: "
        "synthesizer.newton } }",
        cases[i].given, devices);
    opc_test_forget();
    opc_module *m = make_sample("correct", mapping);
    for (int k = 0; k < 3; k++)
      if (!strstr(opc_test_log(), cases[i].expected[k]))
        g_error("'%s' is not in: %s", cases[i].expected[k], opc_test_log());
    g_assert_null(strstr(opc_test_log(), cases[i].silent));
    opc_test_module_free(m);
  }
}

/* A margin that causes a larger error than stated is a finding, which names the
   error of the margin (measured in README.md); a very small margin is
   refused. */
static void test_margin(void) {
  static const struct {
    const char *given, *expected;
  } cases[] = {
      {"margin: 3 um, fine: 5e-5",
       "margin 3000 nm changes the intensity by up to 9e-05 of the clear "
       "field; the error of these simulations requires 4130 nm"},
      {"margin: 1 um", "up to 0.0009 of"},
      {"margin: 1 um, fine: off", "requires 1377 nm"},
      {"margin: 3 um, fine: 5e-4", NULL},
      {"margin: 5 um", NULL},
      {"margin: 100 nm", "at least 413 nm"},
      {"margin: 1e-9 nm, fine: off", "up to 1 of"}};
  g_autofree char *devices = source("data/devices/ptm65.yaml");
  for (size_t i = 0; i < G_N_ELEMENTS(cases); i++) {
    opc_error error = {0};
    g_autofree char *mapping = g_strdup_printf(
        "{ %s, litho: { use: litho.hopkins, wavelength: 248 nm, na: 0.7 }, "
        "resist: { use: resist.threshold }, extractor: { use: "
        "extractor.plain, devices: '%s' }, synthesizer: { use: "
        "synthesizer.newton } }",
        cases[i].given, devices);
    opc_test_forget();
    opc_module *m = opc_test_module("correct", mapping, &error);
    const char *text = m ? opc_test_log() : error.message;
    g_assert_cmpint(m != NULL, ==, i < 5);
    if (cases[i].expected ? !strstr(text, cases[i].expected)
                          : strstr(text, "margin") != NULL)
      g_error("%s: %s", cases[i].given, text);
    if (m) opc_test_module_free(m);
  }
}

/* The forecast of memory is 0.8 to 1.3 times the peak memory of a process that
   corrects a circuit of 1,796 transistors. */
static void test_memory(void) {
#ifdef __SANITIZE_ADDRESS__
  g_test_skip("the sanitizer uses additional memory");
  return;
#endif
  g_autofree char *path = find_data("iscas85/c1908/c1908.gds");
  if (!path) return;
  if (!g_test_subprocess()) {
    g_test_trap_subprocess(NULL, 0, G_TEST_SUBPROCESS_INHERIT_STDERR);
    g_test_trap_assert_passed();
    return;
  }
  g_autofree char *devices = source("data/devices/ptm65.yaml");
  g_autofree char *read = g_strdup_printf(
      "{ file: '%s', scale: 1.3, layers: { poly: 9/0, active: 1/0, contact: "
      "10/0, nwell: 3/0 } }",
      path);
  g_autofree char *correct = g_strdup_printf(
      "{ litho: { use: litho.hopkins }, resist: { use: resist.threshold, "
      "anchor: { line: 65 nm, pitch: 250 nm } }, extractor: { use: "
      "extractor.plain, devices: '%s' }, synthesizer: { use: "
      "synthesizer.newton }, regulator: { use: regulator.drc }, "
      "max_iterations: 2 }",
      devices);
  opc_module *reader = make_sample("read.gds", read);
  void *layout = run_step(reader, NULL, NULL);
  opc_module *segments = make_sample("segment.transistors", "{ grid: 1 nm }");
  void *gates = run_step(segments, "layout", layout);
  opc_module *loop = make_sample("correct", correct);
  opc_test_input(loop, "gates", gates);
  opc_forecast forecast = {0};
  opc_error error = {0};
  const opc_step *step = loop->functions;
  g_assert_false(step->forecast(loop->self, &forecast, &error));
  object_drop(loop, run_step(loop, NULL, NULL));
  object_drop(segments, gates);
  object_drop(reader, layout);
  struct rusage used;
  getrusage(RUSAGE_SELF, &used);
  double peak = 1024.0 * (double)used.ru_maxrss;
  g_test_message("forecast %g MB, peak %g MB", forecast.memory * 1e-6,
                 peak * 1e-6);
  g_assert_cmpfloat(forecast.memory, >, 0.8 * peak);
  g_assert_cmpfloat(forecast.memory, <, 1.3 * peak);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/through/one", test_one);
  g_test_add_func("/through/unit", test_unit);
  g_test_add_func("/through/follows", test_follows);
  g_test_add_func("/through/margin", test_margin);
  g_test_add_func("/through/memory", test_memory);
  return g_test_run();
}
