/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of read.oasis.

   The records are read in one pass. Where one refers to a name by a number
   that comes later, the table of such names is read first, at the place that
   START or END tells; if that does not help, the whole file is gone through
   once for names alone. */
#ifndef OPCFLOW_OASIS_H
#define OPCFLOW_OASIS_H

#include "../layers.h"
#include "stream.h"

/* ---- names by number ---- */

typedef struct oasis_name {
  uint64_t number; /* the key */
  char *text;
  int defined; /* in the pass that builds */
} oasis_name;

/* Tables that hold strings: cells, texts, property names and strings. */
enum { OASIS_NAMES = 4 };

GHashTable *oasis_names_new(void);

/* ---- modal variables ---- */

/* Those that are undefined when a cell begins. */
enum {
  HAS_LAYER = 1 << 0,
  HAS_DATATYPE = 1 << 1,
  HAS_TEXTLAYER = 1 << 2,
  HAS_TEXTTYPE = 1 << 3,
  HAS_WIDTH = 1 << 4,
  HAS_HEIGHT = 1 << 5,
  HAS_HALFWIDTH = 1 << 6,
  HAS_RADIUS = 1 << 7,
  HAS_CTRAPEZOID = 1 << 8,
  HAS_PLACED = 1 << 9,
  HAS_TEXT = 1 << 10,
  HAS_POLYGON = 1 << 11,
  HAS_PATH = 1 << 12,
  HAS_BEGIN = 1 << 13,
  HAS_END = 1 << 14,
  HAS_REPETITION = 1 << 15,
  HAS_PROPERTY = 1 << 16,
  HAS_VALUES = 1 << 17
};

typedef struct oasis_points {
  oasis_vector *p;
  size_t n, room;
} oasis_points;

/* columns x rows on a lattice, or as many as there are offsets, the first of
   which is (0, 0). */
typedef struct oasis_repetition {
  int lattice;
  uint64_t columns, rows;
  oasis_vector column, row;
  oasis_points offsets;
  oasis_vector low, high; /* of all offsets; far beyond coordinates if so */
} oasis_repetition;

/* A string that stands there, or a number that means one. */
typedef struct oasis_reference {
  int by_number;
  uint64_t number;
  oasis_text text;
} oasis_reference;

typedef struct oasis_modal {
  uint32_t has;
  int relative;
  int64_t x, y, text_x, text_y, placed_x, placed_y;
  uint32_t layer, datatype, textlayer, texttype;
  int64_t width, height, halfwidth, radius, begin, end;
  uint32_t ctrapezoid;
  int32_t placed; /* cell of the layout */
  oasis_reference text;
  oasis_points polygon, path; /* from their first point, which is (0, 0) */
  oasis_repetition repetition;
  oasis_reference property;
  int64_t attribute;     /* a property's first value, -1 if that is no number */
  oasis_reference value; /* its second one */
  int has_value;
} oasis_modal;

/* ---- the reader ---- */

typedef struct oasis {
  const reader *r;
  opc_error *error;
  oasis_stream s;
  int naming; /* names are wanted, nothing is built */

  GHashTable *names[OASIS_NAMES]; /* of oasis_name */
  uint64_t next[OASIS_NAMES];     /* number without one of its own */
  int numbered[OASIS_NAMES];      /* 1: without numbers of their own, 2: with */
  uint64_t tables[EDA_OASIS_TABLES]; /* places of complete ones, 0: none */
  int tables_at_end;
  int named; /* the whole file was gone through for names */

  layer_map layers;
  cell_list cells;
  eda_layout *layout;
  int in_cell;
  int32_t cell; /* -1 in one that is left out */
  oasis_modal m;
  uint64_t spent; /* points that shapes took */
  eda_point *points;
  size_t room_points;

  int pending; /* a placement, whose properties may follow */
  eda_placement placement;
  int32_t child;
  int repeated;
  int ranked; /* 0 no name, 1 by a GDSII property, 2 by number 61 */
  oasis_text instance;
} oasis;

/* file.c: all records, from START to END. */
void oasis_read(oasis *o);
void oasis_modal_clear(oasis_modal *m);

/* lookup.c: read a name record; the name of a number, NULL after a failure. */
void oasis_read_name(oasis *o, uint64_t record);
const char *oasis_name_of(oasis *o, int table, uint64_t number);
const char *oasis_referred(oasis *o, int table, const oasis_reference *to);
void oasis_read_reference(oasis *o, int by_number, oasis_reference *to);

/* lists.c */
void oasis_read_points(oasis_stream *s, oasis_points *points, int closed);
void oasis_read_repetition(oasis *o);
/* Of an element whose record says so; single otherwise. */
uint64_t oasis_members(const oasis_repetition *r);
oasis_vector oasis_member(const oasis_repetition *r, uint64_t i);

/* shapes.c, elements.c: a record of that kind, after its number. */
void oasis_read_rectangle(oasis *o);
void oasis_read_polygon(oasis *o);
void oasis_read_path(oasis *o);
void oasis_read_trapezoid(oasis *o, uint64_t record);
void oasis_read_ctrapezoid(oasis *o);
void oasis_read_circle(oasis *o);
void oasis_read_xgeometry(oasis *o);
void oasis_read_text(oasis *o);
void oasis_read_placement(oasis *o, uint64_t record);
void oasis_read_property(oasis *o, uint64_t record);
void oasis_end_placement(oasis *o);

/* What elements share. */
int oasis_need(oasis *o, uint32_t has, const char *what);
/* x and y as the record says, and the modal variable. */
void oasis_read_place(oasis *o, uint32_t info, int64_t *x, int64_t *y);
/* Take `count` times `points` from what a file may make of its length. */
int oasis_spend(oasis *o, uint64_t count, uint64_t points);
/* What the layout said: keep a refusal with the record's place. */
int oasis_told(oasis *o, int code);
/* Whether all members of a shape with these corners have coordinates. */
int oasis_fits(oasis *o, int repeated, oasis_vector low, oasis_vector high);

#endif
