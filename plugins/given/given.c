/* SPDX-License-Identifier: BSD-3-Clause */
/* The step `given`: a mask that another tool has made, printed and measured as
   the end of a correction is. */
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdlib.h>

#include <correct/findings.h>
#include <correct/fine.h>
#include <correct/forecast.h>
#include <correct/report.h>
#include <correct/rules.h>
#include <correct/slots.h>
#include "take.h"

/* ---- state ---- */

typedef struct given {
  const opc_host *host;
  take take;
  const opc_module *litho, *resist, *extractor, *regulator;
  const char *fine_text;
  double fine;      /* error, clear field 1; 0: as the model is by itself */
  double margin;    /* nm */
  double ion_limit; /* % */
  double min_space, min_mask_width, min_edge, min_jog; /* of the mask, nm */
} given;

/* ---- work ---- */

/* Print masks, whatever was printed before, and measure the transistors. The
   models differ from those of a correction's last print in nothing. */
static int print(const given *s, eda_printer *p, const eda_shapes *mask,
                 eda_measurement *out, opc_error *error) {
  const eda_gates *g = s->take.gates;
  for (size_t k = 0; k < g->layers; k++) {
    eda_field_clear(&p->image[k]);
    p->is_fine[k] = 0;
  }
  int code = (p->fine > 0 ? eda_printer_refine : eda_printer_print)(
      p, g->corrected, mask, error);
  return code ? code
              : eda_measure(s->host->context, g, p->print, s->extractor, out,
                            error);
}

static int prepare(const given *s, eda_printer *p, eda_mask *out,
                   opc_error *error) {
  const opc_context *context = s->host->context;
  eda_performance_init(&out->design, s->take.gates->count);
  int code = eda_printer_prepare(p, error);
  if (!code) code = eda_extractor_prepare(context, s->extractor, error);
  if (!code)
    code = eda_measure_drawn(context, s->take.gates, s->extractor, &out->design,
                             error);
  if (!code)
    code = fine_by_drawn(p, s->host, s->take.gates, s->extractor,
                         fine_change(s->fine_text, s->ion_limit), error);
  return code;
}

static int failed(uint32_t flags) {
  return (flags & ~(uint32_t)EDA_PRINT_NOTES) != 0;
}

/* By the words of the guard of `correct`: transistors whose Ion is further off
   than drawn and than the limit, and those that print no more. */
static int tell_of_worse(const given *s, const eda_mask *m,
                         const uint32_t *before, opc_error *error) {
  size_t worse = 0, lost = 0;
  if (!m->gates->count) return OPC_OK;
  for (size_t i = 0; i < m->gates->count; i++) {
    if (failed(before[i])) continue;
    double design = m->design.ion[i];
    double drawn = fabs(eda_deviation(m->before.ion[i], design));
    double now = fabs(eda_deviation(m->after.ion[i], design));
    lost += (size_t)failed(m->flags[i]);
    worse += !failed(m->flags[i]) && now > fmax(drawn, s->ion_limit);
  }
  const opc_metric_value values[] = {{"worse", (double)worse},
                                     {"lost", (double)lost}};
  return opc_put_metrics(s->host, OPC_ARRAY(values), error);
}

static int tell_of_violations(const given *s, eda_mask *m,
                              const double *extension, opc_error *error) {
  enum { ROOM = 10000, ROOM_OF_GATE = 16 };
  const eda_gates *g = m->gates;
  if (!s->regulator) return OPC_OK;
  size_t room = ROOM + ROOM_OF_GATE * g->count, n = 0;
  int32_t *none = eda_alloc(g->count, sizeof *none);
  eda_violation *v = eda_alloc(room, sizeof *v);
  const eda_printed printed = {.gates = g,
                               .flags = m->flags,
                               .l = none,
                               .w = none,
                               .extension = extension,
                               .shapes = m->shapes,
                               .print = m->print,
                               .scanner = eda_scanner_of(s->litho)};
  int code = eda_call_violations(s->host->context, s->regulator, &printed, v,
                                 room, &n, error);
  if (n > room) n = room;
  code = code ? eda_blame(error, code, "regulator")
              : report_violations(s->host, g, v, n, error);
  if (!code) eda_mask_set_violations(m, v, n);
  free(v);
  free(none);
  return code;
}

static int tell(const given *s, eda_mask *m, const double *extension,
                const uint32_t *before, opc_error *error) {
  const double limit[EDA_RULES] = {[EDA_RULE_SPACE] = s->min_space,
                                   [EDA_RULE_WIDTH] = s->min_mask_width,
                                   [EDA_RULE_EDGE] = s->min_edge,
                                   [EDA_RULE_JOG] = s->min_jog};
  const report told = {
      .mask = m, .extension = extension, .flags_before = before};
  int code = tell_of_violations(s, m, extension, error);
  if (!code) code = rules_report(s->host, m->gates, m->shapes, limit, error);
  if (!code) code = tell_of_worse(s, m, before, error);
  if (!code) findings_of_print(s->host, m->gates, m->flags, before);
  return code ? code : report_mask(s->host, &told, error);
}

static void take_prints(eda_printer *p, eda_field *out) {
  for (size_t k = 0; k < p->layers; k++) {
    out[k] = p->print[k];
    p->print[k] = (eda_field){0};
  }
}

static int run(void *self, void **outputs, opc_error *error) {
  given *s = self;
  const eda_gates *g = s->take.gates;
  eda_mask *out = eda_mask_new(g);
  outputs[0] = out; /* released by the host if this fails */
  s->take.host = s->host;
  s->take.margin = s->margin;
  eda_measurement before, after;
  eda_measurement_init(&before, g->count);
  eda_measurement_init(&after, g->count);
  eda_printer printer;
  eda_printer_init(&printer, s->host->context, g, s->litho, s->resist,
                   s->margin);
  printer.fine = s->fine;
  int code = take_shapes(&s->take, out, error);
  if (!code) code = prepare(s, &printer, out, error);
  if (!code) code = print(s, &printer, g->drawn, &before, error);
  take_prints(&printer, out->drawn_print);
  if (!code) code = print(s, &printer, out->shapes, &after, error);
  take_prints(&printer, out->print);
  out->before = before.performance;
  out->after = after.performance;
  out->flags = after.flags;
  out->simulations = printer.simulations;
  out->fine_simulations = printer.fine_simulations;
  if (!code) code = tell(s, out, after.extension, before.flags, error);
  eda_printer_clear(&printer);
  free(before.flags);
  free(before.extension);
  free(after.extension);
  return code;
}

static int save(void *self, void *const *outputs, const char *folder,
                opc_error *error) {
  (void)self;
  return eda_mask_save(outputs[0], folder, error);
}

static int restore(void *self, const char *folder, void **outputs,
                   opc_error *error) {
  const given *s = self;
  return eda_mask_restore(s->take.gates, folder, &outputs[0], error);
}

static int forecast(void *self, opc_forecast *out, opc_error *error) {
  const given *s = self;
  (void)error;
  forecast_prints(s->host->context, s->take.gates, s->litho, s->resist,
                  s->margin, s->fine, "two prints", "two fine prints", out);
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
    PRINT_SLOTS(given),
    OPC_PARAMETER(given, regulator, .type = OPC_SLOT, .choices = "regulator",
                  .summary = "whose rules the print is held against"),
    OPC_PARAMETER(given, margin, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .unit = "nm", .min = 0,
                  .summary =
                      "clear field around the layout, which repeats beyond; as "
                      "'fine' needs it"),
    FINE_PARAMETER(given),
    OPC_PARAMETER(given, ion_limit, .type = OPC_REAL, .flags = OPC_AT_LEAST,
                  .former = "limit", .unit = "%", .preset = "0.5 %",
                  .summary = "Largest allowed |Ion deviation|: within it no "
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
  int code = fine_error(s->fine_text, s->ion_limit, &s->fine, error);
  EDA_FOLLOW(s->host, "given", s, parameters, eda_scanner_of(s->litho));
  s->margin = fine_margin(s->host, s->litho, s->margin, s->fine);
  return code;
}

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = run,
                                   .forecast = forecast, .save = save,
                                   .restore = restore};

OPC_PLUGIN(given, .id = "given", .kind = "step", .version = OPC_VERSION,
           .licence = "BSD-3-Clause",
           .summary = "print and measure a mask that another tool has made",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = check,
           OPC_FUNCTIONS(functions));
