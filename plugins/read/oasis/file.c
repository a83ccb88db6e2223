/* SPDX-License-Identifier: BSD-3-Clause */
/* START, END, cells, and which record is what (SEMI P39, sections 13 to 21). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "oasis.h"

/* ---- tables and the check sum ---- */

/* Six pairs: whether the table is complete, where it is. */
static void read_tables(oasis *o) {
  for (int i = 0; i < EDA_OASIS_TABLES; i++) {
    uint64_t complete = oasis_uint(&o->s), at = oasis_uint(&o->s);
    if (complete > 1) oasis_refuse(&o->s, "an impossible table of offsets");
    o->tables[i] = complete ? at : 0;
  }
}

static uint32_t read_signature(oasis_stream *s) {
  uint32_t v = 0;
  for (int i = 0; i < 4; i++) v |= oasis_byte(s) << 8 * i;
  return v;
}

/* What the END record says, read ahead: which sum to keep, where tables are.
   A file that lacks it will be found out when it ends. */
static void look_ahead(oasis *o) {
  opc_error none = {0};
  oasis end = {.r = o->r, .naming = 1, .error = &none};
  if (o->s.failed || o->s.size < EDA_OASIS_END_BYTES) return;
  oasis_open(&end.s, o->r->host, o->s.path, &none);
  oasis_seek(&end.s, o->s.size - EDA_OASIS_END_BYTES);
  if (oasis_uint(&end.s) == EDA_OASIS_END) {
    if (o->tables_at_end) read_tables(&end);
    oasis_skip_string(&end.s);
    uint64_t scheme = oasis_uint(&end.s);
    if (!end.s.failed && scheme <= EDA_OASIS_SUM32) o->s.scheme = (int)scheme;
    if (!end.s.failed && o->tables_at_end)
      memcpy(o->tables, end.tables, sizeof o->tables);
  }
  oasis_close(&end.s);
}

static void read_end(oasis *o) {
  static const char *const names[] = {"no sum", "CRC32", "sum"};
  oasis_stream *s = &o->s;
  uint64_t tables[EDA_OASIS_TABLES];
  memcpy(tables, o->tables, sizeof tables);
  if (s->inside) oasis_refuse(s, "END in a compressed block");
  if (o->tables_at_end) read_tables(o);
  memcpy(o->tables, tables, sizeof tables);
  oasis_skip_string(s);
  uint64_t scheme = oasis_uint(s);
  if (scheme > EDA_OASIS_SUM32) oasis_refuse(s, "an unknown validation scheme");
  if (s->failed) return;
  uint32_t sum = oasis_sum(s), wanted = 0;
  if (scheme) wanted = read_signature(s);
  if (s->failed) return;
  if (oasis_place(s) != s->record + EDA_OASIS_END_BYTES ||
      oasis_place(s) != s->size) {
    oasis_refuse(s, "END is not the file's last 256 bytes,");
    return;
  }
  if (!o->naming && scheme && wanted != sum) {
    char what[80];
    snprintf(what, sizeof what, "the %s is %08x and not %08x as said",
             names[scheme], (unsigned)sum, (unsigned)wanted);
    oasis_refuse(s, what);
  }
}

/* ---- START ---- */

static void make_layout(oasis *o, double steps) {
  if (!(steps > 0)) {
    oasis_refuse(&o->s, "an impossible unit");
    return;
  }
  /* Steps in a micrometre; the decimal number of 14 digits is meant. */
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g", 1000 / steps);
  o->layout = eda_layout_new(strtod(digits, NULL) * o->r->scale, o->error);
  oasis_told(o, o->layout ? OPC_OK : o->error->code);
}

static void read_start(oasis *o) {
  oasis_stream *s = &o->s;
  oasis_text version = {NULL, 0};
  if (!oasis_begin_record(s)) return;
  if (oasis_uint(s) != EDA_OASIS_START) oasis_refuse(s, "START is missing");
  oasis_string(s, &version);
  if (!s->failed && strcmp(version.s, "1.0") != 0)
    oasis_refuse(s, "an unknown version of OASIS");
  free(version.s);
  double steps = oasis_real(s);
  uint64_t at_end = oasis_uint(s);
  if (at_end > 1) oasis_refuse(s, "an impossible table of offsets");
  o->tables_at_end = at_end == 1;
  if (!at_end) read_tables(o);
  if (s->failed || o->naming) return;
  make_layout(o, steps);
  look_ahead(o);
}

/* ---- cells ---- */

void oasis_modal_clear(oasis_modal *m) {
  free(m->text.text.s);
  free(m->property.text.s);
  free(m->value.text.s);
  free(m->polygon.p);
  free(m->path.p);
  free(m->repetition.offsets.p);
}

static void read_cell(oasis *o, uint64_t record) {
  oasis_stream *s = &o->s;
  oasis_reference to = {0};
  oasis_modal *m = &o->m;
  oasis_read_reference(o, record == EDA_OASIS_CELL_NUMBER, &to);
  m->has = 0;
  m->relative = 0;
  m->x = m->y = m->text_x = m->text_y = m->placed_x = m->placed_y = 0;
  o->in_cell = 1;
  if (!o->naming && !s->failed) {
    int left_out;
    const char *name = oasis_referred(o, EDA_OASIS_CELLNAMES, &to);
    if (name) {
      o->cell =
          cell_list_begin(&o->cells, o->layout, name, &left_out, o->error);
      int code = o->error->code == OPC_INVALID ? OPC_IO : o->error->code;
      oasis_told(o, o->cell < 0 ? code : OPC_OK);
      if (left_out) o->cell = -1;
    }
  }
  free(to.text.s);
}

/* ---- records ---- */

static void read_element(oasis *o, uint64_t record) {
  oasis_stream *s = &o->s;
  if (!o->in_cell) {
    oasis_refuse(s, "a record out of place: not in a cell,");
    return;
  }
  switch (record) {
    case EDA_OASIS_XYABSOLUTE:
    case EDA_OASIS_XYRELATIVE:
      o->m.relative = record == EDA_OASIS_XYRELATIVE;
      break;
    case EDA_OASIS_PLACEMENT:
    case EDA_OASIS_PLACEMENT_REAL:
      oasis_read_placement(o, record);
      break;
    case EDA_OASIS_TEXT:
      oasis_read_text(o);
      break;
    case EDA_OASIS_RECTANGLE:
      oasis_read_rectangle(o);
      break;
    case EDA_OASIS_POLYGON:
      oasis_read_polygon(o);
      break;
    case EDA_OASIS_PATH:
      oasis_read_path(o);
      break;
    case EDA_OASIS_CTRAPEZOID:
      oasis_read_ctrapezoid(o);
      break;
    case EDA_OASIS_CIRCLE:
      oasis_read_circle(o);
      break;
    case EDA_OASIS_XELEMENT:
      oasis_uint(s);
      oasis_skip_string(s);
      break;
    case EDA_OASIS_XGEOMETRY:
      oasis_read_xgeometry(o);
      break;
    default:
      oasis_read_trapezoid(o, record);
  }
}

static void read_record(oasis *o, uint64_t record) {
  oasis_stream *s = &o->s;
  if (record == EDA_OASIS_PAD) return;
  if (record == EDA_OASIS_CBLOCK) {
    oasis_enter_block(s);
    return;
  }
  if (record == EDA_OASIS_PROPERTY || record == EDA_OASIS_PROPERTY_AGAIN) {
    oasis_read_property(o, record);
    return;
  }
  oasis_end_placement(o);
  if (record == EDA_OASIS_CELL || record == EDA_OASIS_CELL_NUMBER) {
    read_cell(o, record);
  } else if ((record >= EDA_OASIS_CELLNAME &&
              record <= EDA_OASIS_LAYERNAME_TEXT) ||
             record == EDA_OASIS_XNAME || record == EDA_OASIS_XNAME_NUMBER) {
    o->in_cell = 0;
    oasis_read_name(o, record);
  } else if (record >= EDA_OASIS_XYABSOLUTE && record <= EDA_OASIS_XGEOMETRY) {
    read_element(o, record);
  } else if (record == EDA_OASIS_END) {
    read_end(o);
  } else {
    oasis_refuse(s, "an unknown record");
  }
}

void oasis_read(oasis *o) {
  oasis_stream *s = &o->s;
  uint64_t record = EDA_OASIS_START;
  read_start(o);
  while (record != EDA_OASIS_END && oasis_begin_record(s)) {
    record = oasis_uint(s);
    if (!s->failed) read_record(o, record);
  }
}
