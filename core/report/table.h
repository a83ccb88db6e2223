/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables that plugins publish: kept, written as CSV, shown. */
#pragma once

#include <glib.h>
#include <opcflow/plugin.h>

typedef struct opc_table {
  char *name, *step; /* `step`: whose it is; may be NULL */
  uint32_t flags;    /* OPC_TABLE_PRINT */
  size_t rows, n_columns;
  opc_column *columns; /* copies: names, units and data are its own */
} opc_table;

/* A copy of what a plugin gave, in columns of `column_size` bytes each; NULL
 *and error if it is not sound. */
opc_table *opc_table_new(const char *name, uint32_t flags, size_t rows,
                         const opc_column *columns, size_t n_columns,
                         size_t column_size, opc_error *error);
void opc_table_free(opc_table *table);

/* Add a column: its data, room for all rows, filled with zeros. Texts in it are
   freed with the table. */
void *opc_table_add(opc_table *table, const char *name, const char *unit,
                    uint32_t type, int32_t decimals);

/* The column of that name, NULL if there is none. */
const opc_column *opc_table_column(const opc_table *table, const char *name);

/* The text of a cell (g_free); "" for NAN. */
char *opc_table_cell(const opc_column *column, size_t row);

/* RFC 4180, lines ended by CR LF, the first with "name (unit)". */
char *opc_table_csv(const opc_table *table);

/* "name (unit)" (g_free) */
char *opc_table_heading(const opc_column *column);

/* Return the table as opc_sheet_text does (base/sheet.h); without a width with
   all digits of numbers, else with six. */
char *opc_table_text(const opc_table *table, size_t width);

/* As a table in Markdown. */
char *opc_table_markdown(const opc_table *table);
