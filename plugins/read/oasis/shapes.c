/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements rectangles, polygons, paths, trapezoids and circles (SEMI P39,
   sections 25 to 30). */
#include <eda/memory.h>
#include <math.h>

#include "oasis.h"

#define PI 3.14159265358979323846

enum { SIDES = 64 }; /* corners of the polygon of a circle */

/* Bits of the information byte of a shape, except those for layer, datatype, x
   and y. REPEATED: a repetition follows; FIRST, SECOND: the first or second
   size or list is in the record; TOP: depends on the shape. */
enum { REPEATED = 4, SECOND = 32, FIRST = 64, TOP = 128 };

static void read_layer(oasis *o, uint32_t info) {
  oasis_read_layer(o, info, HAS_LAYER, &o->m.layer, &o->m.datatype);
}

static int64_t read_size(oasis *o, uint32_t has) {
  uint64_t v = oasis_uint(o);
  if (v > (uint64_t)1 << 32) oasis_refuse(o, "a size beyond 32 bits");
  o->m.has |= has;
  return (int64_t)v;
}

static void read_sizes(oasis *o, uint32_t info) {
  if (info & FIRST) o->m.width = read_size(o, HAS_WIDTH);
  if (info & SECOND) o->m.height = read_size(o, HAS_HEIGHT);
}

/* Read the place and repetition at the end of a shape's record. Return 1 if the
   shape `what`, which needs the modal variables `has`, is to be drawn. */
static int shape_read_end(oasis *o, uint32_t info, const char *what,
                          uint32_t has) {
  oasis_read_place(o, info, &o->m.x, &o->m.y);
  if (info & REPEATED) oasis_read_repetition(o);
  return oasis_need(o, "a shape", HAS_LAYER | HAS_DATATYPE) && !o->naming &&
         o->b.cell >= 0 && oasis_need(o, what, has);
}

/* Return 1 if all members of a shape with these corners are within the range of
   coordinates. */
static int shape_fits(oasis *o, int repeated, oasis_vector low,
                      oasis_vector high) {
  const oasis_modal *m = &o->m;
  oasis_vector zero = {0, 0};
  oasis_vector first = repeated ? m->repetition.low : zero;
  oasis_vector last = repeated ? m->repetition.high : zero;
  if (m->x + first.x + low.x < INT32_MIN ||
      m->y + first.y + low.y < INT32_MIN ||
      m->x + last.x + high.x > INT32_MAX || m->y + last.y + high.y > INT32_MAX)
    oasis_refuse(o, "a coordinate beyond 32 bits");
  return !o->b.failed;
}

/* Add a polygon (`path` 0) or a path (`path` 1) with all members of the
   repetition. */
static void add_points(oasis *o, int repeated, const oasis_vector *p, size_t n,
                       int path) {
  reading *b = &o->b;
  oasis_vector low = p[0], high = p[0];
  for (size_t i = 1; i < n; i++) {
    low = (oasis_vector){MIN(low.x, p[i].x), MIN(low.y, p[i].y)};
    high = (oasis_vector){MAX(high.x, p[i].x), MAX(high.y, p[i].y)};
  }
  uint64_t members = oasis_members(o, repeated);
  int32_t layer = reading_numbered_layer(b, o->m.layer, o->m.datatype);
  if (layer < 0 || !oasis_spend(o, members, path ? 4 * n : n) ||
      !shape_fits(o, repeated, low, high))
    return;
  eda_grow(&o->points, &o->capacity_points, n, sizeof *o->points);
  for (uint64_t i = 0; i < members && !b->failed; i++) {
    oasis_vector at = oasis_member(o, repeated, i);
    for (size_t k = 0; k < n; k++)
      o->points[k] = (eda_point){(int32_t)(o->m.x + at.x + p[k].x),
                                 (int32_t)(o->m.y + at.y + p[k].y)};
    int code = path ? eda_layout_add_path(b->layout, b->cell, layer, o->points,
                                          n, (int32_t)(2 * o->m.halfwidth), 4,
                                          (int32_t)o->m.begin,
                                          (int32_t)o->m.end, &b->layout_error)
                    : eda_layout_add_polygon(b->layout, b->cell, layer,
                                             o->points, n, &b->layout_error);
    reading_check(b, code);
  }
}

static void add_box(oasis *o, int repeated) {
  int64_t w = o->m.width, h = o->m.height;
  const oasis_vector corner[4] = {{0, 0}, {w, 0}, {w, h}, {0, h}};
  add_points(o, repeated, corner, 4, 0);
}

void oasis_read_rectangle(oasis *o) {
  uint32_t info = oasis_byte(o);
  read_layer(o, info);
  read_sizes(o, info);
  if (info & TOP) { /* a square */
    if (info & SECOND) oasis_refuse(o, "a square with a height");
    o->m.height = o->m.width;
    o->m.has |= o->m.has & HAS_WIDTH ? HAS_HEIGHT : 0;
  }
  if (shape_read_end(o, info, "a rectangle", HAS_WIDTH | HAS_HEIGHT))
    add_box(o, info & REPEATED);
}

void oasis_read_polygon(oasis *o) {
  uint32_t info = oasis_byte(o);
  read_layer(o, info);
  if (info & SECOND) {
    oasis_read_points(o, &o->m.polygon, 1);
    o->m.has |= HAS_POLYGON;
  }
  if (shape_read_end(o, info, "a polygon", HAS_POLYGON) &&
      o->m.polygon.n >= 3) /* fewer points have no area */
    add_points(o, info & REPEATED, o->m.polygon.p, o->m.polygon.n, 0);
}

/* Read the extension of a path at one end. Scheme 0: unchanged, 1: none, 2:
   half the width, 3: explicit. */
static void read_extension(oasis *o, uint64_t scheme, uint32_t has,
                           int64_t *out) {
  if (scheme == 1) *out = 0;
  if (scheme == 2) *out = o->m.halfwidth;
  if (scheme == 3) {
    *out = oasis_sint(o);
    if (*out < INT32_MIN || *out > INT32_MAX)
      oasis_refuse(o, "a path's extension beyond 32 bits");
  }
  if (scheme) o->m.has |= has;
}

void oasis_read_path(oasis *o) {
  uint32_t info = oasis_byte(o);
  read_layer(o, info);
  if (info & FIRST) {
    o->m.halfwidth = read_size(o, HAS_HALFWIDTH);
    if (o->m.halfwidth > INT32_MAX / 2)
      oasis_refuse(o, "a path's width beyond 32 bits");
  }
  if (info & TOP) {
    uint64_t scheme = oasis_uint(o);
    if ((scheme >> 2 == 2 || (scheme & 3) == 2) &&
        !oasis_need(o, "a path", HAS_HALFWIDTH))
      return;
    read_extension(o, scheme >> 2 & 3, HAS_BEGIN, &o->m.begin);
    read_extension(o, scheme & 3, HAS_END, &o->m.end);
  }
  if (info & SECOND) {
    oasis_read_points(o, &o->m.path, 0);
    o->m.has |= HAS_PATH;
  }
  if (shape_read_end(o, info, "a path",
                     HAS_HALFWIDTH | HAS_BEGIN | HAS_END | HAS_PATH))
    add_points(o, info & REPEATED, o->m.path.p, o->m.path.n, 1);
}

/* Add a polygon of the corners that differ from the preceding corner. */
static void add_corners(oasis *o, int repeated, const oasis_vector corner[4]) {
  oasis_vector p[4];
  size_t n = 0;
  for (size_t i = 0; i < 4; i++) {
    oasis_vector before = corner[(i + 3) % 4];
    if (corner[i].x != before.x || corner[i].y != before.y) p[n++] = corner[i];
  }
  if (n >= 3) add_points(o, repeated, p, n, 0);
}

void oasis_read_trapezoid(oasis *o, uint64_t record) {
  uint32_t info = oasis_byte(o);
  int64_t a = 0, b = 0;
  read_layer(o, info);
  read_sizes(o, info);
  if (record != EDA_OASIS_TRAPEZOID_B) a = oasis_length(o, oasis_sint(o));
  if (record != EDA_OASIS_TRAPEZOID_A) b = oasis_length(o, oasis_sint(o));
  if (!shape_read_end(o, info, "a trapezoid", HAS_WIDTH | HAS_HEIGHT)) return;
  int64_t w = o->m.width, h = o->m.height;
  int64_t a0 = a < 0 ? -a : 0, a1 = a > 0 ? a : 0;
  int64_t b0 = b < 0 ? -b : 0, b1 = b > 0 ? b : 0;
  int64_t side = info & TOP ? h : w; /* length of the parallel sides */
  if (a0 + b1 > side || a1 + b0 > side) {
    oasis_refuse(o, "a trapezoid whose sides cross");
    return;
  }
  oasis_vector flat[4] = {{a0, 0}, {w - b1, 0}, {w - b0, h}, {a1, h}};
  oasis_vector upright[4] = {{0, a1}, {w, a0}, {w, h - b1}, {0, h - b0}};
  add_corners(o, info & REPEATED, info & TOP ? upright : flat);
}

/* Corners of the compact trapezoids, counter-clockwise: {xw, xh, yw, yh}; x =
   xw * width + xh * height, y likewise. */
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

/* Compute the width or height that a type of trapezoid omits, from the other
   size. Return 0 on failure. */
static int complete_sizes(oasis *o) {
  uint32_t type = o->m.ctrapezoid;
  if (type == 20 || type == 21) {
    if (!oasis_need(o, "a trapezoid", HAS_HEIGHT)) return 0;
    o->m.width = 2 * o->m.height;
  } else {
    if (!oasis_need(o, "a trapezoid", HAS_WIDTH)) return 0;
    if ((type >= 16 && type <= 19) || type == 25) o->m.height = o->m.width;
    if (type == 22 || type == 23) o->m.height = 2 * o->m.width;
  }
  if (type >= 16 && type != 24) o->m.has |= HAS_WIDTH | HAS_HEIGHT;
  return oasis_need(o, "a trapezoid", HAS_HEIGHT);
}

void oasis_read_ctrapezoid(oasis *o) {
  uint32_t info = oasis_byte(o);
  read_layer(o, info);
  if (info & TOP) {
    uint64_t type = oasis_uint(o);
    if (type > 25) oasis_refuse(o, "an unknown kind of trapezoid");
    o->m.ctrapezoid = type > 25 ? 0 : (uint32_t)type;
    o->m.has |= HAS_CTRAPEZOID;
  }
  read_sizes(o, info);
  if (!oasis_need(o, NULL, HAS_CTRAPEZOID) || !complete_sizes(o) ||
      !shape_read_end(o, info, "a trapezoid", 0))
    return;
  uint32_t type = o->m.ctrapezoid;
  int64_t w = o->m.width, h = o->m.height;
  if ((type < 4 && w < h) || (type >= 4 && type < 8 && w < 2 * h) ||
      (type >= 8 && type < 12 && h < w) ||
      (type >= 12 && type < 16 && h < 2 * w)) {
    oasis_refuse(o, "a trapezoid whose sides cross");
    return;
  }
  if (type >= 24) {
    add_box(o, info & REPEATED);
    return;
  }
  oasis_vector corner[4];
  for (int i = 0; i < 4; i++) {
    const int8_t *k = compact[type][i];
    corner[i] = (oasis_vector){k[0] * w + k[1] * h, k[2] * w + k[3] * h};
  }
  add_corners(o, info & REPEATED, corner);
}

void oasis_read_circle(oasis *o) {
  uint32_t info = oasis_byte(o);
  read_layer(o, info);
  if (info & SECOND) o->m.radius = read_size(o, HAS_RADIUS);
  if (!shape_read_end(o, info, "a circle", HAS_RADIUS) || o->m.radius == 0)
    return;
  oasis_vector corner[SIDES];
  for (int i = 0; i < SIDES; i++) {
    double angle = 2 * PI * i / SIDES, r = (double)o->m.radius;
    corner[i] = (oasis_vector){(int64_t)floor(r * cos(angle) + 0.5),
                               (int64_t)floor(r * sin(angle) + 0.5)};
  }
  add_points(o, info & REPEATED, corner, SIDES, 0);
}

/* Skip a record with unknown contents; modal variables are updated. */
void oasis_read_xgeometry(oasis *o) {
  uint32_t info = oasis_byte(o);
  oasis_uint(o);
  read_layer(o, info);
  oasis_skip_string(o);
  oasis_read_place(o, info, &o->m.x, &o->m.y);
  if (info & REPEATED) oasis_read_repetition(o);
}
