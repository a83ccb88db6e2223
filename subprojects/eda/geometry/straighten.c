/* SPDX-License-Identifier: BSD-3-Clause */
/* Straightening of edges that are nearly parallel to an axis. */
#include <eda/geometry.h>
#include <stdlib.h>

/* The points of a polygon; edge i starts at point i. */
typedef struct ring {
  eda_point *p;
  uint32_t n;
  int64_t most; /* largest deviation of an edge from an axis */
} ring;

static int64_t edge_part(const ring *r, uint32_t i, int axis) {
  eda_point a = r->p[i % r->n], b = r->p[(i + 1) % r->n];
  return axis == 0 ? llabs((int64_t)b.x - a.x) : llabs((int64_t)b.y - a.y);
}

/* Return whether edge i has constant or nearly constant x (axis 0) or y (axis
   1). */
static int edge_along_axis(const ring *r, uint32_t i, int axis) {
  int64_t off = edge_part(r, i, axis), along = edge_part(r, i, !axis);
  return off <= r->most && (axis == 0 ? along > off : along >= off) &&
         (along || off);
}

static int32_t *coordinate(const ring *r, uint32_t i, int axis) {
  eda_point *p = &r->p[i % r->n];
  return axis == 0 ? &p->x : &p->y;
}

/* Set the coordinate `axis` of all points of `count` consecutive edges to the
   middle between its smallest and largest value, unless these differ by more
   than the limit. Return the number of changed edges. */
static size_t ring_level(const ring *r, uint32_t first, uint32_t count,
                         int axis) {
  int32_t low = *coordinate(r, first, axis), high = low;
  size_t slanted = 0;
  for (uint32_t i = first; i <= first + count; i++) {
    int32_t at = *coordinate(r, i, axis);
    if (at < low) low = at;
    if (at > high) high = at;
    if (i < first + count) slanted += edge_part(r, i, axis) != 0;
  }
  if (!slanted || (int64_t)high - low > r->most) return 0;
  for (uint32_t i = first; i <= first + count; i++)
    *coordinate(r, i, axis) = low + (high - low) / 2;
  return slanted;
}

/* Straighten all runs of consecutive edges along one axis. Return the number of
   changed edges. */
static size_t level_runs(const ring *r, int axis) {
  uint32_t begin = 0;
  size_t slanted = 0;
  while (begin < r->n && edge_along_axis(r, begin, axis)) begin++;
  if (begin == r->n) return 0;
  for (uint32_t i = begin; i < begin + r->n;) {
    uint32_t count = 0;
    while (count < r->n && edge_along_axis(r, i + count, axis)) count++;
    if (count) slanted += ring_level(r, i, count, axis);
    i += count + 1;
  }
  return slanted;
}

size_t eda_shapes_straighten(const eda_shapes *shapes, int32_t most) {
  size_t slanted = 0;
  for (size_t p = 0; p < shapes->count; p++) {
    uint32_t first = shapes->start[p];
    ring r = {shapes->points + first, shapes->start[p + 1] - first, most};
    if (r.n < 4) continue;
    slanted += level_runs(&r, 0) + level_runs(&r, 1);
  }
  return slanted;
}
