/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step `given`: simulates and measures a mask made by another
   tool. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/findings.h>
#include <correct/report.h>
#include <correct/rules.h>
#include <correct/settings.h>
#include "import.h"

/* ---- state ---- */

typedef struct given {
  const opc_host *host;
import import;
  correct_settings with;
} given;

/* ---- work ---- */

/* Publish the numbers of transistors that are worse than drawn (`worse`) and
   that do not print (`lost`), as the guard of `correct` defines them. */
static int given_report_worse(const given *s, const eda_mask *m,
                              const uint32_t *before, opc_error *error) {
  size_t worse = 0, lost = 0;
  if (!m->gates->count) return OPC_OK;
  for (size_t i = 0; i < m->gates->count; i++) {
    if (eda_print_failed(before[i])) continue;
    double design = m->design.ion[i];
    double drawn = fabs(eda_deviation(m->before.ion[i], design));
    double now = fabs(eda_deviation(m->after.ion[i], design));
    lost += (size_t)eda_print_failed(m->flags[i]);
    worse +=
        !eda_print_failed(m->flags[i]) && now > fmax(drawn, s->with.ion_limit);
  }
  const opc_metric_value values[] = {{"worse", (double)worse},
                                     {"lost", (double)lost}};
  return opc_put_metrics(s->host, OPC_ARRAY(values), error);
}

static int given_report_violations(const given *s, eda_mask *m,
                                   const double *extension, opc_error *error) {
  int32_t *none = eda_alloc(m->gates->count, sizeof *none);
  const eda_printed printed = {.gates = m->gates,
                               .flags = m->flags,
                               .l = none,
                               .w = none,
                               .extension = extension,
                               .shapes = m->shapes,
                               .print = m->print,
                               .scanner = eda_scanner_of(s->with.litho)};
  int code =
      correct_report_rules(s->host, s->with.regulator, &printed, m, error);
  free(none);
  return code;
}

static int given_report(const given *s, eda_mask *m, const double *extension,
                        const uint32_t *before, opc_error *error) {
  const report content = {
      .mask = m, .extension = extension, .flags_before = before};
  int code = given_report_violations(s, m, extension, error);
  if (!code)
    code = correct_rules_report(s->host, m->gates, m->shapes, s->with.rules,
                                error);
  if (!code) code = given_report_worse(s, m, before, error);
  if (!code)
    correct_findings_of_print(s->host, m->gates, NULL, m->flags, before);
  if (!code)
    code = correct_findings_of_slices(s->host, m, s->with.extractor, error);
  return code ? code : correct_report_mask(s->host, &content, error);
}

static int given_run(void *self, void **outputs, opc_error *error) {
  given *s = self;
  eda_mask *out = eda_mask_new(s->import.gates);
  uint32_t *before = NULL;
  double *extension = NULL;
  outputs[0] = out; /* released by the host on failure */
  s->import.host = s->host;
  s->import.margin = s->with.margin;
  int code = import_shapes(&s->import, out, error);
  if (!code)
    code = correct_print(&s->with, s->host, 1, out, &before, &extension, error);
  if (!code) code = given_report(s, out, extension, before, error);
  free(before);
  free(extension);
  return code;
}

static int given_restore(void *self, const char *folder, void **outputs,
                         opc_error *error) {
  const given *s = self;
  return eda_mask_restore(s->import.gates, folder, &outputs[0], error);
}

static int given_forecast(void *self, opc_forecast *out, opc_error *error) {
  const given *s = self;
  (void)error;
  correct_forecast(&s->with, s->host, s->import.gates, "two simulations",
                   "two accurate simulations", out);
  return OPC_OK;
}

static int given_sketch(void *self, void **outputs, opc_error *error) {
  (void)error;
  return correct_sketch_mask(((const given *)self)->import.gates, outputs);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("gates", given, import.gates, .type = OPC_INPUT,
                        .flags = OPC_REQUIRED, .choices = "gates",
                        .summary = "Drawn transistors"),
    OPC_PARAMETER_NAMED("mask_layout", given, import.layout, .type = OPC_INPUT,
                        .flags = OPC_REQUIRED, .choices = "layout",
                        .summary = "Layout that contains the mask"),
    OPC_PARAMETER_NAMED("layers", given, import.layers, .type = OPC_MAP,
                        .flags = OPC_REQUIRED,
                        .summary = "Layers of the mask, as in { poly: poly_opc "
                                   "}; others are as drawn"),
    OPC_PARAMETER_NAMED("top", given, import.top, .type = OPC_TEXT,
                        .summary = "Cell of the mask (default: the cell with "
                                   "the gates' name, or the only top cell)"),
    CORRECT_PRINT_SLOTS(given),
    CORRECT_SLOT(given, regulator, 0,
                 "Rules that the simulated contours are checked against"),
    CORRECT_MARGIN(given),
    CORRECT_FINE(given),
    CORRECT_ION_LIMIT(given,
                      "|Ion deviation| up to which a transistor does not "
                      "count as worse than drawn"),
    RULES_PARAMETERS(given),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0, "number of measured transistors"},
    REPORT_METRICS,
    REPORT_DRAWN_METRICS,
    {"iterations", NULL, OPC_NEUTRAL, 0,
     "always 0, because the step does not change the mask"},
    {"simulations", NULL, OPC_LOWER, 0, "litho simulations of one layer each"},
    {"fine_simulations", NULL, OPC_LOWER, 0,
     "additional simulations of the accurate model"},
    REPORT_PRINT_METRICS,
    REPORT_JUDGED_METRICS,
    RULES_METRICS,
    {"snapped", NULL, OPC_LOWER, 0, "vertices of the mask moved by the grid"},
    {"snapped_worst", "nm", OPC_LOWER, 0,
     "largest displacement of a vertex by the grid"},
};

static int given_check(void *self, opc_error *error) {
  given *s = self;
  EDA_FOLLOW(s->host, "given", s, parameters, eda_scanner_of(s->with.litho));
  return correct_settings_check(&s->with, s->host, error);
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {
    OPC_OUTPUTS(outputs),       .run = given_run,
    .forecast = given_forecast, .sketch = given_sketch,
    .save = correct_save_mask,  .restore = given_restore};

OPC_PLUGIN(given, .id = "given", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "simulate and measure a mask made by another tool",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = given_check, OPC_FUNCTIONS(functions));
