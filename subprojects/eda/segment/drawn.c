/* SPDX-License-Identifier: BSD-3-Clause */
/* L and W of each gate as drawn. Rounding to the mask grid displaces the edges
   of gates. Therefore the gates are computed again on a grid so fine that no
   edge is displaced. */
#include <math.h>
#include <stdlib.h>

#include "segment/segment.h"

/* Grid as a fraction of the layout unit. Corners of magnified cells may be
   between two grid points; L and W then deviate by at most 1/16 of a unit. */
static const double part = 1.0 / 16;

/* Largest coordinate, 2^30. */
static const double most = 1073741824;

/* Return the grid, doubled until the layout fits the coordinates. */
static double find_grid(const segment *s) {
  const eda_box *e = &s->bounds;
  double far = fmax(fmax(fabs((double)e->x0), fabs((double)e->x1)),
                    fmax(fabs((double)e->y0), fabs((double)e->y1)));
  double grid = part * eda_layout_unit(s->layout);
  while ((far + 1) * s->grid / grid > most) grid *= 2;
  return grid;
}

/* Compute the intersection of poly and active. */
static int cut_out(const segment *s, double grid, eda_shapes *regions) {
  eda_shapes drawn[2] = {{0}};
  int code = OPC_OK;
  double ratio = s->grid / grid;
  eda_box window = {0};
  if (s->window)
    window = (eda_box){(int32_t)(s->window->x0 * ratio - ratio),
                       (int32_t)(s->window->y0 * ratio - ratio),
                       (int32_t)(s->window->x1 * ratio + ratio),
                       (int32_t)(s->window->y1 * ratio + ratio)};
  for (int k = 0; k < 2 && !code; k++) {
    eda_flat flat;
    int32_t layer = eda_layout_find_layer(s->layout, s->source[k].from);
    code =
        segment_flatten(s->layout, s->top, layer, grid,
                        s->window ? &window : NULL, &flat, &drawn[k], s->error);
    eda_flat_clear(&flat);
  }
  if (!code)
    code = eda_boolean(EDA_AND, &drawn[0], &drawn[1], regions, s->error);
  for (int k = 0; k < 2; k++) eda_shapes_clear(&drawn[k]);
  return code;
}

/* Return the region that contains the middle of each gate. */
static uint32_t *find_regions(const segment *s, double grid,
                              const eda_shapes *regions) {
  const eda_gates *g = s->gates;
  double ratio = g->grid / grid;
  doubled *middle = eda_alloc(g->count, sizeof *middle);
  uint32_t *which = eda_alloc(g->count, sizeof *which);
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = g->box[i];
    middle[i].x = llround(((double)b.x0 + b.x1) * ratio);
    middle[i].y = llround(((double)b.y0 + b.y1) * ratio);
  }
  segment_find(middle, g->count, regions, which);
  free(middle);
  return which;
}

static double side_length(const eda_box *b, int d) {
  return (double)box_side(b, d, HIGH) - box_side(b, d, LOW);
}

/* Set *size to `drawn` if the sizes differ. If rounding to the grid has not
   changed the size, *size keeps its exact value. */
static void set_size(double *size, double drawn, double grid) {
  if (fabs(*size - drawn) > 1e-6 * grid) *size = drawn;
}

/* Measure L and W of gate i in `region`, the gate as drawn, and return 1. An
   edge that is straight on the mask grid may be drawn with steps. The drawn
   gate is then not a rectangle: keep the sizes on the mask grid, return 0. */
static int gate_measure(eda_gates *g, size_t i, double grid,
                        const eda_shapes *regions, uint32_t region) {
  if (region == UINT32_MAX) return 0;
  const eda_point *p = regions->points + regions->start[region];
  if (regions->start[region + 1] - regions->start[region] != 4) return 0;
  eda_box b = eda_bounds(p, 4);
  int d = g->axis[i];
  set_size(&g->length[i], grid * side_length(&b, d), g->grid);
  set_size(&g->width[i], grid * side_length(&b, !d), g->grid);
  return 1;
}

int segment_drawn(segment *s) {
  eda_gates *g = s->gates;
  eda_shapes regions;
  double grid = find_grid(s);
  if (!s->moved) return OPC_OK;
  int code = cut_out(s, grid, &regions);
  if (code) return code;
  uint32_t *which = find_regions(s, grid, &regions);
  size_t others = 0;
  for (size_t i = 0; i < g->count; i++)
    others += !gate_measure(g, i, grid, &regions, which[i]);
  if (others)
    segment_log(s, 1,
                "%zu gate%s not drawn as a rectangle, but as one on the grid "
                "of %g nm: L and W are measured on the grid",
                others, others == 1 ? " is" : "s are", s->grid);
  free(which);
  eda_shapes_clear(&regions);
  return OPC_OK;
}
