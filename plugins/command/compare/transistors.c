/* SPDX-License-Identifier: BSD-3-Clause */
/* Joins the transistor tables of two runs. */
#include "transistors.h"

#include <math.h>
#include <string.h>

const char *const figure_names[FIGURES] = {"ion", "ioff", "area"};
static const char *const columns[FIGURES] = {"ion_after", "ioff_after",
                                             "area_after"};

/* Return the number in a cell, NAN if the column is missing. */
static double number_of(eda_table *table, const char *column, size_t row) {
  int i = eda_table_find(table, column);
  const double *numbers = i < 0 ? NULL : eda_table_numbers(table, (size_t)i);
  return numbers ? numbers[row] : NAN;
}

/* Return whether drawn length and width are equal, where both tables have
   them. */
static int is_drawn_alike(const transistors *t, size_t i) {
  static const char *const sizes[] = {"l", "w"};
  for (int k = 0; k < 2; k++) {
    double a = number_of(t->base, sizes[k], i);
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
    else if (!is_drawn_alike(t, i))
      t->fault = g_strdup_printf("transistor '%s' was drawn otherwise", name);
  }
  if (!t->fault && others != t->n)
    t->fault =
        g_strdup_printf("there are %zu and %zu transistors", t->n, others);
}

int transistors_join(const pair *p, transistors *t, opc_error *error) {
  *t = (transistors){0};
  if (!eda_run_has_table(p->base, "gates") ||
      !eda_run_has_table(p->other, "gates"))
    return OPC_OK;
  eda_table *base = eda_run_table(p->base, "gates", error);
  eda_table *other = base ? eda_run_table(p->other, "gates", error) : NULL;
  if (!other) return error->code;
  int a = eda_table_find(base, "transistor");
  int b = eda_table_find(other, "transistor");
  if (a < 0 || b < 0) return OPC_OK; /* not a transistor table */
  t->base = base;
  t->other = other;
  transistors_match_rows(t, (size_t)a, (size_t)b);
  return OPC_OK;
}

void transistors_clear(transistors *t) {
  g_free(t->row);
  g_free(t->fault);
  *t = (transistors){0};
}

/* ---- changes ---- */

/* Largest change that counts as none; gates.csv has two or three decimals of a
   percent. */
static const double EQUAL = 1e-9;

typedef struct cell {
  double change; /* sum over its transistors */
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

/* Return the cell of a name, added if new. */
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

/* Return the name of the cell of a transistor: the column `cell`, or the path
   before the last colon of the transistor's name. */
static char *cell_name(const transistors *t, size_t row) {
  int column = eda_table_find(t->base, "cell");
  if (column >= 0)
    return g_strdup(eda_table_text(t->base, row, (size_t)column));
  column = eda_table_find(t->base, "transistor");
  const char *name = eda_table_text(t->base, row, (size_t)column);
  const char *end = strrchr(name, ':');
  return end ? g_strndup(name, (gsize)(end - name)) : g_strdup(name);
}

void changes_add(changes *c, const transistors *t, int figure) {
  for (size_t i = 0; !t->fault && i < t->n; i++) {
    double a = fabs(number_of(t->base, columns[figure], i));
    double b = fabs(number_of(t->other, columns[figure], t->row[i]));
    if (!isfinite(a) || !isfinite(b)) continue;
    g_autofree char *name = cell_name(t, i);
    cell *of = changes_cell(c, name);
    of->change += b - a;
    of->n++;
    c->base += a;
    c->value += b;
    c->n++;
    c->better += b - a < -EQUAL;
    c->worse += b - a > EQUAL;
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
