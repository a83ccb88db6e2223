/* SPDX-License-Identifier: BSD-3-Clause */
/* synthesizer.bisect on transistors with a current of 1 / L, printed too long
   or too short by a known amount. */
#include <eda/synthesizer.h>

#include "check_test.h"

int main(void) {
  const eda_gates *gates = eda_gates_sample();
  const double error_of_print[2] = {-7.3, 12.8}; /* nm */
  double design_ion[2], ion[2];
  uint32_t flags[2] = {0, 0}, vetoes[2] = {0, 0};
  int32_t l[2] = {0, 0}, w[2] = {0, 0};
  eda_performance design = {.count = 2, .ion = design_ion};
  eda_performance printed = {.count = 2, .ion = ion};
  opc_error error = {0};

  opc_module *module = module_make("synthesizer.bisect", "{ ion_limit: 1 % }");
  const eda_synthesizer *s = module->functions;
  CHECK(gates->count == 2);
  for (int i = 0; i < 2; i++) design_ion[i] = 1 / gates->length[i];
  eda_moves moves = {.l = l, .w = w};
  eda_feedback f = {
      .gates = gates, .design = &design, .flags = flags, .vetoes = vetoes};
  CHECK(s->begin(module->self, &f, &error) == OPC_OK);
  f.printed = &printed;
  int done = 0;
  for (; !done; f.iteration++) {
    CHECK(f.iteration < 10);
    for (int i = 0; i < 2; i++)
      ion[i] = 1 / (gates->length[i] + l[i] + error_of_print[i]);
    CHECK(s->update(module->self, &f, &moves, &done, &error) == OPC_OK);
  }
  /* A grid step of 1 nm is 1.7 % of the length: expect the nearest step. */
  CHECK(l[0] == 7 && l[1] == -13);
  CHECK(w[0] == 0 && w[1] == 0);
  opc_test_module_free(module);

  CHECK(!opc_test_module("synthesizer.bisect", "{ ion_limit: 0 % }", &error));
  CHECK(error.code == OPC_INVALID);
  return 0;
}
