/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements read.gds: a GDSII stream file as a layout. */
#include <eda/gds.h>
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "../reader.h"

/* Largest number of instances that replace arrays with non-integer steps in a
   file. Each 64 bytes of a name count as a further instance. */
enum { MAX_APART = 1 << 20 };

/* Largest number of bytes of a record: its length has 16 bits. */
enum { MOST_RECORD = 1 << 16 };

/* ---- state ---- */

/* Data of the current element. */
typedef struct element {
  uint32_t type;
  int32_t layer, datatype; /* -1 if not given */
  int32_t width, begin, end;
  uint32_t ends;
  uint32_t columns, rows;
  uint32_t transform;
  double magnification, angle;
  int32_t property; /* number of the property whose value follows, or -1 */
  int named;        /* source of `instance`: 0 none, 1 the first property, 2
                       property 61 */
  eda_point *points;
  size_t n, capacity;
  char *name, *string,
      *instance; /* placed cell, text, instance name; or NULL */
} element;

/* State of the reader. */
typedef struct gds {
  reading b;
  size_t at, next; /* place of the current record, for errors; place of the next
                      record */
  uint32_t type;   /* type of the current record */
  const uint8_t *data; /* n bytes of data of the record, n even; valid until
                          the next record */
  size_t n;
  size_t apart; /* instances so far that replace arrays (MAX_APART) */
  int absolute; /* 1: a placement has an absolute angle or magnification */
  element e;
} gds;

/* ---- work: records ---- */

static void gds_refuse(void *self, const char *what) {
  gds *g = self;
  if (g->b.failed) return;
  g->b.failed = opc_fail(g->b.error, OPC_IO, NULL, "'%s': %s at byte %zu",
                         g->b.r->file, what, g->at);
}

/* Read the header of the next record. Return 0 on failure. */
static int gds_next(gds *g) {
  size_t left;
  const uint8_t *p = reading_view(&g->b, g->next, MOST_RECORD, &left);
  size_t length = left < 4 ? 4 : eda_gds_u16(p);
  g->at = g->next;
  if (!left)
    gds_refuse(g, "ends before ENDLIB,");
  else if (!g->at && (left < 4 || p[2] != EDA_GDS_HEADER))
    gds_refuse(g, "not a GDSII file: no HEADER");
  else if (length < 4 || length % 2)
    gds_refuse(g, "impossible record length");
  else if (left < length)
    gds_refuse(g, "truncated record");
  if (!reading_goes_on(&g->b, g->at, 1)) return 0;
  g->type = p[2];
  g->data = p + 4;
  g->n = length - 4;
  g->next += length;
  return 1;
}

/* Return the record's data. Fail and return zeros if the data have fewer than
   `bytes` bytes. */
static const uint8_t *record_data(gds *g, size_t bytes) {
  static const uint8_t zeros[16];
  if (g->n >= bytes) return g->data;
  gds_refuse(g, "record too short for its kind");
  return zeros;
}

/* Store the record's string without padding zeros. */
static void gds_take_string(gds *g, char **out) {
  while (g->n && g->data[g->n - 1] == 0) g->n--;
  g_free(*out);
  *out = reader_string(g->data, g->n);
}

/* ---- work: elements ---- */

static void take_points(gds *g) {
  element *e = &g->e;
  if (g->n % 8) gds_refuse(g, "incomplete point");
  eda_grow(&e->points, &e->capacity, e->n + g->n / 8, sizeof *e->points);
  for (size_t i = 0; i < g->n / 8; i++)
    e->points[e->n++] = (eda_point){eda_gds_i32(g->data + 8 * i),
                                    eda_gds_i32(g->data + 8 * i + 4)};
}

/* Read the value of a property. Property 61, or else the first property, is the
   name of an instance. */
static void take_property(gds *g) {
  element *e = &g->e;
  int rank = e->property == EDA_GDS_INSTANCE_NAME ? 2 : 1;
  if (e->property < 0) gds_refuse(g, "PROPVALUE without PROPATTR");
  e->property = -1;
  if ((e->type != EDA_GDS_SREF && e->type != EDA_GDS_AREF) || e->named >= rank)
    return;
  e->named = rank;
  gds_take_string(g, &e->instance);
}

/* Take a record of an element other than ENDEL. */
static void take_record(gds *g) {
  element *e = &g->e;
  switch (g->type) {
    case EDA_GDS_XY:
      take_points(g);
      break;
    case EDA_GDS_LAYER:
      e->layer = (int32_t)eda_gds_u16(record_data(g, 2));
      break;
    case EDA_GDS_DATATYPE:
    case EDA_GDS_TEXTTYPE:
    case EDA_GDS_BOXTYPE:
    case EDA_GDS_NODETYPE:
      e->datatype = (int32_t)eda_gds_u16(record_data(g, 2));
      break;
    case EDA_GDS_WIDTH:
      e->width = eda_gds_i32(record_data(g, 4));
      break;
    case EDA_GDS_BGNEXTN:
      e->begin = eda_gds_i32(record_data(g, 4));
      break;
    case EDA_GDS_ENDEXTN:
      e->end = eda_gds_i32(record_data(g, 4));
      break;
    case EDA_GDS_PATHTYPE:
      e->ends = eda_gds_u16(record_data(g, 2));
      if (e->ends > 4 || e->ends == 3) gds_refuse(g, "unknown PATHTYPE");
      break;
    case EDA_GDS_SNAME:
      gds_take_string(g, &e->name);
      break;
    case EDA_GDS_STRING:
      gds_take_string(g, &e->string);
      break;
    case EDA_GDS_COLROW:
      e->columns = eda_gds_u16(record_data(g, 4));
      e->rows = eda_gds_u16(record_data(g, 4) + 2);
      break;
    case EDA_GDS_STRANS:
      e->transform = eda_gds_u16(record_data(g, 2));
      break;
    case EDA_GDS_MAG:
      e->magnification = eda_gds_real(record_data(g, 8));
      break;
    case EDA_GDS_ANGLE:
      e->angle = eda_gds_real(record_data(g, 8));
      break;
    case EDA_GDS_PROPATTR:
      e->property = (int32_t)eda_gds_u16(record_data(g, 2));
      break;
    case EDA_GDS_PROPVALUE:
      take_property(g);
      break;
    case EDA_GDS_ELFLAGS:
    case EDA_GDS_PLEX:
    case EDA_GDS_PRESENTATION:
    case EDA_GDS_STRTYPE:
    case EDA_GDS_ELKEY:
      break;
    default:
      gds_refuse(g, "unexpected record");
  }
}

static void add_shape(gds *g) {
  element *e = &g->e;
  reading *b = &g->b;
  if (e->layer < 0 || e->datatype < 0) {
    gds_refuse(g, "element without layer or datatype");
    return;
  }
  int32_t layer =
      reading_numbered_layer(b, (uint32_t)e->layer, (uint32_t)e->datatype);
  const eda_point *p = e->points;
  size_t n = e->n;
  int code = OPC_OK;
  if (layer < 0) return;
  if (e->type == EDA_GDS_PATH) {
    int32_t width = e->width == INT32_MIN ? INT32_MAX : abs(e->width);
    if (!n)
      gds_refuse(g, "PATH without points");
    else
      code =
          eda_layout_add_path(b->layout, b->cell, layer, p, n, width,
                              (int)e->ends, e->begin, e->end, &b->layout_error);
  } else if (e->type == EDA_GDS_TEXT) {
    if (!n || !e->string)
      gds_refuse(g, "incomplete TEXT");
    else
      code = eda_layout_add_text(b->layout, b->cell, layer, p[0], e->string,
                                 &b->layout_error);
  } else if (!n) {
    gds_refuse(g, "polygon without points");
  } else {
    if (n > 1 && p[0].x == p[n - 1].x && p[0].y == p[n - 1].y) n--;
    if (n >= 3) /* fewer points have no area */
      code = eda_layout_add_polygon(b->layout, b->cell, layer, p, n,
                                    &b->layout_error);
  }
  reading_check(b, code);
}

/* ---- work: placements ---- */

static int put_instance(gds *g, int32_t child, const eda_placement *p) {
  return reading_check(
      &g->b, eda_layout_add_instance(g->b.layout, g->b.cell, child, p,
                                     g->e.instance, &g->b.layout_error));
}

/* Divide (x, y) into `count` steps of an array; 1 if both are integers. */
static int step_divide(int64_t x, int64_t y, uint32_t count, eda_point *step) {
  *step = (eda_point){(int32_t)(x / count), (int32_t)(y / count)};
  return x % count == 0 && y % count == 0;
}

/* Return i * length / count, rounded to a unit. */
static int64_t step_part(int64_t length, uint32_t i, uint32_t count) {
  return (int64_t)floor((double)length * i / count + 0.5);
}

/* Expand an array whose steps are not all integers: columns, rows or both
   become single placements, rounded to the nearest unit. */
static void add_apart(gds *g, int32_t child, eda_placement p,
                      const int64_t to[4], const int whole[2]) {
  uint32_t full_columns = p.columns, full_rows = p.rows;
  uint32_t columns = whole[0] ? 1 : full_columns;
  uint32_t rows = whole[1] ? 1 : full_rows;
  eda_point origin = p.origin;
  size_t name = g->e.instance ? strlen(g->e.instance) : 0;
  g->apart += (size_t)columns * rows * (1 + name / 64);
  if (g->apart > MAX_APART) {
    gds_refuse(g,
               "too many arrays with steps that are no multiple of the unit, "
               "the last");
    return;
  }
  if (!whole[0]) p.columns = 1;
  if (!whole[1]) p.rows = 1;
  for (uint32_t j = 0; j < rows; j++)
    for (uint32_t i = 0; i < columns; i++) {
      int64_t x = origin.x + step_part(to[0], i, full_columns) +
                  step_part(to[2], j, full_rows);
      int64_t y = origin.y + step_part(to[1], i, full_columns) +
                  step_part(to[3], j, full_rows);
      if (x != (int32_t)x || y != (int32_t)y)
        gds_refuse(g, "an array leaves the range of coordinates");
      p.origin = (eda_point){(int32_t)x, (int32_t)y};
      if (g->b.failed || !put_instance(g, child, &p)) return;
    }
}

static void add_array(gds *g, int32_t child, eda_placement p) {
  const eda_point *o = g->e.points;
  int64_t to[4] = {(int64_t)o[1].x - o[0].x, (int64_t)o[1].y - o[0].y,
                   (int64_t)o[2].x - o[0].x, (int64_t)o[2].y - o[0].y};
  p.columns = g->e.columns ? g->e.columns : 1;
  p.rows = g->e.rows ? g->e.rows : 1;
  for (int i = 0; i < 4; i++)
    if (to[i] != (int32_t)to[i])
      gds_refuse(g, "an array leaves the range of coordinates");
  if (g->b.failed) return;
  int whole[2] = {step_divide(to[0], to[1], p.columns, &p.column_step),
                  step_divide(to[2], to[3], p.rows, &p.row_step)};
  if (whole[0] && whole[1])
    put_instance(g, child, &p);
  else
    add_apart(g, child, p, to, whole);
}

static void add_placement(gds *g) {
  element *e = &g->e;
  if (!e->name || e->n < (e->type == EDA_GDS_AREF ? 3 : 1))
    gds_refuse(g, "incomplete placement");
  else if (!(e->magnification > 0))
    gds_refuse(g, "placement with an impossible MAG");
  if (g->b.failed) return;
  int32_t child = reading_number(
      &g->b, eda_layout_cell(g->b.layout, e->name, &g->b.layout_error));
  if (child < 0) return;
  if (e->transform & 6) g->absolute = 1;
  eda_placement p = {.origin = e->points[0],
                     .magnification = e->magnification,
                     .angle = e->angle,
                     .mirror = e->transform >> 15 & 1,
                     .columns = 1,
                     .rows = 1};
  if (e->type == EDA_GDS_AREF)
    add_array(g, child, p);
  else
    put_instance(g, child, &p);
}

/* ---- work: cells and the library ---- */

/* Reset the data of an element; most elements have no strings. */
static void element_clear(element *e) {
  if (e->name) g_free(e->name);
  if (e->string) g_free(e->string);
  if (e->instance) g_free(e->instance);
  *e = (element){.layer = -1,
                 .datatype = -1,
                 .magnification = 1,
                 .property = -1,
                 .points = e->points,
                 .capacity = e->capacity};
}

/* Read an element after its first record, up to ENDEL. */
static void gds_read_element(gds *g) {
  size_t at = g->at;
  element_clear(&g->e);
  g->e.type = g->type;
  while (gds_next(g) && g->type != EDA_GDS_ENDEL) take_record(g);
  if (g->b.failed) return;
  g->at = at;
  if (g->e.type == EDA_GDS_NODE || g->b.cell < 0) return;
  if (g->e.type == EDA_GDS_SREF || g->e.type == EDA_GDS_AREF)
    add_placement(g);
  else
    add_shape(g);
}

static void gds_read_cell(gds *g) {
  if (!g->b.layout) gds_refuse(g, "BGNSTR before UNITS");
  if (!gds_next(g)) return;
  if (g->type != EDA_GDS_STRNAME) {
    gds_refuse(g, "BGNSTR without STRNAME");
    return;
  }
  gds_take_string(g, &g->e.name);
  reading_begin_cell(&g->b, g->e.name);
  while (gds_next(g) && g->type != EDA_GDS_ENDSTR) switch (g->type) {
      case EDA_GDS_STRCLASS:
        break;
      case EDA_GDS_BOUNDARY:
      case EDA_GDS_PATH:
      case EDA_GDS_SREF:
      case EDA_GDS_AREF:
      case EDA_GDS_TEXT:
      case EDA_GDS_NODE:
      case EDA_GDS_BOX:
        gds_read_element(g);
        break;
      default:
        gds_refuse(g, "unexpected record");
    }
}

/* Take the units; the second number is the unit in metres. Rounding to 14
   digits removes the error of the base-16 representation. */
static void take_units(gds *g) {
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g",
           eda_gds_real(record_data(g, 16) + 8) * 1e9);
  double unit = strtod(digits, NULL);
  if (g->b.layout)
    gds_refuse(g, "UNITS a second time");
  else if (!(unit > 0))
    gds_refuse(g, "impossible UNITS");
  if (g->b.failed) return;
  g->b.layout = eda_layout_new(unit * g->b.r->scale, &g->b.layout_error);
  reading_check(&g->b, g->b.layout ? OPC_OK : g->b.layout_error.code);
}

static void gds_read_library(void *self) {
  gds *g = self;
  if (gds_next(g) && g->n != 2) gds_refuse(g, "not a GDSII file: no HEADER");
  /* Bytes after ENDLIB fill the last block of a tape. */
  while (gds_next(g) && g->type != EDA_GDS_ENDLIB) switch (g->type) {
      case EDA_GDS_UNITS:
        take_units(g);
        break;
      case EDA_GDS_BGNSTR:
        gds_read_cell(g);
        break;
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
        gds_refuse(g, "unexpected record");
    }
  if (!g->b.layout) gds_refuse(g, "ENDLIB before UNITS");
  if (g->absolute)
    g->b.r->host->log(
        g->b.r->host, OPC_LOG_WARNING,
        "'%s': absolute angles or magnifications are read as relative",
        g->b.r->file);
}

static int gds_run(void *self, void **outputs, opc_error *error) {
  gds g = {.b.format = "GDSII", .b.refuse = gds_refuse};
  int code = reading_run(&g, self, outputs, error, gds_read_library);
  element_clear(&g.e);
  free(g.e.points);
  return code;
}

/* ---- entry ---- */

READER_FUNCTIONS(gds_run, UINT16_MAX, "The GDSII file",
                 "Layer names, as in { poly: 9/0 }, or { poly: 9 } for every "
                 "datatype; other layers are named by their numbers, as in 9/0")

OPC_PLUGIN(reader, .id = "read.gds", .summary = "Read a GDSII file",
           READER_ENTRY);
