/* SPDX-License-Identifier: BSD-3-Clause */
/* Tables of texts: as columns of limited width, as Markdown and as CSV. */
#include <base/sheet.h>
#include <string.h>

/* ---- cells ---- */

opc_sheet *opc_sheet_new(size_t columns) {
  opc_sheet *s = g_new0(opc_sheet, 1);
  s->n = columns;
  s->left = g_new0(gboolean, columns + 1);
  s->widths = g_new0(size_t, columns + 1);
  s->cells = g_ptr_array_new_with_free_func(g_free);
  return s;
}

void opc_sheet_free(opc_sheet *s) {
  g_free(s->left);
  g_free(s->widths);
  g_ptr_array_free(s->cells, TRUE);
  g_free(s);
}

static size_t width_of(const char *text) {
  return g_utf8_validate(text, -1, NULL) ? (size_t)g_utf8_strlen(text, -1)
                                         : strlen(text);
}

static const char *cell_of(const opc_sheet *s, size_t row, size_t i) {
  return s->cells->pdata[row * s->n + i];
}

/* Replace line breaks in cells, and measure the columns. */
static void sheet_measure(opc_sheet *s) {
  s->rows = s->cells->len / MAX(s->n, 1);
  for (guint k = 0; k < s->cells->len; k++) {
    char *text = g_strdelimit(s->cells->pdata[k], "\r\n\t", ' ');
    s->widths[k % s->n] = MAX(s->widths[k % s->n], width_of(text));
  }
}

/* ---- aligned text ---- */

enum { GAP = 2 };

/* Append the columns with the numbers in a list as one block. */
static void append_block(GString *out, const opc_sheet *s, const GArray *list) {
  for (size_t row = 0; row < s->rows; row++) {
    for (guint k = 0; k < list->len; k++) {
      size_t i = g_array_index(list, size_t, k);
      const char *text = cell_of(s, row, i);
      gboolean left = s->left[i];
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

static size_t total_of(const opc_sheet *s, const GArray *list) {
  size_t total = list->len ? (list->len - 1) * GAP : 0;
  for (guint k = 0; k < list->len; k++)
    total += s->widths[g_array_index(list, size_t, k)];
  return total;
}

static gboolean is_constant(const opc_sheet *s, size_t i) {
  for (size_t row = 2; row < s->rows; row++)
    if (strcmp(cell_of(s, 1, i), cell_of(s, row, i)) != 0) return FALSE;
  return s->rows > 2;
}

/* Remove columns with equal cells from the list, and append their names and
   values to a note. */
static void drop_constants(const opc_sheet *s, GArray *list, size_t width,
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

/* Return whether the first k columns of a list differ in each pair of rows. */
static gboolean rows_differ(const opc_sheet *s, const GArray *list, guint k) {
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

/* Return the number of columns that identify a row: the first column, and the
   next text columns while some rows are equal, up to half of the width. */
static guint count_keys(const opc_sheet *s, const GArray *list, size_t width) {
  size_t total = s->widths[g_array_index(list, size_t, 0)];
  guint k = 1;
  for (; k < list->len && !rows_differ(s, list, k); k++) {
    size_t i = g_array_index(list, size_t, k);
    total += s->widths[i] + GAP;
    if (!s->left[i] || total > width / 2) break;
  }
  return k;
}

/* Append blocks below each other, each with the key columns. */
static void append_blocks(GString *out, const opc_sheet *s, const GArray *list,
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

/* Append a transposed table: a line for each column, which starts with the
   column's name. */
static void append_turned(GString *out, const opc_sheet *s, const GArray *list,
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

/* Append the transposed table if it has few rows, many columns, and fits.
   Return whether the table was appended. */
static gboolean append_if_turned(GString *out, const opc_sheet *s,
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

static void append_narrow(GString *out, const opc_sheet *s, const GArray *list,
                          size_t width) {
  if (!append_if_turned(out, s, list, width))
    append_blocks(out, s, list, width);
}

char *opc_sheet_text(opc_sheet *s, size_t width) {
  GString *out = g_string_new(NULL);
  g_autoptr(GString) note = g_string_new(NULL);
  g_autoptr(GArray) list = g_array_new(FALSE, FALSE, sizeof(size_t));
  sheet_measure(s);
  for (size_t i = 0; i < s->n; i++) g_array_append_val(list, i);
  if (width && total_of(s, list) > width) drop_constants(s, list, width, note);
  if (width && total_of(s, list) > width)
    append_narrow(out, s, list, width);
  else
    append_block(out, s, list);
  g_string_append(out, note->str);
  return g_string_free(out, FALSE);
}

/* ---- Markdown ---- */

/* Append a text with the special characters of Markdown escaped; a '|' would
   end the cell. */
static void append_escaped(GString *out, const char *text) {
  for (; *text; text++) {
    if (strchr("|\\`*_<", *text)) g_string_append_c(out, '\\');
    g_string_append_c(out, *text);
  }
}

char *opc_sheet_markdown(opc_sheet *s) {
  GString *out = g_string_new(NULL);
  sheet_measure(s);
  for (size_t row = 0; row < s->rows; row++) {
    for (size_t i = 0; i < s->n; i++) {
      g_string_append(out, i ? " | " : "| ");
      append_escaped(out, cell_of(s, row, i));
    }
    g_string_append(out, " |\n");
    for (size_t i = 0; !row && i < s->n; i++)
      g_string_append(out, s->left[i] ? "|---" : "|--:");
    if (!row) g_string_append(out, "|\n");
  }
  return g_string_free(out, FALSE);
}

/* ---- CSV ---- */

/* Return whether a text is a number with or without a unit, or a sign. */
static gboolean is_quantity(const char *text) {
  char *end;
  (void)g_ascii_strtod(text, &end);
  if (end == text)
    end += *end == '-' || *end == '+';
  else
    end += strspn(end, " %abcdefghijklmnopqrstuvwxyzACFHVW");
  return !*end;
}

static gboolean is_control(char c) {
  return (guchar)c < ' ' ? c != '\r' && c != '\n' : c == 0x7f;
}

static gboolean needs_mark(const char *text) {
  if (*text && strchr("=@'", *text)) return TRUE;
  if ((*text == '+' || *text == '-') && !is_quantity(text)) return TRUE;
  while (*text && !is_control(*text)) text++;
  return *text != 0;
}

static void append_field(GString *out, const char *text) {
  gboolean marked = needs_mark(text);
  if (!marked && !strpbrk(text, ",\"\r\n")) {
    g_string_append(out, text);
    return;
  }
  g_autoptr(GString) cell = g_string_new(marked ? "'" : NULL);
  for (; *text; text++)
    if (marked && is_control(*text)) {
      g_string_append_printf(cell, "\\x%02x", *text);
    } else {
      if (marked && *text == '\\') g_string_append_c(cell, '\\');
      g_string_append_c(cell, *text);
    }
  gboolean quoted = strpbrk(cell->str, ",\"\r\n") != NULL;
  g_string_replace(cell, "\"", "\"\"", 0);
  g_string_append_printf(out, quoted ? "\"%s\"" : "%s", cell->str);
}

void opc_cell_unmark(char *text) {
  char *to = text;
  if (*text != '\'') return;
  for (const char *at = text + 1; *at; at++) {
    if (*at == '\\' && at[1] == '\\') {
      at++;
    } else if (*at == '\\' && at[1] == 'x' && g_ascii_isxdigit(at[2]) &&
               g_ascii_isxdigit(at[3])) {
      *to++ = (char)(16 * g_ascii_xdigit_value(at[2]) +
                     g_ascii_xdigit_value(at[3]));
      at += 3;
      continue;
    }
    *to++ = *at;
  }
  *to = 0;
}

char *opc_sheet_csv(const opc_sheet *s) {
  GString *out = g_string_new(NULL);
  for (guint k = 0; k < s->cells->len; k++) {
    append_field(out, s->cells->pdata[k]);
    g_string_append(out, (k + 1) % s->n ? "," : "\r\n");
  }
  return g_string_free(out, FALSE);
}
