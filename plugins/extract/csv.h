/* SPDX-License-Identifier: BSD-3-Clause */
/* Small CSV files: a line of column names, in any order and each with its unit
   in brackets if it likes, then rows; empty lines and lines that begin with #
   are skipped. Faults carry file:line:column. */
#ifndef EXTRACT_CSV_H
#define EXTRACT_CSV_H

#include <glib.h>
#include <opcflow/plugin.h>

enum { CSV_COLUMNS = 8 };

typedef struct csv {
  const opc_host *host;
  const char *path, *parameter;
  int columns;
  const char *const *names, *const *units;   /* NULL: has none */
  int field[CSV_COLUMNS];   /* of each column; -1: not there */
  char **text;              /* the lines of the file */
  GPtrArray *rows;          /* char **: the fields */
  GArray *lines;            /* int: their numbers */
} csv;

/* Read a file. The first `required` columns must be there, others may. `c` has
   host, path, parameter, columns, names and units; is to be cleared. */
int csv_read(csv *c, int required, opc_error *error);
void csv_clear(csv *c);

int csv_has(const csv *c, int column);
/* The text of a field, without blanks around it; "" if it is not there. */
const char *csv_text(const csv *c, guint row, int column);
/* An error about a field: "path:line:column: what 'field'". */
int csv_fail(const csv *c, guint row, int column, const char *what,
             opc_error *error);
/* A finite number above `above`. */
int csv_number(const csv *c, guint row, int column, double above, double *value,
               opc_error *error);
/* "n", "nmos" or "p", "pmos". */
int csv_type(const csv *c, guint row, int column, int *type, opc_error *error);

#endif
