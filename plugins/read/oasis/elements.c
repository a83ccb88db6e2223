/* SPDX-License-Identifier: BSD-3-Clause */
/* Texts, placements and their properties (SEMI P39, sections 22, 24, 31); what
   all elements share. */
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "oasis.h"

/* ---- what elements share ---- */

/* Points that a file's shapes may take for each of its bytes, and so many
   more: repetitions and modal variables make much out of little, for layouts
   cannot hold shapes as arrays. */
enum { POINTS_A_BYTE = 16, POINTS_MORE = 1 << 27 };

int oasis_need(oasis *o, uint32_t has, const char *what) {
  if ((o->m.has & has) == 0) oasis_refuse(&o->s, what);
  return !o->s.failed;
}

/* INFO bits of x and y are those of every element but placements, whose are
   one further up. */
static void read_xy(oasis *o, int has_x, int has_y, int64_t *x, int64_t *y) {
  oasis_stream *s = &o->s;
  if (has_x) *x = oasis_sint(s) + (o->m.relative ? *x : 0);
  if (has_y) *y = oasis_sint(s) + (o->m.relative ? *y : 0);
  if (*x < INT32_MIN || *x > INT32_MAX || *y < INT32_MIN || *y > INT32_MAX) {
    oasis_refuse(s, "a coordinate beyond 32 bits");
    *x = *y = 0;
  }
}

void oasis_read_place(oasis *o, uint32_t info, int64_t *x, int64_t *y) {
  read_xy(o, info & 16, info & 8, x, y);
}

int oasis_spend(oasis *o, uint64_t count, uint64_t points) {
  uint64_t most = oasis_consumed(&o->s) * POINTS_A_BYTE + POINTS_MORE, total;
  if (__builtin_mul_overflow(count, points, &total) || total > most ||
      o->spent + total > most) {
    oasis_refuse(&o->s, "too many shapes for so short a file, those");
    return 0;
  }
  o->spent += total;
  return 1;
}

int oasis_told(oasis *o, int code) {
  if (!code) return !o->s.failed;
  opc_error why = *o->error;
  oasis_refuse(&o->s, why.message);
  o->error->code = code;
  return 0;
}

int oasis_fits(oasis *o, int repeated, oasis_vector low, oasis_vector high) {
  const oasis_modal *m = &o->m;
  oasis_vector zero = {0, 0};
  oasis_vector first = repeated ? m->repetition.low : zero;
  oasis_vector last = repeated ? m->repetition.high : zero;
  if (m->x + first.x + low.x >= INT32_MIN &&
      m->y + first.y + low.y >= INT32_MIN &&
      m->x + last.x + high.x <= INT32_MAX &&
      m->y + last.y + high.y <= INT32_MAX)
    return 1;
  oasis_refuse(&o->s, "a coordinate beyond 32 bits");
  return 0;
}

/* ---- texts ---- */

static void add_texts(oasis *o, int repeated, int32_t layer,
                      const char *string) {
  const oasis_repetition *r = &o->m.repetition;
  uint64_t n = repeated ? oasis_members(r) : 1;
  if (!oasis_spend(o, n, 4 + strlen(string) / 8)) return;
  for (uint64_t i = 0; i < n; i++) {
    oasis_vector d = {0, 0};
    if (repeated) d = oasis_member(r, i);
    int64_t x = o->m.text_x + d.x, y = o->m.text_y + d.y;
    eda_point at = {(int32_t)x, (int32_t)y};
    if (at.x != x || at.y != y) {
      oasis_refuse(&o->s, "a coordinate beyond 32 bits");
      return;
    }
    if (!oasis_told(o, eda_layout_add_text(o->layout, o->cell, layer, at,
                                           string, o->error)))
      return;
  }
}

void oasis_read_text(oasis *o) {
  oasis_stream *s = &o->s;
  uint32_t info = oasis_byte(s);
  if (info & 64) {
    oasis_read_reference(o, info & 32, &o->m.text);
    o->m.has |= HAS_TEXT;
  }
  if (info & 1) {
    o->m.textlayer = oasis_uint32(s, "a layer beyond 32 bits");
    o->m.has |= HAS_TEXTLAYER;
  }
  if (info & 2) {
    o->m.texttype = oasis_uint32(s, "a datatype beyond 32 bits");
    o->m.has |= HAS_TEXTTYPE;
  }
  oasis_read_place(o, info, &o->m.text_x, &o->m.text_y);
  if (info & 4) oasis_read_repetition(o);
  if (!oasis_need(o, HAS_TEXT, "a text without a string") ||
      !oasis_need(o, HAS_TEXTLAYER, "a text without a layer") ||
      !oasis_need(o, HAS_TEXTTYPE, "a text without a datatype") || o->naming ||
      o->cell < 0)
    return;
  const char *string = oasis_referred(o, EDA_OASIS_TEXTSTRINGS, &o->m.text);
  if (!string) return;
  int32_t layer = layer_map_find(&o->layers, o->layout, o->m.textlayer,
                                 o->m.texttype, o->error);
  if (oasis_told(o, layer < 0 ? o->error->code : OPC_OK))
    add_texts(o, info & 4, layer, string);
}

/* ---- placements ---- */

static void read_child(oasis *o, int by_number) {
  oasis_reference to = {0};
  oasis_read_reference(o, by_number, &to);
  if (!o->naming && !o->s.failed) {
    const char *name = oasis_referred(o, EDA_OASIS_CELLNAMES, &to);
    if (name) {
      o->m.placed = eda_layout_cell(o->layout, name, o->error);
      oasis_told(o, o->m.placed < 0 ? o->error->code : OPC_OK);
    }
  }
  o->m.has |= HAS_PLACED;
  free(to.text.s);
}

void oasis_read_placement(oasis *o, uint64_t record) {
  oasis_stream *s = &o->s;
  uint32_t info = oasis_byte(s);
  eda_placement p = {.magnification = 1, .columns = 1, .rows = 1};
  if (info & 128) read_child(o, info & 64);
  if (record == EDA_OASIS_PLACEMENT) {
    p.angle = 90.0 * (info >> 1 & 3);
  } else {
    if (info & 4) p.magnification = oasis_real(s);
    if (info & 2) p.angle = oasis_real(s);
  }
  p.mirror = info & 1;
  read_xy(o, info & 32, info & 16, &o->m.placed_x, &o->m.placed_y);
  if (info & 8) oasis_read_repetition(o);
  if (!oasis_need(o, HAS_PLACED, "a placement of no cell")) return;
  if (!(p.magnification > 0)) {
    oasis_refuse(s, "a placement with an impossible magnification");
    return;
  }
  if (o->naming || o->cell < 0) return;
  p.origin = (eda_point){(int32_t)o->m.placed_x, (int32_t)o->m.placed_y};
  o->pending = 1;
  o->placement = p;
  o->child = o->m.placed;
  o->repeated = (info & 8) != 0;
  o->ranked = 0;
}

/* A lattice as an array of the layout. */
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
  if (!o->pending || o->s.failed) return;
  const oasis_repetition *r = &o->m.repetition;
  const char *name = o->ranked ? o->instance.s : NULL;
  eda_placement p = o->placement;
  o->pending = 0;
  if (!o->repeated || as_array(r, &p)) {
    oasis_told(o, eda_layout_add_instance(o->layout, o->cell, o->child, &p,
                                          name, o->error));
    return;
  }
  p = o->placement;
  uint64_t n = oasis_members(r);
  if (!oasis_spend(o, n, 16 + (name ? strlen(name) / 8 : 0))) return;
  for (uint64_t i = 0; i < n; i++) {
    oasis_vector d = oasis_member(r, i);
    int64_t x = o->placement.origin.x + d.x, y = o->placement.origin.y + d.y;
    p.origin = (eda_point){(int32_t)x, (int32_t)y};
    if (p.origin.x != x || p.origin.y != y) {
      oasis_refuse(&o->s, "an array leaves the range of coordinates");
      return;
    }
    if (!oasis_told(o, eda_layout_add_instance(o->layout, o->cell, o->child, &p,
                                               name, o->error)))
      return;
  }
}

/* ---- properties ---- */

/* One value; the first is a property's number, the second its text. */
static void read_value(oasis *o, uint64_t index) {
  oasis_stream *s = &o->s;
  uint64_t type = oasis_uint(s);
  if (type <= 7) {
    oasis_real_of(s, type);
  } else if (type == 8 || type == 9) {
    uint64_t v = oasis_uint(s);
    if (index == 0 && v <= INT32_MAX) o->m.attribute = (int64_t)v;
  } else if (type <= 15) {
    oasis_reference skipped = {0};
    oasis_reference *to = index == 1 ? &o->m.value : &skipped;
    oasis_read_reference(o, type >= 13, to);
    free(skipped.text.s);
    if (index == 1) o->m.has_value = 1;
  } else {
    oasis_refuse(s, "an unknown kind of property value");
  }
}

/* The property 61 of GDSII, or else the first one, names an instance. */
static void take_property(oasis *o) {
  if (!o->pending || o->s.failed || o->m.attribute < 0 || !o->m.has_value)
    return;
  int rank = o->m.attribute == EDA_OASIS_INSTANCE_NAME ? 2 : 1;
  if (o->ranked >= rank) return;
  const char *name = oasis_referred(o, EDA_OASIS_PROPNAMES, &o->m.property);
  if (!name || strcmp(name, EDA_OASIS_GDS_PROPERTY) != 0) return;
  const char *value = oasis_referred(o, EDA_OASIS_PROPSTRINGS, &o->m.value);
  if (!value) return;
  size_t n = strlen(value) + 1;
  eda_grow(&o->instance.s, &o->instance.room, n, 1);
  memcpy(o->instance.s, value, n);
  o->ranked = rank;
}

void oasis_read_property(oasis *o, uint64_t record) {
  oasis_stream *s = &o->s;
  if (record == EDA_OASIS_PROPERTY) {
    uint32_t info = oasis_byte(s);
    if (info & 4) {
      oasis_read_reference(o, info & 2, &o->m.property);
      o->m.has |= HAS_PROPERTY;
    }
    if (!(info & 8)) {
      uint64_t n = info >> 4 == 15 ? oasis_uint(s) : info >> 4;
      o->m.attribute = -1;
      o->m.has_value = 0;
      for (uint64_t i = 0; i < n && !s->failed; i++) read_value(o, i);
      o->m.has |= HAS_VALUES;
    }
  }
  if (oasis_need(o, HAS_PROPERTY, "a property without a name") &&
      oasis_need(o, HAS_VALUES, "a property without values"))
    take_property(o);
}
