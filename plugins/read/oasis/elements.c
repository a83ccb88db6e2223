/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements texts, placements and their properties (SEMI P39, sections 22, 24,
   31), and the common parts of elements. */
#include <string.h>

#include "oasis.h"

/* ---- common parts of elements ---- */

/* Limit of the number of points of all shapes: POINTS_A_BYTE for each byte that
   was read, plus POINTS_MORE (a million rectangles). A small file can have many
   shapes by repetitions and modal variables, and layouts have no arrays of
   shapes. With twice these limits, a malicious file would take 0.03 s more, and
   1 s more under a sanitizer. */
enum { POINTS_A_BYTE = 16, POINTS_MORE = 1 << 22 };

int oasis_need(oasis *o, const char *what, uint32_t has) {
  static const char *const names[] = {
      "a layer",
      "a datatype",
      "a string",
      "a layer",
      "a datatype",
      "a width",
      "a height",
      "a width",
      "a start extension",
      "an end extension",
      "a radius",
      "points",
      "points",
      "a name",
      "values",
      "a trapezoid without a kind",
      "a placement without a cell",
      "a reference to the preceding repetition without one,"};
  uint32_t missing = has & ~o->m.has;
  if (missing && !o->b.failed) {
    const char *name = names[__builtin_ctz(missing)];
    g_autofree char *all = g_strdup_printf("%s without %s", what, name);
    oasis_refuse(o, what ? all : name);
  }
  return !o->b.failed;
}

void oasis_read_layer(oasis *o, uint32_t info, uint32_t has, uint32_t *layer,
                      uint32_t *datatype) {
  if (info & 1) *layer = oasis_uint32(o, "a layer beyond 32 bits");
  if (info & 2) *datatype = oasis_uint32(o, "a datatype beyond 32 bits");
  o->m.has |= has * (info & 3);
}

/* Read a coordinate. A coordinate that overflows counts as out of range. */
static int64_t read_place(oasis *o, int64_t from) {
  int64_t by = oasis_sint(o), to;
  if (!o->m.relative) return by;
  return __builtin_add_overflow(from, by, &to) ? INT64_MAX : to;
}

/* Read the coordinates that the record contains, and keep the modal values of
   the others. Fail if a coordinate exceeds 32 bits. */
static void read_xy(oasis *o, int has_x, int has_y, int64_t *x, int64_t *y) {
  if (has_x) *x = read_place(o, *x);
  if (has_y) *y = read_place(o, *y);
  if (*x < INT32_MIN || *x > INT32_MAX || *y < INT32_MIN || *y > INT32_MAX) {
    oasis_refuse(o, "a coordinate beyond 32 bits");
    *x = *y = 0;
  }
}

/* The bits of x and y in the information byte of all elements except
   placements, whose bits are one position higher. */
void oasis_read_place(oasis *o, uint32_t info, int64_t *x, int64_t *y) {
  read_xy(o, info & 16, info & 8, x, y);
}

int oasis_spend(oasis *o, uint64_t count, uint64_t points) {
  uint64_t most = oasis_consumed(o) * POINTS_A_BYTE + POINTS_MORE, total;
  if (__builtin_mul_overflow(count, points, &total) || total > most ||
      o->spent + total > most) {
    oasis_refuse(o, "too many shapes for the length of the file, those");
    return 0;
  }
  o->spent += total;
  return 1;
}

/* Compute the place of member i of a repetition whose first member is at (x,
   y). Fail beyond the range of coordinates. */
static int find_member(oasis *o, int repeated, uint64_t i, int64_t x, int64_t y,
                       const char *fault, eda_point *at) {
  oasis_vector d = oasis_member(o, repeated, i);
  x += d.x;
  y += d.y;
  *at = (eda_point){(int32_t)x, (int32_t)y};
  if (at->x != x || at->y != y) oasis_refuse(o, fault);
  return !o->b.failed;
}

/* ---- texts ---- */

static void add_texts(oasis *o, int repeated, int32_t layer,
                      const char *string) {
  reading *b = &o->b;
  uint64_t n = oasis_members(o, repeated);
  eda_point at;
  if (!oasis_spend(o, n, 4 + strlen(string) / 8)) return;
  for (uint64_t i = 0; i < n && !b->failed; i++)
    if (find_member(o, repeated, i, o->m.text_x, o->m.text_y,
                    "a coordinate beyond 32 bits", &at))
      reading_check(b, eda_layout_add_text(b->layout, b->cell, layer, at,
                                           string, &b->layout_error));
}

void oasis_read_text(oasis *o) {
  uint32_t info = oasis_byte(o);
  if (info & 64) {
    oasis_read_reference(o, info & 32, &o->m.text);
    o->m.has |= HAS_TEXT;
  }
  oasis_read_layer(o, info, HAS_TEXTLAYER, &o->m.textlayer, &o->m.texttype);
  oasis_read_place(o, info, &o->m.text_x, &o->m.text_y);
  if (info & 4) oasis_read_repetition(o);
  if (!oasis_need(o, "a text", HAS_TEXT | HAS_TEXTLAYER | HAS_TEXTTYPE) ||
      o->naming || o->b.cell < 0)
    return;
  const char *string = oasis_referred(o, EDA_OASIS_TEXTSTRINGS, &o->m.text);
  if (!string) return;
  int32_t layer = reading_numbered_layer(&o->b, o->m.textlayer, o->m.texttype);
  if (layer >= 0) add_texts(o, info & 4, layer, string);
}

/* ---- placements ---- */

static void read_child(oasis *o, int by_number) {
  oasis_reference to = {0};
  oasis_read_reference(o, by_number, &to);
  const char *name =
      o->naming ? NULL : oasis_referred(o, EDA_OASIS_CELLNAMES, &to);
  if (name)
    o->m.placed = reading_number(
        &o->b, eda_layout_cell(o->b.layout, name, &o->b.layout_error));
  o->m.has |= HAS_PLACED;
  g_free(to.text);
}

void oasis_read_placement(oasis *o, uint64_t record) {
  uint32_t info = oasis_byte(o);
  eda_placement p = {.magnification = 1, .columns = 1, .rows = 1};
  if (info & 128) read_child(o, info & 64);
  if (record == EDA_OASIS_PLACEMENT) {
    p.angle = 90.0 * (info >> 1 & 3);
  } else {
    if (info & 4) p.magnification = oasis_real(o);
    if (info & 2) p.angle = oasis_real(o);
  }
  p.mirror = info & 1;
  read_xy(o, info & 32, info & 16, &o->m.placed_x, &o->m.placed_y);
  if (info & 8) oasis_read_repetition(o);
  if (!oasis_need(o, NULL, HAS_PLACED)) return;
  if (!(p.magnification > 0)) {
    oasis_refuse(o, "a placement with an impossible magnification");
    return;
  }
  if (o->naming || o->b.cell < 0) return;
  p.origin = (eda_point){(int32_t)o->m.placed_x, (int32_t)o->m.placed_y};
  o->pending = 1;
  o->placement = p;
  o->child = o->m.placed;
  o->repeated = (info & 8) != 0;
  o->ranked = 0;
}

/* Convert a repetition to an array of the layout. Return 0 if the repetition is
   no lattice, or exceeds 32 bits. */
static int as_array(const oasis_repetition *r, eda_placement *p) {
  const oasis_vector *c = &r->column, *k = &r->row;
  p->column_step = (eda_point){(int32_t)c->x, (int32_t)c->y};
  p->row_step = (eda_point){(int32_t)k->x, (int32_t)k->y};
  p->columns = (uint32_t)r->columns;
  p->rows = (uint32_t)r->rows;
  return r->lattice && r->columns == p->columns && r->rows == p->rows &&
         c->x == p->column_step.x && c->y == p->column_step.y &&
         k->x == p->row_step.x && k->y == p->row_step.y;
}

void oasis_end_placement(oasis *o) {
  if (!o->pending || o->b.failed) return;
  reading *b = &o->b;
  const char *name = o->ranked ? o->instance : NULL;
  eda_placement p = o->placement;
  int single = !o->repeated || as_array(&o->m.repetition, &p);
  uint64_t n = single ? 1 : oasis_members(o, 1);
  eda_point first = p.origin;
  o->pending = 0;
  if (!single) p = o->placement;
  oasis_spend(o, n, (single ? 0 : 16) + (name ? strlen(name) / 8 : 0));
  for (uint64_t i = 0; i < n && !b->failed; i++)
    if (find_member(o, !single, i, first.x, first.y,
                    "an array leaves the range of coordinates", &p.origin))
      reading_check(b, eda_layout_add_instance(b->layout, b->cell, o->child, &p,
                                               name, &b->layout_error));
}

/* ---- properties ---- */

/* Read value `index` of a property: the first value is the number, the second
   the text. */
static void read_value(oasis *o, uint64_t index) {
  uint64_t type = oasis_uint(o);
  if (type <= 7) {
    oasis_real_of(o, type);
  } else if (type == 8 || type == 9) {
    uint64_t v = oasis_uint(o);
    if (index == 0 && v <= INT32_MAX) o->m.attribute = (int64_t)v;
  } else if (type <= 15) {
    oasis_reference skipped = {0};
    oasis_reference *to = index == 1 ? &o->m.value : &skipped;
    oasis_read_reference(o, type >= 13, to);
    g_free(skipped.text);
    if (index == 1) o->m.has_value = 1;
  } else {
    oasis_refuse(o, "an unknown kind of property value");
  }
}

/* Read a GDSII property. Property 61, or else the first property, is the name
   of an instance. */
static void take_property(oasis *o) {
  if (!o->pending || o->b.failed || o->m.attribute < 0 || !o->m.has_value)
    return;
  int rank = o->m.attribute == EDA_OASIS_INSTANCE_NAME ? 2 : 1;
  if (o->ranked >= rank) return;
  const char *name = oasis_referred(o, EDA_OASIS_PROPNAMES, &o->m.property);
  if (!name || strcmp(name, EDA_OASIS_GDS_PROPERTY) != 0) return;
  const char *value = oasis_referred(o, EDA_OASIS_PROPSTRINGS, &o->m.value);
  if (!value) return;
  g_free(o->instance);
  o->instance = g_strdup(value);
  o->ranked = rank;
}

void oasis_read_property(oasis *o, uint64_t record) {
  if (record == EDA_OASIS_PROPERTY) {
    uint32_t info = oasis_byte(o);
    if (info & 4) {
      oasis_read_reference(o, info & 2, &o->m.property);
      o->m.has |= HAS_PROPERTY;
    }
    if (!(info & 8)) {
      uint64_t n = info >> 4 == 15 ? oasis_uint(o) : info >> 4;
      o->m.attribute = -1;
      o->m.has_value = 0;
      for (uint64_t i = 0; i < n && !o->b.failed; i++) read_value(o, i);
      o->m.has |= HAS_VALUES;
    }
  }
  if (oasis_need(o, "a property", HAS_PROPERTY | HAS_VALUES)) take_property(o);
}
