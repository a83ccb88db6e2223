/* SPDX-License-Identifier: BSD-3-Clause */
/* Search for the first shape that contains a point. The search finds the
   placement that drew the active of each region: the placement of the shape
   that contains the middle of the region. */
#include <eda/index.h>
#include <stdlib.h>

#include "segment/segment.h"

/* Return whether a polygon contains a point. A point on the common edge of two
   abutting shapes is inside exactly one of them. */
static int polygon_contains(const eda_point *p, uint32_t n, doubled at) {
  int wind = 0;
  for (uint32_t i = 0; i < n; i++) {
    eda_point a = p[i], b = p[i + 1 < n ? i + 1 : 0];
    if (2 * (int64_t)a.x > at.x) continue;
    if (2 * (int64_t)a.y <= at.y && 2 * (int64_t)b.y > at.y) wind++;
    if (2 * (int64_t)b.y <= at.y && 2 * (int64_t)a.y > at.y) wind--;
  }
  return wind != 0;
}

void segment_find(const doubled *points, size_t n, const eda_shapes *shapes,
                  uint32_t *which) {
  eda_box *boxes = eda_alloc(n, sizeof *boxes);
  for (size_t i = 0; i < n; i++) {
    doubled p = points[i];
    boxes[i] = (eda_box){(int32_t)(p.x >> 1), (int32_t)(p.y >> 1),
                         (int32_t)((p.x + 1) >> 1), (int32_t)((p.y + 1) >> 1)};
    which[i] = UINT32_MAX;
  }
  eda_index *index = eda_index_new(boxes, n, 0);
  for (size_t s = 0; n && s < shapes->count; s++) {
    const eda_point *p = shapes->points + shapes->start[s];
    uint32_t corners = shapes->start[s + 1] - shapes->start[s];
    eda_finder f = eda_index_find(index, eda_bounds(p, corners));
    for (uint32_t i; eda_index_next(&f, &i);)
      if (which[i] == UINT32_MAX && polygon_contains(p, corners, points[i]))
        which[i] = (uint32_t)s;
  }
  eda_index_free(index);
  free(boxes);
}

/* Return the middle of a box. Regions that are no boxes are rejected later;
   return their first corner, because the interior is above and to the right
   of this corner. */
static doubled middle_of(const eda_shapes *regions, size_t i) {
  const eda_point *p = regions->points + regions->start[i];
  uint32_t n = regions->start[i + 1] - regions->start[i];
  if (n != 4) return (doubled){2 * (int64_t)p->x, 2 * (int64_t)p->y};
  return (doubled){(int64_t)p[0].x + p[2].x, (int64_t)p[0].y + p[2].y};
}

void segment_locate(segment *s) {
  size_t n = s->regions.count;
  doubled *points = eda_alloc(n, sizeof *points);
  s->placement = eda_alloc(n, sizeof *s->placement);
  for (size_t i = 0; i < n; i++) points[i] = middle_of(&s->regions, i);
  segment_find(points, n, &s->active.shapes, s->placement);
  for (size_t i = 0; i < n; i++)
    if (s->placement[i] != UINT32_MAX)
      s->placement[i] = s->active.placement[s->placement[i]];
  free(points);
}
