/* SPDX-License-Identifier: BSD-3-Clause */
/* read.gds: a GDSII stream file as a layout. */
#include <eda/memory.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "../layers.h"
#include "stream.h"

/* Instances that arrays off the unit may be taken apart into, in one file. */
enum { MAX_APART = 1 << 22 };

/* ---- state ---- */

typedef struct text {
  char *s;
  size_t room;
} text;

/* What was said of the current element. */
typedef struct element {
  uint32_t type;
  uint64_t at;
  int has_layer, has_datatype, has_name, has_text;
  uint32_t layer, datatype;
  int32_t width, begin, end;
  uint32_t ends;
  uint32_t columns, rows;
  uint32_t transform;
  double magnification, angle;
  int32_t property; /* number of the one whose value is next; -1 for none */
  int named;        /* 0 not, 1 by the first property, 2 by number 61 */
  eda_point *points;
  size_t n, room;
  text name, string, instance;
} element;

/* A file that is being read. */
typedef struct gds {
  const reader *r;
  layer_map layers;
  gds_stream stream;
  eda_layout *layout;
  int32_t cell; /* -1 in a cell that is left out */
  cell_list cells;
  size_t apart;
  int absolute; /* a placement asked for absolute angle or magnification */
  element e;
} gds;

/* ---- work: elements ---- */

/* The record's string, without the zeros that fill it up. */
static void take_string(gds *g, text *out) {
  const uint8_t *p = g->stream.data;
  size_t n = g->stream.n;
  while (n && p[n - 1] == 0) n--;
  eda_grow(&out->s, &out->room, 4 * n + 1, 1);
  reader_string(p, n, out->s);
}

static int refuse(gds *g, opc_error *error, const char *what) {
  return opc_fail(error, OPC_IO, NULL, "'%s': %s at byte %" PRIu64,
                  g->stream.path, what, g->e.at);
}

/* What the layout said to an element; a refusal with the element's place. */
static int located(gds *g, int code, opc_error *error) {
  if (!code) return OPC_OK;
  opc_error why = *error;
  return opc_fail(error, code, NULL, "'%s': %s, at byte %" PRIu64,
                  g->stream.path, why.message, g->e.at);
}

static int take_points(gds *g, opc_error *error) {
  const gds_stream *s = &g->stream;
  element *e = &g->e;
  if (s->n % 8) return gds_refuse(s, error, "half a point");
  size_t n = s->n / 8;
  eda_grow(&e->points, &e->room, e->n + n, sizeof *e->points);
  for (size_t i = 0; i < n; i++)
    e->points[e->n++] = (eda_point){eda_gds_i32(s->data + 8 * i),
                                    eda_gds_i32(s->data + 8 * i + 4)};
  return OPC_OK;
}

/* Property 61, or else the first one, names an instance. */
static int take_property(gds *g, opc_error *error) {
  element *e = &g->e;
  int rank = e->property == EDA_GDS_INSTANCE_NAME ? 2 : 1;
  if (e->property < 0)
    return gds_refuse(&g->stream, error, "PROPVALUE without PROPATTR");
  e->property = -1;
  if ((e->type != EDA_GDS_SREF && e->type != EDA_GDS_AREF) || e->named >= rank)
    return OPC_OK;
  e->named = rank;
  take_string(g, &e->instance);
  return OPC_OK;
}

static int take_number2(gds *g, uint32_t *out, int *flag, opc_error *error) {
  if (gds_need(&g->stream, 2, error)) return error->code;
  *out = eda_gds_u16(g->stream.data);
  if (flag) *flag = 1;
  return OPC_OK;
}

static int take_number4(gds *g, int32_t *out, opc_error *error) {
  if (gds_need(&g->stream, 4, error)) return error->code;
  *out = eda_gds_i32(g->stream.data);
  return OPC_OK;
}

static int take_real(gds *g, double *out, opc_error *error) {
  if (gds_need(&g->stream, 8, error)) return error->code;
  *out = eda_gds_real(g->stream.data);
  return OPC_OK;
}

/* One record of an element other than ENDEL. */
static int take_record(gds *g, opc_error *error) {
  element *e = &g->e;
  const gds_stream *s = &g->stream;
  uint32_t number = 0;
  switch (s->type) {
    case EDA_GDS_XY:
      return take_points(g, error);
    case EDA_GDS_LAYER:
      return take_number2(g, &e->layer, &e->has_layer, error);
    case EDA_GDS_DATATYPE:
    case EDA_GDS_TEXTTYPE:
    case EDA_GDS_BOXTYPE:
    case EDA_GDS_NODETYPE:
      return take_number2(g, &e->datatype, &e->has_datatype, error);
    case EDA_GDS_WIDTH:
      return take_number4(g, &e->width, error);
    case EDA_GDS_BGNEXTN:
      return take_number4(g, &e->begin, error);
    case EDA_GDS_ENDEXTN:
      return take_number4(g, &e->end, error);
    case EDA_GDS_PATHTYPE:
      if (take_number2(g, &e->ends, NULL, error)) return error->code;
      if (e->ends > 4 || e->ends == 3)
        return gds_refuse(s, error, "unknown PATHTYPE");
      return OPC_OK;
    case EDA_GDS_SNAME:
      e->has_name = 1;
      take_string(g, &e->name);
      return OPC_OK;
    case EDA_GDS_STRING:
      e->has_text = 1;
      take_string(g, &e->string);
      return OPC_OK;
    case EDA_GDS_COLROW:
      if (gds_need(s, 4, error)) return error->code;
      e->columns = eda_gds_u16(s->data);
      e->rows = eda_gds_u16(s->data + 2);
      return OPC_OK;
    case EDA_GDS_STRANS:
      return take_number2(g, &e->transform, NULL, error);
    case EDA_GDS_MAG:
      return take_real(g, &e->magnification, error);
    case EDA_GDS_ANGLE:
      return take_real(g, &e->angle, error);
    case EDA_GDS_PROPATTR:
      if (take_number2(g, &number, NULL, error)) return error->code;
      e->property = (int32_t)number;
      return OPC_OK;
    case EDA_GDS_PROPVALUE:
      return take_property(g, error);
    case EDA_GDS_ELFLAGS:
    case EDA_GDS_PLEX:
    case EDA_GDS_PRESENTATION:
    case EDA_GDS_STRTYPE:
    case EDA_GDS_ELKEY:
      return OPC_OK;
    default:
      return gds_refuse(s, error, "record out of place");
  }
}

static int add_shape(gds *g, int32_t layer, opc_error *error) {
  element *e = &g->e;
  if (e->type == EDA_GDS_PATH) {
    if (!e->n) return refuse(g, error, "PATH without points");
    int32_t width = e->width == INT32_MIN ? INT32_MAX : abs(e->width);
    return located(
        g,
        eda_layout_add_path(g->layout, g->cell, layer, e->points, e->n, width,
                            (int)e->ends, e->begin, e->end, error),
        error);
  }
  if (e->type == EDA_GDS_TEXT) {
    if (!e->n || !e->has_text) return refuse(g, error, "incomplete TEXT");
    return located(g,
                   eda_layout_add_text(g->layout, g->cell, layer, e->points[0],
                                       e->string.s, error),
                   error);
  }
  if (!e->n) return refuse(g, error, "polygon without points");
  size_t n = e->n;
  if (n > 1 && e->points[0].x == e->points[n - 1].x &&
      e->points[0].y == e->points[n - 1].y)
    n--;
  if (n < 3) return OPC_OK; /* no area */
  return located(
      g, eda_layout_add_polygon(g->layout, g->cell, layer, e->points, n, error),
      error);
}

/* ---- work: placements ---- */

static int put_instance(gds *g, int32_t child, const eda_placement *p,
                        opc_error *error) {
  const char *name = g->e.named ? g->e.instance.s : NULL;
  int code = eda_layout_add_instance(g->layout, g->cell, child, p, name, error);
  return located(g, code, error);
}

/* The step of an array whose `count` steps lead to (x, y), and whether it is a
   whole number of units. */
static int divide(int64_t x, int64_t y, uint32_t count, eda_point *step) {
  *step = (eda_point){(int32_t)(x / count), (int32_t)(y / count)};
  return x % count == 0 && y % count == 0;
}

/* i * length / count, the nearest unit */
static int64_t part(int64_t length, uint32_t i, uint32_t count) {
  return (int64_t)floor((double)length * i / count + 0.5);
}

/* An array whose steps are not whole: the columns, the rows or both are placed
   one by one, each at the nearest unit. */
static int add_apart(gds *g, int32_t child, eda_placement p, int whole_columns,
                     int whole_rows, opc_error *error) {
  const element *e = &g->e;
  int64_t cx = (int64_t)e->points[1].x - e->points[0].x;
  int64_t cy = (int64_t)e->points[1].y - e->points[0].y;
  int64_t rx = (int64_t)e->points[2].x - e->points[0].x;
  int64_t ry = (int64_t)e->points[2].y - e->points[0].y;
  uint32_t columns = whole_columns ? 1 : p.columns;
  uint32_t rows = whole_rows ? 1 : p.rows;
  uint32_t full_columns = p.columns, full_rows = p.rows;
  g->apart += (size_t)columns * rows;
  if (g->apart > MAX_APART)
    return refuse(g, error,
                  "too many arrays with steps off the unit, the last");
  if (!whole_columns) p.columns = 1;
  if (!whole_rows) p.rows = 1;
  for (uint32_t j = 0; j < rows; j++)
    for (uint32_t i = 0; i < columns; i++) {
      int64_t x = e->points[0].x, y = e->points[0].y;
      x += part(cx, i, full_columns) + part(rx, j, full_rows);
      y += part(cy, i, full_columns) + part(ry, j, full_rows);
      if (x != (int32_t)x || y != (int32_t)y)
        return refuse(g, error, "an array leaves the range of coordinates");
      p.origin = (eda_point){(int32_t)x, (int32_t)y};
      if (put_instance(g, child, &p, error)) return error->code;
    }
  return OPC_OK;
}

static int add_placement(gds *g, opc_error *error) {
  element *e = &g->e;
  size_t needed = e->type == EDA_GDS_AREF ? 3 : 1;
  if (!e->has_name || e->n < needed)
    return refuse(g, error, "incomplete placement");
  if (!(e->magnification > 0))
    return refuse(g, error, "placement with an impossible MAG");
  int32_t child = eda_layout_cell(g->layout, e->name.s, error);
  if (child < 0) return error->code;
  if (e->transform & 6) g->absolute = 1;
  eda_placement p = {.origin = e->points[0],
                     .magnification = e->magnification,
                     .angle = e->angle,
                     .mirror = e->transform >> 15 & 1,
                     .columns = 1,
                     .rows = 1};
  if (e->type == EDA_GDS_AREF) {
    p.columns = e->columns ? e->columns : 1;
    p.rows = e->rows ? e->rows : 1;
    const eda_point *o = e->points;
    int64_t cx = (int64_t)o[1].x - o[0].x, cy = (int64_t)o[1].y - o[0].y;
    int64_t rx = (int64_t)o[2].x - o[0].x, ry = (int64_t)o[2].y - o[0].y;
    if (cx != (int32_t)cx || cy != (int32_t)cy || rx != (int32_t)rx ||
        ry != (int32_t)ry)
      return refuse(g, error, "an array leaves the range of coordinates");
    int whole_columns = divide(cx, cy, p.columns, &p.column_step);
    int whole_rows = divide(rx, ry, p.rows, &p.row_step);
    if (!whole_columns || !whole_rows)
      return add_apart(g, child, p, whole_columns, whole_rows, error);
  }
  return put_instance(g, child, &p, error);
}

/* ---- work: cells and the library ---- */

/* An element, whose first record has been read, up to its ENDEL. */
static int read_element(gds *g, opc_error *error) {
  element *e = &g->e;
  gds_stream *s = &g->stream;
  *e = (element){.type = s->type,
                 .at = s->at,
                 .magnification = 1,
                 .property = -1,
                 .points = e->points,
                 .room = e->room,
                 .name = e->name,
                 .string = e->string,
                 .instance = e->instance};
  for (;;) {
    if (gds_next(s, error)) return error->code;
    if (s->type == EDA_GDS_ENDEL) break;
    if (take_record(g, error)) return error->code;
  }
  if (e->type == EDA_GDS_NODE || g->cell < 0) return OPC_OK;
  if (e->type == EDA_GDS_SREF || e->type == EDA_GDS_AREF)
    return add_placement(g, error);
  if (!e->has_layer || !e->has_datatype)
    return refuse(g, error, "element without layer or datatype");
  int32_t layer =
      layer_map_find(&g->layers, g->layout, e->layer, e->datatype, error);
  if (layer < 0) return error->code;
  return add_shape(g, layer, error);
}

static int begin_cell(gds *g, opc_error *error) {
  gds_stream *s = &g->stream;
  if (!g->layout) return gds_refuse(s, error, "BGNSTR before UNITS");
  if (gds_next(s, error)) return error->code;
  if (s->type != EDA_GDS_STRNAME)
    return gds_refuse(s, error, "BGNSTR without STRNAME");
  take_string(g, &g->e.name);
  int left_out;
  g->cell =
      cell_list_begin(&g->cells, g->layout, g->e.name.s, &left_out, error);
  if (g->cell < 0 && error->code == OPC_INVALID) {
    opc_error why = *error;
    return gds_refuse(s, error, why.message);
  }
  if (g->cell < 0) return error->code;
  if (left_out) g->cell = -1;
  return OPC_OK;
}

static int read_cell(gds *g, opc_error *error) {
  gds_stream *s = &g->stream;
  if (begin_cell(g, error)) return error->code;
  for (;;) {
    if (gds_next(s, error)) return error->code;
    switch (s->type) {
      case EDA_GDS_ENDSTR:
        return OPC_OK;
      case EDA_GDS_STRCLASS:
        break;
      case EDA_GDS_BOUNDARY:
      case EDA_GDS_PATH:
      case EDA_GDS_SREF:
      case EDA_GDS_AREF:
      case EDA_GDS_TEXT:
      case EDA_GDS_NODE:
      case EDA_GDS_BOX:
        if (read_element(g, error)) return error->code;
        break;
      default:
        return gds_refuse(s, error, "record out of place");
    }
  }
}

/* The second number is the unit in metres. Its decimal value is meant: 14
   digits take away what the base of 16 did to it. */
static int take_units(gds *g, opc_error *error) {
  const gds_stream *s = &g->stream;
  if (g->layout) return gds_refuse(s, error, "UNITS a second time");
  if (gds_need(s, 16, error)) return error->code;
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g", eda_gds_real(s->data + 8) * 1e9);
  double unit = strtod(digits, NULL);
  if (!(unit > 0)) return gds_refuse(s, error, "impossible UNITS");
  g->layout = eda_layout_new(unit * g->r->scale, error);
  return g->layout ? OPC_OK : error->code;
}

static int read_library(gds *g, opc_error *error) {
  gds_stream *s = &g->stream;
  if (gds_next(s, error)) return error->code;
  if (s->type != EDA_GDS_HEADER || s->n != 2)
    return gds_refuse(s, error, "not a GDSII file: no HEADER");
  for (;;) {
    if (gds_next(s, error)) return error->code;
    switch (s->type) {
      case EDA_GDS_UNITS:
        if (take_units(g, error)) return error->code;
        break;
      case EDA_GDS_BGNSTR:
        if (read_cell(g, error)) return error->code;
        break;
      case EDA_GDS_ENDLIB: /* what follows fills the last block of a tape */
        return g->layout ? OPC_OK : gds_refuse(s, error, "ENDLIB before UNITS");
      case EDA_GDS_BGNLIB:
      case EDA_GDS_LIBNAME:
      case EDA_GDS_REFLIBS:
      case EDA_GDS_FONTS:
      case EDA_GDS_GENERATIONS:
      case EDA_GDS_ATTRTABLE:
      case EDA_GDS_TAPENUM:
      case EDA_GDS_TAPECODE:
      case EDA_GDS_FORMAT:
      case EDA_GDS_MASK:
      case EDA_GDS_ENDMASKS:
      case EDA_GDS_LIBDIRSIZE:
      case EDA_GDS_SRFNAME:
      case EDA_GDS_LIBSECUR:
        break;
      default:
        return gds_refuse(s, error, "record out of place");
    }
  }
}

/* ---- work: what the parameters ask of the whole ---- */

static int read_file(gds *g, opc_error *error) {
  const reader *r = g->r;
  if (layer_map_init(&g->layers, r, UINT16_MAX, error) ||
      gds_open(&g->stream, r->host, r->file, error) || read_library(g, error) ||
      layer_map_check(&g->layers, error))
    return error->code;
  cell_list_warn(&g->cells, r, g->layout);
  if (g->absolute)
    r->host->log(r->host, OPC_LOG_WARNING,
                 "'%s': absolute angles or magnifications are taken as "
                 "relative",
                 r->file);
  return reader_keep(r, g->layout, &g->cells, -1, error);
}

static int run(void *self, void **outputs, opc_error *error) {
  gds g = {.r = self};
  int code = read_file(&g, error);
  outputs[0] = g.layout;
  gds_close(&g.stream);
  layer_map_clear(&g.layers);
  free(g.cells.defined);
  free(g.e.points);
  free(g.e.name.s);
  free(g.e.string.s);
  free(g.e.instance.s);
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    READ_PARAMETERS("The GDSII file",
                    "Names for layers: { poly: 9/0 }, or 9 for every datatype; "
                    "the others are called 9/0")};

static int check(void *self, opc_error *error) {
  return layer_map_try(self, UINT16_MAX, error);
}

/* ---- entry ---- */

static const opc_port outputs_of[] = {EDA_PORT_LAYOUT("layout")};
static const opc_step functions = {OPC_OUTPUTS(outputs_of), .run = run};

OPC_PLUGIN(reader, .id = "read.gds", .kind = "step", .version = "0.2.0",
           .licence = "BSD-3-Clause", .summary = "Read a GDSII file",
           .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
           OPC_PARAMETERS(parameters), .check = check,
           OPC_FUNCTIONS(functions));
