/* SPDX-License-Identifier: BSD-3-Clause */
/* Run and release of a step with one output, for tests of steps. */
#pragma once

#include "tools/devel/testing.h"

/* Forget earlier tables and metrics, run the step and return its output. Ends
   the test on an error. */
static inline void *run_step(opc_module *m) {
  opc_error error = {0};
  void *outputs[1];
  opc_test_forget();
  if (opc_test_run(m, outputs, &error)) g_error("%s", error.message);
  return outputs[0];
}

/* Free the output and the step. */
static inline void release_sample(opc_module *m, void *output) {
  opc_test_release(m, &output);
  opc_test_module_free(m);
}
