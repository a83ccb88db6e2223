/* SPDX-License-Identifier: BSD-3-Clause */
/* compat.draw: a step that draws a layout, two transistors side by side, and
   reads it back, through the layout service. */
#include "compat.h"

enum { LENGTH, PITCH, PARAMETERS };

/* One transistor, W 400 nm: poly, active and the well it lies in. */
static int draw_cell(const opc_layout_service *s, opc_layout *layout,
                     int32_t cell, int32_t length, opc_error *error) {
  int32_t poly = s->layer(layout, "poly", error);
  int32_t active = s->layer(layout, "active", error);
  int32_t well = s->layer(layout, "pwell", error);
  opc_point line[4] = {{200, 0}, {0, 0}, {0, 800}, {200, 800}};
  line[1].x = line[2].x = 200 + length;
  if (poly < 0 || active < 0 || well < 0) return error->code;
  int code = s->add_polygon(layout, cell, poly, line, 4, error);
  opc_box box = {0, 200, 400 + length, 600};
  if (!code) code = s->add_box(layout, cell, active, box, error);
  const opc_point path[2] = {{-100, 400}, {600, 400}};
  if (!code)
    code = s->add_path(layout, cell, well, path, 2, 900, 0, 0, 0, error);
  return code ? code
              : s->add_text(layout, cell, poly, line[0], "gate", error);
}

static int draw(const compat *c, opc_layout *layout, opc_error *error) {
  const opc_layout_service *s = c->host->layout;
  int32_t top = s->cell(layout, "pair", error);
  int32_t cell = s->cell(layout, "one", error);
  if (top < 0 || cell < 0) return error->code;
  int code = draw_cell(s, layout, cell,
                       (int32_t)(c->values[LENGTH].real + 0.5), error);
  int32_t pitch = (int32_t)(c->values[PITCH].real + 0.5);
  const opc_placement place = {{0, 0}, 1, 0, 0, 2, 1, {pitch, 0}, {0, 0}};
  return code ? code : s->add_instance(layout, top, cell, &place, "X", error);
}

/* What was drawn is there. */
static int read_back(const compat *c, const opc_layout *layout,
                     opc_error *error) {
  const opc_host *host = c->host;
  const opc_layout_service *s = host->layout;
  int32_t cell = s->find_cell(layout, "one"), layer, child;
  size_t points;
  opc_point at;
  opc_placement place;
  char path[32];
  opc_flat flat;
  int32_t top = s->top(layout, error);
  if (top < 0) return error->code;
  int good = s->cells(layout) == 2 && s->layers(layout) == 3 &&
             s->unit(layout) == 1 && s->polygons(layout, cell) == 3 &&
             s->polygon(layout, cell, 0, &points, &layer) && points == 4 &&
             s->layer_name(layout, layer)[0] == 'p' &&
             s->cell_name(layout, top)[0] == 'p' &&
             s->texts(layout, cell) == 1 &&
             s->text(layout, cell, 0, &at, &layer)[0] == 'g' &&
             s->instances(layout, top) == 1 &&
             s->instance(layout, top, 0, &child, &place)[0] == 'X' &&
             child == cell && place.columns == 2;
  int code = s->flatten(host, layout, top, s->find_layer(layout, "poly"), 1,
                        &flat, error);
  if (code) return code;
  good = good && flat.shapes.count == 2 && flat.vertices == 8 &&
         s->path(layout, top, flat.placement[1], path, sizeof path) == cell &&
         path[0] == 'X';
  s->release(&flat);
  if (good) return OPC_OK;
  return host->fail(host, error, OPC_FAILED, NULL, "the layout has changed");
}

static const opc_layout_service *service;

static void release(void *object) { service->destroy(object); }

static int run(void *self, void **outputs, opc_error *error) {
  const compat *c = self;
  service = c->host->layout;
  opc_layout *layout = service->create(c->host, 1, error);
  if (!layout) return error->code;
  outputs[0] = layout;
  int code = draw(c, layout, error);
  return code ? code : read_back(c, layout, error);
}

static const opc_parameter parameters[PARAMETERS] = {
    {"length", OPC_REAL, OPC_AT_LEAST | OPC_AT_MOST, "nm", "65 nm", 40, 200,
     NULL, "of the poly lines"},
    {"pitch", OPC_REAL, OPC_ABOVE, "nm", "1 um", 0, 0, NULL, "between them"},
};

static const opc_port ports[] = {{"layout", "layout", release}};
static const opc_step operations = {sizeof operations, 1, sizeof(opc_port),
                                    ports, run};

COMPAT_PLUGIN("compat.draw", OPC_KIND_STEP, OPC_PARAMETERS(parameters));
