/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty step with gates as output. */
#include <stdlib.h>

#include "bad.h"

static void release(void *object) {
  evil("release");
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

static int check_gates(const void *gates, opc_error *error) {
  evil("output");
  return eda_gates_check(gates, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  (void)self, (void)error;
  evil("run");
  if (does("escape"))
    return opc_fail(error, OPC_FAILED, NULL, "\033[2Jgone\nerror: not \xFF");
  if (does("escaped log"))
    host->log(host, OPC_LOG_WARNING, "\033[2Jgone\nerror: not \xFF");
  if (does("dangling log")) host->log(host, OPC_LOG_INFO, "%s", (char *)16);
  if (does("memory")) free(eda_alloc(SIZE_MAX / 4, 1));
  if (does("thread later")) leave_thread(), sleep(1);
  while (does("slow") && !opc_cancelled(host->context)) usleep(10000);
  if (does("slow")) return OPC_CANCELLED;
  int code = misbehave();
  if (!code && !does("output")) outputs[0] = make_gates();
  return code;
}

static int forecast(void *self, opc_forecast *out, opc_error *error) {
  (void)self;
  evil("forecast");
  if (does("endless")) memset(out->work, 'x', sizeof out->work);
  if (does("bytes")) memcpy(out->work, "so\xFF", 3);
  if (!does("endless error")) return OPC_OK;
  memset(error, 'x', sizeof *error);
  return OPC_FAILED;
}

static const opc_port outputs[] = {{"gates", "gates", check_gates, release}};

static const opc_step functions = {OPC_OUTPUTS(outputs), .run = run,
                                   .forecast = forecast};

BAD_PLUGIN("step", functions);
