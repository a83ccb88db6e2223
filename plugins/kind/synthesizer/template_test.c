/* SPDX-License-Identifier: BSD-3-Clause */
/* 10 % excess current lengthens the mask, a 10 % deficit shortens it; then the
   plugin corrects a NAND gate in the real loop. */
#include <eda/synthesizer.h>
#include <opcflow/testing.h>

int main(void) {
  const uint32_t none[2] = {0};
  int32_t l[2] = {0};
  eda_performance design = {.ion = (double[]){1, 1}};
  eda_performance printed = {.ion = (double[]){1.1, 0.9}};
  eda_feedback f = {.gates = eda_gates_sample(), .design = &design};
  eda_moves moves = {.l = l};
  opc_error error = {0};
  int done = 1;
  f.printed = &printed, f.flags = f.vetoes = none;
  opc_module *m = opc_test_module("@ID@", "{ gain: 0.5 }", &error);
  const eda_synthesizer *s = m ? m->functions : NULL;
  if (m && !s->begin(m->self, &f, &error))
    s->update(m->self, &f, &moves, &done, &error);
  printf("%d %d %s\n", (int)l[0], (int)l[1], error.message);
  opc_test_module_free(m);
  int code = opc_test_corrects("synthesizer", "{ use: @ID@ }", &error);
  printf("%g %% %s\n", opc_test_metric("ion_max"), code ? error.message : "");
  return !(l[0] == 3 && l[1] == -3 && !done && !code);
}
