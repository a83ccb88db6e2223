/* SPDX-License-Identifier: BSD-3-Clause */
/* write.oasis: a layout or a corrected mask as an OASIS file (SEMI P39), in
   strict mode: names stand in tables at the end, cells and texts refer to them
   by number. */
#include <stdlib.h>
#include <string.h>

#include "../../read/oasis/records.h"
#include "../writer.h"
#include "groups.h"
#include "strings.h"

/* ---- state ---- */

typedef struct oasis {
  writer w;
  layer_number layer;
  pack out;
  groups shapes; /* of `layer` */
  layer_number shapes_layer;
  strings texts, names; /* of instances */
  const opc_layout *layout;
  uint64_t *places; /* of the cells in the file */
  size_t n_places;
} oasis;

/* Standard properties that the file uses, in their table's order. */
enum { CELL_OFFSET = 0, GDS_PROPERTY = 1 };

/* Points of a polygon: larger ones are cut, for the readers' sake. */
enum { MAX_POINTS = 1 << 20 };

/* ---- work: records ---- */

static int set_layer(writer *base, const char *layer) {
  oasis *w = (oasis *)base;
  return layer_number_parse(layer, UINT32_MAX, &w->layer, NULL);
}

static int check(const oasis *w, opc_error *error) {
  return w->out.failed ? writer_no_memory(&w->w, error) : OPC_OK;
}

static int begin(writer *base, const opc_layout *layout, double unit,
                 opc_error *error) {
  oasis *w = (oasis *)base;
  const opc_host *host = w->w.host;
  w->layout = layout;
  w->n_places = layout ? host->layout->cells(layout) : 1;
  w->places = calloc(w->n_places + 1, sizeof *w->places);
  if (!pack_begin(&w->out, host, w->w.file) || !w->places)
    return writer_no_memory(&w->w, error);
  for (const char *c = OASIS_MAGIC; *c; c++) pack_byte(&w->out, (uint8_t)*c);
  pack_uint(&w->out, OASIS_START);
  pack_string(&w->out, "1.0");
  pack_real(&w->out, writer_decimal(1000 / unit)); /* steps in a micrometre */
  pack_uint(&w->out, 1); /* the tables' places are told at the end */
  pack_plain(&w->out);
  return check(w, error);
}

static int begin_cell(writer *base, int32_t cell, const char *name,
                      opc_error *error) {
  oasis *w = (oasis *)base;
  if (!name[0])
    return w->w.host->fail(w->w.host, error, OPC_FAILED, NULL,
                           "OASIS has no cells without a name");
  w->places[cell] = w->out.place;
  pack_uint(&w->out, OASIS_CELL_NUMBER);
  pack_uint(&w->out, (uint64_t)cell);
  pack_plain(&w->out);
  return check(w, error);
}

static void put_shapes(oasis *w) {
  if (w->shapes.n) groups_put(&w->shapes, &w->out, w->shapes_layer);
}

static int put_polygon(writer *base, const opc_point *points, size_t n,
                       opc_error *error) {
  oasis *w = (oasis *)base;
  if (w->layer.layer != w->shapes_layer.layer ||
      w->layer.datatype != w->shapes_layer.datatype || groups_full(&w->shapes))
    put_shapes(w);
  w->shapes_layer = w->layer;
  if (!groups_add(&w->shapes, points, n)) return writer_no_memory(&w->w, error);
  return check(w, error);
}

static int put_text(writer *base, opc_point at, const char *text,
                    opc_error *error) {
  oasis *w = (oasis *)base;
  int64_t number = strings_number(&w->texts, text);
  if (number < 0) return writer_no_memory(&w->w, error);
  put_shapes(w);
  pack_uint(&w->out, OASIS_TEXT);
  pack_byte(&w->out, 0x7b);
  pack_uint(&w->out, (uint64_t)number);
  pack_uint(&w->out, w->layer.layer);
  pack_uint(&w->out, w->layer.datatype);
  pack_sint(&w->out, at.x);
  pack_sint(&w->out, at.y);
  pack_record(&w->out);
  return check(w, error);
}

/* ---- work: placements ---- */

/* The multiple of a right angle, 0 to 3, or -1. */
static int quarters(double angle) {
  for (int i = 0; i < 4; i++)
    if (angle == 90 * i) return i;
  return -1;
}

static void put_array(oasis *w, const opc_placement *p) {
  pack *out = &w->out;
  opc_point c = p->column_step, r = p->row_step;
  if (p->columns > 1 && p->rows > 1) {
    pack_uint(out, 8);
    pack_uint(out, p->columns - 2);
    pack_uint(out, p->rows - 2);
    pack_delta(out, c.x, c.y);
    pack_delta(out, r.x, r.y);
  } else {
    opc_point step = p->columns > 1 ? c : r;
    pack_uint(out, 9);
    pack_uint(out, (p->columns > 1 ? p->columns : p->rows) - 2);
    pack_delta(out, step.x, step.y);
  }
}

static int put_name(oasis *w, const char *name, opc_error *error) {
  int64_t number = strings_number(&w->names, name);
  if (number < 0) return writer_no_memory(&w->w, error);
  pack_uint(&w->out, OASIS_PROPERTY);
  pack_byte(&w->out, 0x27); /* 2 values, a standard name by number */
  pack_uint(&w->out, GDS_PROPERTY);
  pack_uint(&w->out, 8);
  pack_uint(&w->out, OASIS_INSTANCE_NAME);
  pack_uint(&w->out, 14);
  pack_uint(&w->out, (uint64_t)number);
  return OPC_OK;
}

static int put_placement(writer *base, int32_t child, const char *child_name,
                         const opc_placement *p, const char *name,
                         opc_error *error) {
  oasis *w = (oasis *)base;
  pack *out = &w->out;
  int turns = quarters(p->angle), array = p->columns > 1 || p->rows > 1;
  int plain = p->magnification == 1 && turns >= 0;
  uint32_t info = 0xf0 | (array ? 8u : 0) | (p->mirror ? 1u : 0);
  (void)child_name;
  put_shapes(w);
  pack_uint(out, plain ? OASIS_PLACEMENT : OASIS_PLACEMENT_REAL);
  pack_byte(out, plain ? info | (uint32_t)turns << 1 : info | 6);
  pack_uint(out, (uint64_t)child);
  if (!plain) {
    pack_real(out, p->magnification);
    pack_real(out, p->angle);
  }
  pack_sint(out, p->origin.x);
  pack_sint(out, p->origin.y);
  if (array) put_array(w, p);
  if (name && put_name(w, name, error)) return error->code;
  pack_record(out);
  return check(w, error);
}

static int end_cell(writer *base, opc_error *error) {
  oasis *w = (oasis *)base;
  put_shapes(w);
  pack_block(&w->out);
  return check(w, error);
}

/* ---- work: names ---- */

/* Names of cells are printable and have no blanks: what else there is becomes
   "\x20". */
static int put_cell_name(oasis *w, const char *name) {
  static const char hex[] = "0123456789ABCDEF";
  char *plain = malloc(4 * strlen(name) + 1), *c = plain;
  if (!plain) return 0;
  for (; *name; name++) {
    uint8_t byte = (uint8_t)*name;
    if (byte > 0x20 && byte < 0x7f) {
      *c++ = *name;
      continue;
    }
    *c++ = '\\';
    *c++ = 'x';
    *c++ = hex[byte >> 4];
    *c++ = hex[byte & 15];
  }
  *c = '\0';
  pack_string(&w->out, plain);
  free(plain);
  return 1;
}

static int put_cell_names(oasis *w, opc_error *error) {
  const opc_layout_service *l = w->w.host->layout;
  for (size_t i = 0; i < w->n_places; i++) {
    const char *name =
        w->layout ? l->cell_name(w->layout, (int32_t)i) : w->w.cell;
    pack_uint(&w->out, OASIS_CELLNAME);
    if (!put_cell_name(w, name)) return writer_no_memory(&w->w, error);
    pack_uint(&w->out, OASIS_PROPERTY);
    pack_byte(&w->out, 0x17); /* 1 value, a standard name by number */
    pack_uint(&w->out, CELL_OFFSET);
    pack_uint(&w->out, 8);
    pack_uint(&w->out, w->places[i]);
    pack_record(&w->out);
  }
  return check(w, error);
}

static void put_strings(oasis *w, const strings *s, uint32_t record) {
  for (size_t i = 0; i < s->n; i++) {
    pack_uint(&w->out, record);
    pack_string(&w->out, s->text[i]);
    pack_record(&w->out);
  }
}

/* Where a table is that was begun at `from`; 0 if nothing is in it. */
static uint64_t end_table(oasis *w, uint64_t from) {
  pack_block(&w->out);
  return w->out.place > from ? from : 0;
}

static void put_end(oasis *w, const uint64_t places[OASIS_TABLES]) {
  pack *out = &w->out;
  pack_uint(out, OASIS_END);
  for (int i = 0; i < OASIS_TABLES; i++) {
    pack_uint(out, 1); /* strict: the table has all of its kind */
    pack_uint(out, places[i]);
  }
  /* Zeros up to the length of END, with their number in two bytes before. */
  size_t length = OASIS_END_BYTES - 1 - 4 - 2 - out->n;
  pack_byte(out, 0x80 | (length & 0x7f));
  pack_byte(out, (uint32_t)length >> 7);
  for (size_t i = 0; i < length; i++) pack_byte(out, 0);
  pack_uint(out, OASIS_CRC32);
  pack_plain(out);
  uint32_t crc = out->crc;
  for (int i = 0; i < 4; i++) pack_byte(out, crc >> 8 * i & 0xff);
  pack_plain(out);
}

static int end(writer *base, opc_error *error) {
  oasis *w = (oasis *)base;
  uint64_t places[OASIS_TABLES] = {0}, from = w->out.place;
  if (put_cell_names(w, error)) return error->code;
  places[OASIS_CELLNAMES] = end_table(w, from);
  from = w->out.place;
  put_strings(w, &w->texts, OASIS_TEXTSTRING);
  places[OASIS_TEXTSTRINGS] = end_table(w, from);
  from = w->out.place;
  pack_uint(&w->out, OASIS_PROPNAME);
  pack_string(&w->out, "S_CELL_OFFSET");
  pack_uint(&w->out, OASIS_PROPNAME);
  pack_string(&w->out, OASIS_GDS_PROPERTY);
  places[OASIS_PROPNAMES] = end_table(w, from);
  from = w->out.place;
  put_strings(w, &w->names, OASIS_PROPSTRING);
  places[OASIS_PROPSTRINGS] = end_table(w, from);
  put_end(w, places);
  return check(w, error);
}

static void clear(writer *base) {
  oasis *w = (oasis *)base;
  pack_clear(&w->out);
  groups_clear(&w->shapes);
  strings_clear(&w->texts);
  strings_clear(&w->names);
  free(w->places);
  w->places = NULL;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] =
    WRITE_PARAMETERS("mask.oas", "Numbers for layers: { poly: 9/0 }");

/* ---- entry ---- */

static const write_format format = {
    .size = sizeof(oasis),
    .name = "OASIS",
    .layer = "9/0",
    .most_points = MAX_POINTS,
    .mask = {"9/0", "1/0", "10/0", "109/0", "101/0"},
    .set_layer = set_layer,
    .begin = begin,
    .begin_cell = begin_cell,
    .polygon = put_polygon,
    .text = put_text,
    .placement = put_placement,
    .end_cell = end_cell,
    .end = end,
    .clear = clear,
};

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  return writer_create(host, values, &format, error);
}

static const opc_step step = {.size = sizeof step, .run = writer_run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "write.oasis",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Write a layout or a mask as an OASIS file",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = writer_destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
