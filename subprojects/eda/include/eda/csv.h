/* SPDX-License-Identifier: BSD-3-Clause */
/* CSV files written by users: a line of column names in any order, each with an
   optional unit in brackets, then rows. Empty lines and lines that begin with #
   are skipped; blanks around a field are ignored. Errors carry
   file:line:column. */
#pragma once

#include <eda/devices.h>

OPC_C_BEGIN

/* A column of a table. */
typedef struct eda_csv_column {
  const char *name;
  const char *unit; /* only accepted unit; NULL: none */
  int optional;     /* non-zero: the column may be missing */
} eda_csv_column;

enum {
  EDA_CSV_OTHERS = 1 << 0, /* accept and ignore other columns */
  EDA_CSV_EMPTY = 1 << 1   /* accept a table without rows */
};

typedef struct eda_csv eda_csv;

/* Return a table of up to 64 MB; NULL and *error, which names `parameter`, on
   failure. The table refers to `columns`, which the caller keeps. Below,
   `column` is an index into `columns`. */
OPC_EXPORT eda_csv *eda_csv_read(const char *path, const char *parameter,
                                 const eda_csv_column *columns, size_t n,
                                 uint32_t flags, opc_error *error);
OPC_EXPORT void eda_csv_free(eda_csv *csv);

OPC_EXPORT size_t eda_csv_rows(const eda_csv *csv);

/* Return whether the table has a column. */
OPC_EXPORT int eda_csv_has(const eda_csv *csv, int column);

/* Return the text of a field; "" if the column is missing. The table owns the
   text. */
OPC_EXPORT const char *eda_csv_text(const eda_csv *csv, size_t row, int column);

/* Fill *error with "path:line:column: what 'field'" and return its code. */
OPC_EXPORT int eda_csv_fail(const eda_csv *csv, size_t row, int column,
                            const char *what, opc_error *error);

/* Read a finite number above `above`. Return OPC_INVALID and *error for other
   texts. */
OPC_EXPORT int eda_csv_number(const eda_csv *csv, size_t row, int column,
                              double above, double *value, opc_error *error);

/* Read a transistor type: "n" or "nmos", "p" or "pmos" set *type to EDA_NMOS or
   EDA_PMOS. Return OPC_INVALID and *error for other texts. */
OPC_EXPORT int eda_csv_type(const eda_csv *csv, size_t row, int column,
                            int *type, opc_error *error);

OPC_C_END
