/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the steps test.light and test.heavy (FLAGS 0), which have a
   forecast. The steps double the input number. The forecast fails for numbers
   <= 0. */
#include <math.h>
#include <opcflow/step.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- state ---- */

typedef struct wants {
  const opc_host *host;
  double memory; /* GB */
  const double *from;
} wants;

/* ---- work ---- */

static double number(const wants *w) { return w->from ? *w->from : 1; }

static int wants_forecast(void *self, opc_forecast *out, opc_error *error) {
  const wants *w = self;
  out->memory = w->memory * 1e9;
  snprintf(out->work, sizeof out->work, "%g sums", number(w));
  snprintf(out->help, sizeof out->help, "a smaller 'memory'");
  if (w->memory < 0)
    return opc_fail(error, OPC_INVALID, "memory", "less than nothing");
  return OPC_OK;
}

static int wants_run(void *self, void **outputs, opc_error *error) {
  const wants *w = self;
  double *twice = malloc(sizeof *twice);
  outputs[0] = twice;
  *twice = 2 * number(w);
  w->host->log(w->host, OPC_LOG_WARNING, "ran with %g", number(w));
  return w->host->metric(w->host, "twice", *twice, error);
}

static int check_number(const void *object, opc_error *error) {
  if (isfinite(*(const double *)object)) return OPC_OK;
  return opc_fail(error, OPC_FAILED, NULL, "is no number");
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(wants, memory, .type = OPC_REAL, .preset = "0",
                  .summary = "memory of the forecast, GB"),
    OPC_PARAMETER(wants, from, .type = OPC_INPUT, .choices = "number",
                  .summary = "another number"),
};

static const opc_metric metrics[] = {{"twice", NULL, OPC_NEUTRAL, 0, "double"}};

/* ---- entry ---- */

static const opc_port outputs[] = {{"twice", "number", check_number, free}};

static const opc_step functions = {OPC_OUTPUTS(outputs), .run = wants_run,
                                   .forecast = wants_forecast, .flags = FLAGS};

OPC_PLUGIN(wants, .id = ID, .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "Step with a forecast",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           OPC_FUNCTIONS(functions));
