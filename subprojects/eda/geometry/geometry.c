/* SPDX-License-Identifier: BSD-3-Clause */
/* Checks, area and release of shapes; lists of boxes. */
#include <eda/memory.h>
#include <glib.h>
#include <inttypes.h>
#include <math.h>

#include "geometry/scan.h"

int eda_shapes_check(const eda_shapes *shapes, opc_error *error) {
  if (!shapes || shapes->count == 0) return OPC_OK;
  for (size_t p = 0; p < shapes->count; p++) {
    uint32_t first = shapes->start[p], end = shapes->start[p + 1];
    if (end < first || end > INT32_MAX)
      return opc_fail(error, OPC_INVALID, NULL,
                      "polygon %zu: the range of points is not valid", p);
    for (uint32_t i = first; i < end; i++) {
      eda_point a = shapes->points[i];
      eda_point b = shapes->points[i + 1 < end ? i + 1 : first];
      if (a.x < -EDA_COORDINATE_LIMIT || a.x > EDA_COORDINATE_LIMIT ||
          a.y < -EDA_COORDINATE_LIMIT || a.y > EDA_COORDINATE_LIMIT)
        return opc_fail(error, OPC_INVALID, NULL,
                        "point (%" PRId32 ", %" PRId32 ") is beyond 2^30", a.x,
                        a.y);
      if (a.x != b.x && a.y != b.y)
        return opc_fail(error, OPC_INVALID, NULL,
                        "slanted edge from (%" PRId32 ", %" PRId32
                        ") to (%" PRId32 ", %" PRId32 ")",
                        a.x, a.y, b.x, b.y);
    }
  }
  return OPC_OK;
}

int64_t eda_area2(const eda_shapes *shapes) {
  /* The doubled area of one polygon can reach 2^63, so the sum needs more
     bits. */
  __extension__ __int128 sum = 0;
  for (size_t p = 0; p < shapes->count; p++) {
    uint32_t first = shapes->start[p], end = shapes->start[p + 1];
    for (uint32_t i = first; i < end; i++) {
      eda_point a = shapes->points[i];
      eda_point b = shapes->points[i + 1 < end ? i + 1 : first];
      sum += (int64_t)a.x * b.y - (int64_t)b.x * a.y;
    }
  }
  return sum > INT64_MAX   ? INT64_MAX
         : sum < INT64_MIN ? INT64_MIN
                           : (int64_t)sum;
}

int eda_is_box(const eda_point *p, size_t n) {
  return n == 4 && ((p[0].x == p[1].x && p[1].y == p[2].y && p[2].x == p[3].x &&
                     p[3].y == p[0].y) ||
                    (p[0].y == p[1].y && p[1].x == p[2].x && p[2].y == p[3].y &&
                     p[3].x == p[0].x));
}

eda_box eda_shape_box(const eda_shapes *s, size_t i) {
  return eda_bounds(s->points + s->start[i], s->start[i + 1] - s->start[i]);
}

eda_shapes eda_shapes_of_boxes(size_t n) {
  return (eda_shapes){.count = n,
                      .start = eda_alloc(n + 1, sizeof(uint32_t)),
                      .points = eda_alloc(n, 4 * sizeof(eda_point))};
}

void eda_shapes_set_box(eda_shapes *shapes, size_t i, eda_box b) {
  eda_point *p = shapes->points + 4 * i;
  p[0] = (eda_point){b.x0, b.y0};
  p[1] = (eda_point){b.x1, b.y0};
  p[2] = (eda_point){b.x1, b.y1};
  p[3] = (eda_point){b.x0, b.y1};
  shapes->start[i + 1] = (uint32_t)(4 * (i + 1));
}

void eda_shapes_clear(eda_shapes *shapes) {
  g_free(shapes->start);
  g_free(shapes->points);
  g_free(shapes->hole);
  *shapes = (eda_shapes){0};
}

void eda_box_list_add(eda_box_list *list, eda_box box) {
  EDA_PUSH(list->box, list->count, list->capacity, box);
}

double eda_box_distance(eda_box a, eda_box b) {
  return hypot(0.5 * ((double)a.x0 + a.x1 - b.x0 - b.x1),
               0.5 * ((double)a.y0 + a.y1 - b.y0 - b.y1));
}
