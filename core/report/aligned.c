/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables for people: as aligned text that fits its place, and as Markdown. */
#include <base/unit.h>
#include <math.h>
#include <string.h>

#include "core/plugin/value.h"
#include "core/report/table.h"

/* ---- cells ---- */

/* Six digits of numbers that were given all of theirs; whole ones keep them. */
static char *short_cell(const opc_column *c, size_t row) {
  double value = c->type == OPC_REAL ? ((const double *)c->data)[row] : NAN;
  if (c->type != OPC_REAL || c->decimals >= 0 || !isfinite(value) ||
      (value == rint(value) && fabs(value) < 1e15))
    return opc_table_cell(c, row);
  char digits[40];
  g_ascii_formatd(digits, sizeof digits, "%.6g", value);
  return opc_number_text(g_ascii_strtod(digits, NULL));
}

static size_t width_of(const char *text) {
  return g_utf8_validate(text, -1, NULL) ? (size_t)g_utf8_strlen(text, -1)
                                         : strlen(text);
}

/* A table as texts. */
typedef struct sheet {
  const opc_table *table;
  size_t n, rows;   /* columns; rows with the head */
  size_t *widths;   /* of columns */
  GPtrArray *cells; /* char *, row by row */
} sheet;

static sheet sheet_of(const opc_table *table, gboolean exact) {
  sheet s = {table, table->n_columns, table->rows + 1,
             g_new0(size_t, table->n_columns + 1),
             g_ptr_array_new_with_free_func(g_free)};
  for (size_t row = 0; row < s.rows; row++)
    for (size_t i = 0; i < s.n; i++) {
      const opc_column *c = &table->columns[i];
      char *text = !row    ? opc_table_heading(c)
                   : exact ? opc_table_cell(c, row - 1)
                           : short_cell(c, row - 1);
      g_strdelimit(text, "\r\n\t", ' ');
      s.widths[i] = MAX(s.widths[i], width_of(text));
      g_ptr_array_add(s.cells, text);
    }
  return s;
}

static void sheet_clear(sheet *s) {
  g_free(s->widths);
  g_ptr_array_free(s->cells, TRUE);
}

static const char *cell_of(const sheet *s, size_t row, size_t i) {
  return s->cells->pdata[row * s->n + i];
}

/* ---- aligned text ---- */

enum { GAP = 2 };

/* The columns whose numbers are in a list, as one block. */
static void append_block(GString *out, const sheet *s, const GArray *list) {
  for (size_t row = 0; row < s->rows; row++) {
    for (guint k = 0; k < list->len; k++) {
      size_t i = g_array_index(list, size_t, k);
      const char *text = cell_of(s, row, i);
      gboolean left = s->table->columns[i].type == OPC_TEXT;
      int pad = (int)(s->widths[i] - width_of(text));
      if (k) g_string_append_printf(out, "%*s", GAP, "");
      if (!left) g_string_append_printf(out, "%*s", pad, "");
      g_string_append(out, text);
      if (left && k + 1 < list->len)
        g_string_append_printf(out, "%*s", pad, "");
    }
    g_string_append_c(out, '\n');
  }
}

static size_t total_of(const sheet *s, const GArray *list) {
  size_t total = list->len ? (list->len - 1) * GAP : 0;
  for (guint k = 0; k < list->len; k++)
    total += s->widths[g_array_index(list, size_t, k)];
  return total;
}

static gboolean is_constant(const sheet *s, size_t i) {
  for (size_t row = 2; row < s->rows; row++)
    if (strcmp(cell_of(s, 1, i), cell_of(s, row, i)) != 0) return FALSE;
  return s->rows > 2;
}

/* Take columns that are the same in all rows off the list; what they say goes
   into lines of their own. */
static void drop_constants(const sheet *s, GArray *list, size_t width,
                           GString *note) {
  size_t at = 0;
  for (guint k = 0; k < list->len;) {
    size_t i = g_array_index(list, size_t, k);
    if (!is_constant(s, i) || list->len == 1) {
      k++;
      continue;
    }
    g_array_remove_index(list, k);
    const char *value = cell_of(s, 1, i);
    g_autofree char *text = g_strdup_printf("%s %s", cell_of(s, 0, i),
                                            *value ? value : "(nothing)");
    const char *before = note->len ? ", " : "in all rows: ";
    if (note->len && at + width_of(text) + 2 > width) {
      before = ",\n  ";
      at = 0;
    }
    g_string_append_printf(note, "%s%s", before, text);
    at += strlen(before) + width_of(text);
  }
  if (note->len) g_string_append_c(note, '\n');
}

/* Whether the first k columns of a list tell all rows apart. */
static gboolean tells_apart(const sheet *s, const GArray *list, guint k) {
  g_autoptr(GHashTable) seen =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t row = 1; row < s->rows; row++) {
    GString *key = g_string_new(NULL);
    for (guint i = 0; i < k; i++)
      g_string_append_printf(key, "%s\n",
                             cell_of(s, row, g_array_index(list, size_t, i)));
    if (!g_hash_table_add(seen, g_string_free(key, FALSE))) return FALSE;
  }
  return TRUE;
}

/* How many columns say what a row is: the first one, and texts behind it while
   rows look alike, as far as half of the width. */
static guint count_keys(const sheet *s, const GArray *list, size_t width) {
  size_t total = s->widths[g_array_index(list, size_t, 0)];
  guint k = 1;
  for (; k < list->len && !tells_apart(s, list, k); k++) {
    size_t i = g_array_index(list, size_t, k);
    total += s->widths[i] + GAP;
    if (s->table->columns[i].type != OPC_TEXT || total > width / 2) break;
  }
  return k;
}

/* Blocks below each other, each with the key columns. */
static void append_blocks(GString *out, const sheet *s, const GArray *list,
                          size_t width) {
  guint keys = count_keys(s, list, width), k = keys;
  const size_t *columns = (const size_t *)(const void *)list->data;
  do {
    g_autoptr(GArray) block = g_array_new(FALSE, FALSE, sizeof(size_t));
    g_array_append_vals(block, columns, keys);
    do {
      if (k < list->len) g_array_append_val(block, columns[k]);
      k++;
    } while (k < list->len &&
             total_of(s, block) + GAP + s->widths[columns[k]] <= width);
    if (out->len) g_string_append_c(out, '\n');
    append_block(out, s, block);
  } while (k < list->len);
}

/* A line for each column, which begins with its head; rows side by side. */
static void append_turned(GString *out, const sheet *s, const GArray *list,
                          const size_t *widths) {
  for (guint k = 0; k < list->len; k++) {
    size_t i = g_array_index(list, size_t, k);
    for (size_t row = 0; row < s->rows; row++) {
      const char *text = cell_of(s, row, i);
      int pad = (int)(widths[row] - width_of(text));
      if (row) g_string_append_printf(out, "%*s%*s", GAP, "", pad, "");
      g_string_append(out, text);
      if (!row) g_string_append_printf(out, "%*s", pad, "");
    }
    g_string_append_c(out, '\n');
  }
}

/* Few rows of many columns are turned, if they fit then. */
static gboolean append_if_turned(GString *out, const sheet *s,
                                 const GArray *list, size_t width) {
  if (s->rows > list->len) return FALSE;
  g_autofree size_t *widths = g_new0(size_t, s->rows);
  size_t total = (s->rows - 1) * GAP;
  for (size_t row = 0; row < s->rows; row++) {
    for (guint k = 0; k < list->len; k++)
      widths[row] =
          MAX(widths[row],
              width_of(cell_of(s, row, g_array_index(list, size_t, k))));
    total += widths[row];
  }
  if (total > width) return FALSE;
  append_turned(out, s, list, widths);
  return TRUE;
}

static void append_narrow(GString *out, const sheet *s, const GArray *list,
                          size_t width) {
  if (!append_if_turned(out, s, list, width))
    append_blocks(out, s, list, width);
}

char *opc_table_text(const opc_table *table, size_t width) {
  sheet s = sheet_of(table, !width);
  GString *out = g_string_new(NULL);
  g_autoptr(GString) note = g_string_new(NULL);
  g_autoptr(GArray) list = g_array_new(FALSE, FALSE, sizeof(size_t));
  for (size_t i = 0; i < s.n; i++) g_array_append_val(list, i);
  if (width && total_of(&s, list) > width)
    drop_constants(&s, list, width, note);
  if (width && total_of(&s, list) > width)
    append_narrow(out, &s, list, width);
  else
    append_block(out, &s, list);
  g_string_append(out, note->str);
  sheet_clear(&s);
  return g_string_free(out, FALSE);
}

/* ---- Markdown ---- */

/* A bar would end its cell, and a backslash hide a bar. */
static void append_escaped(GString *out, const char *text) {
  for (; *text; text++) {
    if (strchr("|\\`*_<", *text)) g_string_append_c(out, '\\');
    g_string_append_c(out, *text);
  }
}

char *opc_table_markdown(const opc_table *table) {
  sheet s = sheet_of(table, FALSE);
  GString *out = g_string_new(NULL);
  for (size_t row = 0; row < s.rows; row++) {
    for (size_t i = 0; i < s.n; i++) {
      g_string_append(out, i ? " | " : "| ");
      append_escaped(out, cell_of(&s, row, i));
    }
    g_string_append(out, " |\n");
    for (size_t i = 0; !row && i < s.n; i++)
      g_string_append(out,
                      table->columns[i].type == OPC_TEXT ? "|---" : "|--:");
    if (!row) g_string_append(out, "|\n");
  }
  sheet_clear(&s);
  return g_string_free(out, FALSE);
}
