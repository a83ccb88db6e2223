/* SPDX-License-Identifier: BSD-3-Clause */
/* Wishes, from the rows of a table and from the words of notes: both give the
   same values. */
#include "wishes.h"

#include <eda/csv.h>
#include <glib.h>
#include <math.h>
#include <string.h>

/* After the weight the targets, in the order of errors. */
enum { TRANSISTOR, WEIGHT, TARGET, COLUMNS = TARGET + ERRORS };
static const eda_csv_column columns[COLUMNS] = {{"transistor", NULL, 0},
                                                {"weight", NULL, 1},
                                                {"ion", NULL, 1},
                                                {"ioff", NULL, 1},
                                                {"area", NULL, 1}};

/* ---- what both have ---- */

static char *name_of(const eda_gates *g, size_t i) {
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
  int leaks = column == TARGET + IOFF;
  double most = leaks ? 1000 : 10; /* Ioff doubles every few nm */
  if (!good || !(value > 1 / most && value < most))
    return leaks                     ? "multiple of Ioff from 0.001 to 1000"
           : column == TARGET + AREA ? "multiple of an area from 0.1 to 10"
                                     : "multiple of a current from 0.1 to 10";
  w->target[column - TARGET] = value;
  return NULL;
}

/* ---- the table ---- */

static GHashTable *by_name(const eda_gates *g) {
  GHashTable *t = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < g->count; i++)
    g_hash_table_insert(t, name_of(g, i), GSIZE_TO_POINTER(i + 1));
  return t;
}

static int read_row(const eda_csv *csv, size_t row, GHashTable *number,
                    wish *out, opc_error *error) {
  const char *name = eda_csv_text(csv, row, TRANSISTOR);
  size_t i = GPOINTER_TO_SIZE(g_hash_table_lookup(number, name));
  if (!i)
    return eda_csv_fail(csv, row, TRANSISTOR, "there is no transistor", error);
  for (int c = WEIGHT; c < COLUMNS; c++) {
    const char *text = eda_csv_text(csv, row, c);
    const char *fault = *text ? take(&out[i - 1], c, text) : NULL;
    if (!fault) continue;
    g_autofree char *what = g_strdup_printf("no %s:", fault);
    return eda_csv_fail(csv, row, c, what, error);
  }
  return OPC_OK;
}

int read_wishes(const char *path, const eda_gates *gates, wish *out,
                opc_error *error) {
  eda_csv *csv =
      eda_csv_read(path, "wishes", columns, COLUMNS, EDA_CSV_EMPTY, error);
  if (!csv) return error->code;
  g_autoptr(GHashTable) number = by_name(gates);
  int code = OPC_OK;
  for (size_t i = 0; i < eda_csv_rows(csv) && !code; i++)
    code = read_row(csv, i, number, out, error);
  eda_csv_free(csv);
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
  while (c < COLUMNS && strcmp(word, columns[c].name)) c++;
  for (int k = TARGET; k < COLUMNS; k++)
    if (distance(word, columns[k].name) < distance(word, columns[nearest].name))
      nearest = k;
  if (c == COLUMNS && distance(word, columns[nearest].name) <= 2)
    return g_strdup_printf("unknown word '%.100s', did you mean '%s'?", word,
                           columns[nearest].name);
  if (c == COLUMNS)
    return g_strdup_printf(
        "unknown word '%.100s'; there are weight=..., ion=..., ioff=..., "
        "area=...",
        word);
  if (!value)
    return g_strdup_printf("'%s' lacks its value: %s=...", word, word);
  if ((*seen >> c) & 1) return g_strdup_printf("'%s' is there twice", word);
  *seen |= 1 << c;
  const char *fault = take(w, c, value);
  return fault ? g_strdup_printf("'%.100s' is no %s", value, fault) : NULL;
}

int read_notes(const eda_gates *gates, wish *out, opc_error *error) {
  if (!gates->note) return OPC_OK;
  for (size_t i = 0; i < gates->count; i++) {
    if (!gates->note[i] || gates->note[i][0] == '#') continue;
    g_auto(GStrv) words = g_strsplit_set(gates->note[i], " ,\t\r\n", -1);
    int seen = 0;
    for (char **word = words; *word; word++) {
      g_autofree char *fault = **word ? take_word(&out[i], *word, &seen) : NULL;
      if (!fault) continue;
      g_autofree char *name = name_of(gates, i);
      return opc_fail(error, OPC_INVALID, NULL, "note of '%.300s': %s", name,
                      fault);
    }
  }
  return OPC_OK;
}
