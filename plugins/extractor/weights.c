/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements reading and interpolation of tables of gamma. */
#include "weights.h"

#include <eda/csv.h>
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

enum { TYPE, CURRENT, WIDTH, EDGE, GAMMA, COLUMNS };
static const eda_csv_column columns[COLUMNS] = {
    [TYPE] = {.name = "type"},
    [CURRENT] = {.name = "current"},
    [WIDTH] = {.name = "width", .unit = "nm"},
    [EDGE] = {.name = "edge", .unit = "nm"},
    [GAMMA] = {.name = "gamma"}};

typedef struct point {
  int type, current;
  double width, edge, gamma;
  size_t row;
} point;

/* Compare points by type, current, width and edge. */
static int by_place(const void *a, const void *b) {
  const point *x = a, *y = b;
  if (x->type != y->type) return x->type - y->type;
  if (x->current != y->current) return x->current - y->current;
  if (x->width != y->width) return x->width < y->width ? -1 : 1;
  return x->edge == y->edge ? 0 : x->edge < y->edge ? -1 : 1;
}

static int point_read(const eda_csv *c, size_t row, point *p,
                      opc_error *error) {
  const char *text = eda_csv_text(c, row, CURRENT);
  p->row = row;
  p->current = !strcmp(text, "ioff") ? EDA_IOFF : EDA_ION;
  int code = eda_csv_type(c, row, TYPE, &p->type, error);
  if (!code && p->current == EDA_ION && strcmp(text, "ion"))
    code = eda_csv_fail(c, row, CURRENT, "expected 'ion' or 'ioff':", error);
  if (!code) code = eda_csv_number(c, row, WIDTH, 0, &p->width, error);
  if (!code) code = eda_csv_number(c, row, EDGE, -1e-300, &p->edge, error);
  if (!code) code = eda_csv_number(c, row, GAMMA, 0, &p->gamma, error);
  return code;
}

/* Make a grid from sorted points; fail if a point is missing or repeated. */
static int grid_init(const eda_csv *c, const point *p, size_t n, grid *g,
                     opc_error *error) {
  g->edges = 1;
  while (g->edges < n && p[g->edges].width == p[0].width) g->edges++;
  g->widths = (n + g->edges - 1) / g->edges;
  g->width = eda_alloc(g->widths, sizeof *g->width);
  g->edge = eda_alloc(g->edges, sizeof *g->edge);
  g->value = eda_alloc(n, sizeof *g->value);
  for (size_t i = 0; i < n; i++) {
    const point *first = &p[i - i % g->edges];
    if (i && !by_place(&p[i - 1], &p[i]))
      return eda_csv_fail(c, p[i].row, EDGE,
                          "a second row of this width and edge", error);
    if (p[i].width != first->width || p[i].edge != p[i % g->edges].edge)
      return eda_csv_fail(
          c, p[i].row, EDGE,
          "all widths must have the same edges, unexpected row:", error);
    g->width[i / g->edges] = p[i].width;
    g->edge[i % g->edges] = p[i].edge;
    g->value[i] = p[i].gamma;
  }
  if (n % g->edges == 0) return OPC_OK;
  return eda_csv_fail(
      c, p[n - 1].row, EDGE,
      "all widths must have the same edges, missing after the last row:",
      error);
}

int weights_read(const char *path, const char *parameter, weights *out,
                 opc_error *error) {
  eda_csv *c = eda_csv_read(path, parameter, columns, COLUMNS, 0, error);
  if (!c) return error->code;
  size_t rows = eda_csv_rows(c), n;
  point *p = eda_alloc(rows, sizeof *p);
  int code = OPC_OK;
  for (size_t row = 0; row < rows && !code; row++)
    code = point_read(c, row, &p[row], error);
  if (!code) qsort(p, rows, sizeof *p, by_place);
  for (size_t i = 0; i < rows && !code; i += n) {
    n = 1;
    while (i + n < rows && p[i + n].type == p[i].type &&
           p[i + n].current == p[i].current)
      n++;
    code = grid_init(c, p + i, n, &out->grid[p[i].type][p[i].current], error);
  }
  free(p);
  eda_csv_free(c);
  return code;
}

void weights_clear(weights *w) {
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < EDA_CURRENTS; k++) {
      free(w->grid[t][k].width);
      free(w->grid[t][k].edge);
      free(w->grid[t][k].value);
    }
  *w = (weights){0};
}

/* Return the index of the start of the interval of n increasing positions that
   contains x, and the fraction of the interval below x. x is clamped. */
static size_t grid_between(const double *place, size_t n, double x,
                           double *fraction) {
  *fraction = 0;
  if (!(x > place[0])) return 0;
  if (!(x < place[n - 1])) return n - 1;
  size_t low = 0, high = n - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (place[middle] > x)
      high = middle;
    else
      low = middle;
  }
  *fraction = (x - place[low]) / (place[high] - place[low]);
  return low;
}

double grid_at(const grid *g, double edge, double width) {
  if (!g->widths) return 1;
  double s, t, row[2] = {1, 1};
  size_t i = grid_between(g->width, g->widths, width, &s);
  size_t j = grid_between(g->edge, g->edges, edge, &t);
  for (size_t k = 0; k < 2 && i + k < g->widths; k++) {
    const double *value = g->value + (i + k) * g->edges + j;
    row[k] = t > 0 ? value[0] + t * (value[1] - value[0]) : value[0];
  }
  return s > 0 ? row[0] + s * (row[1] - row[0]) : row[0];
}
