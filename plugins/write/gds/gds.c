/* SPDX-License-Identifier: BSD-3-Clause */
/* write.gds: a layout or a corrected mask as a GDSII stream file. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "../../read/gds/records.h"
#include "polygons.h"

/* ---- state ---- */

typedef struct number {
  uint32_t layer, datatype;
} number;

typedef struct writer {
  const opc_host *host;
  const opc_value *values;
  const char *path;
  FILE *file;
  number to; /* of the polygons that are being written */
  uint8_t record[65536];
} writer;

enum { LAYOUT, MASK, FILE_NAME, LAYERS };

enum { MAX_STRING = 65530, MAX_ARRAY = 32767 };

/* Every file has the same date, so that equal layouts are equal files. */
static const uint16_t date[12] = {1970, 1, 1, 0, 0, 0, 1970, 1, 1, 0, 0, 0};

/* What a mask's layers are where the flow does not say. */
static const struct {
  const char *name;
  number preset;
} mask_layers[] = {
    {"poly", {9, 0}},         {"active", {1, 0}},         {"contact", {10, 0}},
    {"poly_drawn", {109, 0}}, {"active_drawn", {101, 0}},
};

enum { N_MASK_LAYERS = sizeof mask_layers / sizeof mask_layers[0] };

/* ---- work: records ---- */

/* n bytes of data stand in w->record from byte 4 on. What fails is seen when
   the file is closed. */
static void put_record(writer *w, uint32_t type, uint32_t kind, size_t n) {
  gds_put_u16(w->record, (uint32_t)n + 4);
  w->record[2] = (uint8_t)type;
  w->record[3] = (uint8_t)kind;
  fwrite(w->record, 1, n + 4, w->file);
}

static void put_empty(writer *w, uint32_t type) {
  put_record(w, type, GDS_NOTHING, 0);
}

static void put_u16(writer *w, uint32_t type, uint32_t kind, uint32_t v) {
  gds_put_u16(w->record + 4, v);
  put_record(w, type, kind, 2);
}

static void put_real(writer *w, uint32_t type, double v) {
  gds_put_real(w->record + 4, v);
  put_record(w, type, GDS_REAL8, 8);
}

static int put_string(writer *w, uint32_t type, const char *text,
                      opc_error *error) {
  size_t n = strlen(text);
  if (n > MAX_STRING)
    return w->host->fail(w->host, error, OPC_FAILED, NULL,
                         "a name or text of %zu characters is too long for "
                         "GDSII: '%.60s...'",
                         n, text);
  memcpy(w->record + 4, text, n);
  w->record[4 + n] = 0;
  put_record(w, type, GDS_ASCII, n + n % 2);
  return OPC_OK;
}

static void put_date(writer *w, uint32_t type) {
  for (size_t i = 0; i < 12; i++) gds_put_u16(w->record + 4 + 2 * i, date[i]);
  put_record(w, type, GDS_INT2, 24);
}

static void put_point(writer *w, size_t i, opc_point p) {
  gds_put_i32(w->record + 4 + 8 * i, p.x);
  gds_put_i32(w->record + 8 + 8 * i, p.y);
}

/* A polygon of few points, to w->to. */
static int put_polygon(void *data, const opc_point *points, size_t n,
                       opc_error *error) {
  writer *w = data;
  (void)error;
  put_empty(w, GDS_BOUNDARY);
  put_u16(w, GDS_LAYER, GDS_INT2, w->to.layer);
  put_u16(w, GDS_DATATYPE, GDS_INT2, w->to.datatype);
  for (size_t i = 0; i < n; i++) put_point(w, i, points[i]);
  put_point(w, n, points[0]);
  put_record(w, GDS_XY, GDS_INT4, 8 * (n + 1));
  put_empty(w, GDS_ENDEL);
  return OPC_OK;
}

/* The decimal number of 14 digits that a product of two such is near to. */
static double decimal(double v) {
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g", v);
  return strtod(digits, NULL);
}

static void begin_library(writer *w, double unit) {
  put_u16(w, GDS_HEADER, GDS_INT2, 600);
  put_date(w, GDS_BGNLIB);
  memcpy(w->record + 4, "OPCFLOW", 8);
  put_record(w, GDS_LIBNAME, GDS_ASCII, 8);
  gds_put_real(w->record + 4, decimal(unit * 1e-3));  /* um, the user's unit */
  gds_put_real(w->record + 12, decimal(unit * 1e-9)); /* m */
  put_record(w, GDS_UNITS, GDS_REAL8, 16);
}

static int begin_cell(writer *w, const char *name, opc_error *error) {
  put_date(w, GDS_BGNSTR);
  return put_string(w, GDS_STRNAME, name, error);
}

/* ---- work: a layout ---- */

/* The numbers of all layers that hold something: from the map, or the name. */
static int number_layers(writer *w, const opc_layout *layout, number *numbers,
                         uint8_t *known, opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  const opc_value *map = &w->values[LAYERS];
  for (size_t i = 0; i < l->layers(layout); i++) {
    number *to = &numbers[i];
    const char *name = l->layer_name(layout, (int32_t)i);
    known[i] = gds_parse_layer(name, &to->layer, &to->datatype, NULL) != 0;
  }
  for (size_t i = 0; i < map->count; i++) {
    int32_t layer = l->find_layer(layout, map->pairs[i].key);
    if (layer < 0)
      return w->host->fail(w->host, error, OPC_INVALID, "layers",
                           "'%s': the layout has no such layer",
                           map->pairs[i].key);
    number *to = &numbers[layer];
    gds_parse_layer(map->pairs[i].value, &to->layer, &to->datatype, NULL);
    known[layer] = 1;
  }
  return OPC_OK;
}

static int no_number(writer *w, const char *name, opc_error *error) {
  return w->host->fail(w->host, error, OPC_INVALID, "layers",
                       "'%s': the layer has no number; say which, as in "
                       "{ %s: 9/0 }",
                       name, name);
}

static int put_polygons(writer *w, const opc_layout *layout, int32_t cell,
                        const number *numbers, const uint8_t *known,
                        opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  gds_taker take = {put_polygon, w};
  for (size_t i = 0; i < l->polygons(layout, cell); i++) {
    size_t n;
    int32_t layer;
    const opc_point *points = l->polygon(layout, cell, i, &n, &layer);
    if (!known[layer]) return no_number(w, l->layer_name(layout, layer), error);
    w->to = numbers[layer];
    if (gds_cut(w->host, points, n, &take, error)) return error->code;
  }
  return OPC_OK;
}

static int put_texts(writer *w, const opc_layout *layout, int32_t cell,
                     const number *numbers, const uint8_t *known,
                     opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  for (size_t i = 0; i < l->texts(layout, cell); i++) {
    int32_t layer;
    opc_point at;
    const char *text = l->text(layout, cell, i, &at, &layer);
    if (!known[layer]) return no_number(w, l->layer_name(layout, layer), error);
    put_empty(w, GDS_TEXT);
    put_u16(w, GDS_LAYER, GDS_INT2, numbers[layer].layer);
    put_u16(w, GDS_TEXTTYPE, GDS_INT2, numbers[layer].datatype);
    put_point(w, 0, at);
    put_record(w, GDS_XY, GDS_INT4, 8);
    if (put_string(w, GDS_STRING, text, error)) return error->code;
    put_empty(w, GDS_ENDEL);
  }
  return OPC_OK;
}

/* from + n * step; 0 if it leaves the range of coordinates. */
static int along(opc_point from, uint32_t n, opc_point step, opc_point *to) {
  int64_t x = from.x + (int64_t)n * step.x, y = from.y + (int64_t)n * step.y;
  *to = (opc_point){(int32_t)x, (int32_t)y};
  return x == to->x && y == to->y;
}

static int put_placement(writer *w, const char *child, const opc_placement *p,
                         const char *name, opc_error *error) {
  int array = p->columns > 1 || p->rows > 1;
  opc_point corner[3] = {p->origin};
  if (array && (!along(p->origin, p->columns, p->column_step, &corner[1]) ||
                !along(p->origin, p->rows, p->row_step, &corner[2])))
    return w->host->fail(w->host, error, OPC_FAILED, NULL,
                         "an array of '%s' leaves the range of coordinates",
                         child);
  put_empty(w, array ? GDS_AREF : GDS_SREF);
  if (put_string(w, GDS_SNAME, child, error)) return error->code;
  if (p->mirror || p->magnification != 1 || p->angle != 0)
    put_u16(w, GDS_STRANS, GDS_BITS, p->mirror ? 0x8000 : 0);
  if (p->magnification != 1) put_real(w, GDS_MAG, p->magnification);
  if (p->angle != 0) put_real(w, GDS_ANGLE, p->angle);
  if (array) {
    gds_put_u16(w->record + 4, p->columns);
    gds_put_u16(w->record + 6, p->rows);
    put_record(w, GDS_COLROW, GDS_INT2, 4);
  }
  size_t n = array ? 3 : 1;
  for (size_t i = 0; i < n; i++) put_point(w, i, corner[i]);
  put_record(w, GDS_XY, GDS_INT4, 8 * n);
  if (name) {
    put_u16(w, GDS_PROPATTR, GDS_INT2, GDS_INSTANCE_NAME);
    if (put_string(w, GDS_PROPVALUE, name, error)) return error->code;
  }
  put_empty(w, GDS_ENDEL);
  return OPC_OK;
}

/* An array larger than its record can say is written in parts. */
static int put_parts(writer *w, const char *child, const opc_placement *whole,
                     const char *name, opc_error *error) {
  for (uint64_t r = 0; r < whole->rows; r += MAX_ARRAY)
    for (uint64_t c = 0; c < whole->columns; c += MAX_ARRAY) {
      opc_placement p = *whole;
      opc_point row;
      if (!along(whole->origin, (uint32_t)r, whole->row_step, &row) ||
          !along(row, (uint32_t)c, whole->column_step, &p.origin))
        return w->host->fail(w->host, error, OPC_FAILED, NULL,
                             "an array of '%s' leaves the range of coordinates",
                             child);
      if (p.columns - c > MAX_ARRAY)
        p.columns = MAX_ARRAY;
      else
        p.columns -= (uint32_t)c;
      if (p.rows - r > MAX_ARRAY)
        p.rows = MAX_ARRAY;
      else
        p.rows -= (uint32_t)r;
      if (put_placement(w, child, &p, name, error)) return error->code;
    }
  return OPC_OK;
}

static int put_cell(writer *w, const opc_layout *layout, int32_t cell,
                    const number *numbers, const uint8_t *known,
                    opc_error *error) {
  const opc_layout_service *l = w->host->layout;
  if (begin_cell(w, l->cell_name(layout, cell), error) ||
      put_polygons(w, layout, cell, numbers, known, error) ||
      put_texts(w, layout, cell, numbers, known, error))
    return error->code;
  for (size_t i = 0; i < l->instances(layout, cell); i++) {
    int32_t child;
    opc_placement p;
    const char *name = l->instance(layout, cell, i, &child, &p);
    if (put_parts(w, l->cell_name(layout, child), &p, name, error))
      return error->code;
  }
  put_empty(w, GDS_ENDSTR);
  return OPC_OK;
}

static int put_layout(writer *w, const opc_layout *layout, opc_error *error) {
  const opc_host *host = w->host;
  const opc_layout_service *l = host->layout;
  number *numbers = host->alloc(host, l->layers(layout), sizeof *numbers);
  uint8_t *known = host->alloc(host, l->layers(layout), 1);
  int code = numbers && known
                 ? number_layers(w, layout, numbers, known, error)
                 : host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  if (!code) begin_library(w, l->unit(layout));
  for (size_t i = 0; i < l->cells(layout) && !code; i++)
    code = put_cell(w, layout, (int32_t)i, numbers, known, error);
  host->free(host, numbers);
  host->free(host, known);
  return code;
}

/* ---- work: a mask ---- */

/* The numbers of the mask's layers, in the order of mask_layers. */
static int number_mask(const writer *w, number *numbers, opc_error *error) {
  const opc_value *map = &w->values[LAYERS];
  for (size_t i = 0; i < N_MASK_LAYERS; i++) numbers[i] = mask_layers[i].preset;
  for (size_t k = 0; k < map->count; k++) {
    size_t i = 0;
    while (i < N_MASK_LAYERS &&
           strcmp(mask_layers[i].name, map->pairs[k].key) != 0)
      i++;
    if (i == N_MASK_LAYERS)
      return w->host->fail(w->host, error, OPC_INVALID, "layers",
                           "'%s': a mask has the layers poly, active, contact, "
                           "poly_drawn and active_drawn",
                           map->pairs[k].key);
    gds_parse_layer(map->pairs[k].value, &numbers[i].layer,
                    &numbers[i].datatype, NULL);
  }
  return OPC_OK;
}

static int put_mask(writer *w, const opc_mask *mask, opc_error *error) {
  const opc_gates *gates = mask->gates;
  const opc_shapes *shapes[N_MASK_LAYERS] = {
      &mask->shapes[OPC_POLY], &mask->shapes[OPC_ACTIVE],
      &gates->drawn[OPC_CONTACT], &gates->drawn[OPC_POLY],
      &gates->drawn[OPC_ACTIVE]};
  number numbers[N_MASK_LAYERS];
  if (number_mask(w, numbers, error)) return error->code;
  begin_library(w, gates->grid);
  if (begin_cell(w, gates->name, error)) return error->code;
  gds_taker take = {put_polygon, w};
  for (size_t i = 0; i < N_MASK_LAYERS; i++) {
    w->to = numbers[i];
    if (gds_without_holes(w->host, shapes[i], &take, error)) return error->code;
  }
  put_empty(w, GDS_ENDSTR);
  return OPC_OK;
}

/* ---- work: the file ---- */

static int put_file(writer *w, opc_error *error) {
  w->file = fopen(w->path, "wb");
  if (!w->file)
    return w->host->fail(w->host, error, OPC_IO, NULL, "'%s': %s", w->path,
                         strerror(errno));
  setvbuf(w->file, NULL, _IOFBF, 1 << 20);
  int code = w->values[MASK].object
                 ? put_mask(w, w->values[MASK].object, error)
                 : put_layout(w, w->values[LAYOUT].object, error);
  if (!code) put_empty(w, GDS_ENDLIB);
  errno = 0;
  int failed = ferror(w->file) | fclose(w->file);
  if (!code && failed)
    code = w->host->fail(w->host, error, OPC_IO, NULL, "'%s': %s", w->path,
                         errno ? strerror(errno) : "could not be written");
  if (code) remove(w->path);
  return code;
}

static int run(void *self, void **outputs, opc_error *error) {
  writer *w = self;
  (void)outputs;
  if (!w->values[LAYOUT].object == !w->values[MASK].object)
    return w->host->fail(w->host, error, OPC_INVALID, "layout",
                         "needs either a layout or a mask");
  w->path = w->host->output_path(w->host, w->values[FILE_NAME].text, error);
  return w->path ? put_file(w, error) : error->code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    [LAYOUT] = {.name = "layout",
                .type = OPC_INPUT,
                .choices = "layout",
                .summary = "The layout to write"},
    [MASK] = {.name = "mask",
              .type = OPC_INPUT,
              .choices = "mask",
              .summary = "The mask to write, in place of a layout"},
    [FILE_NAME] = {.name = "file",
                   .type = OPC_OUTPUT,
                   .preset = "mask.gds",
                   .summary = "The file"},
    [LAYERS] = {.name = "layers",
                .type = OPC_MAP,
                .summary = "Numbers for layers: { poly: 9/0 }"},
};

/* ---- entry ---- */

static void destroy(void *self) {
  writer *w = self;
  w->host->free(w->host, w);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  const opc_value *map = &values[LAYERS];
  for (size_t i = 0; i < map->count; i++) {
    uint32_t layer, datatype;
    if (gds_parse_layer(map->pairs[i].value, &layer, &datatype, NULL)) continue;
    host->fail(host, error, OPC_INVALID, "layers",
               "'%s': a layer is written 9/0", map->pairs[i].value);
    return NULL;
  }
  if (values[LAYOUT].type != OPC_ABSENT && values[MASK].type != OPC_ABSENT) {
    host->fail(host, error, OPC_INVALID, "layout",
               "a layout and a mask cannot go into one file");
    return NULL;
  }
  writer *w = host->alloc(host, 1, sizeof *w);
  if (!w) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  w->host = host;
  w->values = values;
  return w;
}

static const opc_step step = {.size = sizeof step, .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "write.gds",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Write a layout or a mask as a GDSII file",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
