/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements an OASIS file (SEMI P39) in strict mode: names are in tables at
   the end; cells and texts refer to names by number. */
#include "stream.h"

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

/* ---- state ---- */

/* Standard properties of the file: numbers in the table of property names. */
enum { CELL_OFFSET = 0, GDS_PROPERTY = 1 };

/* Largest number of points of a polygon. Larger polygons are divided, because
   other readers limit the number. */
enum { MAX_POINTS = 1 << 20 };

/* ---- work: strings ---- */

static void strings_init(strings *s) {
  s->numbers = g_hash_table_new(g_str_hash, g_str_equal);
  s->texts = g_ptr_array_new();
}

static void strings_clear(strings *s) {
  g_clear_pointer(&s->numbers, g_hash_table_unref);
  g_clear_pointer(&s->texts, g_ptr_array_unref);
}

static uint64_t number_of(strings *s, const char *text) {
  gpointer number;
  if (g_hash_table_lookup_extended(s->numbers, text, NULL, &number))
    return GPOINTER_TO_SIZE(number);
  g_hash_table_insert(s->numbers, (char *)text,
                      GSIZE_TO_POINTER(s->texts->len));
  g_ptr_array_add(s->texts, (char *)text);
  return s->texts->len - 1;
}

/* ---- work: records ---- */

static int set_layer(void *self, const char *layer) {
  oasis *w = self;
  return eda_layer_number_read(layer, UINT32_MAX, &w->layer, NULL);
}

static void oasis_begin(void *self, const eda_layout *layout, double unit) {
  oasis *w = self;
  w->layout = layout;
  w->n_places = layout ? eda_layout_cells(layout) : 1;
  w->places = eda_alloc(w->n_places, sizeof *w->places);
  w->out = eda_oasis_new(w->w.file);
  strings_init(&w->texts);
  strings_init(&w->names);
  for (const char *c = EDA_OASIS_MAGIC; *c; c++)
    eda_oasis_byte(w->out, (uint8_t)*c);
  eda_oasis_uint(w->out, EDA_OASIS_START);
  eda_oasis_string(w->out, "1.0");
  /* grid steps per micrometre */
  eda_oasis_real(w->out, writer_decimal(1000 / unit));
  eda_oasis_uint(w->out, 1); /* the places of the tables are in END */
  eda_oasis_end_plain(w->out);
}

static void begin_cell(void *self, int32_t cell, const char *name) {
  oasis *w = self;
  if (!name[0]) writer_fail(&w->w, "OASIS has no cells without a name");
  w->places[cell] = eda_oasis_place(w->out);
  eda_oasis_uint(w->out, EDA_OASIS_CELL_NUMBER);
  eda_oasis_uint(w->out, (uint64_t)cell);
  eda_oasis_end_plain(w->out);
}

static void put_polygon(void *self, const eda_point *points, size_t n) {
  oasis *w = self;
  eda_oasis_polygon(w->out, w->layer, points, n);
}

static void put_text(void *self, eda_point at, const char *text) {
  oasis *w = self;
  eda_oasis_end_shapes(w->out);
  eda_oasis_uint(w->out, EDA_OASIS_TEXT);
  eda_oasis_byte(w->out, 0x7b);
  eda_oasis_uint(w->out, number_of(&w->texts, text));
  eda_oasis_uint(w->out, w->layer.layer);
  eda_oasis_uint(w->out, w->layer.datatype);
  eda_oasis_sint(w->out, at.x);
  eda_oasis_sint(w->out, at.y);
  eda_oasis_end_record(w->out);
}

/* ---- work: placements ---- */

/* Return the angle as a multiple of 90 degrees, 0 to 3; -1 for other angles. */
static int angle_quarters(double angle) {
  for (int i = 0; i < 4; i++)
    if (angle == 90 * i) return i;
  return -1;
}

static void put_array(oasis *w, const eda_placement *p) {
  eda_oasis *out = w->out;
  eda_point c = p->column_step, r = p->row_step;
  if (p->columns > 1 && p->rows > 1) {
    eda_oasis_uint(out, 8);
    eda_oasis_uint(out, p->columns - 2);
    eda_oasis_uint(out, p->rows - 2);
    eda_oasis_delta(out, c.x, c.y);
    eda_oasis_delta(out, r.x, r.y);
  } else {
    eda_point step = p->columns > 1 ? c : r;
    eda_oasis_uint(out, 9);
    eda_oasis_uint(out, (p->columns > 1 ? p->columns : p->rows) - 2);
    eda_oasis_delta(out, step.x, step.y);
  }
}

static void put_name(oasis *w, const char *name) {
  eda_oasis_uint(w->out, EDA_OASIS_PROPERTY);
  eda_oasis_byte(w->out, 0x27); /* 2 values, a standard name by number */
  eda_oasis_uint(w->out, GDS_PROPERTY);
  eda_oasis_uint(w->out, 8);
  eda_oasis_uint(w->out, EDA_OASIS_INSTANCE_NAME);
  eda_oasis_uint(w->out, 14);
  eda_oasis_uint(w->out, number_of(&w->names, name));
}

static void put_placement(void *self, int32_t child, const char *child_name,
                          const eda_placement *p, const char *name) {
  oasis *w = self;
  eda_oasis *out = w->out;
  int turns = angle_quarters(p->angle), array = p->columns > 1 || p->rows > 1;
  int plain = p->magnification == 1 && turns >= 0;
  uint32_t info = 0xf0 | (array ? 8u : 0) | (p->mirror ? 1u : 0);
  (void)child_name;
  eda_oasis_end_shapes(out);
  eda_oasis_uint(out, plain ? EDA_OASIS_PLACEMENT : EDA_OASIS_PLACEMENT_REAL);
  eda_oasis_byte(out, plain ? info | (uint32_t)turns << 1 : info | 6);
  eda_oasis_uint(out, (uint64_t)child);
  if (!plain) {
    eda_oasis_real(out, p->magnification);
    eda_oasis_real(out, p->angle);
  }
  eda_oasis_sint(out, p->origin.x);
  eda_oasis_sint(out, p->origin.y);
  if (array) put_array(w, p);
  if (name) put_name(w, name);
  eda_oasis_end_record(out);
}

static void end_cell(void *self) {
  oasis *w = self;
  eda_oasis_end_shapes(w->out);
  eda_oasis_end_block(w->out);
}

/* ---- work: names ---- */

/* Write a cell name. Blanks and unprintable characters become "\x20". */
static void put_cell_name(oasis *w, const char *name) {
  g_autoptr(GString) plain = g_string_new(NULL);
  for (; *name; name++)
    if (*name > 0x20 && *name < 0x7f)
      g_string_append_c(plain, *name);
    else
      g_string_append_printf(plain, "\\x%02X", (uint8_t)*name);
  eda_oasis_string(w->out, plain->str);
}

static void put_cell_names(oasis *w) {
  for (size_t i = 0; i < w->n_places; i++) {
    const char *name =
        w->layout ? eda_layout_cell_name(w->layout, (int32_t)i) : w->w.cell;
    eda_oasis_uint(w->out, EDA_OASIS_CELLNAME);
    put_cell_name(w, name);
    eda_oasis_uint(w->out, EDA_OASIS_PROPERTY);
    eda_oasis_byte(w->out, 0x17); /* 1 value, a standard name by number */
    eda_oasis_uint(w->out, CELL_OFFSET);
    eda_oasis_uint(w->out, 8);
    eda_oasis_uint(w->out, w->places[i]);
    eda_oasis_end_record(w->out);
  }
}

static void put_strings(oasis *w, const strings *s, uint32_t record) {
  for (size_t i = 0; i < s->texts->len; i++) {
    eda_oasis_uint(w->out, record);
    eda_oasis_string(w->out, s->texts->pdata[i]);
    eda_oasis_end_record(w->out);
  }
}

static void put_layer_names(oasis *w) {
  for (size_t i = 0; w->layer_names && i < eda_layout_layers(w->layout); i++) {
    eda_layer_number n;
    const char *of = eda_layout_layer_name(w->layout, (int32_t)i);
    if (!w->layer_names[i] || !eda_layer_number_read(of, UINT32_MAX, &n, NULL))
      continue;
    eda_oasis_uint(w->out, EDA_OASIS_LAYERNAME);
    eda_oasis_string(w->out, w->layer_names[i]);
    eda_oasis_uint(w->out, 3); /* one number, not an interval */
    eda_oasis_uint(w->out, n.layer);
    eda_oasis_uint(w->out, 3);
    eda_oasis_uint(w->out, n.datatype);
    eda_oasis_end_record(w->out);
  }
}

/* Return the place of the table that began at `from`; 0 if the table is empty.
 */
static uint64_t end_table(oasis *w, uint64_t from) {
  eda_oasis_end_block(w->out);
  return eda_oasis_place(w->out) > from ? from : 0;
}

static void put_end(oasis *w, const uint64_t places[EDA_OASIS_TABLES]) {
  eda_oasis *out = w->out;
  eda_oasis_uint(out, EDA_OASIS_END);
  for (int i = 0; i < EDA_OASIS_TABLES; i++) {
    eda_oasis_uint(out, 1); /* strict: the table is complete */
    eda_oasis_uint(out, places[i]);
  }
  /* Add zeros up to the fixed length of END. Two bytes before the zeros have
     the number of zeros. */
  size_t length = EDA_OASIS_END_BYTES - 1 - 4 - 2 - eda_oasis_collected(out);
  eda_oasis_byte(out, 0x80 | (length & 0x7f));
  eda_oasis_byte(out, (uint32_t)length >> 7);
  for (size_t i = 0; i < length; i++) eda_oasis_byte(out, 0);
  eda_oasis_uint(out, EDA_OASIS_CRC32);
  eda_oasis_end_plain(out);
  uint32_t crc = eda_oasis_crc(out);
  for (int i = 0; i < 4; i++) eda_oasis_byte(out, crc >> 8 * i & 0xff);
  eda_oasis_end_plain(out);
}

static void oasis_end(void *self) {
  oasis *w = self;
  uint64_t places[EDA_OASIS_TABLES] = {0}, from = eda_oasis_place(w->out);
  put_cell_names(w);
  places[EDA_OASIS_CELLNAMES] = end_table(w, from);
  from = eda_oasis_place(w->out);
  put_strings(w, &w->texts, EDA_OASIS_TEXTSTRING);
  places[EDA_OASIS_TEXTSTRINGS] = end_table(w, from);
  from = eda_oasis_place(w->out);
  eda_oasis_uint(w->out, EDA_OASIS_PROPNAME);
  eda_oasis_string(w->out, "S_CELL_OFFSET");
  eda_oasis_uint(w->out, EDA_OASIS_PROPNAME);
  eda_oasis_string(w->out, EDA_OASIS_GDS_PROPERTY);
  places[EDA_OASIS_PROPNAMES] = end_table(w, from);
  from = eda_oasis_place(w->out);
  put_strings(w, &w->names, EDA_OASIS_PROPSTRING);
  places[EDA_OASIS_PROPSTRINGS] = end_table(w, from);
  from = eda_oasis_place(w->out);
  put_layer_names(w);
  places[EDA_OASIS_LAYERNAMES] = end_table(w, from);
  put_end(w, places);
}

static void oasis_clear(void *self) {
  oasis *w = self;
  g_clear_pointer(&w->out, eda_oasis_free);
  strings_clear(&w->texts);
  strings_clear(&w->names);
  g_clear_pointer(&w->places, free);
}

/* ---- the format ---- */

const write_format oasis_stream = {
    .layer = "9/0",
    .most_points = MAX_POINTS,
    .name_layer = writer_number_layer,
    .set_layer = set_layer,
    .begin = oasis_begin,
    .begin_cell = begin_cell,
    .polygon = put_polygon,
    .text = put_text,
    .placement = put_placement,
    .end_cell = end_cell,
    .end = oasis_end,
    .clear = oasis_clear,
};
