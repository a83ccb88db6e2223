/* SPDX-License-Identifier: BSD-3-Clause */
#include <search.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cif.h"

typedef struct mention {
  int64_t number;
  size_t symbol;
  size_t at; /* where the symbol was first mentioned */
} mention;

static int compare(const void *a, const void *b) {
  int64_t x = ((const mention *)a)->number, y = ((const mention *)b)->number;
  return (x > y) - (x < y);
}

void cif_clear_numbers(cif *c) {
  while (c->numbers) {
    mention *e = *(mention **)c->numbers;
    tdelete(e, &c->numbers, compare);
    free(e);
  }
}

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

static int add_symbol(cif *c, int64_t number) {
  if (!cif_grow(&c->symbols, &c->room_symbols, c->n_symbols + 1,
                sizeof *c->symbols))
    return 0;
  c->symbols[c->n_symbols++] = (cif_symbol){
      .number = number, .a = 1, .b = 1, .at = c->command, .cell = -1};
  return 1;
}

int64_t cif_symbol_of(cif *c, int64_t number) {
  mention key = {.number = number};
  void *found = tfind(&key, &c->numbers, compare);
  mention *e = found ? *(mention **)found : NULL;
  if (e && !forgotten(c, number, e->at)) return (int64_t)e->symbol;
  if (!e) {
    e = malloc(sizeof *e);
    if (!e) return -1;
    e->number = number;
    if (!tsearch(e, &c->numbers, compare)) {
      free(e);
      return -1;
    }
  }
  e->symbol = c->mentioned;
  e->at = c->command;
  if (!c->building && !add_symbol(c, number)) return -1;
  return (int64_t)c->mentioned++;
}

int cif_forget(cif *c, int64_t from, opc_error *error) {
  while (c->n_forgotten && c->forgotten[c->n_forgotten - 1].from >= from)
    c->n_forgotten--;
  if (!cif_grow(&c->forgotten, &c->room_forgotten, c->n_forgotten + 1,
                sizeof *c->forgotten))
    return cif_no_memory(c, error);
  c->forgotten[c->n_forgotten++] = (cif_forgotten){from, c->command};
  return OPC_OK;
}

int cif_begin(cif *c, opc_error *error) {
  cif_clear_numbers(c);
  c->n_forgotten = 0;
  c->mentioned = 1;
  c->at = c->command = 0;
  if (!c->building && !add_symbol(c, 0)) return cif_no_memory(c, error);
  c->symbols[0].defined = 1;
  return OPC_OK;
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
  *unit = c->scale * 10 / (double)(halves ? 2 * divisor : divisor);
  return OPC_OK;
}

/* A cell of that name, or of one like it if there is such a cell already. */
static int make_cell(cif *c, size_t i, const char *name, opc_error *error) {
  const opc_layout_service *l = c->host->layout;
  size_t room = strlen(name) + 32;
  char *unique = malloc(room);
  if (!unique) return cif_no_memory(c, error);
  snprintf(unique, room, "%s", name);
  for (size_t k = i; l->find_cell(c->layout, unique) >= 0; k++)
    snprintf(unique, room, "%s$%zu", name, k);
  c->symbols[i].cell = l->cell(c->layout, unique, error);
  free(unique);
  return c->symbols[i].cell < 0 ? error->code : OPC_OK;
}

/* "inverter" of "cells/inverter.cif" */
static int make_top(cif *c, opc_error *error) {
  const char *slash = strrchr(c->path, '/');
  char *name = strdup(slash ? slash + 1 : c->path);
  if (!name) return cif_no_memory(c, error);
  char *dot = strrchr(name, '.');
  if (dot && dot != name) *dot = '\0';
  int code = make_cell(c, 0, name, error);
  free(name);
  return code;
}

int cif_make_cells(cif *c, opc_error *error) {
  double unit = 0;
  if (choose_unit(c, &unit, error)) return error->code;
  c->layout = c->host->layout->create(c->host, unit, error);
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
