/* SPDX-License-Identifier: BSD-3-Clause */
/* The step `verify`: a corrected mask printed and measured by other models
   than those of its loop. */
#include <eda/print.h>
#include <opcflow/step.h>
#include <stdlib.h>

#include <correct/findings.h>
#include <correct/fine.h>
#include <correct/forecast.h>
#include <correct/report.h>
#include <correct/slots.h>

/* ---- state ---- */

typedef struct verify {
  const opc_host *host;
  const eda_mask *mask;
  const opc_module *litho, *resist, *extractor;
  const char *fine_text;
  double fine;   /* error, clear field 1; 0: as the model is by itself */
  double margin; /* nm */
} verify;

/* ---- work ---- */

/* %, of Ion: what figures are to be good for, as the loop's `limit`. */
static const double limit = 0.5;

/* The mask with the prints and the performance that these models give it. What
   the loop measured is its performance before. */
static int look_again(const verify *v, eda_printer *printer, eda_mask *out,
                      eda_measurement *measured, opc_error *error) {
  const opc_context *context = v->host->context;
  const eda_mask *in = v->mask;
  const eda_gates *gates = in->gates;
  eda_performance_init(&out->design, gates->count);
  eda_performance_init(&out->before, gates->count);
  eda_performance_copy(&out->before, &in->after);
  int code = eda_printer_prepare(printer, error);
  if (!code) code = eda_extractor_prepare(context, v->extractor, error);
  if (!code)
    code = eda_measure_drawn(context, gates, v->extractor, &out->design, error);
  for (size_t k = 0; k < gates->layers && !code; k++)
    code = eda_boolean(EDA_OR, &in->shapes[k], NULL, &out->shapes[k], error);
  if (!code)
    code = fine_by_drawn(printer, v->host, gates, v->extractor,
                         fine_change(v->fine_text, limit), error);
  if (!code)
    code = (printer->fine > 0 ? eda_printer_refine : eda_printer_print)(
        printer, gates->corrected, out->shapes, error);
  if (!code)
    code = eda_measure(context, gates, printer->print, v->extractor, measured,
                       error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const verify *v = self;
  const eda_gates *gates = v->mask->gates;
  eda_mask *out = eda_mask_new(gates);
  outputs[0] = out; /* released by the host if this fails */
  out->iterations = v->mask->iterations;
  eda_measurement measured;
  eda_measurement_init(&measured, gates->count);
  eda_printer printer;
  eda_printer_init(&printer, v->host->context, gates, v->litho, v->resist,
                   v->margin);
  printer.fine = v->fine;
  int code = look_again(v, &printer, out, &measured, error);
  for (size_t k = 0; k < gates->layers; k++) {
    out->print[k] = printer.print[k];
    printer.print[k] = (eda_field){0};
  }
  out->after = measured.performance;
  out->flags = measured.flags;
  out->simulations = printer.simulations;
  out->fine_simulations = printer.fine_simulations;
  const report told = {
      .mask = out, .extension = measured.extension, .corrected = v->mask};
  if (!code) findings_of_print(v->host, gates, out->flags, NULL);
  if (!code) code = report_mask(v->host, &told, error);
  eda_printer_clear(&printer);
  free(measured.extension);
  return code;
}

static int forecast(void *self, opc_forecast *out, opc_error *error) {
  const verify *v = self;
  (void)error;
  forecast_prints(v->host->context, v->mask->gates, v->litho, v->resist,
                  v->margin, v->fine, "one print", "one fine print", out);
  return OPC_OK;
}

/* ---- for the next time ---- */

static int save(void *self, void *const *outputs, const char *folder,
                opc_error *error) {
  (void)self;
  return eda_mask_save(outputs[0], folder, error);
}

static int restore(void *self, const char *folder, void **outputs,
                   opc_error *error) {
  const verify *v = self;
  return eda_mask_restore(v->mask->gates, folder, &outputs[0], error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(verify, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "the corrected mask"),
    PRINT_SLOTS(verify),
    OPC_PARAMETER(verify, margin, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "nm", .min = 0,
                  .summary =
                      "clear field around the layout, which repeats beyond; as "
                      "'fine' needs it"),
    FINE_PARAMETER(verify),
};

static const opc_metric metrics[] = {
    REPORT_METRICS,
    {"ion_change_mean", "%", OPC_LOWER, 0.01,
     "mean of |difference| of the Ion deviation to that in the loop"},
    {"ion_change_max", "%", OPC_LOWER, 0.01,
     "largest |difference| of the Ion deviation to that in the loop"},
    REPORT_PRINT_METRICS,
};

static int check(void *self, opc_error *error) {
  verify *v = self;
  int code = fine_error(v->fine_text, limit, &v->fine, error);
  v->margin = fine_margin(v->host, v->litho, v->margin, v->fine);
  return code;
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = run,
                                   .forecast = forecast, .save = save,
                                   .restore = restore};

OPC_PLUGIN(verify, .id = "verify", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "print and measure a corrected mask with other models",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = check,
           OPC_FUNCTIONS(functions));
