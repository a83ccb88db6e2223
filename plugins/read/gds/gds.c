/* SPDX-License-Identifier: BSD-3-Clause */
/* read.gds: a GDSII stream file as a layout. */
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "../cells.h"
#include "../layers.h"
#include "../parameters.h"
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
  opc_point *points;
  size_t n, room;
  text name, string, instance;
} element;

typedef struct reader {
  const opc_host *host;
  const opc_value *values;
  layer_map layers;
  gds_stream stream;
  opc_layout *layout;
  int32_t cell; /* -1 in a cell that is left out */
  cell_list cells;
  size_t apart;
  int absolute; /* a placement asked for absolute angle or magnification */
  element e;
} reader;

/* A port is released without its instance: the table that every host has. */
static const opc_layout_service *layouts;

/* ---- work: strings ---- */

static int no_memory(reader *r, opc_error *error) {
  return r->host->fail(r->host, error, OPC_FAILED, NULL, "'%s': out of memory",
                       r->stream.path);
}

static int grow(void *array, size_t *room, size_t need, size_t size) {
  if (need <= *room) return 1;
  size_t wanted = need + need / 2 + 16;
  void *memory = realloc(*(void **)array, wanted * size);
  if (!memory) return 0;
  *(void **)array = memory;
  *room = wanted;
  return 1;
}

/* The record's string, without the zeros that fill it up. */
static int take_string(reader *r, text *out, opc_error *error) {
  const uint8_t *p = r->stream.data;
  size_t n = r->stream.n;
  while (n && p[n - 1] == 0) n--;
  if (!grow(&out->s, &out->room, 4 * n + 1, 1)) return no_memory(r, error);
  cell_list_string(p, n, out->s);
  return OPC_OK;
}

/* ---- work: elements ---- */

static int refuse(reader *r, opc_error *error, const char *what) {
  return r->host->fail(r->host, error, OPC_IO, NULL,
                       "'%s': %s at byte %" PRIu64, r->stream.path, what,
                       r->e.at);
}

/* What the layout said to an element; a refusal with the element's place. */
static int located(reader *r, int code, opc_error *error) {
  if (!code) return OPC_OK;
  opc_error why = *error;
  return r->host->fail(r->host, error, code, NULL, "'%s': %s, at byte %" PRIu64,
                       r->stream.path, why.message, r->e.at);
}

static int take_points(reader *r, opc_error *error) {
  const gds_stream *s = &r->stream;
  element *e = &r->e;
  if (s->n % 8) return gds_refuse(s, error, "half a point");
  size_t n = s->n / 8;
  if (!grow(&e->points, &e->room, e->n + n, sizeof *e->points))
    return no_memory(r, error);
  for (size_t i = 0; i < n; i++)
    e->points[e->n++] =
        (opc_point){gds_i32(s->data + 8 * i), gds_i32(s->data + 8 * i + 4)};
  return OPC_OK;
}

/* Property 61, or else the first one, names an instance. */
static int take_property(reader *r, opc_error *error) {
  element *e = &r->e;
  int rank = e->property == GDS_INSTANCE_NAME ? 2 : 1;
  if (e->property < 0)
    return gds_refuse(&r->stream, error, "PROPVALUE without PROPATTR");
  e->property = -1;
  if ((e->type != GDS_SREF && e->type != GDS_AREF) || e->named >= rank)
    return OPC_OK;
  e->named = rank;
  return take_string(r, &e->instance, error);
}

static int take_number2(reader *r, uint32_t *out, int *flag, opc_error *error) {
  if (gds_need(&r->stream, 2, error)) return error->code;
  *out = gds_u16(r->stream.data);
  if (flag) *flag = 1;
  return OPC_OK;
}

static int take_number4(reader *r, int32_t *out, opc_error *error) {
  if (gds_need(&r->stream, 4, error)) return error->code;
  *out = gds_i32(r->stream.data);
  return OPC_OK;
}

static int take_real(reader *r, double *out, opc_error *error) {
  if (gds_need(&r->stream, 8, error)) return error->code;
  *out = gds_real(r->stream.data);
  return OPC_OK;
}

/* One record of an element other than ENDEL. */
static int take_record(reader *r, opc_error *error) {
  element *e = &r->e;
  const gds_stream *s = &r->stream;
  uint32_t number = 0;
  switch (s->type) {
    case GDS_XY:
      return take_points(r, error);
    case GDS_LAYER:
      return take_number2(r, &e->layer, &e->has_layer, error);
    case GDS_DATATYPE:
    case GDS_TEXTTYPE:
    case GDS_BOXTYPE:
    case GDS_NODETYPE:
      return take_number2(r, &e->datatype, &e->has_datatype, error);
    case GDS_WIDTH:
      return take_number4(r, &e->width, error);
    case GDS_BGNEXTN:
      return take_number4(r, &e->begin, error);
    case GDS_ENDEXTN:
      return take_number4(r, &e->end, error);
    case GDS_PATHTYPE:
      if (take_number2(r, &e->ends, NULL, error)) return error->code;
      if (e->ends > 4 || e->ends == 3)
        return gds_refuse(s, error, "unknown PATHTYPE");
      return OPC_OK;
    case GDS_SNAME:
      e->has_name = 1;
      return take_string(r, &e->name, error);
    case GDS_STRING:
      e->has_text = 1;
      return take_string(r, &e->string, error);
    case GDS_COLROW:
      if (gds_need(s, 4, error)) return error->code;
      e->columns = gds_u16(s->data);
      e->rows = gds_u16(s->data + 2);
      return OPC_OK;
    case GDS_STRANS:
      return take_number2(r, &e->transform, NULL, error);
    case GDS_MAG:
      return take_real(r, &e->magnification, error);
    case GDS_ANGLE:
      return take_real(r, &e->angle, error);
    case GDS_PROPATTR:
      if (take_number2(r, &number, NULL, error)) return error->code;
      e->property = (int32_t)number;
      return OPC_OK;
    case GDS_PROPVALUE:
      return take_property(r, error);
    case GDS_ELFLAGS:
    case GDS_PLEX:
    case GDS_PRESENTATION:
    case GDS_STRTYPE:
    case GDS_ELKEY:
      return OPC_OK;
    default:
      return gds_refuse(s, error, "record out of place");
  }
}

static int add_shape(reader *r, int32_t layer, opc_error *error) {
  element *e = &r->e;
  if (e->type == GDS_PATH) {
    if (!e->n) return refuse(r, error, "PATH without points");
    int32_t width = e->width == INT32_MIN ? INT32_MAX : abs(e->width);
    return located(
        r,
        layouts->add_path(r->layout, r->cell, layer, e->points, e->n, width,
                          (int)e->ends, e->begin, e->end, error),
        error);
  }
  if (e->type == GDS_TEXT) {
    if (!e->n || !e->has_text) return refuse(r, error, "incomplete TEXT");
    return located(r,
                   layouts->add_text(r->layout, r->cell, layer, e->points[0],
                                     e->string.s, error),
                   error);
  }
  if (!e->n) return refuse(r, error, "polygon without points");
  size_t n = e->n;
  if (n > 1 && e->points[0].x == e->points[n - 1].x &&
      e->points[0].y == e->points[n - 1].y)
    n--;
  if (n < 3) return OPC_OK; /* no area */
  return located(
      r, layouts->add_polygon(r->layout, r->cell, layer, e->points, n, error),
      error);
}

/* ---- work: placements ---- */

static int put_instance(reader *r, int32_t child, const opc_placement *p,
                        opc_error *error) {
  const char *name = r->e.named ? r->e.instance.s : NULL;
  int code = layouts->add_instance(r->layout, r->cell, child, p, name, error);
  return located(r, code, error);
}

/* The step of an array whose `count` steps lead to (x, y), and whether it is a
   whole number of units. */
static int divide(int64_t x, int64_t y, uint32_t count, opc_point *step) {
  *step = (opc_point){(int32_t)(x / count), (int32_t)(y / count)};
  return x % count == 0 && y % count == 0;
}

/* i * length / count, the nearest unit */
static int64_t part(int64_t length, uint32_t i, uint32_t count) {
  return (int64_t)floor((double)length * i / count + 0.5);
}

/* An array whose steps are not whole: the columns, the rows or both are placed
   one by one, each at the nearest unit. */
static int add_apart(reader *r, int32_t child, opc_placement p,
                     int whole_columns, int whole_rows, opc_error *error) {
  const element *e = &r->e;
  int64_t cx = (int64_t)e->points[1].x - e->points[0].x;
  int64_t cy = (int64_t)e->points[1].y - e->points[0].y;
  int64_t rx = (int64_t)e->points[2].x - e->points[0].x;
  int64_t ry = (int64_t)e->points[2].y - e->points[0].y;
  uint32_t columns = whole_columns ? 1 : p.columns;
  uint32_t rows = whole_rows ? 1 : p.rows;
  uint32_t full_columns = p.columns, full_rows = p.rows;
  r->apart += (size_t)columns * rows;
  if (r->apart > MAX_APART)
    return refuse(r, error,
                  "too many arrays with steps off the unit, the last");
  if (!whole_columns) p.columns = 1;
  if (!whole_rows) p.rows = 1;
  for (uint32_t j = 0; j < rows; j++)
    for (uint32_t i = 0; i < columns; i++) {
      int64_t x = e->points[0].x, y = e->points[0].y;
      x += part(cx, i, full_columns) + part(rx, j, full_rows);
      y += part(cy, i, full_columns) + part(ry, j, full_rows);
      if (x != (int32_t)x || y != (int32_t)y)
        return refuse(r, error, "an array leaves the range of coordinates");
      p.origin = (opc_point){(int32_t)x, (int32_t)y};
      if (put_instance(r, child, &p, error)) return error->code;
    }
  return OPC_OK;
}

static int add_placement(reader *r, opc_error *error) {
  element *e = &r->e;
  size_t needed = e->type == GDS_AREF ? 3 : 1;
  if (!e->has_name || e->n < needed)
    return refuse(r, error, "incomplete placement");
  if (!(e->magnification > 0))
    return refuse(r, error, "placement with an impossible MAG");
  int32_t child = layouts->cell(r->layout, e->name.s, error);
  if (child < 0) return error->code;
  if (e->transform & 6) r->absolute = 1;
  opc_placement p = {.origin = e->points[0],
                     .magnification = e->magnification,
                     .angle = e->angle,
                     .mirror = e->transform >> 15 & 1,
                     .columns = 1,
                     .rows = 1};
  if (e->type == GDS_AREF) {
    p.columns = e->columns ? e->columns : 1;
    p.rows = e->rows ? e->rows : 1;
    const opc_point *o = e->points;
    int64_t cx = (int64_t)o[1].x - o[0].x, cy = (int64_t)o[1].y - o[0].y;
    int64_t rx = (int64_t)o[2].x - o[0].x, ry = (int64_t)o[2].y - o[0].y;
    if (cx != (int32_t)cx || cy != (int32_t)cy || rx != (int32_t)rx ||
        ry != (int32_t)ry)
      return refuse(r, error, "an array leaves the range of coordinates");
    int whole_columns = divide(cx, cy, p.columns, &p.column_step);
    int whole_rows = divide(rx, ry, p.rows, &p.row_step);
    if (!whole_columns || !whole_rows)
      return add_apart(r, child, p, whole_columns, whole_rows, error);
  }
  return put_instance(r, child, &p, error);
}

/* ---- work: cells and the library ---- */

/* An element, whose first record has been read, up to its ENDEL. */
static int read_element(reader *r, opc_error *error) {
  element *e = &r->e;
  gds_stream *s = &r->stream;
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
    if (s->type == GDS_ENDEL) break;
    if (take_record(r, error)) return error->code;
  }
  if (e->type == GDS_NODE || r->cell < 0) return OPC_OK;
  if (e->type == GDS_SREF || e->type == GDS_AREF)
    return add_placement(r, error);
  if (!e->has_layer || !e->has_datatype)
    return refuse(r, error, "element without layer or datatype");
  int32_t layer =
      layer_map_find(&r->layers, r->layout, e->layer, e->datatype, error);
  if (layer < 0) return error->code;
  return add_shape(r, layer, error);
}

static int begin_cell(reader *r, opc_error *error) {
  gds_stream *s = &r->stream;
  if (!r->layout) return gds_refuse(s, error, "BGNSTR before UNITS");
  if (gds_next(s, error)) return error->code;
  if (s->type != GDS_STRNAME)
    return gds_refuse(s, error, "BGNSTR without STRNAME");
  if (take_string(r, &r->e.name, error)) return error->code;
  int left_out;
  r->cell = cell_list_begin(&r->cells, r->host, r->layout, r->e.name.s,
                            &left_out, error);
  if (r->cell < 0 && error->code == OPC_INVALID) {
    opc_error why = *error;
    return gds_refuse(s, error, why.message);
  }
  if (r->cell < 0) return error->code;
  if (left_out) r->cell = -1;
  return OPC_OK;
}

static int read_cell(reader *r, opc_error *error) {
  gds_stream *s = &r->stream;
  if (begin_cell(r, error)) return error->code;
  for (;;) {
    if (gds_next(s, error)) return error->code;
    switch (s->type) {
      case GDS_ENDSTR:
        return OPC_OK;
      case GDS_STRCLASS:
        break;
      case GDS_BOUNDARY:
      case GDS_PATH:
      case GDS_SREF:
      case GDS_AREF:
      case GDS_TEXT:
      case GDS_NODE:
      case GDS_BOX:
        if (read_element(r, error)) return error->code;
        break;
      default:
        return gds_refuse(s, error, "record out of place");
    }
  }
}

/* The second number is the unit in metres. Its decimal value is meant: 14
   digits take away what the base of 16 did to it. */
static int take_units(reader *r, opc_error *error) {
  const gds_stream *s = &r->stream;
  if (r->layout) return gds_refuse(s, error, "UNITS a second time");
  if (gds_need(s, 16, error)) return error->code;
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g", gds_real(s->data + 8) * 1e9);
  double unit = strtod(digits, NULL);
  if (!(unit > 0)) return gds_refuse(s, error, "impossible UNITS");
  r->layout = layouts->create(r->host, unit * r->values[SCALE].real, error);
  return r->layout ? OPC_OK : error->code;
}

static int read_library(reader *r, opc_error *error) {
  gds_stream *s = &r->stream;
  if (gds_next(s, error)) return error->code;
  if (s->type != GDS_HEADER || s->n != 2)
    return gds_refuse(s, error, "not a GDSII file: no HEADER");
  for (;;) {
    if (gds_next(s, error)) return error->code;
    switch (s->type) {
      case GDS_UNITS:
        if (take_units(r, error)) return error->code;
        break;
      case GDS_BGNSTR:
        if (read_cell(r, error)) return error->code;
        break;
      case GDS_ENDLIB: /* what follows fills the last block of a tape */
        return r->layout ? OPC_OK : gds_refuse(s, error, "ENDLIB before UNITS");
      case GDS_BGNLIB:
      case GDS_LIBNAME:
      case GDS_REFLIBS:
      case GDS_FONTS:
      case GDS_GENERATIONS:
      case GDS_ATTRTABLE:
      case GDS_TAPENUM:
      case GDS_TAPECODE:
      case GDS_FORMAT:
      case GDS_MASK:
      case GDS_ENDMASKS:
      case GDS_LIBDIRSIZE:
      case GDS_SRFNAME:
      case GDS_LIBSECUR:
        break;
      default:
        return gds_refuse(s, error, "record out of place");
    }
  }
}

/* ---- work: what the parameters ask of the whole ---- */

static void warn(const reader *r) {
  cell_list_warn(&r->cells, r->host, r->layout, r->stream.path);
  if (r->absolute)
    r->host->log(r->host, OPC_LOG_WARNING,
                 "'%s': absolute angles or magnifications are taken as "
                 "relative",
                 r->stream.path);
}

static int run(void *self, void **outputs, opc_error *error) {
  reader *r = self;
  int code = gds_open(&r->stream, r->host, r->values[FILE_NAME].text, error);
  if (!code) code = read_library(r, error);
  if (!code) code = layer_map_check(&r->layers, r->stream.path, error);
  if (!code) {
    warn(r);
    code = cell_list_keep(&r->cells, r->host, r->layout, &r->values[TOP],
                          r->stream.path, error);
  }
  gds_close(&r->stream);
  if (!code) {
    outputs[0] = r->layout;
    r->layout = NULL;
  }
  return code;
}

/* ---- parameters ---- */

static const opc_parameter parameters[] = {
    READ_PARAMETERS("The GDSII file",
                    "Names for layers: { poly: 9/0 }, or 9 for every datatype; "
                    "the others are called 9/0")};

static void release_layout(void *layout) { layouts->destroy(layout); }

static const opc_port outputs[] = {{"layout", "layout", release_layout}};

/* ---- entry ---- */

static void destroy(void *self) {
  reader *r = self;
  gds_close(&r->stream);
  layer_map_clear(&r->layers);
  if (r->layout) layouts->destroy(r->layout);
  cell_list_clear(&r->cells);
  free(r->e.points);
  free(r->e.name.s);
  free(r->e.string.s);
  free(r->e.instance.s);
  r->host->free(r->host, r);
}

static void *create(const opc_host *host, const opc_value *values,
                    opc_error *error) {
  layouts = host->layout;
  reader *r = host->alloc(host, 1, sizeof *r);
  if (!r) {
    host->fail(host, error, OPC_FAILED, NULL, "out of memory");
    return NULL;
  }
  r->host = host;
  r->values = values;
  if (layer_map_init(&r->layers, host, &values[LAYERS], UINT16_MAX, error)) {
    destroy(r);
    return NULL;
  }
  return r;
}

static const opc_step step = {.size = sizeof step,
                              .n_outputs = 1,
                              .port_size = sizeof(opc_port),
                              .outputs = outputs,
                              .run = run};

static const opc_plugin plugin = {
    .size = sizeof plugin,
    .abi_major = OPC_ABI_MAJOR,
    .abi_minor = OPC_ABI_MINOR,
    .id = "read.gds",
    .version = "0.1.0",
    .licence = "BSD-3-Clause",
    .summary = "Read a GDSII file",
    .kind = OPC_KIND_STEP,
    .flags = OPC_DETERMINISTIC | OPC_REENTRANT,
    OPC_PARAMETERS(parameters),
    .create = create,
    .destroy = destroy,
    .operations = &step,
};

OPC_EXPORT const opc_plugin *opcflow_plugin(void);
const opc_plugin *opcflow_plugin(void) { return &plugin; }
