/* SPDX-License-Identifier: BSD-3-Clause */
/* Pairs of equal transistors in the tables of two runs, and changes of their
   figures, summed by cell. */
#include "runs/changes.h"

#include <math.h>
#include <string.h>

static const char *const columns[FIGURES] = {"ion_after", "ioff_after",
                                             "area_after"};

/* Return the number in a table cell; NAN if the column is missing or not
   numeric. */
static double number_of(eda_table *table, const char *column, size_t row) {
  int i = eda_table_find(table, column);
  const double *numbers = i < 0 ? NULL : eda_table_numbers(table, (size_t)i);
  return numbers ? numbers[row] : NAN;
}

/* Return the row of the base of pair i. */
static size_t base_row(const transistors *t, size_t i) {
  return t->base_row ? t->base_row[i] : i;
}

/* Return whether transistor i has equal drawn length and width in both tables;
   sizes that a table lacks are ignored. */
static int is_drawn_equal(const transistors *t, size_t i) {
  static const char *const sizes[] = {"l", "w"};
  for (int k = 0; k < 2; k++) {
    double a = number_of(t->base, sizes[k], base_row(t, i));
    double b = number_of(t->other, sizes[k], t->row[i]);
    if (a > b || a < b) return 0;
  }
  return 1;
}

static void transistors_match_rows(transistors *t, size_t a, size_t b) {
  g_autoptr(GHashTable) rows = g_hash_table_new(g_str_hash, g_str_equal);
  size_t others = eda_table_rows(t->other);
  t->n = eda_table_rows(t->base);
  t->row = g_new0(size_t, t->n);
  for (size_t i = 0; i < others; i++)
    g_hash_table_insert(rows, (char *)eda_table_text(t->other, i, b),
                        GSIZE_TO_POINTER(i + 1));
  for (size_t i = 0; i < t->n && !t->fault; i++) {
    const char *name = eda_table_text(t->base, i, a);
    size_t found = GPOINTER_TO_SIZE(g_hash_table_lookup(rows, name));
    t->row[i] = found - 1;
    if (!found)
      t->fault = g_strdup_printf("only the base has a transistor '%s'", name);
    else if (!is_drawn_equal(t, i))
      t->fault = g_strdup_printf("transistor '%s' is drawn differently", name);
  }
  if (!t->fault && others != t->n)
    t->fault =
        g_strdup_printf("the runs have %zu and %zu transistors", t->n, others);
}

/* ---- tables of classes ---- */

static const char hint[] =
    "set 'transistors: all.csv' in the steps of both runs that correct";

/* Return the number of transistors in a row of a table with the column `count`,
   otherwise 1. */
static double count_of(eda_table *table, size_t row) {
  double n = number_of(table, "count", row);
  return isnan(n) ? 1 : n;
}

static char *place_of(const eda_table *t, size_t row) {
  int x = eda_table_find(t, "x"), y = eda_table_find(t, "y");
  return x < 0 || y < 0
             ? g_strdup("")
             : g_strdup_printf("(%s, %s)", eda_table_text(t, row, (size_t)x),
                               eda_table_text(t, row, (size_t)y));
}

/* Pair rows by position, if at least one table (`of`) has a row for each class:
   a class is paired with the row of the other table at the position of the
   transistor that represents the class. `by_classes`: 1 if `other`, too, has a
   row for each class; paired classes must then have equally many members. */
static void classes_match_rows(transistors *t, eda_table *of, eda_table *other,
                               int by_classes) {
  g_autoptr(GHashTable) rows =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  double all = 0, others = 0;
  size_t n = eda_table_rows(of);
  t->n = n;
  t->row = g_new0(size_t, n);
  t->base_row = g_new0(size_t, n);
  t->count = g_new0(double, n);
  for (size_t i = 0; i < eda_table_rows(other); i++) {
    g_hash_table_insert(rows, place_of(other, i), GSIZE_TO_POINTER(i + 1));
    others += count_of(other, i);
  }
  for (size_t i = 0; i < n && !t->fault; i++) {
    g_autofree char *place = place_of(of, i);
    size_t found = GPOINTER_TO_SIZE(g_hash_table_lookup(rows, place));
    t->count[i] = count_of(of, i);
    all += t->count[i];
    t->row[i] = of == t->base ? found - 1 : i;
    t->base_row[i] = of == t->base ? i : found - 1;
    if (!found || (by_classes && count_of(other, found - 1) != t->count[i]))
      t->fault = g_strdup_printf(
          "the class of the transistor at %s nm is not in both runs: %s", place,
          hint);
    else if (!is_drawn_equal(t, i))
      t->fault =
          g_strdup_printf("transistor at %s nm is drawn differently", place);
  }
  if (!t->fault && all != others)
    t->fault =
        g_strdup_printf("the runs have %.0f and %.0f transistors", all, others);
}

/* ---- the tables ---- */

/* Return the name (g_free) of the table of all transistors that a step wrote to
   the file in its parameter `transistors`. If `verified` is 1, the step must
   use the plugin `verify`, otherwise another plugin. Return NULL if no such
   step wrote a table. */
static char *listing_of(const eda_run *run, int verified) {
  const eda_run_facts *f = eda_run_info(run);
  for (size_t i = 0; i < f->n_parameters; i++) {
    const eda_run_parameter *p = &f->parameters[i];
    const char *dot = strchr(p->name, '.');
    if (!dot || strcmp(dot, ".transistors") != 0 ||
        !g_str_has_suffix(p->value, ".csv"))
      continue;
    g_autofree char *use =
        g_strdup_printf("%.*s.use", (int)(dot - p->name), p->name);
    const eda_run_parameter *plugin = eda_run_parameter_of(run, use);
    g_autofree char *name = g_strndup(p->value, strlen(p->value) - 4);
    if (plugin && g_str_equal(plugin->value, "verify") == verified &&
        eda_run_has_table(run, name))
      return g_steal_pointer(&name);
  }
  return NULL;
}

/* Find a step that uses `verify` and has a transistor table in both runs.
   Return 1 and the name of the table (g_free), or 0. */
static int is_verified(const eda_run *base, const eda_run *other, char **name) {
  const eda_run_facts *f = eda_run_info(base);
  for (size_t i = 0; i < f->n_parameters; i++) {
    const char *use = f->parameters[i].name, *dot = strchr(use, '.');
    if (!dot || strcmp(dot, ".use") || strcmp(f->parameters[i].value, "verify"))
      continue;
    *name = g_strdup_printf("%.*s.gates", (int)(dot - use), use);
    if (eda_run_has_table(base, *name) && eda_run_has_table(other, *name))
      return 1;
    g_free(*name);
  }
  return 0;
}

/* Return the table of all transistors, or else the table `name`. */
static eda_table *table_of(eda_run *run, int verified, const char *name,
                           opc_error *error) {
  g_autofree char *all = listing_of(run, verified);
  return eda_run_table(run, all ? all : name, error);
}

int transistors_join(eda_run *base, eda_run *other, transistors *t,
                     opc_error *error) {
  g_autofree char *name = NULL;
  *t = (transistors){0};
  int verified = is_verified(base, other, &name);
  if (!verified) name = g_strdup("gates");
  if (!eda_run_has_table(base, name) || !eda_run_has_table(other, name))
    return OPC_OK;
  eda_table *one = table_of(base, verified, name, error);
  eda_table *two = one ? table_of(other, verified, name, error) : NULL;
  if (!two) return error->code;
  int a = eda_table_find(one, "transistor");
  int b = eda_table_find(two, "transistor");
  if (a < 0 || b < 0) return OPC_OK; /* no transistor table */
  t->base = one;
  t->other = two;
  int classes = eda_table_find(one, "count") >= 0,
      others = eda_table_find(two, "count") >= 0;
  if (classes || others)
    classes_match_rows(t, classes ? one : two, classes ? two : one,
                       classes && others);
  else
    transistors_match_rows(t, (size_t)a, (size_t)b);
  return OPC_OK;
}

void transistors_clear(transistors *t) {
  g_free(t->row);
  g_free(t->base_row);
  g_free(t->count);
  g_free(t->fault);
  *t = (transistors){0};
}

/* ---- changes ---- */

/* Largest |change| that counts as equal, %. It is below the resolution of
   gates.csv, which has two or three decimals. */
static const double EQUAL = 1e-9;

typedef struct cell {
  double change; /* sum of the changes of the cell's transistors */
  double n;
} cell;

changes changes_new(void) {
  return (changes){
      .index = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL),
      .cells = g_array_new(FALSE, FALSE, sizeof(cell))};
}

void changes_clear(changes *c) {
  g_hash_table_unref(c->index);
  g_array_free(c->cells, TRUE);
}

/* Return the cell `name`; add the cell if new. */
static cell *changes_cell(changes *c, char *name) {
  size_t at = GPOINTER_TO_SIZE(g_hash_table_lookup(c->index, name));
  if (!at) {
    const cell none = {0, 0};
    g_array_append_val(c->cells, none);
    at = c->cells->len;
    g_hash_table_insert(c->index, g_strdup(name), GSIZE_TO_POINTER(at));
  }
  return &g_array_index(c->cells, cell, at - 1);
}

/* Return the cell of a transistor (g_free): the column `cell`, or the part of
   the transistor's name before the last colon. */
static char *cell_name(const transistors *t, size_t i) {
  /* A table of classes has no cells. */
  int in_base = eda_table_find(t->base, "count") < 0;
  const eda_table *table = in_base ? t->base : t->other;
  size_t row = in_base ? base_row(t, i) : t->row[i];
  int column = eda_table_find(table, "cell");
  if (column >= 0) return g_strdup(eda_table_text(table, row, (size_t)column));
  column = eda_table_find(table, "transistor");
  const char *name = eda_table_text(table, row, (size_t)column);
  const char *end = strrchr(name, ':');
  return end ? g_strndup(name, (gsize)(end - name)) : g_strdup(name);
}

void changes_add(changes *c, const transistors *t, int figure) {
  for (size_t i = 0; !t->fault && i < t->n; i++) {
    double a = fabs(number_of(t->base, columns[figure], base_row(t, i)));
    double b = fabs(number_of(t->other, columns[figure], t->row[i]));
    double n = t->count ? t->count[i] : 1;
    int64_t whole = (int64_t)n;
    c->lost_base += isfinite(a) ? 0 : whole;
    c->lost += isfinite(b) ? 0 : whole;
    if (!isfinite(a) || !isfinite(b)) continue;
    g_autofree char *name = cell_name(t, i);
    cell *of = changes_cell(c, name);
    of->change += n * (b - a);
    of->n += n;
    c->base += n * a;
    c->value += n * b;
    c->n += whole;
    c->better += b - a < -EQUAL ? whole : 0;
    c->worse += b - a > EQUAL ? whole : 0;
  }
}

eda_median changes_median(const changes *c) {
  g_autofree double *means = g_new(double, c->cells->len);
  for (guint i = 0; i < c->cells->len; i++) {
    const cell *of = &g_array_index(c->cells, cell, i);
    means[i] = of->change / of->n;
  }
  return eda_median_of(means, c->cells->len);
}
