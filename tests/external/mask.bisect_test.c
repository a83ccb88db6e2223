/* SPDX-License-Identifier: BSD-3-Clause */
/* mask.bisect against transistors whose current is 1 / L and that print by a
   known amount too long or too short. */
#include <math.h>
#include <opcflow/testing.h>
#include <stdio.h>
#include <stdlib.h>

#define CHECK(condition)                                                \
  do {                                                                  \
    if (!(condition)) {                                                 \
      fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);   \
      exit(1);                                                          \
    }                                                                   \
  } while (0)

int main(void) {
  const opc_gates *gates = opc_test_gates();
  const double error_of_print[2] = {-7.3, 12.8};   /* nm */
  double design_ion[2], ion[2];
  uint32_t flags[2] = {0, 0}, vetoes[2] = {0, 0};
  int32_t l[2] = {0, 0}, w[2] = {0, 0};
  opc_performance design = {0, 0, 0, 0, 0, 0, 0};
  opc_performance printed = {0, 0, 0, 0, 0, 0, 0};
  opc_error error;

  opc_module *module = opc_test_module("mask.bisect", "{ max_pde: 1 % }",
                                       &error);
  if (!module) fprintf(stderr, "%s\n", error.message);
  CHECK(module);
  const opc_synthesizer *s = module->plugin->operations;
  CHECK(gates->count == 2);
  for (int i = 0; i < 2; i++) design_ion[i] = 1 / gates->length[i];
  design.count = printed.count = 2;
  design.ion = design_ion;
  printed.ion = ion;
  opc_moves moves = {sizeof moves, l, w};
  opc_feedback f = {sizeof f, 0, gates, &design, NULL, flags, vetoes};
  CHECK(s->begin(module->self, &f, &error) == OPC_OK);
  f.printed = &printed;
  int done = 0;
  for (; !done; f.iteration++) {
    CHECK(f.iteration < 10);
    for (int i = 0; i < 2; i++)
      ion[i] = 1 / (gates->length[i] + l[i] + error_of_print[i]);
    CHECK(s->update(module->self, &f, &moves, &done, &error) == OPC_OK);
  }
  /* A step of 1 nm is 1.7 %: the length is right to half of it. */
  CHECK(l[0] == 7 && l[1] == -13);
  CHECK(w[0] == 0 && w[1] == 0);
  opc_test_module_free(module);

  CHECK(!opc_test_module("mask.bisect", "{ max_pde: 0 % }", &error));
  CHECK(error.code == OPC_INVALID);
  return 0;
}
