/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements write.gds: a layout or a corrected mask as a GDSII stream file. */
#include <eda/gds.h>
#include <string.h>

#include "../writer.h"

/* ---- state ---- */

typedef struct gds {
  writer w;
  eda_layer_number to; /* layer of the following polygons */
  uint8_t record[65536];
} gds;

/* Largest number of points of a polygon in one record. The record repeats the
   first point. */
enum { MAX_POINTS = 8190 };

enum { MAX_STRING = 65530, MAX_ARRAY = 32767, MAX_PARTS = 1 << 16 };

/* Date in every file: constant, so that equal layouts produce equal files. */
static const uint16_t date[12] = {1970, 1, 1, 0, 0, 0, 1970, 1, 1, 0, 0, 0};

/* ---- work: records ---- */

/* Write a record with n bytes of data, which the caller has put into w->record
   from byte 4 on. Write errors are detected when the file is closed. */
static void put_record(gds *w, uint32_t type, uint32_t kind, size_t n) {
  eda_gds_put_u16(w->record, (uint32_t)n + 4);
  w->record[2] = (uint8_t)type;
  w->record[3] = (uint8_t)kind;
  fwrite(w->record, 1, n + 4, w->w.file);
}

static void put_empty(gds *w, uint32_t type) {
  put_record(w, type, EDA_GDS_NOTHING, 0);
}

static void put_u16(gds *w, uint32_t type, uint32_t kind, uint32_t v) {
  eda_gds_put_u16(w->record + 4, v);
  put_record(w, type, kind, 2);
}

static void put_real(gds *w, uint32_t type, double v) {
  eda_gds_put_real(w->record + 4, v);
  put_record(w, type, EDA_GDS_REAL8, 8);
}

static void put_string(gds *w, uint32_t type, const char *text) {
  size_t n = strlen(text);
  if (n > MAX_STRING) {
    writer_fail(&w->w,
                "a name or text of %zu characters is too long for "
                "GDSII: '%.60s...'",
                n, text);
    return;
  }
  memcpy(w->record + 4, text, n);
  w->record[4 + n] = 0;
  put_record(w, type, EDA_GDS_ASCII, n + n % 2);
}

static void put_date(gds *w, uint32_t type) {
  for (size_t i = 0; i < 12; i++)
    eda_gds_put_u16(w->record + 4 + 2 * i, date[i]);
  put_record(w, type, EDA_GDS_INT2, 24);
}

static void put_point(gds *w, size_t i, eda_point p) {
  eda_gds_put_i32(w->record + 4 + 8 * i, p.x);
  eda_gds_put_i32(w->record + 8 + 8 * i, p.y);
}

/* ---- work: the parts of the file ---- */

static int set_layer(void *self, const char *layer) {
  gds *w = self;
  return eda_layer_number_read(layer, UINT16_MAX, &w->to, NULL);
}

static void gds_begin(void *self, const eda_layout *layout, double unit) {
  gds *w = self;
  (void)layout;
  put_u16(w, EDA_GDS_HEADER, EDA_GDS_INT2, 600);
  put_date(w, EDA_GDS_BGNLIB);
  memcpy(w->record + 4, "OPCFLOW", 8);
  put_record(w, EDA_GDS_LIBNAME, EDA_GDS_ASCII, 8);
  /* user unit, um; unit of the file, m */
  eda_gds_put_real(w->record + 4, writer_decimal(unit * 1e-3));
  eda_gds_put_real(w->record + 12, writer_decimal(unit * 1e-9));
  put_record(w, EDA_GDS_UNITS, EDA_GDS_REAL8, 16);
}

static void begin_cell(void *self, int32_t cell, const char *name) {
  gds *w = self;
  (void)cell;
  put_date(w, EDA_GDS_BGNSTR);
  put_string(w, EDA_GDS_STRNAME, name);
}

static void put_polygon(void *self, const eda_point *points, size_t n) {
  gds *w = self;
  put_empty(w, EDA_GDS_BOUNDARY);
  put_u16(w, EDA_GDS_LAYER, EDA_GDS_INT2, w->to.layer);
  put_u16(w, EDA_GDS_DATATYPE, EDA_GDS_INT2, w->to.datatype);
  for (size_t i = 0; i < n; i++) put_point(w, i, points[i]);
  put_point(w, n, points[0]);
  put_record(w, EDA_GDS_XY, EDA_GDS_INT4, 8 * (n + 1));
  put_empty(w, EDA_GDS_ENDEL);
}

static void put_text(void *self, eda_point at, const char *text) {
  gds *w = self;
  put_empty(w, EDA_GDS_TEXT);
  put_u16(w, EDA_GDS_LAYER, EDA_GDS_INT2, w->to.layer);
  put_u16(w, EDA_GDS_TEXTTYPE, EDA_GDS_INT2, w->to.datatype);
  put_point(w, 0, at);
  put_record(w, EDA_GDS_XY, EDA_GDS_INT4, 8);
  put_string(w, EDA_GDS_STRING, text);
  put_empty(w, EDA_GDS_ENDEL);
}

static void array_beyond(gds *w, const char *child) {
  writer_fail(&w->w, "an array of '%s' leaves the range of coordinates", child);
}

static void put_array(gds *w, const char *child, const eda_placement *p,
                      const char *name) {
  int array = p->columns > 1 || p->rows > 1;
  eda_point corner[3] = {p->origin};
  if (array &&
      (!writer_along(p->origin, p->columns, p->column_step, &corner[1]) ||
       !writer_along(p->origin, p->rows, p->row_step, &corner[2])))
    array_beyond(w, child);
  put_empty(w, array ? EDA_GDS_AREF : EDA_GDS_SREF);
  put_string(w, EDA_GDS_SNAME, child);
  if (p->mirror || p->magnification != 1 || p->angle != 0)
    put_u16(w, EDA_GDS_STRANS, EDA_GDS_BITS, p->mirror ? 0x8000 : 0);
  if (p->magnification != 1) put_real(w, EDA_GDS_MAG, p->magnification);
  if (p->angle != 0) put_real(w, EDA_GDS_ANGLE, p->angle);
  if (array) {
    eda_gds_put_u16(w->record + 4, p->columns);
    eda_gds_put_u16(w->record + 6, p->rows);
    put_record(w, EDA_GDS_COLROW, EDA_GDS_INT2, 4);
  }
  size_t n = array ? 3 : 1;
  for (size_t i = 0; i < n; i++) put_point(w, i, corner[i]);
  put_record(w, EDA_GDS_XY, EDA_GDS_INT4, 8 * n);
  if (name) {
    put_u16(w, EDA_GDS_PROPATTR, EDA_GDS_INT2, EDA_GDS_INSTANCE_NAME);
    put_string(w, EDA_GDS_PROPVALUE, name);
  }
  put_empty(w, EDA_GDS_ENDEL);
}

/* Write an array. An array that exceeds the counts of a record is split. */
static void put_placement(void *self, int32_t number, const char *child,
                          const eda_placement *whole, const char *name) {
  gds *w = self;
  (void)number;
  uint64_t parts = (whole->columns / MAX_ARRAY + (uint64_t)1) *
                   (whole->rows / MAX_ARRAY + (uint64_t)1);
  if (parts > MAX_PARTS) {
    writer_fail(&w->w, "an array of '%s' is too large for GDSII", child);
    return;
  }
  for (uint64_t r = 0; r < whole->rows; r += MAX_ARRAY)
    for (uint64_t c = 0; c < whole->columns; c += MAX_ARRAY) {
      eda_placement p = *whole;
      eda_point row;
      uint64_t columns = whole->columns - c, rows = whole->rows - r;
      if (!writer_along(whole->origin, r, whole->row_step, &row) ||
          !writer_along(row, c, whole->column_step, &p.origin))
        array_beyond(w, child);
      p.columns = columns > MAX_ARRAY ? MAX_ARRAY : (uint32_t)columns;
      p.rows = rows > MAX_ARRAY ? MAX_ARRAY : (uint32_t)rows;
      put_array(w, child, &p, name);
    }
}

static void end_cell(void *self) { put_empty(self, EDA_GDS_ENDSTR); }

static void gds_end(void *self) { put_empty(self, EDA_GDS_ENDLIB); }

/* ---- parameters ---- */

static const opc_parameter parameters[] =
    WRITE_PARAMETERS(gds, "mask.gds", "Layer numbers, as in { poly: 9/0 }");

static const write_format format = {
    .layer = "9/0",
    .most_points = MAX_POINTS,
    .name_layer = writer_number_layer,
    .set_layer = set_layer,
    .begin = gds_begin,
    .begin_cell = begin_cell,
    .polygon = put_polygon,
    .text = put_text,
    .placement = put_placement,
    .end_cell = end_cell,
    .end = gds_end,
};

static int gds_check(void *self, opc_error *error) {
  return writer_check(self, &format, error);
}

/* ---- entry ---- */

static const opc_step functions = {.run = writer_run,
                                   .forecast = writer_forecast};

OPC_PLUGIN(gds, .id = "write.gds", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause",
           .summary = "Write a layout or a mask as a GDSII file",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = gds_check,
           OPC_FUNCTIONS(functions));
