/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of texts, formatted for readers or as CSV. [any]: see opcflow/base.h.
 */
#pragma once

#include <glib.h>

/* A table of texts. */
typedef struct opc_sheet {
  size_t n;         /* columns */
  gboolean *left;   /* [n], TRUE for left-aligned texts, FALSE for numbers */
  GPtrArray *cells; /* char *, owned by the array, row by row; the first row is
                       the head */
  /* Set by the functions below: */
  size_t rows;    /* number of rows, including the head */
  size_t *widths; /* [n], width of each column, characters */
} opc_sheet;

/* Return an empty table; the caller fills `left` and `cells`. [any] */
opc_sheet *opc_sheet_new(size_t columns);
/* Free a table with its texts. */
void opc_sheet_free(opc_sheet *sheet);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_sheet, opc_sheet_free)

/* Return a text with aligned columns (g_free); numbers are right-aligned. A
   table that is wider than `width` characters is changed as follows. If the
   table has two or more rows, a column with equal cells in all rows is printed
   as one line below the table. If the other columns are still too wide, a table
   with fewer rows than columns is transposed, if the transposed table fits.
   Other tables are split into blocks of columns, each with the columns that
   identify a row. If `width` is 0, each row is one line. Line breaks and tabs
   become blanks. */
char *opc_sheet_text(opc_sheet *sheet, size_t width);

/* Return a table in Markdown (g_free); line breaks in cells become blanks. */
char *opc_sheet_markdown(opc_sheet *sheet);

/* Return CSV by RFC 4180, with lines that end with CR LF (g_free).

   An apostrophe marks a cell that a spreadsheet would execute: the first
   character is one of = + - @ and the cell is not a quantity. An apostrophe
   also marks a cell that begins with an apostrophe or has control characters
   other than line breaks. In a marked cell, a backslash is written twice, and a
   control character as a backslash and xHH.
 */
char *opc_sheet_csv(const opc_sheet *sheet);

/* Restore the text of a marked cell, in place. [any] */
void opc_cell_unmark(char *text);
