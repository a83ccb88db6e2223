/* SPDX-License-Identifier: BSD-3-Clause */
/* Growing and shrinking of shapes by a square: dilation and erosion (J. Serra,
   "Image Analysis and Mathematical Morphology", 1982). */
#include <eda/geometry.h>
#include <eda/memory.h>
#include <stdlib.h>

/* Return a box for each edge: the bounding box of the edge, enlarged by `by` on
   each side. */
static eda_shapes boxes_of_edges(const eda_shapes *s, int32_t by) {
  eda_shapes out = eda_shapes_of_boxes(s->count ? s->start[s->count] : 0);
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t next = i + 1 < s->start[p + 1] ? i + 1 : s->start[p];
      const eda_point ends[] = {s->points[i], s->points[next]};
      eda_shapes_set_box(&out, i, eda_box_grown(eda_bounds(ends, 2), by));
    }
  return out;
}

int eda_shapes_grow(const eda_shapes *shapes, int32_t by, eda_shapes *out,
                    opc_error *error) {
  if (by == 0) return eda_boolean(EDA_OR, shapes, NULL, out, error);
  eda_shapes boxes = boxes_of_edges(shapes, abs(by));
  int code = eda_boolean(by > 0 ? EDA_OR : EDA_NOT, shapes, &boxes, out, error);
  eda_shapes_clear(&boxes);
  return code;
}
