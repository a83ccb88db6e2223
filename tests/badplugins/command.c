/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty command. */
#include "bad.h"

static int bad_run(void *self, size_t n, const char *const *arguments,
                   opc_error *error) {
  (void)self, (void)n, (void)arguments, (void)error;
  evil("run");
  return OPC_OK;
}

static const opc_command functions = {.run = bad_run};

BAD_PLUGIN("command", functions);
