/* SPDX-License-Identifier: BSD-3-Clause */
/* Small tables that users write: CSV files with a line of column names, in any
   order and each with its unit in brackets if it likes, then rows. Empty lines
   and lines that begin with # are skipped; blanks around a field do not count.
   Faults carry file:line:column. */
#ifndef EDA_CSV_H
#define EDA_CSV_H

#include <eda/devices.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A column that a table may have. */
typedef struct eda_csv_column {
  const char *name;
  const char *unit; /* the only one it may be given; NULL: none */
  int optional;     /* non-zero: the table may lack it */
} eda_csv_column;

enum {
  EDA_CSV_OTHERS = 1 << 0, /* it may have other columns: they are ignored */
  EDA_CSV_EMPTY = 1 << 1   /* it may have no rows */
};

typedef struct eda_csv eda_csv;

/* Read a table of up to 64 MB; NULL and *error, which names `parameter`. The
   table points to `columns`; below, a column is its number there. */
OPC_EXPORT eda_csv *eda_csv_read(const char *path, const char *parameter,
                                 const eda_csv_column *columns, size_t n,
                                 uint32_t flags, opc_error *error);
OPC_EXPORT void eda_csv_free(eda_csv *csv);

OPC_EXPORT size_t eda_csv_rows(const eda_csv *csv);

/* Whether the table has that column. */
OPC_EXPORT int eda_csv_has(const eda_csv *csv, int column);

/* The text of a field; "" if it is not there. */
OPC_EXPORT const char *eda_csv_text(const eda_csv *csv, size_t row, int column);

/* An error about a field: "path:line:column: what 'field'". The code. */
OPC_EXPORT int eda_csv_fail(const eda_csv *csv, size_t row, int column,
                            const char *what, opc_error *error);

/* A finite number above `above`. */
OPC_EXPORT int eda_csv_number(const eda_csv *csv, size_t row, int column,
                              double above, double *value, opc_error *error);

/* The type of a transistor, "n" or "nmos", "p" or "pmos": EDA_NMOS, EDA_PMOS.
 */
OPC_EXPORT int eda_csv_type(const eda_csv *csv, size_t row, int column,
                            int *type, opc_error *error);

#ifdef __cplusplus
}
#endif
#endif
