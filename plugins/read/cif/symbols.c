/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the symbols of a file. Determines which symbol a number denotes at
   each place of the file, the unit in which all coordinates are integers, and
   the cells of the layout. */
#include <string.h>

#include "cif.h"

typedef struct mention {
  int64_t number; /* the key */
  cif_symbol *symbol;
  size_t at; /* place of the symbol's first mention */
} mention;

static void free_symbol(void *data) {
  cif_symbol *s = data;
  g_free(s->name);
  g_free(s);
}

void cif_open(cif *c) {
  c->symbols = g_ptr_array_new_with_free_func(free_symbol);
  c->numbers = g_hash_table_new_full(g_int64_hash, g_int64_equal, g_free, NULL);
  c->forgotten = g_array_new(FALSE, FALSE, sizeof(cif_forgotten));
  c->points = g_array_new(FALSE, FALSE, sizeof(eda_point));
}

void cif_clear(cif *c) {
  g_ptr_array_unref(c->symbols);
  g_hash_table_unref(c->numbers);
  g_array_unref(c->forgotten);
  g_array_unref(c->points);
  g_free(c->layer);
  g_free(c->outer);
}

/* Return 1 if a later DD deleted the number that was mentioned at `at`. DD n
   deletes the numbers from n on. */
static int symbol_deleted(const cif *c, int64_t number, size_t at) {
  const cif_forgotten *all = (const cif_forgotten *)c->forgotten->data;
  size_t low = 0, high = c->forgotten->len;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (all[middle].from <= number)
      low = middle + 1;
    else
      high = middle;
  }
  return low && all[low - 1].at > at;
}

static void add_symbol(cif *c, int64_t number) {
  cif_symbol *s = g_new0(cif_symbol, 1);
  *s = (cif_symbol){
      .number = number, .a = 1, .b = 1, .at = c->command, .cell = -1};
  g_ptr_array_add(c->symbols, s);
}

cif_symbol *cif_symbol_of(cif *c, int64_t number) {
  mention *e = g_hash_table_lookup(c->numbers, &number);
  if (e && !symbol_deleted(c, number, e->at)) return e->symbol;
  if (!e) {
    e = g_new0(mention, 1);
    e->number = number;
    g_hash_table_add(c->numbers, e);
  }
  if (!c->building) add_symbol(c, number);
  e->symbol = cif_symbol_at(c, c->mentioned++);
  e->at = c->command;
  return e->symbol;
}

void cif_forget(cif *c, int64_t from) {
  GArray *all = c->forgotten;
  cif_forgotten new = {from, c->command};
  guint n = all->len;
  while (n && g_array_index(all, cif_forgotten, n - 1).from >= from) n--;
  g_array_set_size(all, n);
  g_array_append_val(all, new);
}

void cif_begin(cif *c) {
  g_hash_table_remove_all(c->numbers);
  g_array_set_size(c->forgotten, 0);
  c->mentioned = 1;
  c->at = c->command = 0;
  if (!c->building) add_symbol(c, 0);
  c->current = cif_symbol_at(c, 0);
  c->current->defined = 1;
}

/* ---- the unit and the cells ---- */

/* Return the greatest common divisor of positive numbers. */
static int64_t gcd(int64_t a, int64_t b) {
  while (b > 0) {
    int64_t rest = a % b;
    a = b;
    b = rest;
  }
  return a > 0 ? a : 1;
}

/* Return the unit. The unit is a centimicron divided by the least number that
   makes all scale factors integers. If an odd side requires halves, the number
   is doubled. */
static double choose_unit(cif *c) {
  static const char none[] = "scale factors that have no common unit";
  int64_t divisor = 1;
  for (size_t i = 0; i < c->symbols->len && !c->b.failed; i++) {
    cif_symbol *s = cif_symbol_at(c, i);
    if (!s->defined)
      cif_refuse_at(c, s->at, "calls a symbol that is not defined");
    int64_t common = gcd(s->a, s->b);
    s->a /= common;
    s->b /= common;
    divisor *= s->b / gcd(divisor, s->b);
    if (divisor > INT32_MAX) cif_refuse_at(c, s->at, none);
  }
  int halves = 0;
  for (size_t i = 0; i < c->symbols->len && !c->b.failed; i++) {
    cif_symbol *s = cif_symbol_at(c, i);
    s->factor = s->a * (divisor / s->b); /* below 2^62 */
    if (s->factor > INT32_MAX / 2) cif_refuse_at(c, s->at, none);
    if (s->odd && s->factor % 2) halves = 1;
  }
  for (size_t i = 0; i < c->symbols->len && halves; i++)
    cif_symbol_at(c, i)->factor *= 2;
  /* 1 centimicron = 10 nm */
  return c->b.r->scale * 10 / (double)(halves ? 2 * divisor : divisor);
}

/* Create the cell of symbol i with the given name. If another cell has this
   name,
   `$` and a number are appended. tried[name] is the number of the last attempt
   for this name, from which the next attempt continues. */
static void make_cell(cif *c, size_t i, const char *name, GHashTable *tried) {
  g_autofree char *unique = g_strdup(name);
  size_t k = MAX(i, GPOINTER_TO_SIZE(g_hash_table_lookup(tried, name)));
  for (; eda_layout_find_cell(c->b.layout, unique) >= 0; k++) {
    g_free(unique);
    unique = g_strdup_printf("%s$%zu", name, k);
  }
  if (strcmp(unique, name) != 0)
    g_hash_table_insert(tried, g_strdup(name), GSIZE_TO_POINTER(k));
  cif_symbol_at(c, i)->cell = reading_number(
      &c->b, eda_layout_cell(c->b.layout, unique, &c->b.layout_error));
}

/* Create the cell of the commands outside of symbols, named after the file:
   "inverter" for "cells/inverter.cif". */
static void make_top(cif *c, GHashTable *tried) {
  const char *slash = strrchr(c->b.r->file, '/');
  g_autofree char *name = g_strdup(slash ? slash + 1 : c->b.r->file);
  char *dot = strrchr(name, '.');
  if (dot && dot != name) *dot = '\0';
  make_cell(c, 0, name, tried);
}

void cif_make_cells(cif *c) {
  double unit = choose_unit(c);
  if (c->b.failed) return;
  c->b.layout = eda_layout_new(unit, &c->b.layout_error);
  reading_check(&c->b, c->b.layout ? OPC_OK : c->b.layout_error.code);
  g_autoptr(GHashTable) tried =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  for (size_t i = 1; i < c->symbols->len && !c->b.failed; i++) {
    const cif_symbol *s = cif_symbol_at(c, i);
    char number[32];
    snprintf(number, sizeof number, "%lld", (long long)s->number);
    make_cell(c, i, s->name ? s->name : number, tried);
  }
  if (!c->b.failed && (c->loose || c->calls > 1 || c->moved))
    make_top(c, tried);
}
