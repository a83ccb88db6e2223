/* SPDX-License-Identifier: BSD-3-Clause */
/* Conversion of layout layers to layers of gates. */
#include <math.h>

#include "segment/segment.h"

int32_t eda_segment_top(const eda_layout *layout, const char *name,
                        opc_error *error) {
  if (!name) return eda_layout_top(layout, error);
  int32_t top = eda_layout_find_cell(layout, name);
  if (top < 0)
    opc_fail(error, OPC_INVALID, "top", "the layout has no cell '%.200s'",
             name);
  return top;
}

/* Merge flat shapes and clip them at the window. */
static int shapes_merge(const eda_shapes *flat, const eda_box *window,
                        eda_shapes *merged, opc_error *error) {
  if (!window) return eda_boolean(EDA_OR, flat, NULL, merged, error);
  eda_box w = *window;
  eda_point corners[] = {
      {w.x0, w.y0}, {w.x1, w.y0}, {w.x1, w.y1}, {w.x0, w.y1}};
  uint32_t start[] = {0, 4};
  eda_shapes frame = {.count = 1, .start = start, .points = corners};
  return eda_boolean(EDA_AND, flat, &frame, merged, error);
}

int segment_flatten(const eda_layout *layout, int32_t top, int32_t layer,
                    double grid, const eda_box *window, eda_flat *flat,
                    eda_shapes *merged, opc_error *error) {
  *flat = (eda_flat){0};
  *merged = (eda_shapes){0};
  int code =
      eda_layout_flatten_window(layout, top, layer, grid, window, flat, error);
  if (code) return code;
  opc_error inner;
  flat->moved +=
      eda_shapes_straighten(&flat->shapes, (int32_t)lround(fmax(1, 1 / grid)));
  code = shapes_merge(&flat->shapes, window, merged, &inner);
  if (!code) return OPC_OK;
  eda_flat_clear(flat);
  return opc_fail(error, code, NULL, "layer '%s', in units of %g nm: %.800s",
                  eda_layout_layer_name(layout, layer), grid, inner.message);
}

void segment_set_layer(eda_gates *gates, size_t layer, const char *name,
                       int corrected, eda_shapes *drawn) {
  eda_box b =
      eda_bounds(drawn->points, drawn->count ? drawn->start[drawn->count] : 0);
  if (layer == 0) gates->extent = b;
  eda_box_join(&gates->extent, b);
  gates->layer[layer] = eda_gates_text(gates, name);
  gates->corrected[layer] = corrected != 0;
  gates->drawn[layer] = *drawn;
  *drawn = (eda_shapes){0};
}

void segment_cut_plain(eda_gates *gates, size_t layer) {
  const eda_shapes *s = &gates->drawn[layer];
  eda_edges *out = &gates->edges[layer];
  size_t n = s->count ? s->start[s->count] : 0;
  out->start = eda_alloc(s->count + 1, sizeof *out->start);
  out->fragments = eda_alloc(n, sizeof *out->fragments);
  out->polygons = s->count;
  for (size_t p = 1; p <= s->count; p++) out->start[p] = s->start[p];
  for (size_t i = 0; i < n; i++)
    out->fragments[i] = (eda_fragment){.from = s->points[i], .gate = -1};
}

int eda_segment_edges(const eda_layout *layout, int32_t top, int32_t layer,
                      double grid, eda_gates **gates, size_t *moved,
                      opc_error *error) {
  eda_flat flat;
  eda_shapes drawn;
  *gates = NULL;
  int code =
      segment_flatten(layout, top, layer, grid, NULL, &flat, &drawn, error);
  if (code) return code;
  const char *name = eda_layout_layer_name(layout, layer);
  *moved = flat.moved;
  eda_flat_clear(&flat);
  if (!drawn.count)
    return opc_fail(error, OPC_INVALID, NULL, "layer '%s' is empty", name);
  eda_gates *g = *gates = eda_gates_new(1, 0);
  g->name = eda_gates_text(g, eda_layout_cell_name(layout, top));
  g->grid = grid;
  segment_set_layer(g, 0, name, 1, &drawn);
  segment_cut_plain(g, 0);
  return OPC_OK;
}
