/* SPDX-License-Identifier: BSD-3-Clause */
/* Division of polygons with too many points. The polygon is divided in two by a
   vertical line, and alternatively by a horizontal line, near the median of its
   points. The division whose larger part has fewer points is used, and both
   parts are divided further. Clipping at a line preserves the winding numbers
   on both sides, so self-intersecting polygons are allowed. */
#include <eda/formats.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct piece piece;
struct piece {
  piece *next;
  size_t n;
  eda_point points[];
};

static piece *piece_new(size_t capacity) {
  return eda_alloc(1, sizeof(piece) + capacity * sizeof(eda_point));
}

static int32_t coordinate(eda_point p, int axis) { return axis ? p.y : p.x; }

/* Find a coordinate strictly between the smallest and largest coordinate, near
   the median. Return 0 if there is none. */
static int median(const piece *p, int axis, int32_t *values, int32_t *at) {
  for (size_t i = 0; i < p->n; i++) values[i] = coordinate(p->points[i], axis);
  qsort(values, p->n, sizeof *values, eda_int32s_rise);
  int64_t low = values[0], high = values[p->n - 1];
  if (high - low < 2) return 0;
  *at = values[p->n / 2];
  if (*at == low) *at = (int32_t)low + 1;
  if (*at == high) *at = (int32_t)high - 1;
  return 1;
}

/* Append a point. If the last two points and `p` are on the clip line, remove
   the last point first. */
static void piece_add(piece *out, eda_point p, int axis, int32_t at) {
  if (out->n >= 2 && coordinate(p, axis) == at &&
      coordinate(out->points[out->n - 1], axis) == at &&
      coordinate(out->points[out->n - 2], axis) == at)
    out->n--;
  out->points[out->n++] = p;
}

static eda_point edge_crossing(eda_point a, eda_point b, int axis, int32_t at) {
  double ca = coordinate(a, axis), cb = coordinate(b, axis);
  double oa = coordinate(a, !axis), ob = coordinate(b, !axis);
  int32_t other = (int32_t)floor(oa + (ob - oa) * (at - ca) / (cb - ca) + 0.5);
  return axis ? (eda_point){other, at} : (eda_point){at, other};
}

/* Return the part of `p` below (side -1) or above (side 1) the clip line. */
static piece *piece_clip(const piece *p, int axis, int32_t at, int side) {
  piece *out = piece_new(2 * p->n + 2);
  eda_point a = p->points[p->n - 1];
  for (size_t i = 0; i < p->n; i++) {
    eda_point b = p->points[i];
    int64_t da = ((int64_t)coordinate(a, axis) - at) * side;
    int64_t db = ((int64_t)coordinate(b, axis) - at) * side;
    if ((da < 0 && db > 0) || (da > 0 && db < 0))
      piece_add(out, edge_crossing(a, b, axis, at), axis, at);
    if (db >= 0) piece_add(out, b, axis, at);
    a = b;
  }
  return out;
}

static size_t larger_half(const piece *const half[2]) {
  return half[0]->n > half[1]->n ? half[0]->n : half[1]->n;
}

/* Divide a polygon in two by the vertical or the horizontal line near the
   median, by the line whose larger part has fewer points. Return 0 if with both
   lines a part has more than 4/5 of the points. */
static int piece_halve(const piece *p, piece *best[2]) {
  int32_t *values = eda_alloc(p->n, sizeof *values);
  for (int axis = 0; axis < 2; axis++) {
    int32_t at;
    if (!median(p, axis, values, &at)) continue;
    piece *half[2] = {piece_clip(p, axis, at, -1), piece_clip(p, axis, at, 1)};
    if (larger_half((const piece *const *)half) <= p->n * 4 / 5 &&
        (!best[0] || larger_half((const piece *const *)half) <
                         larger_half((const piece *const *)best)))
      for (int i = 0; i < 2; i++) {
        piece *worse = best[i];
        best[i] = half[i];
        half[i] = worse;
      }
    free(half[0]);
    free(half[1]);
  }
  free(values);
  return best[0] != NULL;
}

int eda_polygon_cut(const eda_point *points, size_t n,
                    const eda_polygon_taker *take, opc_error *error) {
  if (n <= take->most) return take->polygon(take->data, points, n, error);
  piece *todo = piece_new(n);
  memcpy(todo->points, points, n * sizeof *points);
  todo->n = n;
  int code = OPC_OK;
  while (todo) {
    piece *p = todo, *half[2] = {NULL, NULL};
    todo = p->next;
    if (!code && p->n <= take->most) {
      if (p->n > 2) code = take->polygon(take->data, p->points, p->n, error);
    } else if (!code && !piece_halve(p, half)) {
      code = opc_fail(error, OPC_FAILED, NULL,
                      "a polygon of %zu points at (%d, %d) cannot be divided "
                      "into polygons of at most %zu points",
                      n, points[0].x, points[0].y, take->most);
    }
    for (int i = 0; i < 2 && half[i]; i++) {
      half[i]->next = todo;
      todo = half[i];
    }
    free(p);
  }
  return code;
}
