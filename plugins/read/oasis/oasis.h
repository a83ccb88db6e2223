/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of read.oasis.

   The records are read in one pass. Where one refers to a name by a number
   that comes later, the table of such names is read first, at the place that
   START or END tells; if that does not help, the whole file is gone through
   once for names alone.

   After a failure everything that is read is 0. Whoever loops over something
   that the file counts looks at b.failed. */
#ifndef OPCFLOW_OASIS_H
#define OPCFLOW_OASIS_H

#include <eda/oasis.h>
#include <zlib.h>

#include "../reader.h"

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

/* Those that are undefined when a cell begins; what lacks several is told of
   the first. */
enum {
  HAS_LAYER = 1 << 0,
  HAS_DATATYPE = 1 << 1,
  HAS_TEXT = 1 << 2,
  HAS_TEXTLAYER = 1 << 3,
  HAS_TEXTTYPE = 1 << 4,
  HAS_WIDTH = 1 << 5,
  HAS_HEIGHT = 1 << 6,
  HAS_HALFWIDTH = 1 << 7,
  HAS_BEGIN = 1 << 8,
  HAS_END = 1 << 9,
  HAS_RADIUS = 1 << 10,
  HAS_POLYGON = 1 << 11,
  HAS_PATH = 1 << 12,
  HAS_PROPERTY = 1 << 13,
  HAS_VALUES = 1 << 14,
  HAS_CTRAPEZOID = 1 << 15,
  HAS_PLACED = 1 << 16,
  HAS_REPETITION = 1 << 17
};

typedef struct oasis_vector {
  int64_t x, y; /* within +-2^33 */
} oasis_vector;

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
  char *text; /* NULL: by number */
  uint64_t number;
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
  reading b;
  int naming; /* names are wanted, nothing is built */

  /* The bytes that can be read at once: the file, or some of a block. */
  const uint8_t *p, *end;
  uint64_t record; /* where the current record begins, in file or block */

  int inside; /* of a compressed block */
  const uint8_t *file_p;
  uint64_t block_at; /* where it begins in the file */
  uint64_t done;     /* of its bytes, before `inflated` */
  uint64_t left_in, left_out;
  uint8_t *inflated;
  z_stream z;
  uint64_t unpacked; /* from all blocks so far */

  GHashTable *names[OASIS_NAMES]; /* of oasis_name */
  uint64_t next[OASIS_NAMES];     /* number without one of its own */
  int numbered[OASIS_NAMES];      /* 1: without numbers of their own, 2: with */
  uint64_t tables[EDA_OASIS_TABLES]; /* places of complete ones, 0: none */
  int tables_at_end;
  int named; /* the whole file was gone through for names */

  int in_cell;
  oasis_modal m;
  uint64_t spent; /* points that shapes took */
  eda_point *points;
  size_t room_points;

  int pending; /* a placement, whose properties may follow */
  eda_placement placement;
  int32_t child;
  int repeated;
  int ranked; /* 0 no name, 1 by a GDSII property, 2 by number 61 */
  char *instance;
} oasis;

/* ---- stream.c: the file as bytes, compressed blocks opened on the way ---- */

/* Another one for the same file, to be cleared: it takes names, nothing else.
   Then what both began with is `from`'s alone. */
oasis oasis_again(const oasis *from, opc_error *error);
void oasis_clear(oasis *o);
/* Go on at another place of the file. */
void oasis_seek(oasis *o, uint64_t at);
/* Fail: "'path': WHAT at byte N", N being where the record begins. */
void oasis_refuse(void *o, const char *what);
/* A record begins here: leave blocks that end here. 0 after a failure. */
int oasis_begin_record(oasis *o);
/* The place in the file; and bytes read up to here, also of blocks, these at
   most 64 for each of the file's. */
uint64_t oasis_place(const oasis *o);
uint64_t oasis_consumed(const oasis *o);
/* The contents of a CBLOCK record are what comes next. */
void oasis_enter_block(oasis *o);
/* More bytes; 0 if there are none, which is a failure. */
int oasis_refill(oasis *o);

/* ---- numbers.c ---- */

static inline uint32_t oasis_byte(oasis *o) {
  if (o->p == o->end && !oasis_refill(o)) return 0;
  return *o->p++;
}

uint64_t oasis_long_uint(oasis *o, uint32_t first);

static inline uint64_t oasis_uint(oasis *o) {
  uint32_t b = oasis_byte(o);
  return b < 0x80 ? b : oasis_long_uint(o, b);
}

/* Sign in the lowest bit. */
static inline int64_t oasis_sint(oasis *o) {
  uint64_t v = oasis_uint(o);
  return v & 1 ? -(int64_t)(v >> 1) : (int64_t)(v >> 1);
}

/* An unsigned integer of 32 bits: `what` is too large otherwise. */
uint32_t oasis_uint32(oasis *o, const char *what);
double oasis_real(oasis *o);
/* Of a type that has been read already. */
double oasis_real_of(oasis *o, uint64_t type);

/* Lengths that a coordinate can have, or it is a failure; also of a sum. */
int64_t oasis_length(oasis *o, int64_t v);
int64_t oasis_size(oasis *o, uint64_t v);
oasis_vector oasis_delta1(oasis *o, int horizontal);
oasis_vector oasis_delta2(oasis *o);
oasis_vector oasis_delta3(oasis *o);
oasis_vector oasis_deltag(oasis *o);

/* A string, bytes that are not printable ASCII as "\xE4", freed with g_free; or
   past it. */
char *oasis_string(oasis *o);
void oasis_skip_string(oasis *o);

/* ---- lookup.c: read a name record; the string of a reference, NULL after a
   failure ---- */

void oasis_read_name(oasis *o, uint64_t record);
void oasis_read_reference(oasis *o, int by_number, oasis_reference *to);
const char *oasis_referred(oasis *o, int table, const oasis_reference *to);

/* oasis.c: all records, from START to END. */
void oasis_read(void *o);

/* ---- lists.c ---- */

void oasis_read_points(oasis *o, oasis_points *points, int closed);
void oasis_read_repetition(oasis *o);
/* Of an element whose record says so; single otherwise. */
uint64_t oasis_members(const oasis *o, int repeated);
oasis_vector oasis_member(const oasis *o, int repeated, uint64_t i);

/* ---- shapes.c, elements.c: a record of that kind, after its number ---- */

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
/* Refuse `what` where it lacks one of the modal variables. */
int oasis_need(oasis *o, const char *what, uint32_t has);
/* A layer and a datatype, as the record says. */
void oasis_read_layer(oasis *o, uint32_t info, uint32_t has, uint32_t *layer,
                      uint32_t *datatype);
/* x and y as the record says, and the modal variable. */
void oasis_read_place(oasis *o, uint32_t info, int64_t *x, int64_t *y);
/* Take `count` times `points` from what a file may make of its length. */
int oasis_spend(oasis *o, uint64_t count, uint64_t points);

#endif
