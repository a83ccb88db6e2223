/* SPDX-License-Identifier: BSD-3-Clause */
/* Rectangles, polygons, paths, trapezoids, circles (SEMI P39, sections 25 to
   30). */
#include <eda/memory.h>
#include <math.h>

#include "oasis.h"

#define PI 3.14159265358979323846

enum { SIDES = 64 }; /* of the polygon that a circle becomes */

/* Bits of the byte that says what a record tells. */
enum {
  LAYER = 1,
  DATATYPE = 2,
  REPEATED = 4,
  SECOND = 32,
  FIRST = 64,
  TOP = 128
};

static void read_layer(oasis *o, uint32_t info) {
  if (info & LAYER) {
    o->m.layer = oasis_uint32(&o->s, "a layer beyond 32 bits");
    o->m.has |= HAS_LAYER;
  }
  if (info & DATATYPE) {
    o->m.datatype = oasis_uint32(&o->s, "a datatype beyond 32 bits");
    o->m.has |= HAS_DATATYPE;
  }
}

static int64_t read_size(oasis *o, uint32_t has) {
  uint64_t v = oasis_uint(&o->s);
  if (v > (uint64_t)1 << 32) oasis_refuse(&o->s, "a size beyond 32 bits");
  o->m.has |= has;
  return (int64_t)v;
}

static void read_sizes(oasis *o, uint32_t info) {
  if (info & FIRST) o->m.width = read_size(o, HAS_WIDTH);
  if (info & SECOND) o->m.height = read_size(o, HAS_HEIGHT);
}

/* The end of every record of a shape: its place, its repetition. Whether there
   is a shape to add, on *layer. */
static int read_rest(oasis *o, uint32_t info, int32_t *layer) {
  oasis_read_place(o, info, &o->m.x, &o->m.y);
  if (info & REPEATED) oasis_read_repetition(o);
  if (!oasis_need(o, HAS_LAYER, "a shape without a layer") ||
      !oasis_need(o, HAS_DATATYPE, "a shape without a datatype"))
    return 0;
  if (o->naming || o->cell < 0) return 0;
  *layer = layer_map_find(&o->layers, o->layout, o->m.layer, o->m.datatype,
                          o->error);
  return oasis_told(o, *layer < 0 ? o->error->code : OPC_OK);
}

static oasis_vector moved(const oasis *o, int repeated, uint64_t i) {
  oasis_vector d = {0, 0};
  if (repeated) d = oasis_member(&o->m.repetition, i);
  return (oasis_vector){d.x + o->m.x, d.y + o->m.y};
}

static void add_boxes(oasis *o, int repeated, int32_t layer) {
  uint64_t n = repeated ? oasis_members(&o->m.repetition) : 1;
  oasis_vector size = {o->m.width, o->m.height};
  if (!oasis_spend(o, n, 4) ||
      !oasis_fits(o, repeated, (oasis_vector){0, 0}, size))
    return;
  for (uint64_t i = 0; i < n; i++) {
    oasis_vector at = moved(o, repeated, i);
    eda_box box = {(int32_t)at.x, (int32_t)at.y, (int32_t)(at.x + size.x),
                   (int32_t)(at.y + size.y)};
    if (!oasis_told(
            o, eda_layout_add_box(o->layout, o->cell, layer, box, o->error)))
      return;
  }
}

/* A polygon, or a path where `path`, with its members. */
static void add_points(oasis *o, int repeated, int32_t layer,
                       const oasis_vector *p, size_t n, int path) {
  oasis_vector low = p[0], high = p[0];
  for (size_t i = 1; i < n; i++) {
    if (p[i].x < low.x) low.x = p[i].x;
    if (p[i].y < low.y) low.y = p[i].y;
    if (p[i].x > high.x) high.x = p[i].x;
    if (p[i].y > high.y) high.y = p[i].y;
  }
  uint64_t members = repeated ? oasis_members(&o->m.repetition) : 1;
  if (!oasis_spend(o, members, path ? 4 * n : n) ||
      !oasis_fits(o, repeated, low, high))
    return;
  eda_grow(&o->points, &o->room_points, n, sizeof *o->points);
  for (uint64_t i = 0; i < members; i++) {
    oasis_vector at = moved(o, repeated, i);
    for (size_t k = 0; k < n; k++)
      o->points[k] =
          (eda_point){(int32_t)(at.x + p[k].x), (int32_t)(at.y + p[k].y)};
    int code = path ? eda_layout_add_path(o->layout, o->cell, layer, o->points,
                                          n, (int32_t)(2 * o->m.halfwidth), 4,
                                          (int32_t)o->m.begin,
                                          (int32_t)o->m.end, o->error)
                    : eda_layout_add_polygon(o->layout, o->cell, layer,
                                             o->points, n, o->error);
    if (!oasis_told(o, code)) return;
  }
}

void oasis_read_rectangle(oasis *o) {
  uint32_t info = oasis_byte(&o->s);
  int32_t layer;
  read_layer(o, info);
  read_sizes(o, info);
  if (info & TOP) { /* a square */
    if (info & SECOND) oasis_refuse(&o->s, "a square with a height");
    o->m.height = o->m.width;
    o->m.has |= o->m.has & HAS_WIDTH ? HAS_HEIGHT : 0;
  }
  if (!read_rest(o, info, &layer) ||
      !oasis_need(o, HAS_WIDTH, "a rectangle without a width") ||
      !oasis_need(o, HAS_HEIGHT, "a rectangle without a height"))
    return;
  add_boxes(o, info & REPEATED, layer);
}

void oasis_read_polygon(oasis *o) {
  uint32_t info = oasis_byte(&o->s);
  int32_t layer;
  read_layer(o, info);
  if (info & SECOND) {
    oasis_read_points(&o->s, &o->m.polygon, 1);
    o->m.has |= HAS_POLYGON;
  }
  if (!read_rest(o, info, &layer) ||
      !oasis_need(o, HAS_POLYGON, "a polygon without points"))
    return;
  if (o->m.polygon.n >= 3) /* others have no area */
    add_points(o, info & REPEATED, layer, o->m.polygon.p, o->m.polygon.n, 0);
}

/* How far a path goes past its end: 0 as before, 1 not at all, 2 half a width,
   3 what follows. */
static void read_extension(oasis *o, uint64_t scheme, uint32_t has,
                           int64_t *out) {
  if (scheme == 1) *out = 0;
  if (scheme == 2) *out = o->m.halfwidth;
  if (scheme == 3) {
    *out = oasis_sint(&o->s);
    if (*out < INT32_MIN || *out > INT32_MAX)
      oasis_refuse(&o->s, "a path's extension beyond 32 bits");
  }
  if (scheme) o->m.has |= has;
}

void oasis_read_path(oasis *o) {
  uint32_t info = oasis_byte(&o->s);
  int32_t layer;
  read_layer(o, info);
  if (info & FIRST) {
    o->m.halfwidth = read_size(o, HAS_HALFWIDTH);
    if (o->m.halfwidth > INT32_MAX / 2)
      oasis_refuse(&o->s, "a path's width beyond 32 bits");
  }
  if (info & TOP) {
    uint64_t scheme = oasis_uint(&o->s);
    if ((scheme >> 2 == 2 || (scheme & 3) == 2) &&
        !oasis_need(o, HAS_HALFWIDTH, "a path without a width"))
      return;
    read_extension(o, scheme >> 2 & 3, HAS_BEGIN, &o->m.begin);
    read_extension(o, scheme & 3, HAS_END, &o->m.end);
  }
  if (info & SECOND) {
    oasis_read_points(&o->s, &o->m.path, 0);
    o->m.has |= HAS_PATH;
  }
  if (!read_rest(o, info, &layer) ||
      !oasis_need(o, HAS_HALFWIDTH, "a path without a width") ||
      !oasis_need(o, HAS_BEGIN, "a path without a start extension") ||
      !oasis_need(o, HAS_END, "a path without an end extension") ||
      !oasis_need(o, HAS_PATH, "a path without points"))
    return;
  add_points(o, info & REPEATED, layer, o->m.path.p, o->m.path.n, 1);
}

/* The corners that differ from those before them. */
static void add_corners(oasis *o, int repeated, int32_t layer,
                        const oasis_vector corner[4]) {
  oasis_vector p[4];
  size_t n = 0;
  for (size_t i = 0; i < 4; i++) {
    oasis_vector before = corner[(i + 3) % 4];
    if (corner[i].x != before.x || corner[i].y != before.y) p[n++] = corner[i];
  }
  if (n >= 3) add_points(o, repeated, layer, p, n, 0);
}

void oasis_read_trapezoid(oasis *o, uint64_t record) {
  oasis_stream *s = &o->s;
  uint32_t info = oasis_byte(s);
  int32_t layer;
  int64_t a = 0, b = 0;
  read_layer(o, info);
  read_sizes(o, info);
  if (record != EDA_OASIS_TRAPEZOID_B) a = oasis_length(s, oasis_sint(s));
  if (record != EDA_OASIS_TRAPEZOID_A) b = oasis_length(s, oasis_sint(s));
  if (!read_rest(o, info, &layer) ||
      !oasis_need(o, HAS_WIDTH, "a trapezoid without a width") ||
      !oasis_need(o, HAS_HEIGHT, "a trapezoid without a height"))
    return;
  int64_t w = o->m.width, h = o->m.height;
  int64_t a0 = a < 0 ? -a : 0, a1 = a > 0 ? a : 0;
  int64_t b0 = b < 0 ? -b : 0, b1 = b > 0 ? b : 0;
  int64_t room = info & TOP ? h : w; /* of the parallel sides */
  if (a0 + b1 > room || a1 + b0 > room) {
    oasis_refuse(s, "a trapezoid whose sides cross");
    return;
  }
  oasis_vector flat[4] = {{a0, 0}, {w - b1, 0}, {w - b0, h}, {a1, h}};
  oasis_vector upright[4] = {{0, a1}, {w, a0}, {w, h - b1}, {0, h - b0}};
  add_corners(o, info & REPEATED, layer, info & TOP ? upright : flat);
}

/* Corners of the compact trapezoids: x and y as multiples of width and height,
   {xw, xh, yw, yh}, counter-clockwise. */
static const int8_t compact[26][4][4] = {
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, -1, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, -1, 0, 0}, {1, 0, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 1}, {0, 1, 0, 1}},
    {{0, 1, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, -1, 0, 1}, {0, 1, 0, 1}},
    {{0, 1, 0, 0}, {1, -1, 0, 0}, {1, 0, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, -1, 0, 0}, {1, 0, 0, 1}, {0, 1, 0, 1}},
    {{0, 1, 0, 0}, {1, 0, 0, 0}, {1, -1, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, -1, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 1}, {0, 0, -1, 1}},
    {{0, 0, 0, 0}, {1, 0, 1, 0}, {1, 0, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 1, 0}, {1, 0, 0, 0}, {1, 0, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 1, 0}, {1, 0, -1, 1}, {0, 0, 0, 1}},
    {{0, 0, 1, 0}, {1, 0, 0, 0}, {1, 0, 0, 1}, {0, 0, -1, 1}},
    {{0, 0, 0, 0}, {1, 0, 1, 0}, {1, 0, 0, 1}, {0, 0, -1, 1}},
    {{0, 0, 1, 0}, {1, 0, 0, 0}, {1, 0, -1, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 0}},
    {{0, 0, 0, 0}, {1, 0, 1, 0}, {0, 0, 1, 0}, {0, 0, 0, 0}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 1, 0}, {0, 0, 0, 0}},
    {{0, 0, 1, 0}, {1, 0, 0, 0}, {1, 0, 1, 0}, {0, 0, 1, 0}},
    {{0, 0, 0, 0}, {0, 2, 0, 0}, {0, 1, 0, 1}, {0, 0, 0, 0}},
    {{0, 0, 0, 1}, {0, 1, 0, 0}, {0, 2, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 1, 0}, {0, 0, 2, 0}, {0, 0, 0, 0}},
    {{0, 0, 1, 0}, {1, 0, 0, 0}, {1, 0, 2, 0}, {0, 0, 1, 0}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 0, 1}, {0, 0, 0, 1}},
    {{0, 0, 0, 0}, {1, 0, 0, 0}, {1, 0, 1, 0}, {0, 0, 1, 0}},
};

/* The sizes that a kind leaves out follow from the other one. */
static int complete_sizes(oasis *o) {
  uint32_t type = o->m.ctrapezoid;
  if (type == 20 || type == 21) {
    if (!oasis_need(o, HAS_HEIGHT, "a trapezoid without a height")) return 0;
    o->m.width = 2 * o->m.height;
  } else {
    if (!oasis_need(o, HAS_WIDTH, "a trapezoid without a width")) return 0;
    if ((type >= 16 && type <= 19) || type == 25) o->m.height = o->m.width;
    if (type == 22 || type == 23) o->m.height = 2 * o->m.width;
  }
  if (type >= 16 && type != 24) o->m.has |= HAS_WIDTH | HAS_HEIGHT;
  return oasis_need(o, HAS_HEIGHT, "a trapezoid without a height");
}

void oasis_read_ctrapezoid(oasis *o) {
  oasis_stream *s = &o->s;
  uint32_t info = oasis_byte(s);
  int32_t layer;
  read_layer(o, info);
  if (info & TOP) {
    uint64_t type = oasis_uint(s);
    if (type > 25) oasis_refuse(s, "an unknown kind of trapezoid");
    o->m.ctrapezoid = type > 25 ? 0 : (uint32_t)type;
    o->m.has |= HAS_CTRAPEZOID;
  }
  read_sizes(o, info);
  if (!oasis_need(o, HAS_CTRAPEZOID, "a trapezoid of no kind") ||
      !complete_sizes(o) || !read_rest(o, info, &layer))
    return;
  uint32_t type = o->m.ctrapezoid;
  int64_t w = o->m.width, h = o->m.height;
  if ((type < 4 && w < h) || (type >= 4 && type < 8 && w < 2 * h) ||
      (type >= 8 && type < 12 && h < w) ||
      (type >= 12 && type < 16 && h < 2 * w)) {
    oasis_refuse(s, "a trapezoid whose sides cross");
    return;
  }
  if (type >= 24) {
    add_boxes(o, info & REPEATED, layer);
    return;
  }
  oasis_vector corner[4];
  for (int i = 0; i < 4; i++) {
    const int8_t *k = compact[type][i];
    corner[i] = (oasis_vector){k[0] * w + k[1] * h, k[2] * w + k[3] * h};
  }
  add_corners(o, info & REPEATED, layer, corner);
}

void oasis_read_circle(oasis *o) {
  uint32_t info = oasis_byte(&o->s);
  int32_t layer;
  read_layer(o, info);
  if (info & SECOND) o->m.radius = read_size(o, HAS_RADIUS);
  if (!read_rest(o, info, &layer) ||
      !oasis_need(o, HAS_RADIUS, "a circle without a radius") ||
      o->m.radius == 0)
    return;
  oasis_vector corner[SIDES];
  for (int i = 0; i < SIDES; i++) {
    double angle = 2 * PI * i / SIDES, r = (double)o->m.radius;
    corner[i] = (oasis_vector){(int64_t)floor(r * cos(angle) + 0.5),
                               (int64_t)floor(r * sin(angle) + 0.5)};
  }
  add_points(o, info & REPEATED, layer, corner, SIDES, 0);
}

/* What it means is not known; the modal variables are. */
void oasis_read_xgeometry(oasis *o) {
  uint32_t info = oasis_byte(&o->s);
  oasis_uint(&o->s);
  read_layer(o, info);
  oasis_skip_string(&o->s);
  oasis_read_place(o, info, &o->m.x, &o->m.y);
  if (info & REPEATED) oasis_read_repetition(o);
}
