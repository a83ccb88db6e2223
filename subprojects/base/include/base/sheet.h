/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of texts, for people and for programs. */
#pragma once

#include <glib.h>

typedef struct opc_sheet {
  size_t n;             /* columns */
  gboolean *left;       /* of each column: texts, not numbers */
  GPtrArray *cells;     /* char *, row by row, the head first */
  size_t rows, *widths; /* measured by the functions below */
} opc_sheet;

/* Return an empty table: fill `left` and `cells`. [any] */
opc_sheet *opc_sheet_new(size_t columns);
void opc_sheet_free(opc_sheet *sheet);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(opc_sheet, opc_sheet_free)

/* Return aligned columns, numbers to the right (g_free). A table that is wider
   than `width` names columns of equal cells once, in a last line. If that is
   not enough, each column of a table of few rows becomes a line; another table
   becomes blocks below each other, each with the columns that identify a row.
   0: one line a row. Line breaks and tabs in cells become blanks. */
char *opc_sheet_text(opc_sheet *sheet, size_t width);

/* Return a table in Markdown (g_free), without line breaks in cells, too. */
char *opc_sheet_markdown(opc_sheet *sheet);

/* Return RFC 4180, lines ended by CR LF (g_free). */
char *opc_sheet_csv(const opc_sheet *sheet);
