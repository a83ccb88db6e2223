/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the common part of the layout writers; compiled into each. */
#include "writer.h"

#include <eda/memory.h>
#include <errno.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

double writer_decimal(double v) {
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g", v);
  return strtod(digits, NULL);
}

int writer_along(eda_point from, uint64_t n, eda_point step, eda_point *to) {
  int64_t x, y;
  int bad = n > UINT32_MAX;
  x = from.x + (int64_t)(uint32_t)n * step.x;
  y = from.y + (int64_t)(uint32_t)n * step.y;
  *to = (eda_point){(int32_t)x, (int32_t)y};
  return !bad && x == to->x && y == to->y;
}

void writer_fail(writer *w, const char *format, ...) {
  va_list arguments;
  if (w->failed) return;
  va_start(arguments, format);
  g_autofree char *what = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  w->failed = opc_fail(w->error, OPC_FAILED, NULL, "%s", what);
}

static int no_layer(const writer *w, const char *name, opc_error *error) {
  return opc_fail(error, OPC_INVALID, "layers",
                  "'%s': the layer has no %s; set a number, as in { %s: %s }",
                  name, strchr(w->format->layer, '/') ? "number" : "name", name,
                  w->format->layer);
}

static int take_polygon(void *data, const eda_point *points, size_t n,
                        opc_error *error) {
  writer *w = data;
  (void)error;
  w->format->polygon(w, points, n);
  return w->failed;
}

/* ---- a layout ---- */

/* Return 1 if two names are the same layer of the file. */
static int names_collide(const char *a, const char *b) {
  eda_layer_number x, y;
  if (!eda_layer_number_read(a, UINT32_MAX, &x, NULL) ||
      !eda_layer_number_read(b, UINT32_MAX, &y, NULL))
    return !strcmp(a, b);
  return x.layer == y.layer && x.datatype == y.datatype;
}

/* Fail if two layers would become one layer of the output file: a layer in the
   map, and a layer that keeps its name from the file of the layout. */
static int check_places(const writer *w, const eda_layout *layout,
                        const char *const *names, opc_error *error) {
  const opc_map *map = &w->layers;
  for (size_t i = 0; i < map->count; i++)
    for (size_t k = 0; k < eda_layout_layers(layout); k++)
      if (names[k] == eda_layout_file_layer(layout, (int32_t)k) &&
          names_collide(names[k], map->pairs[i].value))
        return opc_fail(
            error, OPC_INVALID, "layers",
            "'%.100s' and '%.100s' would both be layer %s; set another one, as "
            "in { %.100s: %s }",
            eda_layout_layer_name(layout, (int32_t)k), map->pairs[i].key,
            names[k], eda_layout_layer_name(layout, (int32_t)k),
            w->format->layer);
  return OPC_OK;
}

/* Set the name of each layer in the output file: from the map, the layout, or
   the file from which the layout was read, in this order of preference. */
static int name_layers(writer *w, const eda_layout *layout, const char **names,
                       opc_error *error) {
  const opc_map *map = &w->layers;
  for (size_t i = 0; i < eda_layout_layers(layout); i++) {
    names[i] = eda_layout_layer_name(layout, (int32_t)i);
    if (!w->format->set_layer(w, names[i]))
      names[i] = eda_layout_file_layer(layout, (int32_t)i);
  }
  for (size_t i = 0; i < map->count; i++) {
    int32_t layer = eda_layout_find_layer(layout, map->pairs[i].key);
    if (layer < 0)
      return opc_fail(error, OPC_INVALID, "layers",
                      "'%s': the layout has no such layer", map->pairs[i].key);
    names[layer] = map->pairs[i].value;
  }
  return check_places(w, layout, names, error);
}

/* Fail for a layer with shapes or texts that has no name in the file. */
static int check_names(writer *w, const eda_layout *layout,
                       const char *const *names, opc_error *error) {
  size_t n, layers = eda_layout_layers(layout);
  int32_t layer, bad = -1;
  eda_point at;
  uint8_t *refused = eda_alloc(layers, 1);
  int any = 0;
  for (size_t k = 0; k < layers; k++)
    any |= refused[k] = !w->format->set_layer(w, names[k]);
  for (int32_t c = 0; any && (size_t)c < eda_layout_cells(layout); c++) {
    for (size_t i = 0; i < eda_layout_polygons(layout, c) && bad < 0; i++)
      if (eda_layout_polygon(layout, c, i, &n, &layer) && refused[layer])
        bad = layer;
    for (size_t i = 0; i < eda_layout_texts(layout, c) && bad < 0; i++)
      if (eda_layout_text(layout, c, i, &at, &layer) && refused[layer])
        bad = layer;
  }
  free(refused);
  return bad < 0 ? OPC_OK
                 : no_layer(w, eda_layout_layer_name(layout, bad), error);
}

static int put_polygons(writer *w, const eda_layout *layout, int32_t cell,
                        const char *const *names, opc_error *error) {
  const eda_polygon_taker take = {take_polygon, w, w->format->most_points};
  int32_t before = -1, layer;
  size_t n_polygons = eda_layout_polygons(layout, cell), n;
  for (size_t i = 0; i < n_polygons; i++) {
    const eda_point *points = eda_layout_polygon(layout, cell, i, &n, &layer);
    if (layer != before && !w->format->set_layer(w, names[layer]))
      return no_layer(w, eda_layout_layer_name(layout, layer), error);
    before = layer;
    if (eda_polygon_cut(points, n, &take, error)) return error->code;
  }
  return OPC_OK;
}

static int put_texts(writer *w, const eda_layout *layout, int32_t cell,
                     const char *const *names, opc_error *error) {
  for (size_t i = 0; i < eda_layout_texts(layout, cell); i++) {
    int32_t layer;
    eda_point at;
    const char *text = eda_layout_text(layout, cell, i, &at, &layer);
    if (!w->format->set_layer(w, names[layer]))
      return no_layer(w, eda_layout_layer_name(layout, layer), error);
    w->format->text(w, at, text);
  }
  return w->failed;
}

static int put_cell(writer *w, const eda_layout *layout, int32_t cell,
                    const char *const *names, opc_error *error) {
  w->cell = eda_layout_cell_name(layout, cell);
  w->format->begin_cell(w, cell, w->cell);
  if (w->failed || put_polygons(w, layout, cell, names, error) ||
      put_texts(w, layout, cell, names, error))
    return error->code;
  for (size_t i = 0; i < eda_layout_instances(layout, cell) && !w->failed;
       i++) {
    int32_t child;
    eda_placement p;
    const char *name = eda_layout_instance(layout, cell, i, &child, &p);
    w->format->placement(w, child, eda_layout_cell_name(layout, child), &p,
                         name);
  }
  w->format->end_cell(w);
  return w->failed;
}

/* Write all cells. `names` has the name of each layer in the output file. */
static int put_cells(writer *w, const eda_layout *layout,
                     const char *const *names, opc_error *error) {
  w->format->begin(w, layout, eda_layout_unit(layout));
  int code = w->failed;
  for (size_t i = 0; i < eda_layout_cells(layout) && !code; i++) {
    if (opc_cancelled(w->host->context))
      code = opc_fail(error, OPC_CANCELLED, NULL, "cancelled");
    else
      code = put_cell(w, layout, (int32_t)i, names, error);
  }
  return code;
}

static int put_layout(writer *w, const eda_layout *layout, opc_error *error) {
  const char **names = eda_alloc(eda_layout_layers(layout), sizeof *names);
  int code = name_layers(w, layout, names, error);
  if (!code) code = put_cells(w, layout, names, error);
  free(names);
  return code;
}

/* ---- a mask ---- */

/* A layer of the mask, or the drawn shapes of a layer. */
typedef struct mask_layer {
  const eda_shapes *shapes;
  char name[256]; /* name in the flow */
  const char *file_name;
  char preset[64]; /* default of `file_name` */
} mask_layer;

void writer_number_layer(const eda_gates *gates, size_t k, int drawn,
                         char *name) {
  uint32_t number = eda_gates_number(gates, k);
  snprintf(name, 64, "%u/0",
           (unsigned)(number + (drawn ? EDA_DRAWN_NUMBER : 0)));
}

/* List all layers of the mask, then the drawn shapes of the corrected layers as
   separate layers. Return the number of elements of the list. */
static size_t list_mask(const writer *w, mask_layer *layers) {
  const eda_gates *g = w->mask->gates;
  size_t n = 0;
  for (int drawn = 0; drawn < 2; drawn++)
    for (size_t k = 0; k < g->layers; k++) {
      if (drawn && !g->corrected[k]) continue;
      mask_layer *l = &layers[n++];
      int corrected = g->corrected[k] && !drawn;
      l->shapes = corrected ? &w->mask->shapes[k] : &g->drawn[k];
      snprintf(l->name, sizeof l->name, "%.240s%s", g->layer[k],
               drawn ? "_drawn" : "");
      w->format->name_layer(g, k, drawn, l->preset);
      l->file_name = l->preset;
    }
  return n;
}

static int refuse_name(const char *name, const mask_layer *layers, size_t n,
                       opc_error *error) {
  g_autoptr(GString) all = g_string_new(layers[0].name);
  for (size_t i = 1; i < n; i++)
    g_string_append_printf(all, "%s%s", i + 1 == n ? " and " : ", ",
                           layers[i].name);
  return opc_fail(error, OPC_INVALID, "layers",
                  "'%s': a mask has the layers %s", name, all->str);
}

/* Set the file names of the mask layers according to the map. */
static int name_mask(const writer *w, mask_layer *layers, size_t n,
                     opc_error *error) {
  const opc_map *map = &w->layers;
  for (size_t k = 0; k < map->count; k++) {
    const char *name = map->pairs[k].key;
    size_t i = 0;
    while (i < n && strcmp(layers[i].name, name) != 0) i++;
    if (i < n)
      layers[i].file_name = map->pairs[k].value;
    else if (strcmp(name, "contact") != 0) /* may be absent */
      return refuse_name(name, layers, n, error);
  }
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < i; j++)
      if (names_collide(layers[i].file_name, layers[j].file_name))
        return opc_fail(error, OPC_INVALID, "layers",
                        "'%.100s' and '%.100s' would both be layer %s; set "
                        "different ones, as in { %.100s: %s }",
                        layers[j].name, layers[i].name, layers[i].file_name,
                        layers[i].name, w->format->layer);
  return OPC_OK;
}

static int put_mask_layers(writer *w, mask_layer *layers, opc_error *error) {
  const eda_gates *gates = w->mask->gates;
  const eda_polygon_taker take = {take_polygon, w, w->format->most_points};
  size_t n = list_mask(w, layers);
  w->cell = gates->name;
  if (name_mask(w, layers, n, error)) return error->code;
  w->format->begin(w, NULL, gates->grid);
  if (!w->failed) w->format->begin_cell(w, 0, gates->name);
  for (size_t i = 0; i < n && !w->failed; i++) {
    if (!w->format->set_layer(w, layers[i].file_name))
      return no_layer(w, layers[i].name, error);
    if (eda_polygons_without_holes(layers[i].shapes, &take, error))
      return error->code;
  }
  w->format->end_cell(w);
  return w->failed;
}

/* Write a mask by classes as cells and arrays, without the drawn shapes. */
static int put_classes(writer *w, mask_layer *layers, opc_error *error) {
  const eda_mask *m = w->mask;
  const eda_layout *layout = NULL;
  if (name_mask(w, layers, list_mask(w, layers), error)) return error->code;
  int code = m->access->layout(m, 0, &layout, error);
  if (code) return code;
  const char **names = eda_alloc(m->layers, sizeof *names);
  for (size_t k = 0; k < m->layers; k++) {
    int32_t at = eda_layout_find_layer(layout, m->gates->layer[k]);
    if (at >= 0) names[at] = layers[k].file_name;
  }
  code = put_cells(w, layout, names, error);
  if (!code)
    w->host->log(w->host, OPC_LOG_INFO,
                 "%s: the mask in %zu cells; the drawn shapes are in the file "
                 "of the layout",
                 w->name, eda_layout_cells(layout));
  free(names);
  return code;
}

static int put_mask(writer *w, opc_error *error) {
  mask_layer *layers = eda_alloc(2 * w->mask->gates->layers, sizeof *layers);
  int code = w->mask->chip ? put_classes(w, layers, error)
                           : put_mask_layers(w, layers, error);
  free(layers);
  return code;
}

/* ---- the file ---- */

static int put_file(writer *w, opc_error *error) {
  w->file = fopen(w->path, "wb");
  if (!w->file)
    return opc_fail(error, OPC_IO, NULL, "'%s': %s", w->path, strerror(errno));
  setvbuf(w->file, NULL, _IOFBF, 1 << 20);
  w->error = error;
  w->failed = OPC_OK;
  int code = w->mask ? put_mask(w, error) : put_layout(w, w->layout, error);
  if (!code) w->format->end(w);
  if (w->format->clear) w->format->clear(w);
  errno = 0;
  int failed = ferror(w->file) | fclose(w->file);
  if (!code && failed)
    code = opc_fail(error, OPC_IO, NULL, "'%s': %s", w->path,
                    errno ? strerror(errno) : "could not be written");
  if (code) remove(w->path);
  return code;
}

int writer_run(void *self, void **outputs, opc_error *error) {
  writer *w = self;
  (void)outputs;
  if (!w->layout == !w->mask)
    return opc_fail(error, OPC_INVALID, "layout",
                    "set either 'layout' or 'mask'");
  w->path = w->host->output_path(w->host, w->name, error);
  return w->path ? put_file(w, error) : error->code;
}

int writer_forecast(void *self, opc_forecast *out, opc_error *error) {
  writer *w = self;
  int code = OPC_OK;
  (void)out;
  if (w->layout) {
    const char **names = eda_alloc(eda_layout_layers(w->layout), sizeof *names);
    code = name_layers(w, w->layout, names, error);
    if (!code) code = check_names(w, w->layout, names, error);
    free(names);
  } else if (w->mask) {
    mask_layer *layers = eda_alloc(2 * w->mask->gates->layers, sizeof *layers);
    code = name_mask(w, layers, list_mask(w, layers), error);
    free(layers);
  }
  return code;
}

int writer_check(writer *w, const write_format *format, opc_error *error) {
  w->format = format;
  if (w->layout_given && w->mask_given)
    return opc_fail(error, OPC_INVALID, "layout",
                    "'layout' and 'mask' exclude each other");
  for (size_t i = 0; i < w->layers.count; i++)
    if (!format->set_layer(w, w->layers.pairs[i].value))
      return opc_fail(error, OPC_INVALID, "layers",
                      "'%s': invalid layer (example: %s)",
                      w->layers.pairs[i].value, format->layer);
  return OPC_OK;
}
