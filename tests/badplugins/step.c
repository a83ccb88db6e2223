/* SPDX-License-Identifier: BSD-3-Clause */
/* A step that makes a number, and goes wrong. */
#include "bad.h"

static void release(void *object) {
  if (does("release")) write_wildly(NULL, 7);
  host->free(host, object);
}

static opc_gates *make_gates(void) {
  opc_gates *gates = host->alloc(host, 1, sizeof *gates);
  gates->size = sizeof *gates;
  gates->grid = does("grid") ? 0 : 1;
  gates->count = does("arrays") ? 3 : 0;
  return gates;
}

static int run(void *self, void **outputs, opc_error *error) {
  (void)self, (void)error;
  int code = misbehave();
  if (!code && !does("output")) outputs[0] = make_gates();
  return code;
}

static const opc_port ports[] = {{"gates", "gates", release}};

static const opc_step operations = {.size = sizeof operations,
                                    .n_outputs = 1,
                                    .port_size = sizeof(opc_port),
                                    .outputs = ports,
                                    .run = run};

BAD_PLUGIN(OPC_KIND_STEP, operations);
