/* SPDX-License-Identifier: BSD-3-Clause */
/* Reader of small CSV tables. The whole file is read, then split into fields in
   place. The address of a field determines its column in messages. */
#include <base/sheet.h>
#include <eda/csv.h>
#include <glib.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

/* Largest size, bytes: a million transistors with rows of about 60
   characters. */
enum { MOST_BYTES = 64 << 20 };

/* ---- state ---- */

typedef struct line {
  int number;       /* line number in the file, from 1 */
  const char *text; /* start of the line */
  size_t first;     /* index of the first field in eda_csv.fields */
} line;

struct eda_csv {
  const char *parameter;
  const eda_csv_column *columns;
  size_t n; /* number of columns */
  uint32_t flags;
  char *path, *text;
  int *field;        /* position of each column in a row; -1: absent */
  int width;         /* number of fields in a row */
  GArray *rows;      /* line */
  GPtrArray *fields; /* const char *: `width` fields for each row */
};

/* ---- errors ---- */

static int fail_at(const eda_csv *c, const line *l, const char *place,
                   const char *what, const char *text, opc_error *error) {
  return opc_fail(error, OPC_INVALID, c->parameter, "%s:%d:%td: %s '%.40s'",
                  c->path, l->number, place - l->text + 1, what, text);
}

int eda_csv_fail(const eda_csv *c, size_t row, int column, const char *what,
                 opc_error *error) {
  const char *text = eda_csv_text(c, row, column);
  const line *l = &g_array_index(c->rows, line, row);
  return fail_at(c, l, *text || eda_csv_has(c, column) ? text : l->text, what,
                 text, error);
}

/* ---- fields and lines ---- */

/* Return the next field of *rest without surrounding blanks, and advance *rest.
   After the last field, *rest is NULL. */
static char *cut_field(char **rest) {
  char *field = *rest, *comma = strchr(field, ',');
  *rest = comma ? comma + 1 : NULL;
  if (comma) *comma = '\0';
  g_strchomp(field);
  while (g_ascii_isspace(*field)) field++;
  opc_cell_unmark(field);
  return field;
}

/* Return the next line that is neither empty nor a comment, terminated in
   place; NULL at the end of the file. */
static char *next_line(char **rest, line *l) {
  while (*rest) {
    char *text = *rest, *end = strchr(text, '\n');
    *rest = end ? end + 1 : NULL;
    if (end) *end = '\0';
    l->number++;
    l->text = text;
    g_strchomp(text);
    const char *content = text;
    while (g_ascii_isspace(*content)) content++;
    if (*content && *content != '#') return text;
  }
  return NULL;
}

/* Read a column name in the header, with or without unit. */
static int read_name(eda_csv *c, const line *l, const char *field,
                     opc_error *error) {
  g_autofree char *name = g_strdup(field);
  char *unit = strchr(name, '(');
  if (unit) *unit++ = '\0';
  g_strchomp(name);
  for (size_t i = 0; i < c->n; i++) {
    if (strcmp(name, c->columns[i].name)) continue;
    const char *known = c->columns[i].unit;
    g_autofree char *want = g_strdup_printf("%s)", known ? known : "");
    if (unit && strcmp(unit, want))
      return fail_at(c, l, field, "wrong unit:", field, error);
    if (c->field[i] >= 0)
      return fail_at(c, l, field, "duplicate column:", name, error);
    c->field[i] = c->width;
    return OPC_OK;
  }
  if (c->flags & EDA_CSV_OTHERS) return OPC_OK;
  return fail_at(c, l, field, "unknown column", name, error);
}

static int read_header(eda_csv *c, const line *l, char *text,
                       opc_error *error) {
  for (; text; c->width++) {
    int code = read_name(c, l, cut_field(&text), error);
    if (code) return code;
  }
  for (size_t i = 0; i < c->n; i++)
    if (c->field[i] < 0 && !c->columns[i].optional)
      return fail_at(c, l, l->text, "missing column", c->columns[i].name,
                     error);
  return OPC_OK;
}

/* Read a row. Missing fields at the end of the row are empty. */
static int read_row(eda_csv *c, line *l, char *text, opc_error *error) {
  char *end = text + strlen(text), *rest = text;
  l->first = c->fields->len;
  for (int i = 0; i < c->width; i++)
    g_ptr_array_add(c->fields, rest ? cut_field(&rest) : end);
  g_array_append_val(c->rows, *l);
  while (rest) {
    const char *more = cut_field(&rest);
    if (*more) return fail_at(c, l, more, "unexpected field:", more, error);
  }
  return OPC_OK;
}

/* ---- reading ---- */

static int read_text(eda_csv *c, opc_error *error) {
  size_t size = 0;
  g_autoptr(GError) trouble = NULL;
  struct stat about = {0};
  if (!stat(c->path, &about) && !S_ISREG(about.st_mode))
    return opc_fail(error, OPC_IO, c->parameter, "'%s': is not a regular file",
                    c->path);
  if (about.st_size > MOST_BYTES)
    return opc_fail(error, OPC_INVALID, c->parameter,
                    "'%s' has %jd bytes, more than 64 MB", c->path,
                    (intmax_t)about.st_size);
  if (!g_file_get_contents(c->path, &c->text, &size, &trouble))
    return opc_fail(error, OPC_IO, c->parameter, "%s", trouble->message);
  const char *nul = memchr(c->text, 0, size);
  if (nul)
    return opc_fail(error, OPC_INVALID, c->parameter,
                    "'%s' is not a text file: byte %zu is 0", c->path,
                    (size_t)(nul - c->text));
  return OPC_OK;
}

static int read_all(eda_csv *c, opc_error *error) {
  int code = read_text(c, error);
  line l = {0};
  char *rest = c->text;
  char *text = code ? NULL : next_line(&rest, &l);
  if (text) code = read_header(c, &l, text, error);
  while (!code && text && (text = next_line(&rest, &l)))
    code = read_row(c, &l, text, error);
  if (!code && !c->rows->len && !(c->flags & EDA_CSV_EMPTY))
    code =
        opc_fail(error, OPC_INVALID, c->parameter, "'%s' has no rows", c->path);
  return code;
}

eda_csv *eda_csv_read(const char *path, const char *parameter,
                      const eda_csv_column *columns, size_t n, uint32_t flags,
                      opc_error *error) {
  eda_csv *c = g_new0(eda_csv, 1);
  *c = (eda_csv){.parameter = parameter,
                 .columns = columns,
                 .n = n,
                 .flags = flags,
                 .path = g_strdup(path),
                 .field = g_new(int, n),
                 .rows = g_array_new(FALSE, FALSE, sizeof(line)),
                 .fields = g_ptr_array_new()};
  for (size_t i = 0; i < n; i++) c->field[i] = -1;
  if (!read_all(c, error)) return c;
  eda_csv_free(c);
  return NULL;
}

void eda_csv_free(eda_csv *c) {
  if (!c) return;
  g_array_free(c->rows, TRUE);
  g_ptr_array_free(c->fields, TRUE);
  g_free(c->field);
  g_free(c->text);
  g_free(c->path);
  g_free(c);
}

/* ---- queries ---- */

size_t eda_csv_rows(const eda_csv *c) { return c->rows->len; }

int eda_csv_has(const eda_csv *c, int column) { return c->field[column] >= 0; }

const char *eda_csv_text(const eda_csv *c, size_t row, int column) {
  if (!eda_csv_has(c, column)) return "";
  size_t first = g_array_index(c->rows, line, row).first;
  return c->fields->pdata[first + (size_t)c->field[column]];
}

int eda_csv_number(const eda_csv *c, size_t row, int column, double above,
                   double *value, opc_error *error) {
  const char *text = eda_csv_text(c, row, column);
  char *end;
  *value = g_ascii_strtod(text, &end);
  if (end == text || *end || !isfinite(*value))
    return eda_csv_fail(c, row, column, "not a number:", error);
  if (*value > above) return OPC_OK;
  g_autofree char *what = g_strdup_printf("not above %g:", above);
  return eda_csv_fail(c, row, column, what, error);
}

int eda_csv_type(const eda_csv *c, size_t row, int column, int *type,
                 opc_error *error) {
  const char *text = eda_csv_text(c, row, column);
  *type = !strcmp(text, "p") || !strcmp(text, "pmos") ? EDA_PMOS : EDA_NMOS;
  if (*type == EDA_PMOS || !strcmp(text, "n") || !strcmp(text, "nmos"))
    return OPC_OK;
  return eda_csv_fail(c, row, column, "neither 'n' nor 'p':", error);
}
