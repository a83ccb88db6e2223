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
#include "take.h"

/* ---- state ---- */

typedef struct given {
  const opc_host *host;
  take take;
  correct_settings with;
} given;

/* ---- work ---- */

/* Report the numbers of worse and lost transistors, as the guard of `correct`
   defines them. */
static int tell_of_worse(const given *s, const eda_mask *m,
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

static int tell_of_violations(const given *s, eda_mask *m,
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

static int tell(const given *s, eda_mask *m, const double *extension,
                const uint32_t *before, opc_error *error) {
  const report told = {
      .mask = m, .extension = extension, .flags_before = before};
  int code = tell_of_violations(s, m, extension, error);
  if (!code)
    code = correct_rules_report(s->host, m->gates, m->shapes, s->with.rules,
                                error);
  if (!code) code = tell_of_worse(s, m, before, error);
  if (!code) correct_findings_of_print(s->host, m->gates, m->flags, before);
  return code ? code : correct_report_mask(s->host, &told, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  given *s = self;
  eda_mask *out = eda_mask_new(s->take.gates);
  uint32_t *before = NULL;
  double *extension = NULL;
  outputs[0] = out; /* released by the host on failure */
  s->take.host = s->host;
  s->take.margin = s->with.margin;
  int code = take_shapes(&s->take, out, error);
  if (!code)
    code = correct_print(&s->with, s->host, 1, out, &before, &extension, error);
  if (!code) code = tell(s, out, extension, before, error);
  free(before);
  free(extension);
  return code;
}

static int restore(void *self, const char *folder, void **outputs,
                   opc_error *error) {
  const given *s = self;
  return eda_mask_restore(s->take.gates, folder, &outputs[0], error);
}

static int forecast(void *self, opc_forecast *out, opc_error *error) {
  const given *s = self;
  (void)error;
  correct_forecast(&s->with, s->host, s->take.gates, "two prints",
                   "two fine prints", out);
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER_NAMED("gates", given, take.gates, .type = OPC_INPUT,
                        .flags = OPC_REQUIRED, .choices = "gates",
                        .summary = "what is drawn"),
    OPC_PARAMETER_NAMED("mask_layout", given, take.layout, .type = OPC_INPUT,
                        .flags = OPC_REQUIRED, .choices = "layout",
                        .summary = "where the mask is"),
    OPC_PARAMETER_NAMED("layers", given, take.layers, .type = OPC_MAP,
                        .flags = OPC_REQUIRED,
                        .summary = "its layers: { poly: poly_opc }; others are "
                                   "as drawn"),
    OPC_PARAMETER_NAMED("top", given, take.top, .type = OPC_TEXT,
                        .summary = "its cell; if not given, that of the gates' "
                                   "name, or the only one that no other "
                                   "places"),
    CORRECT_PRINT_SLOTS(given),
    CORRECT_SLOT(given, regulator, 0, "whose rules the print is held against"),
    CORRECT_MARGIN(given),
    CORRECT_FINE(given),
    CORRECT_ION_LIMIT(given,
                      "Largest allowed |Ion deviation|: within it no "
                      "transistor counts as worse than drawn"),
    RULES_PARAMETERS(given),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0, "how many are measured"},
    REPORT_METRICS,
    REPORT_DRAWN_METRICS,
    {"iterations", NULL, OPC_NEUTRAL, 0, "none: the mask is as it came"},
    {"simulations", NULL, OPC_LOWER, 0, "litho simulations, of one layer each"},
    {"fine_simulations", NULL, OPC_LOWER, 0,
     "those of the fine model, beside them"},
    REPORT_PRINT_METRICS,
    REPORT_JUDGED_METRICS,
    RULES_METRICS,
    {"snapped", NULL, OPC_LOWER, 0, "vertices of the mask that the grid moved"},
    {"snapped_worst", "nm", OPC_LOWER, 0, "by how much at most"},
};

static int check(void *self, opc_error *error) {
  given *s = self;
  EDA_FOLLOW(s->host, "given", s, parameters, eda_scanner_of(s->with.litho));
  return correct_settings_check(&s->with, s->host, error);
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {
    OPC_OUTPUTS(outputs), .run = run, .forecast = forecast,
    .save = correct_save_mask, .restore = restore};

OPC_PLUGIN(given, .id = "given", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "print and measure a mask that another tool has made",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = check,
           OPC_FUNCTIONS(functions));
