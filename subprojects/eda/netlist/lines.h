/* SPDX-License-Identifier: BSD-3-Clause */
/* Netlist files as lines of words. Inside the library only. */
#pragma once

#include <eda/netlist.h>

typedef struct word {
  const char *text;
  eda_place at;
  int quoted; /* an expression */
} word;

typedef struct line {
  size_t words, room;
  word *word;
  size_t length, text_room;
  char *text;  /* as it is written, without comments; "\n+ " between pieces */
  double x, y; /* of a comment, nm; or NAN */
} line;

typedef struct eda_lines {
  opc_error *error;
  eda_pool *pool;
  /* What to do with a line that is not empty, and with what. */
  int (*take)(void *data, const line *l);
  void *data;

  size_t files, room;
  const char **file;
  int ended; /* set by `take` after .end */
  int depth; /* of .include */
  size_t bytes;
  int wraps; /* whether a '{' may be closed in a continuation */
  /* The real path, with a '/' at its end, of the folder that what is included
     must lie in; NULL: it may lie anywhere. */
  const char *root;
} lines;

/* Read a file, or the text of one, and have each of its lines taken. */
int lines_read(lines *s, const char *path);
int lines_read_text(lines *s, const char *name, const char *text,
                    size_t length);

/* The folder of a file, as a root; NULL if it is not there. */
const char *lines_folder(eda_pool *pool, const char *path);

/* Whether it is .include, or .inc; and what that asks for: to read another
   file, beside the one that the line stands in. */
int lines_is_include(const line *l);
int lines_include(lines *s, const line *l);

/* Refuse what stands at a place: OPC_INVALID, "FILE:LINE:COLUMN: WHAT". */
int lines_refuse(const lines *s, eda_place at, const char *format, ...)
    OPC_PRINTF(3, 4);

/* Whether a word is a '='. */
int is_equals(const word *w);

/* ---- value.c ---- */

/* The value of a setting: a number, or an expression of parameters. */
int netlist_value(const eda_netlist *n, const eda_scope *in,
                  const eda_assignment *s, double *out);

/* A plain SPICE number ("0.21u", "1meg"); the place behind it, NULL if there is
   none. */
const char *netlist_number(const char *text, double *out);

/* ---- parse.c ---- */

/* EDA_NMOS or EDA_PMOS, -1 if nothing tells. */
int netlist_type(const eda_netlist *n, const char *model);
