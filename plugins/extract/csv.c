/* SPDX-License-Identifier: BSD-3-Clause */
#include "csv.h"

#include <math.h>
#include <opcflow/devices.h>
#include <string.h>

enum { MOST_BYTES = 16 << 20 };

static int fail_at(const csv *c, int line, size_t column, const char *what,
                   const char *text, opc_error *error) {
  return c->host->fail(c->host, error, OPC_INVALID, c->parameter,
                       "%s:%d:%zu: %s '%.40s'", c->path, line, column + 1, what,
                       text);
}

/* Without the blanks at its end. */
static void trim(char **field) {
  for (; *field; field++) g_strchomp(*field);
}

/* Where field k of a line begins, past its blanks; the line's end if there are
   fewer. */
static size_t begin_of(const char *line, int k) {
  const char *at = line;
  for (int i = 0; i < k && *at; i++) {
    at += strcspn(at, ",");
    at += *at == ',';
  }
  while (g_ascii_isspace(*at)) at++;
  return (size_t)(at - line);
}

static int header_field(csv *c, int line, char **field, int k,
                        opc_error *error) {
  g_autofree char *name = g_strstrip(g_strdup(field[k]));
  char *unit = strchr(name, '(');
  size_t at = begin_of(c->text[line - 1], k);
  if (unit) *unit++ = '\0';
  g_strchomp(name);
  for (int i = 0; i < c->columns; i++) {
    if (strcmp(name, c->names[i])) continue;
    g_autofree char *want = g_strdup_printf("%s)", c->units[i] ? c->units[i] : "");
    if (unit && strcmp(unit, want))
      return fail_at(c, line, at, "a wrong unit:", field[k], error);
    if (c->field[i] >= 0)
      return fail_at(c, line, at, "a column twice:", name, error);
    c->field[i] = k;
    return OPC_OK;
  }
  return fail_at(c, line, at, "unknown column", name, error);
}

static int read_header(csv *c, int line, char **field, int required,
                       opc_error *error) {
  int code = OPC_OK;
  for (int i = 0; i < c->columns; i++) c->field[i] = -1;
  for (int k = 0; field[k] && !code; k++)
    code = header_field(c, line, field, k, error);
  for (int i = 0; i < required && !code; i++)
    if (c->field[i] < 0)
      code = fail_at(c, line, 0, "there is no column", c->names[i], error);
  return code;
}

/* The lines of the file. */
static char **read_lines(const csv *c, opc_error *error) {
  g_autofree char *text = NULL;
  size_t size = 0;
  g_autoptr(GError) trouble = NULL;
  if (!g_file_get_contents(c->path, &text, &size, &trouble)) {
    c->host->fail(c->host, error, OPC_IO, c->parameter, "%s", trouble->message);
    return NULL;
  }
  const char *nul = memchr(text, 0, size);
  if (size <= MOST_BYTES && !nul) return g_strsplit(text, "\n", -1);
  if (nul)
    c->host->fail(c->host, error, OPC_INVALID, c->parameter,
                  "'%s' is no text: byte %zu is 0", c->path,
                  (size_t)(nul - text));
  else
    c->host->fail(c->host, error, OPC_INVALID, c->parameter,
                  "'%s' has %zu bytes, more than 16 MB", c->path, size);
  return NULL;
}

int csv_read(csv *c, int required, opc_error *error) {
  c->text = read_lines(c, error);
  if (!c->text) return error->code;
  c->rows = g_ptr_array_new_with_free_func((GDestroyNotify)g_strfreev);
  c->lines = g_array_new(FALSE, FALSE, sizeof(int));
  int number = 0, headed = 0, code = OPC_OK;
  for (char **line = c->text; *line && !code; line++) {
    number++;
    g_strchomp(*line);
    if (!**line || **line == '#') continue;
    char **field = g_strsplit(*line, ",", -1);
    if (headed) trim(field);
    if (headed) {
      g_ptr_array_add(c->rows, field);
      g_array_append_val(c->lines, number);
      continue;
    }
    code = read_header(c, number, field, required, error);
    g_strfreev(field);
    headed = 1;
  }
  if (!code && !c->rows->len)
    code = c->host->fail(c->host, error, OPC_INVALID, c->parameter,
                         "'%s' has no rows", c->path);
  return code;
}

void csv_clear(csv *c) {
  if (c->rows) g_ptr_array_free(c->rows, TRUE);
  if (c->lines) g_array_free(c->lines, TRUE);
  g_strfreev(c->text);
  c->text = NULL;
  c->rows = NULL;
  c->lines = NULL;
}

int csv_has(const csv *c, int column) { return c->field[column] >= 0; }

const char *csv_text(const csv *c, guint row, int column) {
  char **field = c->rows->pdata[row];
  int k = c->field[column];
  if (k < 0 || k >= (int)g_strv_length(field)) return "";
  const char *text = field[k];
  while (g_ascii_isspace(*text)) text++;
  return text;
}

int csv_fail(const csv *c, guint row, int column, const char *what,
             opc_error *error) {
  int line = g_array_index(c->lines, int, row);
  return fail_at(c, line, begin_of(c->text[line - 1], c->field[column]), what,
                 csv_text(c, row, column), error);
}

int csv_number(const csv *c, guint row, int column, double above, double *value,
               opc_error *error) {
  const char *text = csv_text(c, row, column);
  char *end;
  *value = g_ascii_strtod(text, &end);
  if (end == text || *end || !isfinite(*value))
    return csv_fail(c, row, column, "not a number:", error);
  if (*value > above) return OPC_OK;
  g_autofree char *what = g_strdup_printf("not above %g:", above);
  return csv_fail(c, row, column, what, error);
}

int csv_type(const csv *c, guint row, int column, int *type, opc_error *error) {
  const char *text = csv_text(c, row, column);
  *type = !strcmp(text, "p") || !strcmp(text, "pmos") ? OPC_PMOS : OPC_NMOS;
  if (*type == OPC_PMOS || !strcmp(text, "n") || !strcmp(text, "nmos"))
    return OPC_OK;
  return csv_fail(c, row, column, "neither 'n' nor 'p':", error);
}
