/* SPDX-License-Identifier: BSD-3-Clause */
/* The step `correct`: the correction loop (loop.c), its result and its
   report. */
#include "core/correct/check.h"
#include "core/correct/loop.h"
#include "core/plugin/guard.h"
#include "core/plugin/host.h"

#include <string.h>

/* ---- state ---- */

enum {
  GATES, LITHO, RESIST, EXTRACT, SYNTHESIZER, REGULATOR, MAX_ITERATIONS, MARGIN,
  PARAMETERS
};

enum { ROOM_FOR_VIOLATIONS = 10000 };

typedef struct correct {
  const opc_host *host;
  const opc_value *values;
} correct;

/* ---- work ---- */

static void tell_of_overlaps(const opc_loop *l) {
  const opc_geometry_service *g = l->host->geometry;
  for (int layer = 0; layer < OPC_MASKS; layer++)
    if (!l->now.patches[layer].count && !l->now.bites[layer].count &&
        !l->now.assists[layer].count &&
        g->area2(&l->polygons[layer]) != g->area2(&l->mask[layer])) {
      l->host->log(l->host, OPC_LOG_WARNING,
                   "mask edges have met: their polygons were merged");
      return;
    }
}

/* Move what outlives the run from the loop to its result. */
static void hand_over(opc_loop *l, opc_mask *out) {
  out->size = sizeof *out;
  out->gates = l->gates;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    out->shapes[layer] = l->mask[layer];
    out->print[layer] = l->printer.print[layer];
    l->mask[layer] = (opc_shapes){0};
    l->printer.print[layer] = (opc_field){0};
  }
  out->design = l->design;
  out->before = l->before;
  out->after = l->measured.performance;
  l->design = l->before = l->measured.performance = (opc_performance){0};
  out->flags = l->measured.flags;
  l->measured.flags = NULL;
  out->iterations = l->iterations;
  out->simulations = l->printer.simulations;
}

static int report_violations(const opc_loop *l, opc_error *error) {
  if (!l->regulator) return OPC_OK;
  const opc_regulator *r = l->regulator->plugin->operations;
  opc_violation *v =
      l->host->alloc(l->host, ROOM_FOR_VIOLATIONS, sizeof *v);
  if (!v) return opc_fail(error, OPC_FAILED, NULL, "out of memory");
  opc_printed p = opc_loop_printed(l);
  size_t total = 0;
  const char *before = opc_call(l->regulator, error);
  int code = r->violations(l->regulator->self, &p, v, ROOM_FOR_VIOLATIONS,
                           &total, error);
  opc_leave(before);
  size_t n = total < ROOM_FOR_VIOLATIONS ? total : ROOM_FOR_VIOLATIONS;
  if (!code) code = opc_check_violations(v, n, l->gates->count, error);
  code = opc_blame(error, code, "regulator");
  if (!code)
    code = opc_report_violations(l->host, l->gates, v, n, total, error);
  l->host->free(l->host, v);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const correct *c = self;
  const opc_value *v = c->values;
  const opc_host *host = c->host;
  opc_loop l = {.host = host,
                .gates = v[GATES].object,
                .extract = v[EXTRACT].object,
                .synthesizer = v[SYNTHESIZER].object,
                .regulator = v[REGULATOR].object,
                .max_iterations = (int)v[MAX_ITERATIONS].integer};
  opc_printer_make(&l.printer, host, l.gates, v[LITHO].object,
                   v[RESIST].object, v[MARGIN].real);
  opc_mask *mask = host->alloc(host, 1, sizeof *mask);
  int code = mask ? opc_loop_run(&l, error)
                  : opc_fail(error, OPC_FAILED, NULL, "out of memory");
  if (!code) {
    tell_of_overlaps(&l);
    code = report_violations(&l, error);
  }
  if (!code) {
    hand_over(&l, mask);
    outputs[0] = mask;   /* released by the host if the report fails */
    const opc_report report = {.mask = mask,
                               .extension = l.measured.extension,
                               .sites = l.sites,
                               .biases = &l.now.biases,
                               .synthesizer = l.synthesizer};
    code = opc_report_mask(host, &report, error);
    if (!code) code = opc_history_table(l.history, host, error);
  } else {
    host->free(host, mask);
  }
  opc_loop_clear(&l);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [GATES] = {.name = "gates", .type = OPC_INPUT, .flags = OPC_REQUIRED,
               .choices = "gates", .summary = "the transistors to correct"},
    [LITHO] = {.name = "litho", .type = OPC_SLOT, .flags = OPC_REQUIRED,
               .choices = "litho", .summary = "model of the optics"},
    [RESIST] = {.name = "resist", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                .choices = "resist", .summary = "model of the resist"},
    [EXTRACT] = {.name = "extract", .type = OPC_SLOT, .flags = OPC_REQUIRED,
                 .choices = "extract",
                 .summary = "performance of a printed transistor"},
    [SYNTHESIZER] = {.name = "synthesizer", .type = OPC_SLOT,
                     .flags = OPC_REQUIRED, .choices = "mask",
                     .summary = "what moves the mask's edges"},
    [REGULATOR] = {.name = "regulator", .type = OPC_SLOT, .choices = "drc",
                   .summary = "what keeps the print free of failures"},
    [MAX_ITERATIONS] = {.name = "max_iterations", .type = OPC_INT,
                        .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "100",
                        .min = 0, .max = 100000,
                        .summary = "stop after so many moves"},
    [MARGIN] = {.name = "margin", .type = OPC_REAL, .flags = OPC_AT_LEAST,
                .unit = "nm", .preset = "1000 nm", .min = 0,
                .summary = "clear field around the layout, which repeats beyond"},
};

static const opc_metric metrics[] = {
    {.name = "transistors", .summary = "how many were corrected"},
    {.name = "ion_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "mean of |Ion deviation| after correction"},
    {.name = "ion_max", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |Ion deviation| after correction"},
    {.name = "ion_stdv", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "standard deviation of the Ion deviation, thesis eq. 3.5"},
    {.name = "ion_mean_drawn", .unit = "%",
     .summary = "mean of |Ion deviation| of the mask as drawn"},
    {.name = "ion_max_drawn", .unit = "%",
     .summary = "largest |Ion deviation| of the mask as drawn"},
    {.name = "area_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "mean of |gate area deviation| after correction"},
    {.name = "area_max", .unit = "%", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |gate area deviation| after correction"},
    {.name = "ioff_mean", .unit = "%", .better = OPC_LOWER, .tolerance = 0.1,
     .summary = "mean of |Ioff deviation| after correction"},
    {.name = "epe_mean", .unit = "nm", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "mean of |edge placement error| of the synthesizer's fragments"},
    {.name = "epe_max", .unit = "nm", .better = OPC_LOWER, .tolerance = 0.01,
     .summary = "largest |edge placement error|"},
    {.name = "epe_lost", .better = OPC_LOWER,
     .summary = "fragments without a printed edge within 100 nm"},
    {.name = "iterations", .better = OPC_LOWER,
     .summary = "times that the synthesizer moved edges"},
    {.name = "simulations", .better = OPC_LOWER,
     .summary = "litho simulations, of one layer each"},
    {.name = "failed", .better = OPC_LOWER,
     .summary = "transistors that do not print as one of their own"},
    {.name = "violations", .better = OPC_LOWER,
     .summary = "rules of the regulator that the print does not keep"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  correct *c = host->alloc(host, 1, sizeof *c);
  if (!c) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  c->host = host;
  c->values = values;
  return c;
}

static void destroy(void *self) {
  correct *c = self;
  c->host->free(c->host, c);
}

/* ---- entry ---- */

static const opc_port ports[] = {{"mask", "mask", opc_mask_release}};

static const opc_step operations = {.size = sizeof operations,
                                    .n_outputs = 1,
                                    .port_size = sizeof(opc_port),
                                    .outputs = ports,
                                    .run = run};

extern const opc_plugin opc_correct_plugin;
const opc_plugin opc_correct_plugin = {
    .size = sizeof(opc_plugin),
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "correct",
    .version = OPC_VERSION,
    .licence = "BSD-3-Clause",
    .summary = "move mask edges until every transistor performs as drawn",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};
