/* SPDX-License-Identifier: BSD-3-Clause */
/* Netlist files as lines of words, private to the library. */
#pragma once

#include <eda/netlist.h>

/* A word of a line. */
typedef struct word {
  const char *text;
  eda_place at;
  int quoted; /* 1: an expression or file name within quotes or braces */
} word;

/* A line with its continuation lines. */
typedef struct line {
  size_t words, capacity;
  word *word;
  size_t length, text_capacity;
  char *text; /* original text without comments; "\n+ " joins continuation lines
               */
  double x, y; /* position from a comment, nm; NAN: none */
} line;

/* State of the reader of lines. */
typedef struct eda_lines {
  opc_error *error;
  eda_pool *pool;
  /* Function called for each statement (a line with its continuation lines),
     and the argument of the function. */
  int (*take)(void *data, const line *l);
  void *data;

  size_t files, capacity;
  const char **file;
  int ended; /* set by `take` at .end; the rest of the file is not read */
  int depth; /* current nesting depth of .include */
  size_t bytes;
  int wraps; /* 1: a '{' may be closed in a continuation line */
  /* Real path of the folder that must contain all included files, ending with
     '/'. NULL: no restriction. */
  const char *root;
} lines;

/* Read a file or a text, and call `take` for each line. Return OPC_OK, or an
   error code and lines.error. */
int lines_read(lines *s, const char *path);
int lines_read_text(lines *s, const char *name, const char *text,
                    size_t length);

/* Return the real path of the folder of a file, for `root`; NULL if the file
   does not exist. */
const char *lines_folder(eda_pool *pool, const char *path);

/* lines_is_include: return whether a line is .include or .inc. lines_include:
   read the included file, relative to the folder of the including file. */
int lines_is_include(const line *l);
int lines_include(lines *s, const line *l);

/* Set "FILE:LINE:COLUMN: MESSAGE" as the error, and return OPC_INVALID. */
int lines_refuse(const lines *s, eda_place at, const char *format, ...)
    OPC_PRINTF(3, 4);

/* Return whether a word is '='. */
int is_equals(const word *w);

/* ---- value.c ---- */

/* Compute the value of a setting: a number, or an expression of parameters.
   Return an OPC_* code. */
int netlist_value(const eda_netlist *n, const eda_scope *in,
                  const eda_assignment *s, double *out);

/* Parse a plain SPICE number such as "0.21u" or "1meg". Return the first byte
   after the number and unit; NULL if the text does not begin with a number. */
const char *netlist_number(const char *text, double *out);

/* ---- parse.c ---- */

/* Return the transistor type of a model, EDA_NMOS or EDA_PMOS; -1 if
   unknown. */
int netlist_type(const eda_netlist *n, const char *model);
