/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <opcflow/testing.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                \
  do {                                                                  \
    if (!(condition)) {                                                 \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);   \
      exit(1);                                                          \
    }                                                                   \
  } while (0)

/* A mask of which only the currents matter. */
static void run_with(const char *parameters, double n_ion, double p_ion) {
  double design_ion[2] = {1e-4, 2e-4}, after_ion[2];
  opc_mask mask;
  opc_error error;
  opc_module *module = opc_test_module("list.worst", parameters, &error);
  CHECK(module);
  memset(&mask, 0, sizeof mask);
  mask.size = sizeof mask;
  mask.gates = opc_test_gates();
  mask.design.count = mask.after.count = 2;
  mask.design.ion = design_ion;
  mask.after.ion = after_ion;
  after_ion[0] = n_ion;
  after_ion[1] = p_ion;
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
