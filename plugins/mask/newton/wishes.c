/* SPDX-License-Identifier: BSD-3-Clause */
#include "wishes.h"

#include <glib.h>
#include <math.h>
#include <string.h>

enum { TRANSISTOR, WEIGHT, ION, COLUMNS };
static const char *const names[COLUMNS] = {"transistor", "weight", "ion"};

typedef struct reader {
  const opc_host *host;
  const char *path;
  GHashTable *number;      /* of a transistor, by name, from 1 */
  int column[COLUMNS];     /* where it stands, -1: nowhere */
  int line;
} reader;

static GHashTable *by_name(const opc_gates *g) {
  GHashTable *t = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < g->count; i++)
    g_hash_table_insert(t,
                        g_strdup_printf("%s:%u",
                                        *g->instance[i] ? g->instance[i]
                                                        : g->cell[i],
                                        g->number[i]),
                        GSIZE_TO_POINTER(i + 1));
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
    char *end;
    double value = g_ascii_strtod(text, &end);
    int good = !*end && isfinite(value) && value >= 0;
    if (!good || (c == ION && !(value > 0.1 && value < 10)))
      return r->host->fail(r->host, error, OPC_INVALID, "wishes",
                           "%s:%d: '%s' is no %s", r->path, r->line, text,
                           c == ION ? "multiple of a current from 0.1 to 10"
                                    : "weight");
    if (c == ION) out[i - 1].ion = value;
    else out[i - 1].weight = value;
  }
  return OPC_OK;
}

int read_wishes(const opc_host *host, const char *path, const opc_gates *gates,
                wish *out, opc_error *error) {
  g_autofree char *text = NULL;
  g_autoptr(GError) trouble = NULL;
  if (!g_file_get_contents(path, &text, NULL, &trouble))
    return host->fail(host, error, OPC_IO, "wishes", "%s", trouble->message);
  g_auto(GStrv) lines = g_strsplit(text, "\n", -1);
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
