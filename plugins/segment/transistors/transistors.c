/* SPDX-License-Identifier: BSD-3-Clause */
/* segment.transistors: the transistors of a layout and the mask edges that
   move them (thesis 2.2.5 and 3.2.2). */
#include <math.h>
#include <opcflow/step.h>

#include "segment.h"

/* ---- state ---- */

typedef struct transistors {
  const opc_host *host;
  const opc_value *values;
} transistors;

enum { LAYOUT, TOP, GRID, OVERHANG, LINE_END, PARAMETERS };

/* ---- work ---- */

static void release_gates(void *object) {
  owned_gates *o = object;
  if (!o) return;
  const opc_host *host = o->host;
  opc_gates *g = &o->gates;
  for (int k = 0; k < OPC_LAYERS; k++) host->geometry->release(&g->drawn[k]);
  for (int k = 0; k < OPC_MASKS; k++) {
    host->free(host, g->edges[k].start);
    host->free(host, g->edges[k].fragments);
  }
  host->free(host, g->box);
  host->free(host, g->type);
  host->free(host, g->axis);
  host->free(host, g->length);
  host->free(host, g->width);
  host->free(host, g->room);
  host->free(host, g->extension);
  host->free(host, g->instance);
  host->free(host, g->cell);
  host->free(host, g->number);
  host->free(host, g->note);
  host->free(host, o->names);
  host->free(host, o);
}

/* What stays behind of the work. */
static void clean(segment *s) {
  s->host->layout->release(&s->active);
  for (int k = 0; k < DOPINGS; k++) s->host->geometry->release(&s->doping[k]);
  s->host->geometry->release(&s->regions);
  for (int k = 0; k < OPC_MASKS; k++) s->host->free(s->host, s->index[k].edges);
  s->host->free(s->host, s->placement);
}

static int has_layer(const segment *s, const char *name) {
  return s->host->layout->find_layer(s->layout, name) >= 0;
}

/* The layer with all placements, as drawn, and merged. Empty if the layout does
   not have it. */
static int get_layer(segment *s, const char *name, opc_flat *flat,
                     opc_shapes *merged) {
  const opc_layout_service *layout = s->host->layout;
  int32_t layer = layout->find_layer(s->layout, name);
  if (layer < 0) return OPC_OK;
  int code = layout->flatten(s->host, s->layout, s->top, layer, s->grid, flat,
                             s->error);
  if (code) return code;
  opc_error inner;
  code = s->host->geometry->boolean(s->host, OPC_OR, &flat->shapes, NULL,
                                    merged, &inner);
  if (!code) return OPC_OK;
  return s->host->fail(s->host, s->error, code, NULL,
                       "layer '%s', in units of %g nm: %.800s", name, s->grid,
                       inner.message);
}

static int get_dopings(segment *s) {
  static const char *const names[DOPINGS] = {"nwell", "pwell", "nimplant",
                                             "pimplant"};
  int code = OPC_OK;
  for (int k = 0; !code && k < DOPINGS; k++) {
    opc_flat flat = {0};
    s->has_doping[k] = has_layer(s, names[k]);
    code = get_layer(s, names[k], &flat, &s->doping[k]);
    s->host->layout->release(&flat);
  }
  return code;
}

static void extend(opc_box *box, const opc_shapes *shapes) {
  size_t n = shapes->count ? shapes->start[shapes->count] : 0;
  for (size_t i = 0; i < n; i++) {
    opc_point p = shapes->points[i];
    if (p.x < box->x0) box->x0 = p.x;
    if (p.y < box->y0) box->y0 = p.y;
    if (p.x > box->x1) box->x1 = p.x;
    if (p.y > box->y1) box->y1 = p.y;
  }
}

/* The layers that are kept, and what the grid did to them. */
static int get_drawn(segment *s) {
  static const char *const names[OPC_LAYERS] = {"poly", "active", "contact"};
  size_t moved = 0;
  double worst = 0;
  int code = OPC_OK;
  s->gates->extent = (opc_box){INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (int k = 0; !code && k < OPC_LAYERS; k++) {
    opc_flat flat = {0};
    code = get_layer(s, names[k], &flat, &s->gates->drawn[k]);
    moved += flat.moved;
    worst = fmax(worst, flat.worst);
    if (flat.moved)
      s->host->log(s->host, OPC_LOG_INFO,
                   "segment.transistors: the grid of %g nm moved %zu of %zu "
                   "vertices of layer '%s', by %.3g nm at most",
                   s->grid, flat.moved, flat.vertices, names[k], flat.worst);
    extend(&s->gates->extent, &s->gates->drawn[k]);
    if (k == OPC_ACTIVE)
      s->active = flat;
    else
      s->host->layout->release(&flat);
  }
  if (!code)
    code = s->host->metric(s->host, "snapped", (double)moved, s->error);
  if (!code) code = s->host->metric(s->host, "snapped_worst", worst, s->error);
  return code;
}

static int allocate(segment *s) {
  const opc_host *host = s->host;
  opc_gates *g = s->gates;
  size_t n = g->count = s->regions.count;
  g->box = host->alloc(host, n, sizeof *g->box);
  g->type = host->alloc(host, n, sizeof *g->type);
  g->axis = host->alloc(host, n, sizeof *g->axis);
  g->length = host->alloc(host, n, sizeof *g->length);
  g->width = host->alloc(host, n, sizeof *g->width);
  g->room = host->alloc(host, n, 2 * sizeof *g->room);
  g->extension = host->alloc(host, n, 2 * sizeof *g->extension);
  g->instance = host->alloc(host, n, sizeof *g->instance);
  g->cell = host->alloc(host, n, sizeof *g->cell);
  g->number = host->alloc(host, n, sizeof *g->number);
  if (!g->box || !g->type || !g->axis || !g->length || !g->width || !g->room ||
      !g->extension || !g->instance || !g->cell || !g->number)
    return segment_no_memory(s);
  return OPC_OK;
}

static int find_regions(segment *s) {
  const opc_host *host = s->host;
  opc_gates *g = s->gates;
  int code =
      host->geometry->boolean(host, OPC_AND, &g->drawn[OPC_POLY],
                              &g->drawn[OPC_ACTIVE], &s->regions, s->error);
  if (code) return code;
  if (!s->regions.count)
    return host->fail(host, s->error, OPC_INVALID, NULL,
                      "no transistor: layers 'poly' and 'active' do not cross");
  return allocate(s);
}

static int publish(const segment *s) {
  const opc_gates *g = s->gates;
  size_t pmos = 0;
  for (size_t i = 0; i < g->count; i++) pmos += g->type[i] == OPC_PMOS;
  double nmos = (double)(g->count - pmos);
  int code =
      s->host->metric(s->host, "transistors", (double)g->count, s->error);
  if (!code) code = s->host->metric(s->host, "nmos", nmos, s->error);
  if (!code) code = s->host->metric(s->host, "pmos", (double)pmos, s->error);
  return code;
}

static int find_top(segment *s, const opc_value *top) {
  const opc_layout_service *layout = s->host->layout;
  if (top->type == OPC_ABSENT) {
    s->top = layout->top(s->layout, s->error);
    return s->top < 0 ? s->error->code : OPC_OK;
  }
  s->top = layout->find_cell(s->layout, top->text);
  if (s->top >= 0) return OPC_OK;
  return s->host->fail(s->host, s->error, OPC_INVALID, "top",
                       "the layout has no cell '%.200s'", top->text);
}

static int segment_all(segment *s) {
  static const char *const needed[] = {"poly", "active"};
  for (int k = 0; k < 2; k++)
    if (!has_layer(s, needed[k]))
      return s->host->fail(s->host, s->error, OPC_INVALID, NULL,
                           "no transistor: the layout has no layer '%s'",
                           needed[k]);
  int (*const steps[])(segment *) = {
      get_drawn,      get_dopings,   find_regions,
      segment_locate, segment_index, segment_recognise,
      segment_cut,    segment_room,  segment_name,
      segment_notes};
  int code = OPC_OK;
  for (size_t k = 0; !code && k < sizeof steps / sizeof *steps; k++) {
    code = steps[k](s);
    if (!code && s->host->cancelled(s->host))
      code = s->host->fail(s->host, s->error, OPC_CANCELLED, NULL, "cancelled");
  }
  return code ? code : publish(s);
}

/* In grid units, within what coordinates can be. */
static int32_t in_units(double nm, double grid) {
  return (int32_t)fmin(floor(nm / grid + 0.5), 1073741824.0);
}

static int run(void *self, void **outputs, opc_error *error) {
  const transistors *t = self;
  const opc_value *v = t->values;
  const opc_host *host = t->host;
  segment s = {.host = host,
               .error = error,
               .layout = v[LAYOUT].object,
               .grid = v[GRID].real,
               .overhang = in_units(v[OVERHANG].real, v[GRID].real),
               .line_end = in_units(v[LINE_END].real, v[GRID].real)};
  s.owned = host->alloc(host, 1, sizeof *s.owned);
  if (!s.owned) return segment_no_memory(&s);
  s.owned->host = host;
  s.gates = outputs[0] = &s.owned->gates;
  s.gates->size = sizeof *s.gates;
  s.gates->grid = s.grid;
  int code = find_top(&s, &v[TOP]);
  if (!code) {
    s.gates->name = host->layout->cell_name(s.layout, s.top);
    code = segment_all(&s);
  }
  clean(&s);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[PARAMETERS] = {
    [LAYOUT] = {.name = "layout",
                .type = OPC_INPUT,
                .flags = OPC_REQUIRED,
                .choices = "layout",
                .summary = "layers poly, active, contact, nwell, pwell, "
                           "nimplant, pimplant, notes"},
    [TOP] = {.name = "top",
             .type = OPC_TEXT,
             .summary = "the cell to take; if not given, the only one that no "
                        "other places"},
    [GRID] = {.name = "grid",
              .type = OPC_REAL,
              .flags = OPC_ABOVE,
              .unit = "nm",
              .preset = "1 nm",
              .summary = "mask grid"},
    [OVERHANG] = {.name = "overhang",
                  .type = OPC_REAL,
                  .flags = OPC_AT_LEAST,
                  .unit = "nm",
                  .preset = "84 nm",
                  .summary = "how far past the active a transistor owns the "
                             "edges of a poly that goes on"},
    [LINE_END] = {.name = "line_end",
                  .type = OPC_REAL,
                  .flags = OPC_AT_LEAST,
                  .unit = "nm",
                  .preset = "200 nm",
                  .summary = "poly that ends within this distance of the "
                             "active is the transistor's own line end"},
};

static const opc_metric metrics[] = {
    {.name = "transistors", .summary = "transistors found"},
    {.name = "nmos", .summary = "n-channel transistors"},
    {.name = "pmos", .summary = "p-channel transistors"},
    {.name = "snapped",
     .better = OPC_LOWER,
     .summary = "vertices of poly, active and contact that the grid moved"},
    {.name = "snapped_worst",
     .unit = "nm",
     .better = OPC_LOWER,
     .summary = "how far it moved one at most"},
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  transistors *t = host->alloc(host, 1, sizeof *t);
  if (!t) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  t->host = host;
  t->values = values;
  return t;
}

static void destroy(void *self) {
  transistors *t = self;
  t->host->free(t->host, t);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {
    {.name = "gates", .kind = "gates", .release = release_gates}};

static const opc_step operations = {
    .size = sizeof operations,
    .n_outputs = 1,
    .port_size = sizeof(opc_port),
    .outputs = outputs_of,
    .run = run,
};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "segment.transistors",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary =
        "find the transistors of a layout and the mask edges that move "
        "them",
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
