/* SPDX-License-Identifier: BSD-3-Clause */
/* The step `correct`: the correction loop (../loop.c), its result and its
   report. */
#include <eda/memory.h>
#include <opcflow/step.h>
#include <stdlib.h>

#include "../loop.h"

enum { ROOM_FOR_VIOLATIONS = 10000 };

/* ---- state ---- */

typedef struct correct {
  const opc_host *host;
  const eda_gates *gates;
  const opc_module *litho, *resist, *extractor, *synthesizer, *edges,
      *regulator;
  int64_t max_iterations;
  double margin; /* nm */
} correct;

/* ---- work ---- */

static void tell_of_overlaps(const loop *l) {
  for (size_t k = 0; k < l->gates->layers; k++)
    if (!l->now.patches[k].count && !l->now.bites[k].count &&
        !l->now.assists[k].count &&
        eda_area2(&l->polygons[k]) != eda_area2(&l->mask[k])) {
      l->host->log(l->host, OPC_LOG_WARNING,
                   "mask edges have met: their polygons were merged");
      return;
    }
}

/* Move what outlives the run from the loop to its result. */
static eda_mask *hand_over(loop *l) {
  eda_mask *out = eda_mask_new(l->gates);
  for (size_t k = 0; k < l->gates->layers; k++) {
    out->shapes[k] = l->mask[k];
    out->print[k] = l->printer.print[k];
    l->mask[k] = (eda_shapes){0};
    l->printer.print[k] = (eda_field){0};
  }
  out->design = l->design;
  out->before = l->before;
  out->after = l->measured.performance;
  l->design = l->before = l->measured.performance = (eda_performance){0};
  out->flags = l->measured.flags;
  l->measured.flags = NULL;
  out->iterations = l->iterations;
  out->simulations = l->printer.simulations;
  return out;
}

static int tell_of_violations(const loop *l, opc_error *error) {
  if (!l->regulator) return OPC_OK;
  const eda_regulator *r = l->regulator->functions;
  eda_violation *v = eda_alloc(ROOM_FOR_VIOLATIONS, sizeof *v);
  eda_printed p = loop_printed(l);
  size_t total = 0;
  const char *before = eda_enter(l->host->context, l->regulator, error);
  int code = r->violations(l->regulator->self, &p, v, ROOM_FOR_VIOLATIONS,
                           &total, error);
  opc_leave(l->host->context, before);
  size_t n = total < ROOM_FOR_VIOLATIONS ? total : ROOM_FOR_VIOLATIONS;
  if (!code) code = eda_check_violations(v, n, l->gates->count, error);
  code = eda_blame(error, code, "regulator");
  if (!code) code = report_violations(l->host, l->gates, v, n, total, error);
  free(v);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const correct *c = self;
  loop l = {
      .host = c->host,
      .gates = c->gates,
      .extractor = c->extractor,
      .regulator = c->regulator,
      .max_iterations = c->max_iterations,
      .drivers = {[MAIN].module = c->synthesizer, [EDGES].module = c->edges}};
  eda_printer_init(&l.printer, c->host->context, c->gates, c->litho, c->resist,
                   c->margin);
  int code = loop_run(&l, error);
  if (!code) {
    tell_of_overlaps(&l);
    code = tell_of_violations(&l, error);
  }
  if (!code) {
    eda_mask *mask = hand_over(&l);
    outputs[0] = mask; /* released by the host if the report fails */
    const report told = {.mask = mask,
                         .extension = l.measured.extension,
                         .sites = l.sites,
                         .biases = &l.now.biases,
                         .synthesizer = l.drivers[MAIN].module};
    code = report_mask(c->host, &told, error);
    if (!code) code = history_report(&l.history, c->host, error);
  }
  loop_clear(&l);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    {.name = "gates",
     .type = OPC_INPUT,
     .flags = OPC_REQUIRED,
     .choices = "gates",
     .summary = "the transistors to correct",
     OPC_FIELD(correct, gates)},
    {.name = "litho",
     .type = OPC_SLOT,
     .flags = OPC_REQUIRED,
     .choices = "litho",
     .summary = "model of the optics",
     OPC_FIELD(correct, litho)},
    {.name = "resist",
     .type = OPC_SLOT,
     .flags = OPC_REQUIRED,
     .choices = "resist",
     .summary = "model of the resist",
     OPC_FIELD(correct, resist)},
    {.name = "extractor",
     .type = OPC_SLOT,
     .flags = OPC_REQUIRED,
     .choices = "extractor",
     .summary = "performance of a printed transistor",
     OPC_FIELD(correct, extractor)},
    {.name = "synthesizer",
     .type = OPC_SLOT,
     .flags = OPC_REQUIRED,
     .choices = "synthesizer",
     .summary = "what moves the mask's edges",
     OPC_FIELD(correct, synthesizer)},
    {.name = "edges",
     .type = OPC_SLOT,
     .choices = "synthesizer",
     .summary = "what moves the edges of layers that no transistor moves",
     OPC_FIELD(correct, edges)},
    {.name = "regulator",
     .type = OPC_SLOT,
     .choices = "regulator",
     .summary = "what keeps the print free of failures",
     OPC_FIELD(correct, regulator)},
    {.name = "max_iterations",
     .type = OPC_INT,
     .flags = OPC_AT_LEAST | OPC_AT_MOST,
     .preset = "100",
     .min = 0,
     .max = 100000,
     .summary = "stop after so many moves",
     OPC_FIELD(correct, max_iterations)},
    {.name = "margin",
     .type = OPC_REAL,
     .flags = OPC_AT_LEAST,
     .unit = "nm",
     .preset = "1000 nm",
     .min = 0,
     .summary = "clear field around the layout, which repeats beyond",
     OPC_FIELD(correct, margin)},
};

static const opc_metric metrics[] = {
    {.name = "transistors", .summary = "how many were corrected"},
    {.name = "ion_mean",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "mean of |Ion deviation| after correction"},
    {.name = "ion_max",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "largest |Ion deviation| after correction"},
    {.name = "ion_stdv",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "standard deviation of the Ion deviation, thesis eq. 3.5"},
    {.name = "ion_mean_drawn",
     .unit = "%",
     .summary = "mean of |Ion deviation| of the mask as drawn"},
    {.name = "ion_max_drawn",
     .unit = "%",
     .summary = "largest |Ion deviation| of the mask as drawn"},
    {.name = "area_mean",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "mean of |gate area deviation| after correction"},
    {.name = "area_max",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "largest |gate area deviation| after correction"},
    {.name = "ioff_mean",
     .unit = "%",
     .better = OPC_LOWER,
     .tolerance = 0.1,
     .summary = "mean of |Ioff deviation| after correction"},
    {.name = "epe_mean",
     .unit = "nm",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary =
         "mean of |edge placement error| of the synthesizer's fragments"},
    {.name = "epe_max",
     .unit = "nm",
     .better = OPC_LOWER,
     .tolerance = 0.01,
     .summary = "largest |edge placement error|"},
    {.name = "epe_lost",
     .better = OPC_LOWER,
     .summary = "fragments without a printed edge within 100 nm"},
    {.name = "iterations",
     .better = OPC_LOWER,
     .summary = "times that the synthesizer moved edges"},
    {.name = "simulations",
     .better = OPC_LOWER,
     .summary = "litho simulations, of one layer each"},
    {.name = "failed",
     .better = OPC_LOWER,
     .summary = "transistors that do not print as one of their own"},
    {.name = "violations",
     .better = OPC_LOWER,
     .summary = "rules of the regulator that the print does not keep"},
};

/* ---- entry ---- */

static const opc_port outputs[] = {EDA_PORT_MASK("mask")};
static const opc_step functions = {OPC_OUTPUTS(outputs), .run = run};

OPC_PLUGIN(
    correct, .id = "correct", .kind = "step", .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary = "move mask edges until every transistor performs as drawn",
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT, OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics), OPC_FUNCTIONS(functions));
