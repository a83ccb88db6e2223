/* SPDX-License-Identifier: BSD-3-Clause */
/* The parts of read.cif.

   A file is read twice: a survey finds the symbols, their names and scale
   factors, from which the unit follows; then the layout is built. Both go
   through the same parser. (Mead and Conway, Introduction to VLSI Systems,
   section 4.5: CIF 2.0.) */
#ifndef OPCFLOW_CIF_H
#define OPCFLOW_CIF_H

#include <glib.h>

#include "../reader.h"

/* Number 0 is what stands outside of all symbols. */
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
  const reader *r;
  uint8_t *seen; /* of each pair of the map of layers */

  char *text;            /* the file */
  size_t n, at, command; /* its length, the place, the current command */

  int building;
  eda_layout *layout;
  cif_symbol *symbols; /* in order of their first mention */
  size_t n_symbols, room_symbols;
  size_t mentioned;         /* of them, in this reading */
  GHashTable *numbers;      /* number to its latest mention; symbols.c */
  cif_forgotten *forgotten; /* both fields increase */
  size_t n_forgotten, room_forgotten;

  size_t current;      /* symbol */
  char *layer, *outer; /* its name, and the one outside the symbol */
  size_t room_layer, room_outer;
  int32_t layer_number; /* -1: not looked up yet */
  eda_point *points;
  size_t n_points, room_points;
  char *word;
  size_t room_word;

  /* What stands outside of all symbols. */
  size_t loose, calls; /* shapes and texts; calls */
  int moved;           /* a call is not just the symbol as it is */
  size_t called;       /* the last one */
} cif;

/* "FILE:LINE:COLUMN: WHAT (byte N)", of the place `at`. */
int cif_refuse(cif *c, size_t at, opc_error *error, const char *what);

/* ---- symbols.c ---- */

/* The symbol that a number means here, new if need be. */
size_t cif_symbol_of(cif *c, int64_t number);
void cif_forget(cif *c, int64_t from);
/* Begin a reading. */
void cif_begin(cif *c);
/* After the survey: the unit, the layout and its cells. */
int cif_make_cells(cif *c, opc_error *error);

/* ---- parse.c ---- */

int cif_parse(cif *c, opc_error *error);

/* ---- build.c: what the parser found, in the symbol's own coordinates ---- */

int cif_box(cif *c, int64_t length, int64_t width, int64_t x, int64_t y,
            int64_t dx, int64_t dy, opc_error *error);
/* c->points, whose coordinates are in units already. */
int cif_polygon(cif *c, opc_error *error);
int cif_wire(cif *c, int64_t width, opc_error *error);
int cif_flash(cif *c, int64_t diameter, int64_t x, int64_t y, opc_error *error);
int cif_label(cif *c, const char *label, int64_t x, int64_t y,
              opc_error *error);
int cif_call(cif *c, size_t symbol, const cif_transform *t, opc_error *error);
/* A coordinate of the current symbol in units; refused beyond 32 bits. */
int cif_units(cif *c, int64_t v, int32_t *out, opc_error *error);
/* The angle of a direction, degrees, exact for the axes and diagonals. */
double cif_angle(int64_t dx, int64_t dy);
/* Once all is built: names of layers that do not occur are refused. */
int cif_check_layers(cif *c, opc_error *error);

#endif
