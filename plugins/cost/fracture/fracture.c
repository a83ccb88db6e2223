/* SPDX-License-Identifier: BSD-3-Clause */
/* cost.fracture: what a mask costs to write, counted in rectangles, as a
   writer with a variable shaped beam exposes them, and in vertices. */
#include <opcflow/opcflow.h>

/* ---- state ---- */

enum { MASK };

typedef struct counter {
  const opc_host *host;
  const opc_value *values;
} counter;

/* The cost of a layer, as an array of each figure has it: [layer]. */
typedef struct cost {
  int64_t rectangles[OPC_MASKS], vertices[OPC_MASKS];
  double area[OPC_MASKS]; /* um^2 */
} cost;

/* ---- work ---- */

static int count_layer(const counter *c, const opc_shapes *shapes, double grid,
                       int layer, cost *out, opc_error *error) {
  const opc_geometry_service *g = c->host->geometry;
  opc_box *boxes = NULL;
  size_t n = 0;
  int code = g->fracture(c->host, shapes, &boxes, &n, error);
  if (code) return code;
  c->host->free(c->host, boxes);
  out->rectangles[layer] = (int64_t)n;
  out->vertices[layer] = shapes->count ? shapes->start[shapes->count] : 0;
  double um = grid * 1e-3;
  out->area[layer] = (double)g->area2(shapes) / 2 * um * um;
  return OPC_OK;
}

static int count_all(const counter *c, const opc_shapes *shapes, double grid,
                     cost *out, opc_error *error) {
  int code = OPC_OK;
  for (int layer = 0; layer < OPC_MASKS && !code; layer++)
    code = count_layer(c, &shapes[layer], grid, layer, out, error);
  return code;
}

static int publish(const counter *c, const cost *drawn, const cost *corrected,
                   opc_error *error) {
  static const char *const names[OPC_MASKS] = {
      [OPC_POLY] = "poly", [OPC_ACTIVE] = "active"};
  const opc_column columns[] = {
      {"layer", NULL, OPC_TEXT, 0, names},
      {"rectangles_drawn", NULL, OPC_INT, 0, drawn->rectangles},
      {"rectangles", NULL, OPC_INT, 0, corrected->rectangles},
      {"vertices_drawn", NULL, OPC_INT, 0, drawn->vertices},
      {"vertices", NULL, OPC_INT, 0, corrected->vertices},
      {"area_drawn", "um^2", OPC_REAL, 4, drawn->area},
      {"area", "um^2", OPC_REAL, 4, corrected->area},
  };
  const opc_host *host = c->host;
  double rectangles = 0, rectangles_drawn = 0, vertices = 0;
  for (int layer = 0; layer < OPC_MASKS; layer++) {
    rectangles += (double)corrected->rectangles[layer];
    rectangles_drawn += (double)drawn->rectangles[layer];
    vertices += (double)corrected->vertices[layer];
  }
  int code = host->table(host, "cost", OPC_TABLE_PRINT, OPC_MASKS, columns,
                         sizeof columns / sizeof columns[0], error);
  if (!code) code = host->metric(host, "rectangles", rectangles, error);
  if (!code)
    code = host->metric(host, "rectangles_drawn", rectangles_drawn, error);
  if (!code) code = host->metric(host, "vertices", vertices, error);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  const counter *c = self;
  const opc_mask *mask = c->values[MASK].object;
  const opc_gates *gates = mask->gates;
  cost drawn, corrected;
  (void)outputs;
  if (count_all(c, gates->drawn, gates->grid, &drawn, error) ||
      count_all(c, mask->shapes, gates->grid, &corrected, error))
    return error->code;
  return publish(c, &drawn, &corrected, error);
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .flags = OPC_REQUIRED,
              .choices = "mask",
              .summary = "The mask to count"},
};

static const opc_metric metrics[] = {
    {.name = "rectangles",
     .better = OPC_LOWER,
     .summary = "Rectangles of the corrected mask, poly and active"},
    {.name = "rectangles_drawn",
     .better = OPC_NEUTRAL,
     .summary = "Rectangles of the mask as drawn, poly and active"},
    {.name = "vertices",
     .better = OPC_LOWER,
     .summary = "Vertices of the corrected mask, poly and active"},
};

/* ---- entry ---- */

static void destroy(void *self) {
  counter *c = self;
  c->host->free(c->host, c);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  counter *c = host->alloc(host, 1, sizeof *c);
  if (!c) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  c->host = host;
  c->values = values;
  return c;
}

static const opc_step step = {.size = sizeof step, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "cost.fracture",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Count the rectangles and vertices of a mask",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
