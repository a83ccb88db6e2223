/* SPDX-License-Identifier: BSD-3-Clause */
/* A mask printed again: by the models that made it, where nothing may change,
   and by others, where the change is that of the figures themselves. */
#include <eda/gates.h>
#include <eda/print.h>
#include <math.h>

#include "core/testing/testing.h"

#define RESIST                                                             \
  "resist: { use: resist.threshold, anchor: { line: 65 nm, pitch: 250 nm " \
  "} }"

static opc_module *make(const char *id, const char *litho, const char *more) {
  opc_error error = {0};
  g_autofree char *devices = g_build_filename(
      g_getenv("OPCFLOW_SOURCE"), "data", "devices", "ptm65.yaml", NULL);
  g_autofree char *map = g_strdup_printf(
      "{ litho: { use: %s }, " RESIST
      ", extractor: { use: extractor.plain, devices: '%s' }%s }",
      litho, devices, more);
  opc_module *m = opc_test_module(id, map, &error);
  if (!m) g_error("%s: %s", id, error.message);
  return m;
}

static eda_mask *run(opc_module *m, const char *input, const void *object) {
  void *outputs[1];
  opc_error error = {0};
  opc_test_input(m, input, (void *)object);
  if (opc_test_run(m, outputs, &error)) g_error("%s", error.message);
  return outputs[0];
}

static void release(opc_module *m, eda_mask *mask) {
  void *outputs[1] = {mask};
  opc_test_release(m, outputs);
  opc_test_module_free(m);
}

static void test_again(void) {
  opc_module *loop = make("correct", "litho.hopkins",
                          ", synthesizer: { use: synthesizer.dpb }, "
                          "max_iterations: 3");
  eda_mask *mask = run(loop, "gates", eda_gates_sample());
  opc_module *same = make("verify", "litho.hopkins", "");
  opc_module *other = make("verify", "litho.hopkins, defocus: 60 nm", "");
  opc_test_forget();
  eda_mask *again = run(same, "mask", mask);
  g_assert_true(opc_test_metric("ion_change_max") == 0);
  opc_test_forget();
  eda_mask *blurred = run(other, "mask", mask);
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
  release(other, blurred);
  release(same, again);
  release(loop, mask);
}

int main(int argc, char **argv) {
  g_test_init(&argc, &argv, NULL);
  g_test_add_func("/verify/again", test_again);
  return g_test_run();
}
