/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements segment.transistors: finds the transistors of a layout and the
   mask edges that determine their printed size (thesis 2.2.5 and 3.2.2), and
   the edges of further layers. The algorithm is in eda/segment.h. */
#include <eda/segment.h>
#include <opcflow/step.h>
#include <stdio.h>

/* ---- state ---- */

typedef struct transistors {
  const opc_host *host;
  const eda_layout *layout;
  const char *top;
  opc_map also;     /* maps the name of a further layer to the layer of the
                       layout */
  opc_map flavours; /* maps the name of a flavour to its marker layers */
  double grid, overhang, line_end;
} transistors;

/* ---- work ---- */

static int transistors_publish(const opc_host *host, const eda_gates *g,
                               const eda_segment_report *report,
                               opc_error *error) {
  size_t pmos = 0;
  for (size_t i = 0; i < g->count; i++) pmos += g->type[i] == EDA_PMOS;
  const struct {
    const char *name;
    double value;
  } all[] = {{"snapped", (double)report->moved},
             {"snapped_worst", report->worst},
             {"transistors", (double)g->count},
             {"nmos", (double)(g->count - pmos)},
             {"pmos", (double)pmos}};
  int code = OPC_OK;
  for (size_t k = 0; !code && k < sizeof all / sizeof *all; k++)
    code = host->metric(host, all[k].name, all[k].value, error);
  return code;
}

static void transistors_log(void *data, int warning, const char *message) {
  const opc_host *host = data;
  host->log(host, warning ? OPC_LOG_WARNING : OPC_LOG_INFO,
            "segment.transistors: %s", message);
}

static int transistors_run(void *self, void **outputs, opc_error *error) {
  const transistors *t = self;
  eda_segment_settings settings = EDA_SEGMENT_SETTINGS(t);
  settings.log = transistors_log;
  settings.data = (void *)t->host;
  int32_t top = eda_segment_top(t->layout, t->top, error);
  if (top < 0) return error->code;
  eda_gates *gates;
  eda_segment_report report;
  int code = eda_segment(t->host->context, t->layout, top, &settings, &gates,
                         &report, error);
  outputs[0] = gates;
  return code ? code : transistors_publish(t->host, gates, &report, error);
}

static int transistors_forecast(void *self, opc_forecast *out,
                                opc_error *error) {
  const transistors *t = self;
  eda_segment_settings settings = EDA_SEGMENT_SETTINGS(t);
  int32_t top = eda_segment_top(t->layout, t->top, error);
  if (top < 0) return error->code;
  out->memory += eda_segment_bytes(t->layout, top, &settings);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller cell as 'top', or smaller arrays");
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(transistors, layout, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "layout",
                  .summary = "layout with layers poly, active, contact, nwell, "
                             "pwell, nimplant, pimplant, notes"),
    OPC_PARAMETER(
        transistors, top, .type = OPC_TEXT,
        .summary = "top cell; default: the only cell without a parent"),
    EDA_SEGMENT_PARAMETERS(transistors),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0, "number of transistors"},
    {"nmos", NULL, OPC_NEUTRAL, 0, "number of n-channel transistors"},
    {"pmos", NULL, OPC_NEUTRAL, 0, "number of p-channel transistors"},
    {"snapped", NULL, OPC_LOWER, 0,
     "number of vertices moved by the grid, all layers"},
    {"snapped_worst", "nm", OPC_LOWER, 0,
     "largest displacement of a vertex by the grid"},
};

static int transistors_check(void *self, opc_error *error) {
  const transistors *t = self;
  eda_segment_settings settings = EDA_SEGMENT_SETTINGS(t);
  return eda_segment_check(&settings, error);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_GATES("gates")};
static const opc_step functions = {
    OPC_OUTPUTS(outputs_of), .run = transistors_run,
    .forecast = transistors_forecast, .flags = OPC_STEP_LIGHT};

OPC_PLUGIN(transistors, .id = "segment.transistors", .kind = "step",
           .version = "0.3.0", .licence = "BSD-3-Clause",
           .summary =
               "find the transistors of a layout and the mask edges that "
               "determine their size",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           .check = transistors_check, OPC_FUNCTIONS(functions));
