/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the step list.delays: the delay of each transistor of a mask, as
   drawn and as printed, by the timing model in the slot. */
#include <eda/gates.h>
#include <eda/memory.h>
#include <stdlib.h>

#include <opcflow/step.h>
#include <opcflow/table.h>

#include "timing.h"

/* ---- state ---- */

typedef struct delays {
  const opc_host *host;
  const eda_mask *mask;
  const opc_module *timing;
} delays;

/* ---- work ---- */

/* Return the delays of all transistors in ps. */
static double *delays_of(const delays *s, const eda_performance *p) {
  const timing *t = s->timing->functions;
  size_t n = s->mask->gates->count;
  double *delay = eda_alloc(n, sizeof *delay);
  for (size_t i = 0; i < n; i++)
    delay[i] = 1e12 * t->delay(s->timing->self, p->ion[i], p->area[i]);
  return delay;
}

static int delays_run(void *self, void **outputs, opc_error *error) {
  const delays *s = self;
  const eda_gates *g = s->mask->gates;
  double *drawn = delays_of(s, &s->mask->design);
  double *printed = delays_of(s, &s->mask->after);
  int64_t *number = eda_alloc(g->count, sizeof *number);
  double slower = 0;
  (void)outputs;
  for (size_t i = 0; i < g->count; i++) {
    double change = 100 * (printed[i] - drawn[i]) / drawn[i];
    if (change > slower) slower = change;
    number[i] = g->number[i];
  }
  const opc_column columns[] = {{"cell", NULL, OPC_TEXT, 0, g->cell},
                                {"number", NULL, OPC_INT, 0, number},
                                {"drawn", "ps", OPC_REAL, 4, drawn},
                                {"printed", "ps", OPC_REAL, 4, printed}};
  int code = opc_put_table(s->host, "delays", OPC_TABLE_PRINT, g->count,
                           columns, 4, error);
  free(drawn);
  free(printed);
  free(number);
  return code ? code : s->host->metric(s->host, "slower", slower, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(delays, mask, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "mask", .summary = "mask with the transistors"),
    OPC_PARAMETER(delays, timing, .type = OPC_SLOT,
                  .preset = "{ use: timing.cv }", .choices = "timing",
                  .summary = "timing model"),
};

static const opc_metric metrics[] = {
    {"slower", "%", OPC_LOWER, 0.01, "largest relative increase of a delay"},
};

/* ---- entry ---- */

static const opc_step functions = {.run = delays_run};

OPC_PLUGIN(delays, .id = "list.delays", .kind = "step", .version = "1.0.0",
           .licence = "BSD-3-Clause", .summary = "delay of each transistor",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           OPC_FUNCTIONS(functions));
