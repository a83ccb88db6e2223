/* SPDX-License-Identifier: BSD-3-Clause */
/* write.gds: a layout or a corrected mask as a GDSII stream file. */
#include <string.h>

#include "../../read/gds/records.h"
#include "../../read/layer_number.h"
#include "../writer.h"

/* ---- state ---- */

typedef struct gds {
  writer w;
  layer_number to; /* of the polygons that are being written */
  uint8_t record[65536];
} gds;

/* Points of a polygon that fit one record, its first point twice. */
enum { MAX_POINTS = 8190 };

enum { MAX_STRING = 65530, MAX_ARRAY = 32767, MAX_PARTS = 1 << 16 };

/* Every file has the same date, so that equal layouts are equal files. */
static const uint16_t date[12] = {1970, 1, 1, 0, 0, 0, 1970, 1, 1, 0, 0, 0};

/* ---- work: records ---- */

/* n bytes of data stand in w->record from byte 4 on. What fails is seen when
   the file is closed. */
static void put_record(gds *w, uint32_t type, uint32_t kind, size_t n) {
  gds_put_u16(w->record, (uint32_t)n + 4);
  w->record[2] = (uint8_t)type;
  w->record[3] = (uint8_t)kind;
  fwrite(w->record, 1, n + 4, w->w.file);
}

static void put_empty(gds *w, uint32_t type) {
  put_record(w, type, GDS_NOTHING, 0);
}

static void put_u16(gds *w, uint32_t type, uint32_t kind, uint32_t v) {
  gds_put_u16(w->record + 4, v);
  put_record(w, type, kind, 2);
}

static void put_real(gds *w, uint32_t type, double v) {
  gds_put_real(w->record + 4, v);
  put_record(w, type, GDS_REAL8, 8);
}

static int put_string(gds *w, uint32_t type, const char *text,
                      opc_error *error) {
  size_t n = strlen(text);
  if (n > MAX_STRING)
    return w->w.host->fail(w->w.host, error, OPC_FAILED, NULL,
                           "a name or text of %zu characters is too long for "
                           "GDSII: '%.60s...'",
                           n, text);
  memcpy(w->record + 4, text, n);
  w->record[4 + n] = 0;
  put_record(w, type, GDS_ASCII, n + n % 2);
  return OPC_OK;
}

static void put_date(gds *w, uint32_t type) {
  for (size_t i = 0; i < 12; i++) gds_put_u16(w->record + 4 + 2 * i, date[i]);
  put_record(w, type, GDS_INT2, 24);
}

static void put_point(gds *w, size_t i, opc_point p) {
  gds_put_i32(w->record + 4 + 8 * i, p.x);
  gds_put_i32(w->record + 8 + 8 * i, p.y);
}

/* ---- work: the parts of the file ---- */

static int set_layer(writer *base, const char *layer) {
  gds *w = (gds *)base;
  return layer_number_parse(layer, UINT16_MAX, &w->to, NULL);
}

static int begin(writer *base, const opc_layout *layout, double unit,
                 opc_error *error) {
  gds *w = (gds *)base;
  (void)layout;
  (void)error;
  put_u16(w, GDS_HEADER, GDS_INT2, 600);
  put_date(w, GDS_BGNLIB);
  memcpy(w->record + 4, "OPCFLOW", 8);
  put_record(w, GDS_LIBNAME, GDS_ASCII, 8);
  /* um, the user's unit, and m */
  gds_put_real(w->record + 4, writer_decimal(unit * 1e-3));
  gds_put_real(w->record + 12, writer_decimal(unit * 1e-9));
  put_record(w, GDS_UNITS, GDS_REAL8, 16);
  return OPC_OK;
}

static int begin_cell(writer *base, int32_t cell, const char *name,
                      opc_error *error) {
  gds *w = (gds *)base;
  (void)cell;
  put_date(w, GDS_BGNSTR);
  return put_string(w, GDS_STRNAME, name, error);
}

static int put_polygon(writer *base, const opc_point *points, size_t n,
                       opc_error *error) {
  gds *w = (gds *)base;
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

static int put_text(writer *base, opc_point at, const char *text,
                    opc_error *error) {
  gds *w = (gds *)base;
  put_empty(w, GDS_TEXT);
  put_u16(w, GDS_LAYER, GDS_INT2, w->to.layer);
  put_u16(w, GDS_TEXTTYPE, GDS_INT2, w->to.datatype);
  put_point(w, 0, at);
  put_record(w, GDS_XY, GDS_INT4, 8);
  if (put_string(w, GDS_STRING, text, error)) return error->code;
  put_empty(w, GDS_ENDEL);
  return OPC_OK;
}

static int put_array(gds *w, const char *child, const opc_placement *p,
                     const char *name, opc_error *error) {
  int array = p->columns > 1 || p->rows > 1;
  opc_point corner[3] = {p->origin};
  if (array &&
      (!writer_along(p->origin, p->columns, p->column_step, &corner[1]) ||
       !writer_along(p->origin, p->rows, p->row_step, &corner[2])))
    return w->w.host->fail(w->w.host, error, OPC_FAILED, NULL,
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
static int put_placement(writer *base, int32_t number, const char *child,
                         const opc_placement *whole, const char *name,
                         opc_error *error) {
  gds *w = (gds *)base;
  (void)number;
  uint64_t parts = (whole->columns / MAX_ARRAY + (uint64_t)1) *
                   (whole->rows / MAX_ARRAY + (uint64_t)1);
  if (parts > MAX_PARTS)
    return w->w.host->fail(w->w.host, error, OPC_FAILED, NULL,
                           "an array of '%s' is too large for GDSII", child);
  for (uint64_t r = 0; r < whole->rows; r += MAX_ARRAY)
    for (uint64_t c = 0; c < whole->columns; c += MAX_ARRAY) {
      opc_placement p = *whole;
      opc_point row;
      if (!writer_along(whole->origin, r, whole->row_step, &row) ||
          !writer_along(row, c, whole->column_step, &p.origin))
        return w->w.host->fail(
            w->w.host, error, OPC_FAILED, NULL,
            "an array of '%s' leaves the range of coordinates", child);
      if (p.columns - c > MAX_ARRAY)
        p.columns = MAX_ARRAY;
      else
        p.columns -= (uint32_t)c;
      if (p.rows - r > MAX_ARRAY)
        p.rows = MAX_ARRAY;
      else
        p.rows -= (uint32_t)r;
      if (put_array(w, child, &p, name, error)) return error->code;
    }
  return OPC_OK;
}

static int end_cell(writer *base, opc_error *error) {
  (void)error;
  put_empty((gds *)base, GDS_ENDSTR);
  return OPC_OK;
}

static int end(writer *base, opc_error *error) {
  (void)error;
  put_empty((gds *)base, GDS_ENDLIB);
  return OPC_OK;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] =
    WRITE_PARAMETERS("mask.gds", "Numbers for layers: { poly: 9/0 }");

/* ---- entry ---- */

static const write_format format = {
    .size = sizeof(gds),
    .name = "GDSII",
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
    .id = "write.gds",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Write a layout or a mask as a GDSII file",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = writer_destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
