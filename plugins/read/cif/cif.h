/* SPDX-License-Identifier: BSD-3-Clause */
/* Common header of the files of read.cif.
   A file is read twice by the same parser. The first pass, the survey, finds
   the symbols, their names and their scale factors. The scale factors, and odd
   widths or lengths, determine the unit of the layout. The second pass builds
   the layout. (Mead and Conway, Introduction to VLSI Systems, section 4.5:
   CIF 2.0.) */
#pragma once

#include "../reader.h"

/* A symbol, the CIF term for a cell. symbols[0] stands for the commands outside
   of all symbols. */
typedef struct cif_symbol {
  int64_t number;
  int64_t a, b;   /* a / b is the unit of coordinates, centimicrons */
  int64_t factor; /* unit of coordinates, in units of the layout */
  char *name;     /* NULL if the symbol has no name; the cell is then named by
                     the number */
  size_t at;      /* place of the first mention in the text */
  int defined;
  int odd;      /* 1: a box or wire has an odd width or length */
  int32_t cell; /* cell of the layout; -1: none */
} cif_symbol;

/* A command DD at the place `at` of the text, which deletes all symbols with
   numbers of at least `from`. */
typedef struct cif_forgotten {
  int64_t from;
  size_t at;
} cif_forgotten;

/* Transformation of a call: mirror about the x axis if `mirror` is set, rotate
   by `angle` degrees, and move by (x, y) in coordinates of the calling symbol.
 */
typedef struct cif_transform {
  int mirror;
  double angle, x, y;
} cif_transform;

/* State of the reader. */
typedef struct cif {
  reading b;
  size_t at, command; /* place in the text; place of the current command */
  int building;       /* 1 in the second pass */
  GPtrArray *symbols; /* cif_symbol, in the order of their first mention */
  size_t mentioned;   /* number of symbols mentioned so far in this pass */
  GHashTable
      *numbers; /* symbol that each number denotes at the current command */
  GArray
      *forgotten; /* cif_forgotten; `from` and `at` increase with the index */

  cif_symbol *current;  /* symbol that contains the current command */
  char *layer, *outer;  /* current layer; layer before the current symbol */
  int32_t layer_number; /* layer of the layout for `layer`; -1 until needed */
  GArray *points;       /* eda_point */

  /* Contents outside of all symbols. */
  size_t loose, calls; /* number of shapes and texts; of calls */
  int moved;           /* 1: a call has a transformation */
  cif_symbol *called;  /* symbol of the last call */
} cif;

/* Fail with "FILE:LINE:COLUMN: FAULT (byte N)" for the place `at`, or for the
   current command. Parsing ends after a failure. */
void cif_refuse_at(cif *c, size_t at, const char *what);
void cif_refuse(void *c, const char *what);

/* ---- symbols.c ---- */

/* Return symbol i. */
static inline cif_symbol *cif_symbol_at(const cif *c, size_t i) {
  return c->symbols->pdata[i];
}

/* Allocate the state; free it. */
void cif_open(cif *c);
void cif_clear(cif *c);
/* Return the symbol that a number denotes at the current command; create the
   symbol if necessary. After DD, a number can be defined again. */
cif_symbol *cif_symbol_of(cif *c, int64_t number);
/* Delete the symbols with numbers of at least `from` (DD). */
void cif_forget(cif *c, int64_t from);
/* Start a pass. */
void cif_begin(cif *c);
/* Select the unit and create the layout and its cells, after the survey. */
void cif_make_cells(cif *c);

/* ---- parse.c ---- */

/* Read the file once: one pass. */
void cif_parse(cif *c);

/* ---- build.c: shapes and calls, in coordinates of the current symbol ---- */

/* Add a box with the centre (x, y) and the length along the direction (dx, dy).
 */
void cif_box(cif *c, int64_t length, int64_t width, int64_t x, int64_t y,
             int64_t dx, int64_t dy);
/* Add c->points, in units, as a polygon. */
void cif_polygon(cif *c);
/* Add a wire along c->points, a round flash, a text, a call of a symbol. */
void cif_wire(cif *c, int64_t width);
void cif_flash(cif *c, int64_t diameter, int64_t x, int64_t y);
void cif_label(cif *c, const char *label, int64_t x, int64_t y);
void cif_call(cif *c, cif_symbol *called, const cif_transform *t);
/* Return a coordinate of the current symbol in units; fail beyond 32 bits. */
int32_t cif_units(cif *c, int64_t v);
/* Return the angle of a direction, degrees, exact for axes and diagonals. */
double cif_angle(int64_t dx, int64_t dy);
