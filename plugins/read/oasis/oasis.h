/* SPDX-License-Identifier: BSD-3-Clause */
/* Common header of the files of read.oasis.

   Records are read in one pass. If a record refers to a name number that is not
   yet defined, the reader loads the name table at the place stored in START or
   END. If the table lacks the name, a second pass reads all names of the file.

   After a failure, all read functions return 0. Loops over counts from the file
   must check b.failed. */
#pragma once

#include <eda/oasis.h>
#include <zlib.h>

#include "../reader.h"

/* ---- names by number ---- */

/* A name with its number. */
typedef struct oasis_name {
  uint64_t number; /* the key */
  char *text;
  int defined; /* 1: defined in the pass that builds the layout */
} oasis_name;

/* Number of tables that hold strings: cells, texts, property names, property
   strings. */
enum { OASIS_NAMES = 4 };

/* Return an empty table of names (oasis_name) by number. */
GHashTable *oasis_names_new(void);

/* ---- modal variables ---- */

/* Modal variables that are undefined at the start of a cell. If several
   required variables are undefined, the error names the first one. */
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

/* A displacement or a point. */
typedef struct oasis_vector {
  int64_t x, y; /* within +-2^33 */
} oasis_vector;

/* A list of points. */
typedef struct oasis_points {
  oasis_vector *p;
  size_t n, capacity;
} oasis_points;

/* Members of a repetition: columns x rows on a lattice or, if `lattice` is 0,
   the listed offsets, the first of which is (0, 0). */
typedef struct oasis_repetition {
  int lattice;
  uint64_t columns, rows;
  oasis_vector column, row;
  oasis_points offsets;
  oasis_vector low, high; /* bounds of all offsets; BEYOND (lists.c) if out of
                             range */
} oasis_repetition;

/* A string, or the reference number of a string. */
typedef struct oasis_reference {
  char *text; /* NULL: `number` refers to the string */
  uint64_t number;
} oasis_reference;

/* Modal variables: values of the preceding records, which a record may omit. */
typedef struct oasis_modal {
  uint32_t has; /* HAS_*: variables that are defined */
  int relative; /* 1: coordinates are relative to the preceding ones */
  int64_t x, y, text_x, text_y, placed_x, placed_y;
  uint32_t layer, datatype, textlayer, texttype;
  int64_t width, height, halfwidth, radius, begin, end;
  uint32_t ctrapezoid;
  int32_t placed; /* last placed cell, in the layout */
  oasis_reference text;
  oasis_points polygon, path; /* relative to the first point, which is (0, 0) */
  oasis_repetition repetition;
  oasis_reference property;
  int64_t attribute;     /* first value of the property; -1 if not a number */
  oasis_reference value; /* second value */
  int has_value;
} oasis_modal;

/* ---- the reader ---- */

/* State of the reader. */
typedef struct oasis {
  reading b;
  int naming; /* 1: this pass reads only names */

  /* Bytes not yet read, in the window on the file or in `inflated`. */
  const uint8_t *p, *end;
  uint64_t record; /* place of the current record, in file or block */

  int inside;        /* 1: inside a compressed block */
  uint64_t file_at;  /* place in the file after the bytes passed to zlib */
  uint64_t block_at; /* place of the block in the file */
  uint64_t done; /* number of decompressed bytes of the block before those in
                    `inflated` */
  uint64_t left_in, left_out; /* bytes of the block not yet passed to zlib; not
                                 yet decompressed */
  uint8_t *inflated;          /* buffer of decompressed bytes of the block */
  z_stream z;
  uint64_t unpacked; /* decompressed bytes of all blocks so far */

  GHashTable *names[OASIS_NAMES]; /* oasis_name */
  uint64_t next[OASIS_NAMES];     /* next implicit number */
  int numbered[OASIS_NAMES];      /* 1: implicit numbers, 2: explicit numbers */
  uint64_t tables[EDA_OASIS_TABLES]; /* place of each complete table in the
                                        file; 0 if there is none */
  int tables_at_end;                 /* 1: END has the places, not START */
  int named;                         /* 1: all names of the file were read */

  int in_cell;
  oasis_modal m;
  uint64_t spent; /* points of all shapes so far */
  eda_point *points;
  size_t capacity_points;

  /* A placement is added to the layout after its properties. */
  int pending; /* 1: a placement was read and is not yet added */
  eda_placement placement;
  int32_t child;
  int repeated;
  int ranked; /* source of `instance`: 0 none, 1 the first GDSII property, 2
                 GDSII property 61 */
  char *instance;
} oasis;

/* ---- stream.c: the file as bytes, compressed blocks opened while reading
   ---- */

/* Return a second reader of the same file that reads only names. Free with
   oasis_clear; `from` still owns shared data. */
oasis oasis_again(const oasis *from, opc_error *error);
void oasis_clear(oasis *o);
/* Continue at another place of the file. */
void oasis_seek(oasis *o, uint64_t at);
/* Fail with "'path': FAULT at byte N", with N the place of the record. */
void oasis_refuse(void *o, const char *what);
/* Begin a record. If a compressed block ends at this place, continue after the
   block in the file. Return 0 after a failure. */
int oasis_begin_record(oasis *o);
/* oasis_place returns the place in the file. oasis_consumed returns the number
   of bytes read so far, counted after decompression but at most 64 for each
   byte of the file. */
uint64_t oasis_place(const oasis *o);
uint64_t oasis_consumed(const oasis *o);
/* Continue in the contents of a CBLOCK record. */
void oasis_enter_block(oasis *o);
/* Make more bytes available. Fail and return 0 at the end of the data. */
int oasis_refill(oasis *o);

/* ---- numbers.c ---- */

/* Read a byte. */
static inline uint32_t oasis_byte(oasis *o) {
  if (o->p == o->end && !oasis_refill(o)) return 0;
  return *o->p++;
}

/* Read the bytes of an unsigned integer after its first byte. */
uint64_t oasis_long_uint(oasis *o, uint32_t first);

/* Read an unsigned integer. */
static inline uint64_t oasis_uint(oasis *o) {
  uint32_t b = oasis_byte(o);
  return b < 0x80 ? b : oasis_long_uint(o, b);
}

/* Read a signed integer; the sign is the lowest bit. */
static inline int64_t oasis_sint(oasis *o) {
  uint64_t v = oasis_uint(o);
  return v & 1 ? -(int64_t)(v >> 1) : (int64_t)(v >> 1);
}

/* Read an unsigned integer; fail with `what` if it exceeds 32 bits. oasis_real
   reads the type and the value of a real. */
uint32_t oasis_uint32(oasis *o, const char *what);
double oasis_real(oasis *o);
/* Read the value of a real whose type has been read. */
double oasis_real_of(oasis *o, uint64_t type);

/* Return `v` as a length; fail if `v` exceeds the range of coordinates. */
int64_t oasis_length(oasis *o, int64_t v);
int64_t oasis_size(oasis *o, uint64_t v);
/* Read a displacement: along an axis (1-delta), in one of 4 (2-delta) or 8
   directions (3-delta), in any direction (g-delta). */
oasis_vector oasis_delta1(oasis *o, int horizontal);
oasis_vector oasis_delta2(oasis *o);
oasis_vector oasis_delta3(oasis *o);
oasis_vector oasis_deltag(oasis *o);

/* Read a string; bytes that are not printable ASCII become "\xE4". Free with
   g_free. oasis_skip_string skips a string. */
char *oasis_string(oasis *o);
void oasis_skip_string(oasis *o);

/* ---- lookup.c: names; oasis_referred returns NULL after a failure ---- */

/* Read a name record; read a reference to a name, by number or as text; return
   the text of a reference in a table of names. */
void oasis_read_name(oasis *o, uint64_t record);
void oasis_read_reference(oasis *o, int by_number, oasis_reference *to);
const char *oasis_referred(oasis *o, int table, const oasis_reference *to);

/* oasis.c: read all records from START to END. */
void oasis_read(void *o);

/* ---- lists.c ---- */

/* Read a list of points (`closed`: of a polygon); read a repetition. */
void oasis_read_points(oasis *o, oasis_points *points, int closed);
void oasis_read_repetition(oasis *o);
/* Return the number of members of an element, 1 unless `repeated`; return the
   displacement of member i. */
uint64_t oasis_members(const oasis *o, int repeated);
oasis_vector oasis_member(const oasis *o, int repeated, uint64_t i);

/* ---- shapes.c, elements.c ---- */

/* Read the rest of a record, whose number has been read, and add its elements
   to the layout. The functions are named by the kind of the record. */
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

/* Fail if one of the modal variables `has` is undefined. The message is "WHAT
   without VARIABLE"; without `what`, the name of the variable is the message.
   Return 0 after a failure. */
int oasis_need(oasis *o, const char *what, uint32_t has);
/* Read the layer and the datatype if their bits in the information byte `info`
   of the record are set. `has` is the HAS_ bit of the layer; the bit of the
   datatype follows. */
void oasis_read_layer(oasis *o, uint32_t info, uint32_t has, uint32_t *layer,
                      uint32_t *datatype);
/* Read x and y if the bits `info` are set; update the modal variables. */
void oasis_read_place(oasis *o, uint32_t info, int64_t *x, int64_t *y);
/* Count `count` shapes of `points` points each. Fail and return 0 if the shapes
   of the file have too many points. */
int oasis_spend(oasis *o, uint64_t count, uint64_t points);
