/* SPDX-License-Identifier: BSD-3-Clause */
/* CSV files written by users: a line of column names in any order, each with an
   optional unit in brackets, then one row per line. Blank lines and lines that
   begin with # are skipped; blanks around a field are ignored. Fields have no
   quotes and no commas. Missing fields at the end of a row are empty. Errors
   name the place as file:line:column. Tables that opcflow itself writes have
   another format: runs.h. */
#pragma once

#include <eda/devices.h>

OPC_C_BEGIN

/* A column of a table. */
typedef struct eda_csv_column {
  const char *name;
  const char *unit; /* the only unit accepted in brackets; NULL: the column name
                       must not have brackets */
  int optional;     /* non-zero: the column may be missing */
} eda_csv_column;

/* Flags of eda_csv_read. */
enum {
  EDA_CSV_OTHERS = 1 << 0, /* accept and ignore other columns */
  EDA_CSV_EMPTY = 1 << 1   /* accept a table without rows */
};

/* A table in memory. */
typedef struct eda_csv eda_csv;

/* Read a file of up to 64 MB. Return the table, or NULL and *error, which names
   `parameter`: OPC_IO if the file cannot be read, else OPC_INVALID. columns[n]
   must outlive the table. In the functions below, `column` is an index into
   this array. */
OPC_EXPORT eda_csv *eda_csv_read(const char *path, const char *parameter,
                                 const eda_csv_column *columns, size_t n,
                                 uint32_t flags, opc_error *error);
/* Free a table (NULL: do nothing). */
OPC_EXPORT void eda_csv_free(eda_csv *csv);

/* Return the number of rows, without the line of column names. */
OPC_EXPORT size_t eda_csv_rows(const eda_csv *csv);

/* Return 1 if the file has the column, otherwise 0. */
OPC_EXPORT int eda_csv_has(const eda_csv *csv, int column);

/* Return the text of a field, owned by the table; "" if the column is
   missing. */
OPC_EXPORT const char *eda_csv_text(const eda_csv *csv, size_t row, int column);

/* Fill *error with "path:line:column: what 'field'" and return OPC_INVALID. */
OPC_EXPORT int eda_csv_fail(const eda_csv *csv, size_t row, int column,
                            const char *what, opc_error *error);

/* Read a field as a finite number greater than `above` into *value. Return
   OPC_INVALID and an error for other texts and if the field or its column is
   missing. */
OPC_EXPORT int eda_csv_number(const eda_csv *csv, size_t row, int column,
                              double above, double *value, opc_error *error);

/* Read a transistor type: "n" or "nmos" sets *type to EDA_NMOS, "p" or "pmos"
   to EDA_PMOS. Return OPC_INVALID and *error for other texts. */
OPC_EXPORT int eda_csv_type(const eda_csv *csv, size_t row, int column,
                            int *type, opc_error *error);

OPC_C_END
