/* SPDX-License-Identifier: BSD-3-Clause */
#include "weights.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "csv.h"

enum { TYPE, CURRENT, WIDTH, EDGE, GAMMA, COLUMNS };
static const char *const names[COLUMNS] = {"type", "current", "width", "edge",
                                           "gamma"};
static const char *const units[COLUMNS] = {NULL, NULL, "nm", "nm", NULL};

typedef struct point {
  double width, edge, gamma;
  guint row;
} point;

static int by_place(const void *a, const void *b) {
  const point *x = a, *y = b;
  if (x->width != y->width) return x->width < y->width ? -1 : 1;
  return x->edge == y->edge ? 0 : x->edge < y->edge ? -1 : 1;
}

static int read_row(const csv *c, guint row, GArray *points[2][CURRENTS],
                    opc_error *error) {
  const char *text = csv_text(c, row, CURRENT);
  int type, code = csv_type(c, row, TYPE, &type, error);
  int current = !strcmp(text, "ioff") ? IOFF : ION;
  point p = {.row = row};
  if (!code && current == ION && strcmp(text, "ion"))
    code = csv_fail(c, row, CURRENT, "neither 'ion' nor 'ioff':", error);
  if (!code) code = csv_number(c, row, WIDTH, 0, &p.width, error);
  if (!code) code = csv_number(c, row, EDGE, -1e-300, &p.edge, error);
  if (!code) code = csv_number(c, row, GAMMA, 0, &p.gamma, error);
  if (!code) g_array_append_val(points[type][current], p);
  return code;
}

/* A grid of points that are all there, once. */
static int make_grid(const csv *c, GArray *points, grid *g, opc_error *error) {
  size_t n = points->len;
  point *p = (point *)(void *)points->data;
  if (!n) return OPC_OK;
  qsort(p, n, sizeof *p, by_place);
  while (g->edges < n && p[g->edges].width == p[0].width) g->edges++;
  g->widths = (n + g->edges - 1) / g->edges;
  g->width = malloc(g->widths * sizeof *g->width);
  g->edge = malloc(g->edges * sizeof *g->edge);
  g->value = malloc(n * sizeof *g->value);
  if (!g->width || !g->edge || !g->value)
    return c->host->fail(c->host, error, OPC_FAILED, NULL, "out of memory");
  for (size_t i = 0; i < n; i++) {
    const point *first = &p[i - i % g->edges];
    if (i && !by_place(&p[i - 1], &p[i]))
      return csv_fail(c, p[i].row, EDGE, "a second row of this width and edge",
                      error);
    if (p[i].width != first->width || p[i].edge != p[i % g->edges].edge)
      return csv_fail(c, p[i].row, EDGE,
                      "not all widths have the same edges; this is odd:", error);
    g->width[i / g->edges] = p[i].width;
    g->edge[i % g->edges] = p[i].edge;
    g->value[i] = p[i].gamma;
  }
  if (n % g->edges == 0) return OPC_OK;
  return csv_fail(c, p[n - 1].row, EDGE,
                  "not all widths have the same edges; this is the last:",
                  error);
}

int weights_read(const opc_host *host, const char *path, const char *parameter,
                 weights *out, opc_error *error) {
  csv c = {.host = host, .path = path, .parameter = parameter,
           .columns = COLUMNS, .names = names, .units = units};
  GArray *points[2][CURRENTS];
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < CURRENTS; k++)
      points[t][k] = g_array_new(FALSE, FALSE, sizeof(point));
  int code = csv_read(&c, COLUMNS, error);
  for (guint row = 0; !code && row < c.rows->len; row++)
    code = read_row(&c, row, points, error);
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < CURRENTS; k++) {
      if (!code) code = make_grid(&c, points[t][k], &out->grid[t][k], error);
      g_array_free(points[t][k], TRUE);
    }
  csv_clear(&c);
  return code;
}

void weights_clear(weights *w) {
  for (int t = 0; t < 2; t++)
    for (int k = 0; k < CURRENTS; k++) {
      free(w->grid[t][k].width);
      free(w->grid[t][k].edge);
      free(w->grid[t][k].value);
    }
  *w = (weights){0};
}

/* Before which of n increasing places x is, and how far from the one before to
   it; the last places are never left. */
static size_t between(const double *place, size_t n, double x,
                      double *fraction) {
  *fraction = 0;
  if (!(x > place[0])) return 0;
  if (!(x < place[n - 1])) return n - 1;
  size_t low = 0, high = n - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (place[middle] > x) high = middle;
    else low = middle;
  }
  *fraction = (x - place[low]) / (place[high] - place[low]);
  return low;
}

double grid_at(const grid *g, double edge, double width) {
  if (!g->widths) return 1;
  double s, t, row[2] = {1, 1};
  size_t i = between(g->width, g->widths, width, &s);
  size_t j = between(g->edge, g->edges, edge, &t);
  for (size_t k = 0; k < 2 && i + k < g->widths; k++) {
    const double *value = g->value + (i + k) * g->edges + j;
    row[k] = t > 0 ? value[0] + t * (value[1] - value[0]) : value[0];
  }
  return s > 0 ? row[0] + s * (row[1] - row[0]) : row[0];
}
