/* SPDX-License-Identifier: BSD-3-Clause */
#include "writer.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "polygons.h"

static const char *const mask_layers[MASK_LAYERS] = {
    "poly", "active", "contact", "poly_drawn", "active_drawn"};

int writer_no_memory(const writer *w, opc_error *error) {
  return w->host->fail(w->host, error, OPC_FAILED, NULL, "out of memory");
}

double writer_decimal(double v) {
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g", v);
  return strtod(digits, NULL);
}

int writer_along(opc_point from, uint64_t n, opc_point step, opc_point *to) {
  int64_t x, y;
  int bad = n > UINT32_MAX;
  x = from.x + (int64_t)(uint32_t)n * step.x;
  y = from.y + (int64_t)(uint32_t)n * step.y;
  *to = (opc_point){(int32_t)x, (int32_t)y};
  return !bad && x == to->x && y == to->y;
}

/* ---- a layout ---- */

static int no_layer(const writer *w, const char *name, opc_error *error) {
  return w->host->fail(w->host, error, OPC_INVALID, "layers",
                       "'%s': the layer has no %s; say which, as in "
                       "{ %s: %s }",
                       name, strchr(w->format->layer, '/') ? "number" : "name",
                       name, w->format->layer);
}

/* What the file calls each layer: by the map, or as the layout does. */
static int name_layers(const writer *w, const opc_layout *layout,
                       const char **names, opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  const opc_value *map = &w->values[WRITE_LAYERS];
  for (size_t i = 0; i < l->layers(layout); i++)
    names[i] = l->layer_name(layout, (int32_t)i);
  for (size_t i = 0; i < map->count; i++) {
    int32_t layer = l->find_layer(layout, map->pairs[i].key);
    if (layer < 0)
      return w->host->fail(w->host, error, OPC_INVALID, "layers",
                           "'%s': the layout has no such layer",
                           map->pairs[i].key);
    names[layer] = map->pairs[i].value;
  }
  return OPC_OK;
}

static int take_polygon(void *data, const opc_point *points, size_t n,
                        opc_error *error) {
  writer *w = data;
  return w->format->polygon(w, points, n, error);
}

static int put_polygons(writer *w, const opc_layout *layout, int32_t cell,
                        const char *const *names, opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  polygon_taker take = {take_polygon, w, w->format->most_points};
  int32_t before = -1, layer;
  size_t n_polygons = l->polygons(layout, cell), n;
  for (size_t i = 0; i < n_polygons; i++) {
    const opc_point *points = l->polygon(layout, cell, i, &n, &layer);
    if (layer != before && !w->format->set_layer(w, names[layer]))
      return no_layer(w, l->layer_name(layout, layer), error);
    before = layer;
    if (polygon_cut(w->host, points, n, &take, error)) return error->code;
  }
  return OPC_OK;
}

static int put_texts(writer *w, const opc_layout *layout, int32_t cell,
                     const char *const *names, opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  for (size_t i = 0; i < l->texts(layout, cell); i++) {
    int32_t layer;
    opc_point at;
    const char *text = l->text(layout, cell, i, &at, &layer);
    if (!w->format->set_layer(w, names[layer]))
      return no_layer(w, l->layer_name(layout, layer), error);
    if (w->format->text(w, at, text, error)) return error->code;
  }
  return OPC_OK;
}

static int put_cell(writer *w, const opc_layout *layout, int32_t cell,
                    const char *const *names, opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  w->cell = l->cell_name(layout, cell);
  if (w->format->begin_cell(w, cell, w->cell, error) ||
      put_polygons(w, layout, cell, names, error) ||
      put_texts(w, layout, cell, names, error))
    return error->code;
  for (size_t i = 0; i < l->instances(layout, cell); i++) {
    int32_t child;
    opc_placement p;
    const char *name = l->instance(layout, cell, i, &child, &p);
    if (w->format->placement(w, child, l->cell_name(layout, child), &p, name,
                             error))
      return error->code;
  }
  return w->format->end_cell(w, error);
}

static int put_layout(writer *w, const opc_layout *layout, opc_error *error) {
  const opc_host *host = w->host;
  const opc_layout_service *l = host->layout;
  const char **names = host->alloc(host, l->layers(layout), sizeof *names);
  int code =
      names ? name_layers(w, layout, names, error) : writer_no_memory(w, error);
  if (!code) code = w->format->begin(w, layout, l->unit(layout), error);
  for (size_t i = 0; i < l->cells(layout) && !code; i++) {
    if (host->cancelled(host))
      code = host->fail(host, error, OPC_CANCELLED, NULL, "cancelled");
    else
      code = put_cell(w, layout, (int32_t)i, names, error);
  }
  host->free(host, names);
  return code;
}

/* ---- a mask ---- */

/* What the file calls the layers of the mask, in the order of mask_layers. */
static int name_mask(const writer *w, const char **names, opc_error *error) {
  const opc_value *map = &w->values[WRITE_LAYERS];
  memcpy(names, w->format->mask, sizeof w->format->mask);
  for (size_t k = 0; k < map->count; k++) {
    size_t i = 0;
    while (i < MASK_LAYERS && strcmp(mask_layers[i], map->pairs[k].key) != 0)
      i++;
    if (i == MASK_LAYERS)
      return w->host->fail(w->host, error, OPC_INVALID, "layers",
                           "'%s': a mask has the layers " MASK_LAYER_LIST,
                           map->pairs[k].key);
    names[i] = map->pairs[k].value;
  }
  return OPC_OK;
}

static int put_mask(writer *w, const opc_mask *mask, opc_error *error) {
  const opc_gates *gates = mask->gates;
  const opc_shapes *shapes[MASK_LAYERS] = {
      &mask->shapes[OPC_POLY], &mask->shapes[OPC_ACTIVE],
      &gates->drawn[OPC_CONTACT], &gates->drawn[OPC_POLY],
      &gates->drawn[OPC_ACTIVE]};
  const char *names[MASK_LAYERS];
  polygon_taker take = {take_polygon, w, w->format->most_points};
  w->cell = gates->name;
  if (name_mask(w, names, error) ||
      w->format->begin(w, NULL, gates->grid, error) ||
      w->format->begin_cell(w, 0, gates->name, error))
    return error->code;
  for (size_t i = 0; i < MASK_LAYERS; i++) {
    if (!w->format->set_layer(w, names[i]))
      return no_layer(w, mask_layers[i], error);
    if (polygons_without_holes(w->host, shapes[i], &take, error))
      return error->code;
  }
  return w->format->end_cell(w, error);
}

/* ---- the file ---- */

static int put_file(writer *w, opc_error *error) {
  w->file = fopen(w->path, "wb");
  if (!w->file)
    return w->host->fail(w->host, error, OPC_IO, NULL, "'%s': %s", w->path,
                         strerror(errno));
  setvbuf(w->file, NULL, _IOFBF, 1 << 20);
  int code = w->values[WRITE_MASK].object
                 ? put_mask(w, w->values[WRITE_MASK].object, error)
                 : put_layout(w, w->values[WRITE_LAYOUT].object, error);
  if (!code) code = w->format->end(w, error);
  if (w->format->clear) w->format->clear(w);
  errno = 0;
  int failed = ferror(w->file) | fclose(w->file);
  if (!code && failed)
    code = w->host->fail(w->host, error, OPC_IO, NULL, "'%s': %s", w->path,
                         errno ? strerror(errno) : "could not be written");
  if (code) remove(w->path);
  return code;
}

int writer_run(void *self, void **outputs, opc_error *error) {
  writer *w = self;
  (void)outputs;
  if (!w->values[WRITE_LAYOUT].object == !w->values[WRITE_MASK].object)
    return w->host->fail(w->host, error, OPC_INVALID, "layout",
                         "needs either a layout or a mask");
  const char *name = w->values[WRITE_FILE].text;
  w->path = w->host->output_path(w->host, name, error);
  return w->path ? put_file(w, error) : error->code;
}

/* ---- life ---- */

void writer_destroy(void *self) {
  writer *w = self;
  w->host->free(w->host, w);
}

void *writer_create(const opc_host *host, const opc_value *values,
                    const write_format *format, opc_error *error) {
  const opc_value *map = &values[WRITE_LAYERS];
  if (values[WRITE_LAYOUT].type != OPC_ABSENT &&
      values[WRITE_MASK].type != OPC_ABSENT) {
    host->fail(host, error, OPC_INVALID, "layout",
               "a layout and a mask cannot go into one file");
    return NULL;
  }
  writer *w = host->alloc(host, 1, format->size);
  if (!w) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  w->host = host;
  w->values = values;
  w->format = format;
  for (size_t i = 0; i < map->count; i++) {
    if (format->set_layer(w, map->pairs[i].value)) continue;
    host->fail(host, error, OPC_INVALID, "layers",
               "'%s': a layer is written %s", map->pairs[i].value,
               format->layer);
    writer_destroy(w);
    return NULL;
  }
  return w;
}
