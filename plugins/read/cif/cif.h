/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of read.cif.

   A file is read twice: a survey finds the symbols, their names and scale
   factors, from which the unit follows; then the layout is built. Both go
   through the same parser. (Mead and Conway, Introduction to VLSI Systems,
   section 4.5: CIF 2.0.) */
#ifndef OPCFLOW_CIF_H
#define OPCFLOW_CIF_H

#include "../reader.h"

/* The first one is what stands outside of all symbols. */
typedef struct cif_symbol {
  int64_t number;
  int64_t a, b;   /* its coordinates times a / b are centimicrons */
  int64_t factor; /* its coordinates times this are units */
  char *name;     /* NULL: called after its number */
  size_t at;      /* where it is first mentioned */
  int defined;
  int odd; /* a width or length in it is odd */
  int32_t cell;
} cif_symbol;

/* Numbers that are forgotten from some place of the file on (DD). */
typedef struct cif_forgotten {
  int64_t from;
  size_t at;
} cif_forgotten;

/* mirror about the x axis, turn by `angle` degrees, move by (x, y) units */
typedef struct cif_transform {
  int mirror;
  double angle, x, y;
} cif_transform;

typedef struct cif {
  reading b;
  size_t at, command; /* the place in the text, the current command */
  int building;
  GPtrArray *symbols;  /* of cif_symbol, in order of their first mention */
  size_t mentioned;    /* of them, in this reading */
  GHashTable *numbers; /* number to its latest mention; symbols.c */
  GArray *forgotten;   /* of cif_forgotten: both fields increase */

  cif_symbol *current;  /* the first one is not defined by the file */
  char *layer, *outer;  /* its name, and the one outside the symbol */
  int32_t layer_number; /* -1: not looked up yet */
  GArray *points;       /* of eda_point */

  /* What stands outside of all symbols. */
  size_t loose, calls; /* shapes and texts; calls */
  int moved;           /* a call is not just the symbol as it is */
  cif_symbol *called;  /* the last one */
} cif;

/* "FILE:LINE:COLUMN: WHAT (byte N)", of the place `at`, or of the current
   command. After a failure there is nothing more to read. */
void cif_refuse_at(cif *c, size_t at, const char *what);
void cif_refuse(void *c, const char *what);

/* ---- symbols.c ---- */

static inline cif_symbol *cif_symbol_at(const cif *c, size_t i) {
  return c->symbols->pdata[i];
}

void cif_open(cif *c);
void cif_clear(cif *c);
/* The symbol that a number means here, new if need be. */
cif_symbol *cif_symbol_of(cif *c, int64_t number);
void cif_forget(cif *c, int64_t from);
/* Begin a reading. */
void cif_begin(cif *c);
/* After the survey: the unit, the layout and its cells. */
void cif_make_cells(cif *c);

/* ---- parse.c ---- */

void cif_parse(cif *c);

/* ---- build.c: what the parser found, in the symbol's own coordinates ---- */

void cif_box(cif *c, int64_t length, int64_t width, int64_t x, int64_t y,
             int64_t dx, int64_t dy);
/* c->points, whose coordinates are in units already. */
void cif_polygon(cif *c);
void cif_wire(cif *c, int64_t width);
void cif_flash(cif *c, int64_t diameter, int64_t x, int64_t y);
void cif_label(cif *c, const char *label, int64_t x, int64_t y);
void cif_call(cif *c, cif_symbol *called, const cif_transform *t);
/* A coordinate of the current symbol in units; refused beyond 32 bits. */
int32_t cif_units(cif *c, int64_t v);
/* The angle of a direction, degrees, exact for the axes and diagonals. */
double cif_angle(int64_t dx, int64_t dy);

#endif
