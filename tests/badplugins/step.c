/* SPDX-License-Identifier: BSD-3-Clause */
/* A step that makes gates, and goes wrong. */
#include <stdlib.h>

#include "bad.h"

static void release(void *object) {
  if (does("release")) write_wildly(NULL, 7);
  eda_gates_free(object);
}

static eda_gates *make_gates(void) {
  eda_gates *gates = eda_gates_new(2, does("arrays") ? 3 : 0);
  gates->name = eda_gates_text(gates, "bad");
  gates->layer[EDA_POLY] = eda_gates_text(gates, "poly");
  gates->layer[EDA_ACTIVE] = eda_gates_text(gates, "active");
  gates->grid = does("grid") ? 0 : 1;
  if (does("arrays")) {
    free(gates->box);
    gates->box = NULL;
  }
  return gates;
}

static int run(void *self, void **outputs, opc_error *error) {
  (void)self, (void)error;
  int code = misbehave();
  if (!code && !does("output")) outputs[0] = make_gates();
  return code;
}

static const opc_port outputs[] = {
    {"gates", "gates", eda_gates_check, release}};

static const opc_step functions = {OPC_OUTPUTS(outputs), .run = run};

BAD_PLUGIN("step", functions);
