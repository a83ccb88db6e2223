/* SPDX-License-Identifier: BSD-3-Clause */
/* A faulty step with gates as output. */
#include <stdlib.h>

#include "bad.h"

static void object_release(void *object) {
  evil("release");
  if (fault_is("release")) write_wildly(NULL, 7);
  eda_gates_free(object);
}

static eda_gates *make_gates(void) {
  eda_gates *gates = eda_gates_new(2, fault_is("arrays") ? 3 : 0);
  gates->name = eda_gates_text(gates, "bad");
  gates->layer[EDA_POLY] = eda_gates_text(gates, "poly");
  gates->layer[EDA_ACTIVE] = eda_gates_text(gates, "active");
  gates->grid = fault_is("grid") ? 0 : 1;
  if (fault_is("arrays")) {
    free(gates->box);
    gates->box = NULL;
  }
  return gates;
}

static int check_gates(const void *gates, opc_error *error) {
  evil("output");
  return eda_gates_check(gates, error);
}

static int bad_run(void *self, void **outputs, opc_error *error) {
  (void)self, (void)error;
  evil("run");
  if (fault_is("escape"))
    return opc_fail(error, OPC_FAILED, NULL, "\033[2Jgone\nerror: not \xFF");
  if (fault_is("escaped log"))
    host->log(host, OPC_LOG_WARNING, "\033[2Jgone\nerror: not \xFF");
  if (fault_is("dangling log")) host->log(host, OPC_LOG_INFO, "%s", (char *)16);
  if (fault_is("memory")) free(eda_alloc(SIZE_MAX / 4, 1));
  if (fault_is("thread later")) leave_thread(), sleep(1);
  while (fault_is("slow") && !opc_cancelled(host->context)) usleep(10000);
  if (fault_is("slow")) return OPC_CANCELLED;
  int code = fault_apply();
  if (!code && !fault_is("output")) outputs[0] = make_gates();
  return code;
}

static int bad_forecast(void *self, opc_forecast *out, opc_error *error) {
  (void)self;
  evil("forecast");
  if (fault_is("endless")) memset(out->work, 'x', sizeof out->work);
  if (fault_is("bytes")) memcpy(out->work, "so\xFF", 3);
  if (!fault_is("endless error")) return OPC_OK;
  memset(error, 'x', sizeof *error);
  return OPC_FAILED;
}

static const opc_port outputs[] = {
    {"gates", "gates", check_gates, object_release}};

static const opc_step functions = {OPC_OUTPUTS(outputs), .run = bad_run,
                                   .forecast = bad_forecast};

BAD_PLUGIN("step", functions);
