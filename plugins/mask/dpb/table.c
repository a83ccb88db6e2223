/* SPDX-License-Identifier: BSD-3-Clause */
#include "table.h"

#include <glib.h>
#include <math.h>
#include <string.h>

enum { LENGTH, WIDTH, ADJUST, COLUMNS };
static const char *const names[COLUMNS] = {"l", "w", "init_adjust"};

enum { MOST_BYTES = 16 << 20, MOST_ROWS = 10000, MOST_NM = 100 };

typedef struct reader {
  const opc_host *host;
  const char *path;
  int line;
  int column[COLUMNS];   /* the number of the field, -1: not there */
  GArray *rows;
} reader;

static int fail(const reader *r, size_t column, opc_error *error,
                const char *what, const char *text) {
  return r->host->fail(r->host, error, OPC_INVALID, "init_adjust_table",
                       "%s:%d:%zu: %s '%.40s'", r->path, r->line, column + 1,
                       what, text);
}

/* Where field k of a line begins, as far as the line has so many. */
static size_t begin_of(char *const *field, int k) {
  size_t at = 0;
  for (int i = 0; i < k && field[i]; i++) at += strlen(field[i]) + 1;
  return at;
}

/* "l (nm)": the name, and the only unit it may have. */
static int read_header(reader *r, char **field, opc_error *error) {
  for (int c = 0; c < COLUMNS; c++) r->column[c] = -1;
  for (int k = 0; field[k]; k++) {
    g_autofree char *name = g_strstrip(g_strdup(field[k]));
    char *unit = strchr(name, '(');
    if (unit) *unit++ = '\0';
    g_strchomp(name);
    for (int c = 0; c < COLUMNS; c++) {
      if (strcmp(name, names[c])) continue;
      if (unit && strcmp(unit, "nm)"))
        return fail(r, begin_of(field, k), error, "the unit is nm, not", field[k]);
      if (r->column[c] >= 0)
        return fail(r, begin_of(field, k), error, "a column twice:", name);
      r->column[c] = k;
    }
  }
  for (int c = 0; c < COLUMNS; c++)
    if (r->column[c] < 0) return fail(r, 0, error, "there is no column", names[c]);
  return OPC_OK;
}

static int read_row(const reader *r, char **field, opc_error *error) {
  int n = (int)g_strv_length(field);
  double value[COLUMNS];
  for (int c = 0; c < COLUMNS; c++) {
    int k = r->column[c];
    if (k >= n) return fail(r, begin_of(field, n), error, "missing", names[c]);
    g_autofree char *text = g_strstrip(g_strdup(field[k]));
    char *end;
    value[c] = g_ascii_strtod(text, &end);
    if (end == text || *end || !isfinite(value[c]))
      return fail(r, begin_of(field, k), error, "not a number:", text);
    if (c == ADJUST ? fabs(value[c]) > MOST_NM : !(value[c] > 0))
      return fail(r, begin_of(field, k), error,
                  c == ADJUST ? "beyond +-100 nm:" : "not above 0:", text);
  }
  if (r->rows->len == MOST_ROWS)
    return fail(r, 0, error, "more than 10000 rows, here of L",
                field[r->column[LENGTH]]);
  for (guint i = 0; i < r->rows->len; i++) {
    const first_correction *row = &g_array_index(r->rows, first_correction, i);
    if (row->length == value[LENGTH] && row->width == value[WIDTH])
      return fail(r, 0, error, "a second row of this size, of L",
                  field[r->column[LENGTH]]);
  }
  const first_correction row = {value[LENGTH], value[WIDTH], value[ADJUST]};
  g_array_append_val(r->rows, row);
  return OPC_OK;
}

/* The lines of the file, without line ends. */
static char **read_lines(const reader *r, opc_error *error) {
  char *text = NULL;
  size_t size = 0;
  g_autoptr(GError) trouble = NULL;
  if (!g_file_get_contents(r->path, &text, &size, &trouble)) {
    r->host->fail(r->host, error, OPC_IO, "init_adjust_table", "%s",
                  trouble->message);
    return NULL;
  }
  const char *nul = memchr(text, 0, size);
  char **lines = NULL;
  if (size > MOST_BYTES)
    r->host->fail(r->host, error, OPC_INVALID, "init_adjust_table",
                  "'%s' has %zu bytes, more than 16 MB", r->path, size);
  else if (nul)
    r->host->fail(r->host, error, OPC_INVALID, "init_adjust_table",
                  "'%s' is no text: byte %zu is 0", r->path, (size_t)(nul - text));
  else
    lines = g_strsplit(text, "\n", -1);
  g_free(text);
  return lines;
}

int first_table_read(const opc_host *host, const char *path, first_table *out,
                     opc_error *error) {
  reader r = {.host = host, .path = path};
  g_auto(GStrv) lines = read_lines(&r, error);
  if (!lines) return error->code;
  r.rows = g_array_new(FALSE, FALSE, sizeof(first_correction));
  int code = OPC_OK, headed = 0;
  for (char **line = lines; *line && !code; line++) {
    r.line++;
    g_strchomp(*line);
    if (!**line || **line == '#') continue;
    g_auto(GStrv) field = g_strsplit(*line, ",", -1);
    code = headed ? read_row(&r, field, error) : read_header(&r, field, error);
    headed = 1;
  }
  if (!code && !r.rows->len)
    code = host->fail(host, error, OPC_INVALID, "init_adjust_table",
                      "'%s' has no rows", path);
  out->count = r.rows->len;
  out->row = (first_correction *)(void *)g_array_free(r.rows, FALSE);
  if (code) first_table_clear(out);
  return code;
}

double first_table_look(const first_table *t, double length, double width) {
  const first_correction *best = NULL;
  for (size_t i = 0; i < t->count; i++) {
    const first_correction *row = &t->row[i];
    double by_l = fabs(row->length - length), by_w = fabs(log(row->width / width));
    if (best) {
      double best_l = fabs(best->length - length);
      if (by_l > best_l) continue;
      if (by_l == best_l && by_w >= fabs(log(best->width / width))) continue;
    }
    best = row;
  }
  return best ? best->adjust : 0;
}

void first_table_clear(first_table *table) {
  g_free(table->row);
  *table = (first_table){0};
}
