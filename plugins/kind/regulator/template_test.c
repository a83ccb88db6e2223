/* SPDX-License-Identifier: BSD-3-Clause */
/* A line end printed 5 nm past the active is lengthened, one of 30 nm is
   not; then the plugin is part of a correction that succeeds. */
#include <eda/regulator.h>
#include <opcflow/testing.h>

int main(void) {
  const double extension[4] = {5, 30, 30, 30};
  uint32_t vetoes[2] = {0};
  int32_t end[4] = {0};
  eda_printed p = {.gates = eda_gates_sample(), .extension = extension};
  eda_ruling ruling = {.vetoes = vetoes, .end = end};
  opc_error error = {0};
  opc_module *m = opc_test_module("@ID@", "{ extension: 10 nm }", &error);
  const eda_regulator *r = m ? m->functions : NULL;
  if (m) r->rule(m->self, &p, &ruling, &error);
  printf("%d %d %s\n", (int)end[0], (int)end[1], error.message);
  opc_test_module_free(m);
  int code = opc_test_corrects("regulator", "{ use: @ID@ }", &error);
  printf("%g %% %s\n", opc_test_metric("ion_max"), code ? error.message : "");
  return code || !(end[0] == 1 && end[1] == 0 && ruling.transistors == 2);
}
