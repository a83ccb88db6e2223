/* SPDX-License-Identifier: BSD-3-Clause */
/* Cutting a polygon that has too many points: into two by a vertical or
   horizontal line through the median of its points, whichever leaves fewer
   points, and those again. Clipping keeps the winding number on either side of
   the line, so that no shape is too odd for it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "polygons.h"

typedef struct piece piece;
struct piece {
  piece *next;
  size_t n, room;
  opc_point points[];
};

static piece *piece_new(size_t room) {
  piece *p = malloc(sizeof *p + room * sizeof p->points[0]);
  if (p) *p = (piece){.room = room};
  return p;
}

static int32_t coordinate(opc_point p, int axis) { return axis ? p.y : p.x; }

static int by_value(const void *a, const void *b) {
  int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
  return (x > y) - (x < y);
}

/* A value strictly inside the range of the points, near their median; 0 if
   there is none. */
static int median(const piece *p, int axis, int32_t *values, int32_t *at) {
  for (size_t i = 0; i < p->n; i++) values[i] = coordinate(p->points[i], axis);
  qsort(values, p->n, sizeof *values, by_value);
  int64_t low = values[0], high = values[p->n - 1];
  if (high - low < 2) return 0;
  *at = values[p->n / 2];
  if (*at == low) *at = (int32_t)low + 1;
  if (*at == high) *at = (int32_t)high - 1;
  return 1;
}

/* Add a point; of three on the line of the cut the middle one goes. */
static void add(piece *out, opc_point p, int axis, int32_t at) {
  if (out->n >= 2 && coordinate(p, axis) == at &&
      coordinate(out->points[out->n - 1], axis) == at &&
      coordinate(out->points[out->n - 2], axis) == at)
    out->n--;
  out->points[out->n++] = p;
}

static opc_point crossing(opc_point a, opc_point b, int axis, int32_t at) {
  double ca = coordinate(a, axis), cb = coordinate(b, axis);
  double oa = coordinate(a, !axis), ob = coordinate(b, !axis);
  int32_t other = (int32_t)floor(oa + (ob - oa) * (at - ca) / (cb - ca) + 0.5);
  return axis ? (opc_point){other, at} : (opc_point){at, other};
}

/* The part of `p` on one side of the line: side -1 below, 1 above. */
static piece *clip(const piece *p, int axis, int32_t at, int side) {
  piece *out = piece_new(2 * p->n + 2);
  if (!out) return NULL;
  opc_point a = p->points[p->n - 1];
  for (size_t i = 0; i < p->n; i++) {
    opc_point b = p->points[i];
    int64_t da = ((int64_t)coordinate(a, axis) - at) * side;
    int64_t db = ((int64_t)coordinate(b, axis) - at) * side;
    if ((da < 0 && db > 0) || (da > 0 && db < 0))
      add(out, crossing(a, b, axis, at), axis, at);
    if (db >= 0) add(out, b, axis, at);
    a = b;
  }
  return out;
}

static size_t larger(const piece *const half[2]) {
  return half[0]->n > half[1]->n ? half[0]->n : half[1]->n;
}

/* The two parts of a polygon: -1 without memory, 0 if no line makes both
   clearly smaller. */
static int halve(const piece *p, piece *best[2]) {
  int32_t *values = malloc(p->n * sizeof *values);
  if (!values) return -1;
  int good = 0;
  for (int axis = 0; axis < 2 && good >= 0; axis++) {
    int32_t at;
    if (!median(p, axis, values, &at)) continue;
    piece *half[2] = {clip(p, axis, at, -1), clip(p, axis, at, 1)};
    int lost = !half[0] || !half[1];
    if (lost) good = -1;
    if (!lost && larger((const piece *const *)half) <= p->n / 5 * 4 &&
        (!best[0] || larger((const piece *const *)half) <
                         larger((const piece *const *)best))) {
      for (int i = 0; i < 2; i++) {
        piece *worse = best[i];
        best[i] = half[i];
        half[i] = worse;
      }
      good = 1;
    }
    free(half[0]);
    free(half[1]);
  }
  free(values);
  return good;
}

int polygon_cut(const opc_host *host, const opc_point *points, size_t n,
                const polygon_taker *take, opc_error *error) {
  if (n <= take->most) return take->polygon(take->data, points, n, error);
  piece *todo = piece_new(n);
  if (!todo) return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  memcpy(todo->points, points, n * sizeof *points);
  todo->n = n;
  int code = OPC_OK;
  while (todo) {
    piece *p = todo, *half[2] = {NULL, NULL};
    todo = p->next;
    if (!code && p->n <= take->most) {
      if (p->n > 2) code = take->polygon(take->data, p->points, p->n, error);
    } else if (!code) {
      int good = halve(p, half);
      if (good < 0)
        code = host->fail(host, error, OPC_FAILED, NULL, "out of memory");
      else if (!good)
        code = host->fail(host, error, OPC_FAILED, NULL,
                          "a polygon of %zu points at (%d, %d) cannot be cut "
                          "into ones of %zu",
                          n, points[0].x, points[0].y, take->most);
      for (int i = 0; i < 2; i++)
        if (half[i]) {
          half[i]->next = todo;
          todo = half[i];
        }
    }
    free(p);
  }
  return code;
}
