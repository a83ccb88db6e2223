/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of CSV tables of runs (RFC 4180). The whole file is read, then split
   into fields in place. */
#include <base/sheet.h>
#include <glib.h>
#include <math.h>
#include <string.h>

#include "runs/text.h"

/* bytes; gates.csv has about 200 bytes for each transistor */
static const size_t LARGEST_TABLE = (size_t)1 << 30;
enum { MOST_COLUMNS = 10000 };

/* ---- state ---- */

typedef struct column {
  char *name, *unit;
  double *numbers;
  int looked; /* 1: `numbers` is set or the column is not numeric */
} column;

struct eda_table {
  char *path, *text;
  GArray *columns;   /* column */
  GPtrArray *fields; /* char *, row by row, without the header row */
  GArray *lines;     /* uint32_t: line number of each row in the file */
};

/* Position of the reader in the text. */
typedef struct cursor {
  eda_table *table;
  char *at, *line_start;
  uint32_t line;
  int ended; /* 1: the last field was the last in its line */
} cursor;

/* ---- fields ---- */

static int fail_here(const cursor *c, const char *what, opc_error *error) {
  return opc_fail(error, OPC_INVALID, NULL, "%s:%u:%ld: %s", c->table->path,
                  (unsigned)c->line,
                  g_utf8_pointer_to_offset(c->line_start, c->at) + 1, what);
}

/* Return the next field, which is quoted; replace doubled quotes in place. */
static int cut_quoted(cursor *c, char **field, opc_error *error) {
  char *out = *field = c->at, *in = c->at + 1;
  const cursor start = *c;
  for (; *in && !(*in == '"' && in[1] != '"'); in++) {
    if (*in == '"') in++;
    if (*in == '\n') c->line++, c->line_start = in + 1;
    *out++ = *in;
  }
  if (!*in) return fail_here(&start, "a quote is not closed", error);
  c->at = in + 1;
  if (*c->at && !strchr(",\r\n", *c->at))
    return fail_here(c, "text after a closing quote", error);
  *out = '\0';
  return OPC_OK;
}

/* Return the next field, and overwrite the separator behind the field with
   NUL. */
static int cut_field(cursor *c, char **field, opc_error *error) {
  int code = OPC_OK;
  *field = c->at;
  if (*c->at == '"')
    code = cut_quoted(c, field, error);
  else
    c->at += strcspn(c->at, ",\r\n\"");
  if (code) return code;
  if (*c->at == '"') return fail_here(c, "a quote within a field", error);
  char *end = c->at;
  c->ended = *end != ',';
  if (*end == '\r' && end[1] != '\n' && end[1])
    return fail_here(c, "a carriage return within a line", error);
  c->at += *end == '\r' && end[1] ? 2 : *end ? 1 : 0;
  *end = '\0';
  return OPC_OK;
}

static void end_line(cursor *c) {
  c->line++;
  c->line_start = c->at;
}

/* ---- rows ---- */

/* Split a header "name (unit)" into name and unit. */
static column head_of(const char *text) {
  size_t n = strlen(text);
  const char *unit = n && text[n - 1] == ')' ? g_strrstr(text, " (") : NULL;
  if (!unit) return (column){.name = g_strdup(text), .unit = g_strdup("")};
  return (column){.name = g_strndup(text, (size_t)(unit - text)),
                  .unit = g_strndup(unit + 2, n - (size_t)(unit - text) - 3)};
}

static int read_head(cursor *c, opc_error *error) {
  char *field;
  for (c->ended = 0; !c->ended;) {
    const cursor before = *c;
    if (cut_field(c, &field, error)) return error->code;
    if (!*field) return fail_here(&before, "a column without a name", error);
    if (c->table->columns->len == MOST_COLUMNS)
      return fail_here(&before, "more than 10000 columns", error);
    column one = head_of(field);
    g_array_append_val(c->table->columns, one);
  }
  end_line(c);
  return OPC_OK;
}

static int read_row(cursor *c, opc_error *error) {
  guint n = c->table->columns->len, i = 0;
  const cursor start = *c;
  g_array_append_val(c->table->lines, c->line);
  for (c->ended = 0; !c->ended && i < n; i++) {
    char *field;
    if (cut_field(c, &field, error)) return error->code;
    opc_cell_unmark(field);
    g_ptr_array_add(c->table->fields, field);
  }
  g_autofree char *what =
      i < n       ? g_strdup_printf("found %u fields, expected %u", i, n)
      : !c->ended ? g_strdup_printf("more than %u fields", n)
                  : NULL;
  if (what) return fail_here(i < n ? &start : c, what, error);
  end_line(c);
  return OPC_OK;
}

static int read_all(eda_table *t, opc_error *error) {
  t->text = runs_text(t->path, LARGEST_TABLE, error);
  if (!t->text) return error->code;
  cursor c = {.table = t, .at = t->text, .line_start = t->text, .line = 1};
  int code = read_head(&c, error);
  while (!code && *c.at) code = read_row(&c, error);
  return code;
}

eda_table *eda_table_read(const char *path, opc_error *error) {
  eda_table *t = g_new0(eda_table, 1);
  *t = (eda_table){.path = g_strdup(path),
                   .columns = g_array_new(FALSE, FALSE, sizeof(column)),
                   .fields = g_ptr_array_new(),
                   .lines = g_array_new(FALSE, FALSE, sizeof(uint32_t))};
  if (!read_all(t, error)) return t;
  eda_table_free(t);
  return NULL;
}

void eda_table_free(eda_table *t) {
  if (!t) return;
  for (guint i = 0; i < t->columns->len; i++) {
    column *c = &g_array_index(t->columns, column, i);
    g_free(c->name);
    g_free(c->unit);
    g_free(c->numbers);
  }
  g_array_free(t->columns, TRUE);
  g_ptr_array_free(t->fields, TRUE);
  g_array_free(t->lines, TRUE);
  g_free(t->text);
  g_free(t->path);
  g_free(t);
}

/* ---- queries ---- */

static column *column_of(const eda_table *t, size_t i) {
  return &g_array_index(t->columns, column, i);
}

size_t eda_table_rows(const eda_table *t) { return t->lines->len; }

size_t eda_table_columns(const eda_table *t) { return t->columns->len; }

const char *eda_table_name(const eda_table *t, size_t i) {
  return column_of(t, i)->name;
}

const char *eda_table_unit(const eda_table *t, size_t i) {
  return column_of(t, i)->unit;
}

int eda_table_find(const eda_table *t, const char *name) {
  for (guint i = 0; i < t->columns->len; i++)
    if (!strcmp(column_of(t, i)->name, name)) return (int)i;
  return -1;
}

const char *eda_table_text(const eda_table *t, size_t row, size_t i) {
  return t->fields->pdata[row * t->columns->len + i];
}

int eda_table_fail(const eda_table *t, size_t row, size_t i, const char *what,
                   opc_error *error) {
  return opc_fail(error, OPC_INVALID, NULL, "%s:%u: column '%s': %s '%.60s'",
                  t->path, (unsigned)g_array_index(t->lines, uint32_t, row),
                  eda_table_name(t, i), what, eda_table_text(t, row, i));
}

static double *make_numbers(const eda_table *t, size_t i) {
  size_t rows = eda_table_rows(t), there = 0;
  double *numbers = g_new(double, rows);
  for (size_t row = 0; row < rows; row++) {
    const char *text = eda_table_text(t, row, i);
    char *end;
    numbers[row] = *text ? g_ascii_strtod(text, &end) : NAN;
    there += *text != 0;
    if (!*text || (end != text && !*end && !isnan(numbers[row]))) continue;
    there = 0;
    break;
  }
  if (there) return numbers;
  g_free(numbers);
  return NULL;
}

const double *eda_table_numbers(eda_table *t, size_t i) {
  column *c = column_of(t, i);
  if (!c->looked) c->numbers = make_numbers(t, i);
  c->looked = 1;
  return c->numbers;
}
