/* SPDX-License-Identifier: BSD-3-Clause */
/* segment.edges: the edges of one drawn layer without any transistors, to be
   corrected by their places alone: metal, contacts, test patterns. */
#include <opcflow/opcflow.h>

#include <math.h>
#include <stddef.h>

/* ---- state ---- */

enum { LAYOUT, LAYER, TOP, GRID, PARAMETERS };

typedef struct edges {
  const opc_host *host;
  const opc_value *values;
} edges;

/* The output and what only its release needs. */
typedef struct owned_gates {
  opc_gates gates;         /* the first member */
  const opc_host *host;
} owned_gates;

/* ---- work ---- */

static void release_gates(void *object) {
  owned_gates *o = object;
  if (!o) return;
  const opc_host *host = o->host;
  host->geometry->release(&o->gates.drawn[OPC_POLY]);
  host->free(host, o->gates.edges[OPC_POLY].start);
  host->free(host, o->gates.edges[OPC_POLY].fragments);
  host->free(host, o);
}

static int find_top(const edges *e, const opc_layout *layout, int32_t *top,
                    opc_error *error) {
  const opc_layout_service *l = e->host->layout;
  const opc_value *name = &e->values[TOP];
  *top = name->type == OPC_ABSENT ? l->top(layout, error)
                                  : l->find_cell(layout, name->text);
  if (*top >= 0) return OPC_OK;
  if (name->type == OPC_ABSENT) return error->code;
  return e->host->fail(e->host, error, OPC_INVALID, "top",
                       "the layout has no cell '%.200s'", name->text);
}

/* The layer that is named, or the only one that the layout has. */
static int find_layer(const edges *e, const opc_layout *layout, int32_t *layer,
                      opc_error *error) {
  const opc_layout_service *l = e->host->layout;
  const opc_value *name = &e->values[LAYER];
  *layer = name->type == OPC_ABSENT ? (l->layers(layout) == 1 ? 0 : -1)
                                    : l->find_layer(layout, name->text);
  if (*layer >= 0) return OPC_OK;
  if (name->type == OPC_ABSENT)
    return e->host->fail(e->host, error, OPC_INVALID, "layer",
                         "the layout has %zu layers: say which one",
                         l->layers(layout));
  return e->host->fail(e->host, error, OPC_INVALID, "layer",
                       "the layout has no layer '%.200s'", name->text);
}

static int get_drawn(const edges *e, opc_gates *g, opc_error *error) {
  const opc_host *host = e->host;
  const opc_layout *layout = e->values[LAYOUT].object;
  int32_t top, layer;
  if (find_top(e, layout, &top, error) || find_layer(e, layout, &layer, error))
    return error->code;
  g->name = host->layout->cell_name(layout, top);
  opc_flat flat = {0};
  int code = host->layout->flatten(host, layout, top, layer, g->grid, &flat,
                                   error);
  if (code) return code;
  opc_error inner;
  code = host->geometry->boolean(host, OPC_OR, &flat.shapes, NULL,
                                 &g->drawn[OPC_POLY], &inner);
  if (code)
    host->fail(host, error, code, NULL, "layer '%s', in units of %g nm: %.800s",
               host->layout->layer_name(layout, layer), g->grid, inner.message);
  if (!code) code = host->metric(host, "snapped", (double)flat.moved, error);
  host->layout->release(&flat);
  if (code || g->drawn[OPC_POLY].count) return code;
  return host->fail(host, error, OPC_INVALID, NULL, "layer '%s' is empty",
                    host->layout->layer_name(layout, layer));
}

/* One fragment an edge, of no transistor; and the extent. */
static int get_edges(const edges *e, opc_gates *g, opc_error *error) {
  const opc_shapes *s = &g->drawn[OPC_POLY];
  opc_edges *out = &g->edges[OPC_POLY];
  size_t n = s->start[s->count];
  out->start = e->host->alloc(e->host, s->count + 1, sizeof *out->start);
  out->fragments = e->host->alloc(e->host, n, sizeof *out->fragments);
  if (!out->start || !out->fragments)
    return e->host->fail(e->host, error, OPC_FAILED, NULL, "out of memory");
  out->polygons = s->count;
  for (size_t p = 0; p <= s->count; p++) out->start[p] = s->start[p];
  g->extent = (opc_box){INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (size_t i = 0; i < n; i++) {
    opc_point p = s->points[i];
    out->fragments[i] = (opc_fragment){.from = p, .gate = -1};
    if (p.x < g->extent.x0) g->extent.x0 = p.x;
    if (p.y < g->extent.y0) g->extent.y0 = p.y;
    if (p.x > g->extent.x1) g->extent.x1 = p.x;
    if (p.y > g->extent.y1) g->extent.y1 = p.y;
  }
  return OPC_OK;
}

static int run(void *self, void **outputs, opc_error *error) {
  const edges *e = self;
  const opc_host *host = e->host;
  owned_gates *o = host->alloc(host, 1, sizeof *o);
  if (!o) return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  o->host = host;
  outputs[0] = o;
  opc_gates *g = &o->gates;
  g->size = sizeof *g;
  g->grid = e->values[GRID].real;
  int code = get_drawn(e, g, error);
  if (!code) code = get_edges(e, g, error);
  const opc_shapes *s = &g->drawn[OPC_POLY];
  if (!code)
    code = host->metric(host, "polygons", (double)s->count, error);
  if (!code)
    code = host->metric(host, "edges", (double)s->start[s->count], error);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [LAYOUT] = {.name = "layout", .type = OPC_INPUT, .flags = OPC_REQUIRED,
                .choices = "layout", .summary = "where the layer is drawn"},
    [LAYER] = {.name = "layer", .type = OPC_TEXT,
               .summary = "which layer; if not given, the only one"},
    [TOP] = {.name = "top", .type = OPC_TEXT,
             .summary = "the cell to take; if not given, the only one that no "
                        "other places"},
    [GRID] = {.name = "grid", .type = OPC_REAL, .flags = OPC_ABOVE,
              .unit = "nm", .preset = "1 nm", .summary = "mask grid"},
};

static const opc_metric metrics[] = {
    {.name = "polygons", .summary = "polygons, and holes in them"},
    {.name = "edges", .summary = "their edges"},
    {.name = "snapped", .better = OPC_LOWER,
     .summary = "vertices that the grid moved"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  edges *e = host->alloc(host, 1, sizeof *e);
  if (!e) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  e->host = host;
  e->values = values;
  return e;
}

static void destroy(void *self) {
  edges *e = self;
  e->host->free(e->host, e);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {
    {.name = "gates", .kind = "gates", .release = release_gates}};

static const opc_step operations = {.size = sizeof operations,
                                    .n_outputs = 1,
                                    .port_size = sizeof(opc_port),
                                    .outputs = outputs_of,
                                    .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "segment.edges",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "the edges of one drawn layer, without transistors",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    OPC_METRICS(metrics),
    .create = create,
    .destroy = destroy,
    .operations = &operations,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
