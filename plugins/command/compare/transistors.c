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
      t->fault = g_strdup_printf("transistor '%s' is drawn differently", name);
  }
  if (!t->fault && others != t->n)
    t->fault =
        g_strdup_printf("the runs have %zu and %zu transistors", t->n, others);
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

void transistors_add(const transistors *t, int figure, GArray *base,
                     GArray *other) {
  for (size_t i = 0; !t->fault && i < t->n; i++) {
    double a = fabs(number_of(t->base, columns[figure], i));
    double b = fabs(number_of(t->other, columns[figure], t->row[i]));
    if (!isfinite(a) || !isfinite(b)) continue;
    g_array_append_val(base, a);
    g_array_append_val(other, b);
  }
}
