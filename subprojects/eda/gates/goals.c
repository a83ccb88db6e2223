/* SPDX-License-Identifier: BSD-3-Clause */
/* Goals of transistors, parsed from rows of a table and from words of notes.
   Both syntaxes use the same names, bounds and values. */
#include <base/suggest.h>
#include <eda/csv.h>
#include <eda/goals.h>
#include <glib.h>
#include <math.h>
#include <string.h>

/* Columns: the transistor, the weight, then one target for each of
   EDA_GOAL_ION, EDA_GOAL_IOFF and EDA_GOAL_AREA. */
enum { TRANSISTOR, WEIGHT, TARGET, COLUMNS = TARGET + EDA_GOAL_TARGETS };
static const eda_csv_column columns[COLUMNS] = {{"transistor", NULL, 0},
                                                {"weight", NULL, 1},
                                                {"ion", NULL, 1},
                                                {"ioff", NULL, 1},
                                                {"area", NULL, 1}};

/* ---- values ---- */

/* Bounds of targets: 1 / most_of to most_of. The bounds of Ioff are wider,
   because Ioff doubles every 2 to 3 nm of length. */
static const double most_of[EDA_GOAL_TARGETS] = {
    [EDA_GOAL_ION] = 10, [EDA_GOAL_IOFF] = 1000, [EDA_GOAL_AREA] = 10};
static const char *const target_words[EDA_GOAL_TARGETS] = {
    [EDA_GOAL_ION] = "multiple of a current from 0.1 to 10",
    [EDA_GOAL_IOFF] = "multiple of Ioff from 0.001 to 1000",
    [EDA_GOAL_AREA] = "multiple of an area from 0.1 to 10"};

static int weight_is_good(double x) { return isfinite(x) && x >= 0; }

static int target_is_good(int target, double x) {
  return x >= 1 / most_of[target] && x <= most_of[target];
}

const char *eda_goal_fault(const eda_goal *w) {
  if (!weight_is_good(w->weight)) return "weight";
  for (int k = 0; k < EDA_GOAL_TARGETS; k++)
    if (!target_is_good(k, w->target[k])) return target_words[k];
  return NULL;
}

/* Set the value of one column. Return NULL, or a noun that describes the
   expected text. */
static const char *goal_set(eda_goal *w, int column, const char *text) {
  char *end;
  int target = column - TARGET;
  double value = g_ascii_strtod(text, &end);
  if (end == text || *end) value = NAN;
  if (column == WEIGHT && !weight_is_good(value)) return "weight";
  if (column != WEIGHT && !target_is_good(target, value))
    return target_words[target];
  *(column == WEIGHT ? &w->weight : &w->target[target]) = value;
  w->given = 1;
  return NULL;
}

/* ---- the table ---- */

static GHashTable *by_name(const eda_gates *g) {
  GHashTable *t = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 0; i < g->count; i++)
    g_hash_table_insert(
        t, g_strdup_printf("%s:%u", eda_gates_owner(g, i), g->number[i]),
        GSIZE_TO_POINTER(i + 1));
  return t;
}

static int read_row(const eda_csv *csv, size_t row, GHashTable *number,
                    eda_goal *out, opc_error *error) {
  const char *name = eda_csv_text(csv, row, TRANSISTOR);
  size_t i = GPOINTER_TO_SIZE(g_hash_table_lookup(number, name));
  if (!i)
    return eda_csv_fail(csv, row, TRANSISTOR, "unknown transistor", error);
  for (int c = WEIGHT; c < COLUMNS; c++) {
    const char *text = eda_csv_text(csv, row, c);
    const char *fault = *text ? goal_set(&out[i - 1], c, text) : NULL;
    if (!fault) continue;
    g_autofree char *what = g_strdup_printf("no %s:", fault);
    return eda_csv_fail(csv, row, c, what, error);
  }
  return OPC_OK;
}

int eda_goals_read(const char *path, const eda_gates *gates, eda_goal *out,
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

/* Set the value of one word; bit c of *seen marks column c as set. Return NULL,
   or an error message (g_free()). */
static char *goal_take_word(eda_goal *w, char *word, int *seen) {
  char *value = strchr(word, '=');
  if (value) *value++ = '\0';
  if (strchr(word, '.')) return NULL;
  int c = WEIGHT, nearest = WEIGHT;
  while (c < COLUMNS && strcmp(word, columns[c].name)) c++;
  for (int k = TARGET; k < COLUMNS; k++)
    if (opc_edit_distance(word, columns[k].name) <
        opc_edit_distance(word, columns[nearest].name))
      nearest = k;
  if (c == COLUMNS && opc_edit_distance(word, columns[nearest].name) <= 2)
    return g_strdup_printf("unknown word '%.100s', did you mean '%s'?", word,
                           columns[nearest].name);
  if (c == COLUMNS)
    return g_strdup_printf(
        "unknown word '%.100s'; expected weight=..., ion=..., ioff=... or "
        "area=...",
        word);
  if (!value)
    return g_strdup_printf("'%s' has no value, expected %s=...", word, word);
  if ((*seen >> c) & 1) return g_strdup_printf("'%s' is set twice", word);
  *seen |= 1 << c;
  const char *fault = goal_set(w, c, value);
  return fault ? g_strdup_printf("'%.100s' is no %s", value, fault) : NULL;
}

char *eda_goal_parse(const char *note, eda_goal *out) {
  *out = eda_goal_none;
  if (!*note || *note == '#') return NULL;
  out->given = 1;
  g_auto(GStrv) words = g_strsplit_set(note, " ,\t\r\n", -1);
  char *fault = NULL;
  int seen = 0;
  for (char **word = words; *word && !fault; word++)
    if (**word) fault = goal_take_word(out, *word, &seen);
  return fault;
}
