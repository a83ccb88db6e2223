/* SPDX-License-Identifier: BSD-3-Clause */
/* Tests the repeated simulation of a mask: by the same models, where no figure
   may change, and by other models, where the change equals that of the
   figures. */
#include <eda/gates.h>
#include <eda/print.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "tools/devel/testing.h"

#define RESIST                                                             \
  "resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 nm " \
  "} }"

/* `more`: further parameters, or a replacement of the extractor. */
static opc_module *try_to_make(const char *id, const char *litho,
                               const char *more, opc_error *error) {
  g_autofree char *devices = g_build_filename(
      g_getenv("OPCFLOW_SOURCE"), "data", "devices", "ptm65.yaml", NULL);
  g_autofree char *plain = g_strdup_printf(
      ", extractor: { use: extractor.plain, devices: '%s' }", devices);
  g_autofree char *map =
      g_strdup_printf("{ litho: { use: %s }, " RESIST "%s%s }", litho,
                      strstr(more, "extractor:") ? "" : plain, more);
  return opc_test_module(id, map, error);
}

static opc_module *make_sample(const char *id, const char *litho,
                               const char *more) {
  opc_error error = {0};
  opc_module *m = try_to_make(id, litho, more, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

static eda_mask *run_step(opc_module *m, const char *input,
                          const void *object) {
  void *outputs[1];
  opc_error error = {0};
  opc_test_input(m, input, (void *)object);
  if (opc_test_run(m, outputs, &error)) g_error("%s", error.message);
  return outputs[0];
}

static void release_sample(opc_module *m, eda_mask *mask) {
  void *outputs[1] = {mask};
  opc_test_release(m, outputs);
  opc_test_module_free(m);
}

static void test_again(void) {
  opc_module *loop = make_sample("correct", "litho.hopkins",
                                 ", synthesizer: { use: synthesizer.dpb }, "
                                 "max_iterations: 3");
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  opc_module *same = make_sample("verify", "litho.hopkins", "");
  opc_module *other =
      make_sample("verify", "litho.hopkins, defocus: 60 nm", "");
  opc_test_forget();
  eda_mask *again = run_step(same, "mask", mask);
  g_assert_true(opc_test_metric("ion_change_max") == 0);
  opc_test_forget();
  eda_mask *blurred = run_step(other, "mask", mask);
  double largest = 0;
  for (size_t i = 0; i < mask->gates->count; i++) {
    g_assert_true(again->after.ion[i] == mask->after.ion[i]);
    g_assert_true(blurred->before.ion[i] == mask->after.ion[i]);
    double change = eda_deviation(blurred->after.ion[i], mask->design.ion[i]) -
                    eda_deviation(mask->after.ion[i], mask->design.ion[i]);
    largest = fmax(largest, fabs(change));
  }
  g_assert_cmpfloat(largest, >, 1);
  g_assert_cmpfloat_with_epsilon(opc_test_metric("ion_change_max"), largest,
                                 1e-9);
  release_sample(other, blurred);
  release_sample(same, again);
  release_sample(loop, mask);
}

/* Total leakage is computed from the sums over the transistors. */
static void test_leakage(void) {
  opc_module *loop = make_sample("correct", "litho.hopkins",
                                 ", synthesizer: { use: synthesizer.dpb }, "
                                 "max_iterations: 1, fine: off");
  opc_test_forget();
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  g_assert_cmpuint(mask->gates->count, ==, 2);
  const double *now = mask->after.ioff, *drawn = mask->design.ioff;
  double by[2], all = 100 * ((now[0] + now[1]) / (drawn[0] + drawn[1]) - 1);
  for (size_t i = 0; i < 2; i++) /* an n-transistor and a p-transistor */
    by[i] = 100 * (now[i] / drawn[i] - 1);
  const struct {
    const char *name;
    double value;
  } expected[] = {{"ioff_total", all},
                  {"ioff_total_n", by[0]},
                  {"ioff_total_p", by[1]},
                  {"ioff_mean", (fabs(by[0]) + fabs(by[1])) / 2},
                  {"ioff_max", fmax(fabs(by[0]), fabs(by[1]))}};
  g_assert_cmpfloat(fabs(by[0] - by[1]), >, 1);
  for (size_t k = 0; k < G_N_ELEMENTS(expected); k++)
    g_assert_cmpfloat_with_epsilon(opc_test_metric(expected[k].name),
                                   expected[k].value, 1e-6);
  release_sample(loop, mask);
}

/* Return the device table with another line, in a new file (g_free). */
static char *modelled_table(const char *line) {
  g_autofree char *name = g_build_filename(g_getenv("OPCFLOW_SOURCE"), "data",
                                           "devices", "ptm65.yaml", NULL);
  g_autofree char *text = NULL;
  g_assert_true(g_file_get_contents(name, &text, NULL, NULL));
  char *path = g_build_filename(g_get_tmp_dir(), "verify-XXXXXX.yaml", NULL);
  g_assert_cmpint(close(g_mkstemp(path)), ==, 0);
  char *at = strstr(text, "\nlength:");
  g_autofree char *all =
      g_strdup_printf("%.*s%s%s", (int)(at - text), text, line, at);
  g_assert_true(g_file_set_contents(path, all, -1, NULL));
  return path;
}

/* Return the short slices that correct, and verify, count. */
static double short_slices(const char *line, int *findings) {
  g_autofree char *path = modelled_table(line);
  g_autofree char *more = g_strdup_printf(
      ", synthesizer: { use: synthesizer.dpb }, max_iterations: 1, extractor: "
      "{ use: extractor.plain, devices: '%s', slices: 12 }",
      path);
  g_autofree char *same = g_strdup(strstr(more, ", extractor"));
  opc_module *loop = make_sample("correct", "litho.hopkins", more);
  opc_test_forget();
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  double count = opc_test_metric("short_slices");
  *findings = strstr(opc_test_log(), "shorter than the device model") != NULL;
  opc_module *step = make_sample("verify", "litho.hopkins", same);
  opc_test_forget();
  eda_mask *again = run_step(step, "mask", mask);
  g_assert_cmpfloat(opc_test_metric("short_slices"), ==, count);
  release_sample(step, again);
  release_sample(loop, mask);
  g_assert_cmpint(remove(path), ==, 0);
  return count;
}

/* Slices below the length that the model covers are counted, by type. */
static void test_short_slices(void) {
  int findings;
  g_assert_cmpfloat(short_slices("", &findings), ==, 0);
  g_assert_cmpint(findings, ==, 0);
  g_assert_cmpfloat(short_slices("\nnmos_modelled: 300 nm", &findings), ==, 12);
  g_assert_cmpint(findings, ==, 1);
  g_assert_cmpfloat(
      short_slices("\nnmos_modelled: 300 nm\npmos_modelled: 300 nm", &findings),
      ==, 24);
}

/* The accurate model changes the figures by at most its error; without an
   accurate model, the figures are those of the fast model. */
static void test_fine(void) {
  static const char *const fines[] = {"", ", fine: 3e-4", ", fine: off"};
  double ion[3][2];
  opc_module *loop = make_sample("correct", "litho.hopkins, kernels: 4",
                                 ", synthesizer: { use: synthesizer.dpb }, "
                                 "max_iterations: 0, margin: 1000 nm");
  opc_test_forget();
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  g_assert_true(opc_test_metric("fine_simulations") == 2);
  g_assert_cmpuint(mask->fine_simulations, ==, 2);
  for (int k = 0; k < 3; k++) {
    g_autofree char *more = g_strdup_printf(", margin: 1000 nm%s", fines[k]);
    opc_module *again =
        make_sample("verify", "litho.hopkins, kernels: 4", more);
    eda_mask *out = run_step(again, "mask", mask);
    memcpy(ion[k], out->after.ion, sizeof ion[k]);
    g_assert_cmpuint(out->fine_simulations, ==, k == 2 ? 0 : 2);
    g_assert_cmpuint(out->simulations, ==, k == 2 ? 2 : 0);
    release_sample(again, out);
  }
  for (size_t i = 0; i < 2; i++) {
    double other = fabs(ion[1][i] / ion[0][i] - 1),
           cheap = fabs(ion[2][i] / ion[0][i] - 1);
    g_assert_true(ion[0][i] == mask->after.ion[i]);
    g_assert_cmpfloat(other, <, 3e-3);
    g_assert_cmpfloat(cheap, >, 4 * other);
  }
  release_sample(loop, mask);
}

/* Displace all shapes of active by grid steps. */
static void shift_active(eda_shapes *active, int32_t x, int32_t y) {
  for (size_t i = 0; i < active->start[active->count]; i++) {
    active->points[i].x += x;
    active->points[i].y += y;
  }
}

/* Move the right end of active to 50 nm from the gates, so that the layout is
   not symmetric. */
static void cut_active(eda_shapes *active) {
  for (size_t i = 0; i < active->start[active->count]; i++)
    if (active->points[i].x > 200) active->points[i].x = 110;
}

/* A displaced image of active equals the image of a mask whose active was
   displaced before the simulation. */
static void test_overlay(void) {
  static const int32_t by[][2] = {{10, 0}, {-40, 20}, {30, 0}};
  opc_module *loop = make_sample("correct", "litho.hopkins",
                                 ", synthesizer: { use: synthesizer.dpb }, "
                                 "max_iterations: 2, guard: off");
  eda_mask *mask = run_step(loop, "gates", eda_gates_sample());
  cut_active(&mask->shapes[EDA_ACTIVE]);
  opc_module *aligned = make_sample("verify", "litho.hopkins", "");
  double largest = 0;
  for (size_t k = 0; k < G_N_ELEMENTS(by); k++) {
    g_autofree char *more =
        g_strdup_printf(", overlay: [%d nm, %d nm]", by[k][0], by[k][1]);
    opc_module *displaced = make_sample("verify", "litho.hopkins", more);
    eda_mask *got = run_step(displaced, "mask", mask);
    shift_active(&mask->shapes[EDA_ACTIVE], by[k][0], by[k][1]);
    eda_mask *want = run_step(aligned, "mask", mask);
    shift_active(&mask->shapes[EDA_ACTIVE], -by[k][0], -by[k][1]);
    for (size_t i = 0; i < mask->gates->count; i++) {
      g_assert_cmpfloat(fabs(got->after.ion[i] / want->after.ion[i] - 1), <,
                        2e-4);
      g_assert_cmpfloat(fabs(got->after.ioff[i] / want->after.ioff[i] - 1), <,
                        1e-2);
      largest = fmax(largest, fabs(got->after.ion[i] / mask->after.ion[i] - 1));
    }
    release_sample(aligned, want);
    aligned = make_sample("verify", "litho.hopkins", "");
    release_sample(displaced, got);
  }
  g_assert_cmpfloat(largest, >, 0.01);
  opc_test_module_free(aligned);
  release_sample(loop, mask);
  opc_error error = {0};
  g_assert_null(
      try_to_make("verify", "litho.hopkins", ", overlay: [1 nm]", &error));
  g_assert_nonnull(strstr(error.message, "'overlay' has 1 values, expected 2"));
}

static void test_words(void) {
  static const char *const wrong[] = {"0", "-1e-4", "0.1", "fast", "1e-4 nm"};
  for (size_t k = 0; k < G_N_ELEMENTS(wrong); k++) {
    opc_error error = {0};
    g_autofree char *more = g_strdup_printf(", fine: %s", wrong[k]);
    g_assert_null(try_to_make("verify", "litho.hopkins", more, &error));
    g_autofree char *text = g_strdup_printf(
        "'fine' is '%s', expected a number above 0 and below 0.1, or off",
        wrong[k]);
    g_assert_nonnull(strstr(error.message, text));
  }
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/verify/again", test_again);
  g_test_add_func("/verify/leakage", test_leakage);
  g_test_add_func("/verify/short-slices", test_short_slices);
  g_test_add_func("/verify/fine", test_fine);
  g_test_add_func("/verify/overlay", test_overlay);
  g_test_add_func("/verify/words", test_words);
  return g_test_run();
}
