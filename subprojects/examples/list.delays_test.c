/* SPDX-License-Identifier: BSD-3-Clause */
/* list.delays with timing.cv: half the current doubles the delay. */
#include <eda/gates.h>

#include "check_test.h"

int main(void) {
  opc_error error = {0};
  opc_module *module = module_make(
      "list.delays", "{ timing: { supply: 2 V, capacitance: 0.01 } }");
  double design[2] = {1e-4, 1e-4}, after[2] = {1e-4, 0.5e-4};
  double area[2] = {12000, 18000};
  eda_mask mask = {.gates = eda_gates_sample()};
  mask.design = (eda_performance){.count = 2, .ion = design, .area = area};
  mask.after = (eda_performance){.count = 2, .ion = after, .area = area};
  opc_test_input(module, "mask", &mask);
  CHECK(opc_test_run(module, NULL, &error) == OPC_OK);
  CHECK(fabs(opc_test_number("delays", "drawn", 0) - 2.4) < 1e-9);
  CHECK(fabs(opc_test_number("delays", "printed", 1) - 7.2) < 1e-9);
  CHECK(fabs(opc_test_metric("slower") - 100) < 1e-9);
  opc_test_module_free(module);
  return 0;
}
