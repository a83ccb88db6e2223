/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements segment.edges: the edges of one drawn layer without transistors,
   for correction by edge placement alone (metal, contacts, test patterns). */
#include <eda/segment.h>
#include <opcflow/step.h>

/* ---- state ---- */

typedef struct edges {
  const opc_host *host;
  const eda_layout *layout;
  const char *layer, *top;
  double grid;
} edges;

/* ---- work ---- */

/* Find the layer with the given name; without a name, the only layer. */
static int find_layer(const edges *e, int32_t *layer, opc_error *error) {
  size_t n = eda_layout_layers(e->layout);
  *layer = e->layer ? eda_layout_select(e->layout, e->layer, error)
           : n == 1 ? 0
                    : -1;
  if (*layer >= 0) return OPC_OK;
  if (!e->layer)
    return opc_fail(error, OPC_INVALID, "layer",
                    "the layout has %zu layers: set 'layer'", n);
  (void)snprintf(error->parameter, sizeof error->parameter, "layer");
  return error->code;
}

static int edges_publish(const opc_host *host, const eda_shapes *s,
                         size_t moved, opc_error *error) {
  int code = host->metric(host, "snapped", (double)moved, error);
  if (!code) code = host->metric(host, "polygons", (double)s->count, error);
  if (!code)
    code = host->metric(host, "edges", (double)s->start[s->count], error);
  return code;
}

static int edges_run(void *self, void **outputs, opc_error *error) {
  const edges *e = self;
  int32_t layer, top = eda_segment_top(e->layout, e->top, error);
  if (top < 0 || find_layer(e, &layer, error)) return error->code;
  eda_gates *gates;
  size_t moved;
  int code =
      eda_segment_edges(e->layout, top, layer, e->grid, &gates, &moved, error);
  outputs[0] = gates;
  return code ? code : edges_publish(e->host, &gates->drawn[0], moved, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(edges, layout, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "layout", .summary = "layout with the layer"),
    OPC_PARAMETER(edges, layer, .type = OPC_TEXT,
                  .summary = "name of the layer; default: the only one"),
    OPC_PARAMETER(
        edges, top, .type = OPC_TEXT,
        .summary = "top cell; default: the only cell without a parent"),
    OPC_PARAMETER(edges, grid, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "nm", .preset = "1 nm", .summary = "mask grid"),
};

static const opc_metric metrics[] = {
    {"polygons", NULL, OPC_NEUTRAL, 0, "number of polygons and holes"},
    {"edges", NULL, OPC_NEUTRAL, 0, "number of edges of polygons"},
    {"snapped", NULL, OPC_LOWER, 0, "number of vertices moved by the grid"},
};

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_GATES("gates")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = edges_run,
                                   .flags = OPC_STEP_LIGHT};

OPC_PLUGIN(edges, .id = "segment.edges", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "find the edges of one drawn layer, without transistors",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics),
           OPC_FUNCTIONS(functions));
