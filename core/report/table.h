/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables that plugins publish: copied, written as CSV, printed. */
#pragma once

#include <glib.h>
#include <opcflow/plugin.h>

/* A table. */
typedef struct opc_table {
  char *name, *step; /* `step`: publishing instance; may be NULL */
  uint32_t flags;    /* OPC_TABLE_PRINT */
  size_t rows, n_columns;
  opc_column *columns; /* names, units and data are owned */
} opc_table;

/* Return a copy of a plugin's table (opc_table_free), whose columns have
   `column_size` bytes each; NULL and *error if the table is not valid. */
opc_table *opc_table_new(const char *name, uint32_t flags, size_t rows,
                         const opc_column *columns, size_t n_columns,
                         size_t column_size, opc_error *error);
void opc_table_free(opc_table *table);

/* Add a column and return its data: one zeroed element per row. Texts in the
   column are freed with the table. */
void *opc_table_add(opc_table *table, const char *name, const char *unit,
                    uint32_t type, int32_t decimals);

/* Return the column of that name, NULL if there is none. */
const opc_column *opc_table_column(const opc_table *table, const char *name);

/* Return the text of a cell (g_free); "" for NAN. */
char *opc_table_cell(const opc_column *column, size_t row);

/* Return the table as CSV (g_free): RFC 4180, lines end with CR LF, headings
   "name (unit)". */
char *opc_table_csv(const opc_table *table);

/* Return the table as opc_sheet_text does (g_free; base/sheet.h). Numbers have
   all digits if `width` is 0, else six. */
char *opc_table_text(const opc_table *table, size_t width);

/* Return the table as Markdown (g_free). */
char *opc_table_markdown(const opc_table *table);
