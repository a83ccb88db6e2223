/* SPDX-License-Identifier: BSD-3-Clause */
/* segment.transistors: the transistors of a layout and the mask edges that
   move them (thesis 2.2.5 and 3.2.2), and further layers, whose edges are of
   no transistor. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "segment.h"

/* ---- state ---- */

typedef struct transistors {
  const opc_host *host;
  const eda_layout *layout;
  const char *top;
  opc_map also; /* name: layer of the layout */
  double grid, overhang, line_end;
} transistors;

/* What the layout calls them, and the gates. */
static const char *const known[] = {"poly", "active", "contact"};
enum { CONTACT = 2, KNOWN = 3 };

/* ---- work ---- */

/* The layer with all placements, as drawn, and merged. Empty if the layout does
   not have it. */
static int get_layer(segment *s, const char *name, eda_flat *flat,
                     eda_shapes *merged) {
  int32_t layer = eda_layout_find_layer(s->layout, name);
  *flat = (eda_flat){0};
  *merged = (eda_shapes){0};
  return layer < 0 ? OPC_OK
                   : segment_flatten(s->layout, s->top, layer, s->grid, flat,
                                     merged, s->error);
}

static int get_dopings(segment *s) {
  static const char *const names[DOPINGS] = {"nwell", "pwell", "nimplant",
                                             "pimplant"};
  int code = OPC_OK;
  for (int k = 0; !code && k < DOPINGS; k++) {
    eda_flat flat;
    s->has_doping[k] = eda_layout_find_layer(s->layout, names[k]) >= 0;
    code = get_layer(s, names[k], &flat, &s->doping[k]);
    eda_flat_clear(&flat);
  }
  return code;
}

/* The error is about a key of `also`. */
static int blame(opc_error *error, const char *name) {
  snprintf(error->parameter, sizeof error->parameter, "also.%.58s", name);
  return error->code;
}

/* The layers must be there, but for contacts; further ones with shapes. */
static int check_layers(segment *s) {
  for (size_t k = 0; k < s->sources; k++) {
    const char *from = s->source[k].from;
    if (k == CONTACT || eda_layout_find_layer(s->layout, from) >= 0) continue;
    if (k < KNOWN)
      return opc_fail(s->error, OPC_INVALID, NULL,
                      "no transistor: the layout has no layer '%s'", from);
    opc_fail(s->error, OPC_INVALID, NULL, "the layout has no layer '%.200s'",
             from);
    return blame(s->error, s->source[k].name);
  }
  return OPC_OK;
}

/* The layers of the gates, and what the grid did to them. */
static int get_drawn(segment *s) {
  size_t moved = 0;
  double worst = 0;
  int code = OPC_OK;
  for (size_t k = 0; !code && k < s->sources; k++) {
    source *from = &s->source[k];
    eda_flat flat;
    code = get_layer(s, from->from, &flat, &from->drawn);
    moved += flat.moved;
    worst = fmax(worst, flat.worst);
    if (flat.moved)
      s->host->log(s->host, OPC_LOG_INFO,
                   "segment.transistors: the grid of %g nm moved %zu of %zu "
                   "vertices of layer '%s', by %.3g nm at most",
                   s->grid, flat.moved, flat.vertices, from->from, flat.worst);
    if (k <= EDA_ACTIVE) s->moved += flat.moved;
    if (k == EDA_ACTIVE)
      s->active = flat;
    else
      eda_flat_clear(&flat);
    if (!code && k >= KNOWN && !from->drawn.count) {
      opc_fail(s->error, OPC_INVALID, NULL, "layer '%.200s' is empty",
               from->from);
      code = blame(s->error, from->name);
    }
  }
  if (!code)
    code = s->host->metric(s->host, "snapped", (double)moved, s->error);
  if (!code) code = s->host->metric(s->host, "snapped_worst", worst, s->error);
  return code;
}

static int find_regions(segment *s) {
  int code = eda_boolean(EDA_AND, &s->source[EDA_POLY].drawn,
                         &s->source[EDA_ACTIVE].drawn, &s->regions, s->error);
  if (!code && !s->regions.count)
    code = opc_fail(s->error, OPC_INVALID, NULL,
                    "no transistor: layers 'poly' and 'active' do not cross");
  return code;
}

/* The gates, with all layers but contacts where none are drawn. */
static int make_gates(segment *s) {
  size_t layers = s->sources - !s->source[CONTACT].drawn.count, n = 0;
  eda_gates *g = s->gates = eda_gates_new(layers, s->regions.count);
  g->name = eda_gates_text(g, eda_layout_cell_name(s->layout, s->top));
  g->grid = s->grid;
  for (size_t k = 0; k < s->sources; k++) {
    source *from = &s->source[k];
    if (k == CONTACT && !from->drawn.count) continue;
    segment_set_layer(g, n, from->name, k != CONTACT, &from->drawn);
    if (k >= KNOWN) segment_cut_plain(g, n);
    n++;
  }
  return OPC_OK;
}

static int find_gates(segment *s) {
  segment_locate(s);
  segment_index(s);
  if (segment_recognise(s) || segment_drawn(s)) return s->error->code;
  segment_cut(s);
  segment_space(s);
  segment_name(s);
  return segment_notes(s);
}

static int publish(segment *s) {
  const opc_host *host = s->host;
  const eda_gates *g = s->gates;
  size_t pmos = 0;
  for (size_t i = 0; i < g->count; i++) pmos += g->type[i] == EDA_PMOS;
  double nmos = (double)(g->count - pmos);
  int code = host->metric(host, "transistors", (double)g->count, s->error);
  if (!code) code = host->metric(host, "nmos", nmos, s->error);
  if (!code) code = host->metric(host, "pmos", (double)pmos, s->error);
  return code;
}

static int segment_all(segment *s) {
  int (*const steps[])(segment *) = {check_layers, get_drawn,  get_dopings,
                                     find_regions, make_gates, find_gates,
                                     publish};
  int code = OPC_OK;
  for (size_t k = 0; !code && k < sizeof steps / sizeof *steps; k++) {
    code = steps[k](s);
    if (!code && opc_cancelled(s->host->context))
      code = opc_fail(s->error, OPC_CANCELLED, NULL, "cancelled");
  }
  return code;
}

/* In grid units, within what coordinates can be. */
static int32_t in_units(double nm, double grid) {
  return (int32_t)fmin(floor(nm / grid + 0.5), 1073741824.0);
}

static void get_sources(const transistors *t, segment *s) {
  s->sources = KNOWN + t->also.count;
  s->source = eda_alloc(s->sources, sizeof *s->source);
  for (size_t k = 0; k < s->sources; k++) {
    const opc_pair *pair = k < KNOWN ? NULL : &t->also.pairs[k - KNOWN];
    s->source[k].name = pair ? pair->key : known[k];
    s->source[k].from = pair ? pair->value : known[k];
  }
}

static int run(void *self, void **outputs, opc_error *error) {
  const transistors *t = self;
  segment s = {.host = t->host,
               .error = error,
               .layout = t->layout,
               .grid = t->grid,
               .overhang = in_units(t->overhang, t->grid),
               .line_end = in_units(t->line_end, t->grid)};
  get_sources(t, &s);
  int code = segment_top(t->layout, t->top, &s.top, error);
  if (!code) code = segment_all(&s);
  outputs[0] = s.gates;
  for (size_t k = 0; k < s.sources; k++) eda_shapes_clear(&s.source[k].drawn);
  free(s.source);
  eda_flat_clear(&s.active);
  for (int k = 0; k < DOPINGS; k++) eda_shapes_clear(&s.doping[k]);
  eda_shapes_clear(&s.regions);
  for (int k = 0; k < 2; k++) free(s.index[k].edges);
  free(s.placement);
  return code;
}

/* The layers made flat are there side by side, with as much again where they
   are merged. */
static int forecast(void *self, opc_forecast *out, opc_error *error) {
  const transistors *t = self;
  segment s = {0};
  int code = segment_top(t->layout, t->top, &s.top, error);
  if (code) return code;
  get_sources(t, &s);
  for (size_t k = 0; k < s.sources; k++) {
    int32_t layer = eda_layout_find_layer(t->layout, s.source[k].from);
    if (layer >= 0)
      out->memory += 2 * eda_layout_flat_bytes(t->layout, s.top, layer);
  }
  free(s.source);
  (void)snprintf(out->help, sizeof out->help,
                 "a smaller cell as 'top', or smaller arrays");
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    OPC_PARAMETER(transistors, layout, .type = OPC_INPUT, .flags = OPC_REQUIRED,
                  .choices = "layout",
                  .summary = "layers poly, active, contact, nwell, pwell, "
                             "nimplant, pimplant, notes"),
    OPC_PARAMETER(transistors, top, .type = OPC_TEXT,
                  .summary = "the cell to take; if not given, the only one "
                             "that no other places"),
    OPC_PARAMETER(
        transistors, also, .type = OPC_MAP,
        .summary = "further layers to correct, by the places of their edges: { "
                   "metal1: M1 } calls the layout's M1 metal1"),
    OPC_PARAMETER(transistors, grid, .type = OPC_REAL, .flags = OPC_ABOVE,
                  .unit = "nm", .preset = "1 nm", .summary = "mask grid"),
    OPC_PARAMETER(transistors, overhang, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST, .unit = "nm", .preset = "84 nm",
                  .summary = "how far past the active a transistor owns the "
                             "edges of a poly that goes on"),
    OPC_PARAMETER(transistors, line_end, .type = OPC_REAL,
                  .flags = OPC_AT_LEAST, .unit = "nm", .preset = "200 nm",
                  .summary = "poly that ends within this distance of the "
                             "active is the transistor's own line end"),
};

static const opc_metric metrics[] = {
    {"transistors", NULL, OPC_NEUTRAL, 0, "transistors found"},
    {"nmos", NULL, OPC_NEUTRAL, 0, "n-channel transistors"},
    {"pmos", NULL, OPC_NEUTRAL, 0, "p-channel transistors"},
    {"snapped", NULL, OPC_LOWER, 0,
     "vertices of poly, active, contact and further layers that the grid "
     "moved"},
    {"snapped_worst", "nm", OPC_LOWER, 0, "how far it moved one at most"},
};

/* Whether files can carry the name of a further layer: one word. NAME_drawn is
   what writers call the drawn shapes of NAME. */
static int is_layer_name(const char *name) {
  size_t n = strlen(name);
  static const char drawn[] = "_drawn";
  size_t end = sizeof drawn - 1;
  return n &&
         strspn(name,
                "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                "0123456789_") == n &&
         (n < end || strcmp(name + n - end, drawn) != 0);
}

/* Names are told apart, and so are the layers that they stand for. */
static int check(void *self, opc_error *error) {
  transistors *t = self;
  segment s = {0};
  get_sources(t, &s);
  int code = OPC_OK;
  for (size_t i = KNOWN; !code && i < s.sources; i++) {
    if (!is_layer_name(s.source[i].name))
      code = opc_fail(error, OPC_INVALID, NULL,
                      "'%.200s' is no name of a layer: letters, digits and "
                      "'_', not ending in '_drawn'",
                      s.source[i].name);
    for (size_t j = 0; !code && j < i; j++) {
      const source *a = &s.source[i], *b = &s.source[j];
      if (!strcmp(a->name, b->name))
        code = opc_fail(error, OPC_INVALID, NULL,
                        "'%.200s': there is a layer of that name already",
                        a->name);
      else if (!strcmp(a->from, b->from))
        code = opc_fail(error, OPC_INVALID, NULL,
                        "'%.200s': layer %.200s is '%.200s' already", a->name,
                        a->from, b->name);
    }
    if (code) blame(error, s.source[i].name);
  }
  free(s.source);
  return code;
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_GATES("gates")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = run,
                                   .forecast = forecast,
                                   .flags = OPC_STEP_LIGHT};

OPC_PLUGIN(transistors, .id = "segment.transistors", .kind = "step",
           .version = "0.2.0", .licence = "BSD-3-Clause",
           .summary =
               "find the transistors of a layout and the mask edges "
               "that move them",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), OPC_METRICS(metrics), .check = check,
           OPC_FUNCTIONS(functions));
