/* SPDX-License-Identifier: BSD-3-Clause */
/* list.worst on a mask with given currents. */
#include <eda/gates.h>

#include "check_test.h"

static void run_with(const char *parameters, double n_ion, double p_ion) {
  opc_error error = {0};
  opc_module *module = module_make("list.worst", parameters);
  double design[2] = {1e-4, 2e-4}, after[2] = {n_ion, p_ion};
  eda_mask mask = {.gates = eda_gates_sample()};
  mask.design.ion = design;
  mask.after.ion = after;
  opc_test_forget();
  opc_test_input(module, "mask", &mask);
  CHECK(opc_test_run(module, NULL, &error) == OPC_OK);
  opc_test_module_free(module);
}

int main(void) {
  run_with("{}", 1.01e-4, 1.9e-4);
  CHECK(opc_test_rows("worst") == 2);
  CHECK(opc_test_number("worst", "number", 0) == 2);
  CHECK(fabs(opc_test_number("worst", "ion", 0) + 5) < 1e-9);
  CHECK(strcmp(opc_test_text("worst", "cell", 0), "sample") == 0);
  CHECK(strcmp(opc_test_text("worst", "ion", 1), "1.000") == 0);
  CHECK(fabs(opc_test_metric("worst") - 5) < 1e-9);

  run_with("{ most: 1 }", 1.06e-4, 1.9e-4);
  CHECK(opc_test_rows("worst") == 1);
  CHECK(opc_test_number("worst", "number", 0) == 1);
  return 0;
}
