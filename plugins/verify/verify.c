/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `verify`: simulates and measures a corrected mask by
   models other than the models of the correction loop. */
#include <opcflow/step.h>
#include <stdlib.h>

#include <correct/findings.h>
#include <correct/report.h>
#include <correct/settings.h>

/* ---- state ---- */

typedef struct verify {
  const opc_host *host;
  const eda_mask *mask;
  correct_settings with;
} verify;

/* ---- work ---- */

static int verify_run(void *self, void **outputs, opc_error *error) {
  const verify *v = self;
  const eda_gates *gates = v->mask->gates;
  if (eda_mask_need_flat(v->mask, "verify", error)) return error->code;
  eda_mask *out = eda_mask_new(gates);
  double *extension = NULL;
  int code = OPC_OK;
  outputs[0] = out; /* released by the host on failure */
  out->iterations = v->mask->iterations;
  eda_performance_init(&out->before, gates->count);
  eda_performance_copy(&out->before, &v->mask->after);
  for (size_t k = 0; k < gates->layers && !code; k++)
    code =
        eda_boolean(EDA_OR, &v->mask->shapes[k], NULL, &out->shapes[k], error);
  if (!code)
    code = correct_print(&v->with, v->host, 1, out, NULL, &extension, error);
  const report content = {
      .mask = out, .extension = extension, .corrected = v->mask};
  if (!code) correct_findings_of_print(v->host, gates, out->flags, NULL);
  if (!code) code = correct_report_mask(v->host, &content, error);
  free(extension);
  return code;
}

static int verify_forecast(void *self, opc_forecast *out, opc_error *error) {
  const verify *v = self;
  if (eda_mask_need_flat(v->mask, "verify", error)) return error->code;
  correct_forecast(&v->with, v->host, v->mask->gates, "one simulation",
                   "one accurate simulation", out);
  return OPC_OK;
}

static int verify_sketch(void *self, void **outputs, opc_error *error) {
  (void)error;
  return correct_sketch_mask(((const verify *)self)->mask->gates, outputs);
}

/* ---- restoring ---- */

static int verify_restore(void *self, const char *folder, void **outputs,
                          opc_error *error) {
  const verify *v = self;
  return eda_mask_restore(v->mask->gates, folder, &outputs[0], error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(verify, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "Corrected mask"),
    CORRECT_PRINT_SLOTS(verify),
    CORRECT_MARGIN(verify),
    CORRECT_FINE(verify),
    CORRECT_OVERLAY(verify),
};

static const opc_metric metrics[] = {
    REPORT_METRICS,
    {"ion_change_mean", "%", OPC_LOWER, 0.01,
     "mean |difference| between the Ion deviations of verification and loop"},
    {"ion_change_max", "%", OPC_LOWER, 0.01,
     "largest |difference| between the Ion deviations of verification and "
     "loop"},
    REPORT_PRINT_METRICS,
};

static int verify_check(void *self, opc_error *error) {
  verify *v = self;
  v->with.ion_limit = CORRECT_USUAL_LIMIT;
  return correct_settings_check(&v->with, v->host, error);
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {
    OPC_OUTPUTS(outputs),        .run = verify_run,
    .forecast = verify_forecast, .sketch = verify_sketch,
    .save = correct_save_mask,   .restore = verify_restore};

OPC_PLUGIN(verify, .id = "verify", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "simulate and measure a corrected mask with other models",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = verify_check, OPC_FUNCTIONS(functions));
