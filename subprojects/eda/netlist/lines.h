/* SPDX-License-Identifier: BSD-3-Clause */
/* Netlist files as lines of words, private to the library. */
#pragma once

#include <eda/netlist.h>

typedef struct word {
  const char *text;
  eda_place at;
  int quoted; /* quoted: an expression */
} word;

typedef struct line {
  size_t words, capacity;
  word *word;
  size_t length, text_capacity;
  char *text;  /* original text without comments; "\n+ " between continued
                  parts */
  double x, y; /* position in a comment, nm; or NAN */
} line;

typedef struct eda_lines {
  opc_error *error;
  eda_pool *pool;
  /* Callback for each line that is not empty, and its data. */
  int (*take)(void *data, const line *l);
  void *data;

  size_t files, capacity;
  const char **file;
  int ended; /* set by `take` after .end */
  int depth; /* depth of .include */
  size_t bytes;
  int wraps; /* whether a continuation line may close a '{' */
  /* Real path, ending with '/', of the folder that must contain included files;
     NULL: no restriction. */
  const char *root;
} lines;

/* Read a file, or a text, and call `take` for each line. Return an OPC_*
   code. */
int lines_read(lines *s, const char *path);
int lines_read_text(lines *s, const char *name, const char *text,
                    size_t length);

/* Return the folder of a file as a root; NULL if the folder does not exist. */
const char *lines_folder(eda_pool *pool, const char *path);

/* Return whether a line is .include or .inc; or execute it: read another file,
   relative to that of the line. */
int lines_is_include(const line *l);
int lines_include(lines *s, const line *l);

/* Return OPC_INVALID with "FILE:LINE:COLUMN: MESSAGE" for a place. */
int lines_refuse(const lines *s, eda_place at, const char *format, ...)
    OPC_PRINTF(3, 4);

/* Return whether a word is '='. */
int is_equals(const word *w);

/* ---- value.c ---- */

/* Compute the value of a setting: a number, or an expression of parameters.
   Return an OPC_* code. */
int netlist_value(const eda_netlist *n, const eda_scope *in,
                  const eda_assignment *s, double *out);

/* Parse a plain SPICE number ("0.21u", "1meg"). Return the end of the number,
   NULL without a number. */
const char *netlist_number(const char *text, double *out);

/* ---- parse.c ---- */

/* Return EDA_NMOS or EDA_PMOS, -1 if unknown. */
int netlist_type(const eda_netlist *n, const char *model);
