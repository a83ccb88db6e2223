/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements read.oasis: an OASIS file as a layout. This file reads START, END
   and cells, and dispatches records (SEMI P39, sections 13 to 21). */
#include <stdlib.h>
#include <string.h>

#include "oasis.h"

/* ---- tables and the check sum ---- */

/* Read the table offsets, a pair for each table: whether all names are in the
   table (1), and the place of the table in the file. */
static void read_tables(oasis *o) {
  for (int i = 0; i < EDA_OASIS_TABLES; i++) {
    uint64_t complete = oasis_uint(o), at = oasis_uint(o);
    if (complete > 1) oasis_refuse(o, "an impossible table of offsets");
    o->tables[i] = complete ? at : 0;
  }
}

static uint32_t read_signature(oasis *o) {
  uint32_t v = 0;
  for (int i = 0; i < 4; i++) v |= oasis_byte(o) << 8 * i;
  return v;
}

/* Read the places of the tables from END, before the other records. A missing
   END is no failure here; the reader fails when it reaches the end of the file.
 */
static void look_ahead(oasis *o) {
  opc_error none;
  oasis end = oasis_again(o, &none);
  if (o->b.n >= EDA_OASIS_END_BYTES)
    oasis_seek(&end, o->b.n - EDA_OASIS_END_BYTES);
  if (oasis_uint(&end) == EDA_OASIS_END) {
    read_tables(&end);
    if (!end.b.failed) memcpy(o->tables, end.tables, sizeof o->tables);
  }
  oasis_clear(&end);
}

/* Return the checksum of the file up to the current place. */
static uint32_t sum_up(oasis *o, uint64_t scheme) {
  reading all = reading_again(&o->b, o->b.error);
  uint64_t end = oasis_place(o);
  uint32_t sum = 0;
  size_t n;
  for (uint64_t at = 0; at < end && !all.failed; at += n) {
    const uint8_t *bytes = reading_view(&all, at, 1, &n);
    n = MIN(n, end - at);
    if (scheme == EDA_OASIS_CRC32) sum = (uint32_t)crc32_z(sum, bytes, n);
    for (size_t i = 0; scheme == EDA_OASIS_SUM32 && i < n; i++) sum += bytes[i];
  }
  o->b.failed = all.failed;
  if (all.file >= 0) free(all.bytes);
  return sum;
}

static void read_end(oasis *o) {
  static const char *const names[] = {"no sum", "CRC32", "sum"};
  uint64_t tables[EDA_OASIS_TABLES];
  memcpy(tables, o->tables, sizeof tables);
  if (o->inside) oasis_refuse(o, "END in a compressed block");
  if (o->tables_at_end) read_tables(o);
  memcpy(o->tables, tables, sizeof tables);
  oasis_skip_string(o);
  uint64_t scheme = oasis_uint(o);
  if (scheme > EDA_OASIS_SUM32) oasis_refuse(o, "an unknown validation scheme");
  if (o->b.failed) return;
  uint32_t sum = o->naming || !scheme ? 0 : sum_up(o, scheme);
  uint32_t wanted = scheme ? read_signature(o) : 0;
  if (oasis_place(o) != o->record + EDA_OASIS_END_BYTES ||
      oasis_place(o) != o->b.n)
    oasis_refuse(o, "END is not in the last 256 bytes of the file,");
  if (!o->naming && scheme && wanted != sum) {
    g_autofree char *what =
        g_strdup_printf("the %s is %08x, expected %08x", names[scheme],
                        (unsigned)sum, (unsigned)wanted);
    oasis_refuse(o, what);
  }
}

/* ---- START ---- */

static void make_layout(oasis *o, double steps) {
  if (!(steps > 0)) {
    oasis_refuse(o, "an impossible unit");
    return;
  }
  /* Grid steps per micrometre, rounded to a decimal number of 14 digits. */
  char digits[40];
  snprintf(digits, sizeof digits, "%.14g", 1000 / steps);
  o->b.layout =
      eda_layout_new(strtod(digits, NULL) * o->b.r->scale, &o->b.layout_error);
  reading_check(&o->b, o->b.layout ? OPC_OK : o->b.layout_error.code);
}

static void read_start(oasis *o) {
  for (const char *c = EDA_OASIS_MAGIC; *c; c++)
    if (oasis_byte(o) != (uint8_t)*c)
      oasis_refuse(o, "not an OASIS file: no magic bytes");
  if (!oasis_begin_record(o)) return;
  if (oasis_uint(o) != EDA_OASIS_START) oasis_refuse(o, "START is missing");
  g_autofree char *version = oasis_string(o);
  if (strcmp(version, "1.0") != 0)
    oasis_refuse(o, "an unknown version of OASIS");
  double steps = oasis_real(o);
  uint64_t at_end = oasis_uint(o);
  if (at_end > 1) oasis_refuse(o, "an impossible table of offsets");
  o->tables_at_end = at_end == 1;
  if (!at_end) read_tables(o);
  if (o->b.failed || o->naming) return;
  make_layout(o, steps);
  if (o->tables_at_end) look_ahead(o);
}

/* ---- cells ---- */

static void read_cell(oasis *o, uint64_t record) {
  oasis_reference to = {0};
  oasis_modal *m = &o->m;
  oasis_read_reference(o, record == EDA_OASIS_CELL_NUMBER, &to);
  m->has = 0;
  m->relative = 0;
  m->x = m->y = m->text_x = m->text_y = m->placed_x = m->placed_y = 0;
  o->in_cell = 1;
  const char *name =
      o->naming ? NULL : oasis_referred(o, EDA_OASIS_CELLNAMES, &to);
  if (name) reading_begin_cell(&o->b, name);
  g_free(to.text);
}

/* ---- records ---- */

static void read_element(oasis *o, uint64_t record) {
  if (!o->in_cell) {
    oasis_refuse(o, "an unexpected record: not in a cell,");
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
      oasis_uint(o);
      oasis_skip_string(o);
      break;
    case EDA_OASIS_XGEOMETRY:
      oasis_read_xgeometry(o);
      break;
    default:
      oasis_read_trapezoid(o, record);
  }
}

static void read_record(oasis *o, uint64_t record) {
  if (record == EDA_OASIS_PAD) return;
  if (record == EDA_OASIS_CBLOCK) {
    oasis_enter_block(o);
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
    oasis_refuse(o, "an unknown record");
  }
}

void oasis_read(void *self) {
  oasis *o = self;
  uint64_t record = EDA_OASIS_START;
  oasis_seek(o, 0);
  read_start(o);
  while (record != EDA_OASIS_END && oasis_begin_record(o)) {
    record = oasis_uint(o);
    if (!o->b.failed) read_record(o, record);
  }
}

static int oasis_run(void *self, void **outputs, opc_error *error) {
  oasis o = {.b.format = "OASIS", .b.refuse = oasis_refuse};
  for (int i = 0; i < OASIS_NAMES; i++) o.names[i] = oasis_names_new();
  int code = reading_run(&o, self, outputs, error, oasis_read);
  oasis_clear(&o);
  return code;
}

/* ---- entry ---- */

READER_FUNCTIONS(oasis_run, UINT32_MAX, "The OASIS file",
                 "Layer names, as in { poly: 9/0 }, or { poly: 9 } for every "
                 "datatype; other layers are named by their numbers, as in 9/0")

OPC_PLUGIN(reader, .id = "read.oasis", .summary = "Read an OASIS file",
           READER_ENTRY);
