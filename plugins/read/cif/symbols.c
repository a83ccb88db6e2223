/* SPDX-License-Identifier: BSD-3-Clause */
/* The symbols of a file: what a number means at each place, the unit that makes
   all coordinates whole, and the cells of the layout. */
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

#include "cif.h"

typedef struct mention {
  int64_t number; /* the key */
  size_t symbol;
  size_t at; /* where the symbol was first mentioned */
} mention;

/* Whether a number mentioned at `at` was forgotten since: by the last DD from
   no higher a number. */
static int forgotten(const cif *c, int64_t number, size_t at) {
  size_t low = 0, high = c->n_forgotten;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (c->forgotten[middle].from <= number)
      low = middle + 1;
    else
      high = middle;
  }
  return low && c->forgotten[low - 1].at > at;
}

static void add_symbol(cif *c, int64_t number) {
  eda_grow(&c->symbols, &c->room_symbols, c->n_symbols + 1, sizeof *c->symbols);
  c->symbols[c->n_symbols++] = (cif_symbol){
      .number = number, .a = 1, .b = 1, .at = c->command, .cell = -1};
}

size_t cif_symbol_of(cif *c, int64_t number) {
  mention *e = g_hash_table_lookup(c->numbers, &number);
  if (e && !forgotten(c, number, e->at)) return e->symbol;
  if (!e) {
    e = eda_alloc(1, sizeof *e);
    e->number = number;
    g_hash_table_add(c->numbers, e);
  }
  e->symbol = c->mentioned;
  e->at = c->command;
  if (!c->building) add_symbol(c, number);
  return c->mentioned++;
}

void cif_forget(cif *c, int64_t from) {
  while (c->n_forgotten && c->forgotten[c->n_forgotten - 1].from >= from)
    c->n_forgotten--;
  eda_grow(&c->forgotten, &c->room_forgotten, c->n_forgotten + 1,
           sizeof *c->forgotten);
  c->forgotten[c->n_forgotten++] = (cif_forgotten){from, c->command};
}

void cif_begin(cif *c) {
  g_hash_table_remove_all(c->numbers);
  c->n_forgotten = 0;
  c->mentioned = 1;
  c->at = c->command = 0;
  if (!c->building) add_symbol(c, 0);
  c->symbols[0].defined = 1;
}

/* ---- the unit and the cells ---- */

/* Of positive numbers. */
static int64_t gcd(int64_t a, int64_t b) {
  while (b > 0) {
    int64_t rest = a % b;
    a = b;
    b = rest;
  }
  return a > 0 ? a : 1;
}

/* The unit is a centimicron divided by the least number that makes whole all
   scale factors, and twice that if a box with an odd side asks for halves. */
static int choose_unit(cif *c, double *unit, opc_error *error) {
  int64_t divisor = 1;
  for (size_t i = 0; i < c->n_symbols; i++) {
    cif_symbol *s = &c->symbols[i];
    if (!s->defined)
      return cif_refuse(c, s->at, error, "calls a symbol that is not defined");
    int64_t common = gcd(s->a, s->b);
    s->a /= common;
    s->b /= common;
    divisor *= s->b / gcd(divisor, s->b);
    if (divisor > INT32_MAX)
      return cif_refuse(c, s->at, error,
                        "scale factors that have no common unit");
  }
  int halves = 0;
  for (size_t i = 0; i < c->n_symbols; i++) {
    cif_symbol *s = &c->symbols[i];
    s->factor = s->a * (divisor / s->b); /* below 2^62 */
    if (s->factor > INT32_MAX / 2)
      return cif_refuse(c, s->at, error,
                        "scale factors that have no common unit");
    if (s->odd && s->factor % 2) halves = 1;
  }
  for (size_t i = 0; i < c->n_symbols && halves; i++) c->symbols[i].factor *= 2;
  /* 1 centimicron = 10 nm */
  *unit = c->r->scale * 10 / (double)(halves ? 2 * divisor : divisor);
  return OPC_OK;
}

/* A cell of that name, or of one like it if there is such a cell already. */
static int make_cell(cif *c, size_t i, const char *name, opc_error *error) {
  g_autofree char *unique = g_strdup(name);
  for (size_t k = i; eda_layout_find_cell(c->layout, unique) >= 0; k++) {
    g_free(unique);
    unique = g_strdup_printf("%s$%zu", name, k);
  }
  c->symbols[i].cell = eda_layout_cell(c->layout, unique, error);
  return c->symbols[i].cell < 0 ? error->code : OPC_OK;
}

/* "inverter" of "cells/inverter.cif" */
static int make_top(cif *c, opc_error *error) {
  const char *slash = strrchr(c->r->file, '/');
  g_autofree char *name = g_strdup(slash ? slash + 1 : c->r->file);
  char *dot = strrchr(name, '.');
  if (dot && dot != name) *dot = '\0';
  return make_cell(c, 0, name, error);
}

int cif_make_cells(cif *c, opc_error *error) {
  double unit = 0;
  if (choose_unit(c, &unit, error)) return error->code;
  c->layout = eda_layout_new(unit, error);
  if (!c->layout) return error->code;
  for (size_t i = 1; i < c->n_symbols; i++) {
    char number[32];
    snprintf(number, sizeof number, "%lld", (long long)c->symbols[i].number);
    const char *name = c->symbols[i].name;
    if (make_cell(c, i, name ? name : number, error)) return error->code;
  }
  if (c->loose || c->calls > 1 || c->moved) return make_top(c, error);
  return OPC_OK;
}
