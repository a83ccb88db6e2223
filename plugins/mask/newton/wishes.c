/* SPDX-License-Identifier: BSD-3-Clause */
#include "wishes.h"

#include <glib.h>
#include <math.h>
#include <string.h>

/* A row of some 60 letters for each of a million transistors. */
enum { MOST_BYTES = 64 << 20 };

enum { TRANSISTOR, WEIGHT, ION, COLUMNS };
static const char *const names[COLUMNS] = {"transistor", "weight", "ion"};

typedef struct reader {
  const opc_host *host;
  const char *path;
  GHashTable *number;      /* of a transistor, by name, from 1 */
  int column[COLUMNS];     /* where it stands, -1: nowhere */
  int line;
} reader;

/* ---- what both have ---- */

static char *name_of(const opc_gates *g, size_t i) {
  return g_strdup_printf("%s:%u", *g->instance[i] ? g->instance[i] : g->cell[i],
                         g->number[i]);
}

/* Take in a value, or tell what it is not; NULL if it is good. */
static const char *take(wish *w, int column, const char *text) {
  char *end;
  double value = g_ascii_strtod(text, &end);
  int good = end != text && !*end && isfinite(value) && value >= 0;
  if (column == WEIGHT) {
    if (good) w->weight = value;
    return good ? NULL : "weight";
  }
  if (!good || !(value > 0.1 && value < 10))
    return "multiple of a current from 0.1 to 10";
  w->ion = value;
  return NULL;
}

/* ---- the table ---- */

static GHashTable *by_name(const opc_gates *g) {
  GHashTable *t = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < g->count; i++)
    g_hash_table_insert(t, name_of(g, i), GSIZE_TO_POINTER(i + 1));
  return t;
}

static int read_header(reader *r, char **field, opc_error *error) {
  for (int c = 0; c < COLUMNS; c++) r->column[c] = -1;
  for (int k = 0; field[k]; k++) {
    int c = 0;
    while (c < COLUMNS && strcmp(g_strstrip(field[k]), names[c])) c++;
    if (c == COLUMNS || r->column[c] >= 0)
      return r->host->fail(r->host, error, OPC_INVALID, "wishes",
                           "%s:%d: column '%s' is not one of transistor, "
                           "weight, ion, or is there twice",
                           r->path, r->line, field[k]);
    r->column[c] = k;
  }
  if (r->column[TRANSISTOR] >= 0) return OPC_OK;
  return r->host->fail(r->host, error, OPC_INVALID, "wishes",
                       "%s:%d: there is no column 'transistor'", r->path,
                       r->line);
}

static int read_row(const reader *r, char **field, wish *out,
                    opc_error *error) {
  int n = (int)g_strv_length(field);
  for (int c = 0; c < COLUMNS; c++)
    if (r->column[c] >= n)
      return r->host->fail(r->host, error, OPC_INVALID, "wishes",
                           "%s:%d: '%s' is missing", r->path, r->line,
                           names[c]);
  const char *name = g_strstrip(field[r->column[TRANSISTOR]]);
  size_t i = GPOINTER_TO_SIZE(g_hash_table_lookup(r->number, name));
  if (!i)
    return r->host->fail(r->host, error, OPC_INVALID, "wishes",
                         "%s:%d: there is no transistor '%s'", r->path, r->line,
                         name);
  for (int c = WEIGHT; c < COLUMNS; c++) {
    if (r->column[c] < 0) continue;
    const char *text = g_strstrip(field[r->column[c]]);
    if (!*text) continue;
    const char *fault = take(&out[i - 1], c, text);
    if (fault)
      return r->host->fail(r->host, error, OPC_INVALID, "wishes",
                           "%s:%d: '%s' is no %s", r->path, r->line, text,
                           fault);
  }
  return OPC_OK;
}

/* The lines of the file. */
static char **read_lines(const opc_host *host, const char *path,
                         opc_error *error) {
  g_autofree char *text = NULL;
  size_t size = 0;
  g_autoptr(GError) trouble = NULL;
  if (!g_file_get_contents(path, &text, &size, &trouble)) {
    host->fail(host, error, OPC_IO, "wishes", "%s", trouble->message);
    return NULL;
  }
  const char *nul = memchr(text, 0, size);
  if (size <= MOST_BYTES && !nul) return g_strsplit(text, "\n", -1);
  if (nul)
    host->fail(host, error, OPC_INVALID, "wishes",
               "'%s' is no text: byte %zu is 0", path, (size_t)(nul - text));
  else
    host->fail(host, error, OPC_INVALID, "wishes",
               "'%s' has %zu bytes, more than 64 MB", path, size);
  return NULL;
}

int read_wishes(const opc_host *host, const char *path, const opc_gates *gates,
                wish *out, opc_error *error) {
  g_auto(GStrv) lines = read_lines(host, path, error);
  if (!lines) return error->code;
  reader r = {.host = host, .path = path, .number = by_name(gates)};
  int code = OPC_OK, headed = 0;
  for (char **line = lines; *line && !code; line++) {
    r.line++;
    if (!*g_strstrip(*line) || **line == '#') continue;
    g_auto(GStrv) field = g_strsplit(*line, ",", -1);
    code = headed ? read_row(&r, field, out, error)
                  : read_header(&r, field, error);
    headed = 1;
  }
  g_hash_table_destroy(r.number);
  return code;
}

/* ---- notes ---- */

/* Letters to add, drop, change or swap until `a` is `b`; short words. */
static int distance(const char *a, const char *b) {
  int d[12][12], n = (int)strlen(a), m = (int)strlen(b);
  if (n > 11 || m > 11) return 12;
  for (int i = 0; i <= n; i++)
    for (int j = 0; j <= m; j++) {
      if (!i || !j) {
        d[i][j] = i + j;
        continue;
      }
      int best = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
      best = MIN(best, 1 + MIN(d[i - 1][j], d[i][j - 1]));
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        best = MIN(best, 1 + d[i - 2][j - 2]);
      d[i][j] = best;
    }
  return d[n][m];
}

/* The fault of one word, NULL if it is good; to be freed. */
static char *take_word(wish *w, char *word, int *seen) {
  char *value = strchr(word, '=');
  if (value) *value++ = '\0';
  if (strchr(word, '.')) return NULL;
  int c = WEIGHT, nearest = WEIGHT;
  while (c < COLUMNS && strcmp(word, names[c])) c++;
  if (distance(word, names[ION]) < distance(word, names[WEIGHT])) nearest = ION;
  if (c == COLUMNS && distance(word, names[nearest]) <= 2)
    return g_strdup_printf("unknown word '%.100s', did you mean '%s'?", word,
                           names[nearest]);
  if (c == COLUMNS)
    return g_strdup_printf("unknown word '%.100s'; there are weight=..., "
                           "ion=...", word);
  if (!value) return g_strdup_printf("'%s' lacks its value: %s=...", word, word);
  if ((*seen >> c) & 1) return g_strdup_printf("'%s' is there twice", word);
  *seen |= 1 << c;
  const char *fault = take(w, c, value);
  return fault ? g_strdup_printf("'%.100s' is no %s", value, fault) : NULL;
}

int read_notes(const opc_host *host, const opc_gates *gates, wish *out,
               opc_error *error) {
  if (!OPC_HAS(gates, note)) return OPC_OK;
  for (size_t i = 0; i < gates->count; i++) {
    if (!gates->note[i] || gates->note[i][0] == '#') continue;
    g_auto(GStrv) words = g_strsplit_set(gates->note[i], " ,\t\r\n", -1);
    int seen = 0;
    for (char **word = words; *word; word++) {
      g_autofree char *fault = **word ? take_word(&out[i], *word, &seen) : NULL;
      if (!fault) continue;
      g_autofree char *name = name_of(gates, i);
      return host->fail(host, error, OPC_INVALID, NULL, "note of '%.300s': %s",
                        name, fault);
    }
  }
  return OPC_OK;
}
