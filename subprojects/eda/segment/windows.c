/* SPDX-License-Identifier: BSD-3-Clause */
/* Segmentation of windows of a layout. All shapes relevant to a transistor are
   within a fixed distance, the reach. A window with this margin around a core
   is therefore sufficient, unless the border of the window cuts a transistor;
   then the window is enlarged. */
#include "segment/windows.h"

#include <stdlib.h>

/* Margin of a window beyond the reach, nm. Most transistors are smaller than
   this margin, so that the first window contains all transistors near the core
   completely. With half of this margin, every second window of 65 nm circuits
   is enlarged and computed again. */
#define BEYOND 1000.0

/* Clip a window at one unit beyond the bounds of the layout, where the border
   cuts no shape. */
static void window_clip(eda_box *w, eda_box bounds) {
  bounds = eda_box_grown(bounds, 1);
  if (w->x0 < bounds.x0) w->x0 = bounds.x0;
  if (w->y0 < bounds.y0) w->y0 = bounds.y0;
  if (w->x1 > bounds.x1) w->x1 = bounds.x1;
  if (w->y1 > bounds.y1) w->y1 = bounds.y1;
}

/* Remove the regions cut by the border of the window. */
static void drop_cut(segment *s) {
  eda_shapes *r = &s->regions;
  eda_box inner = eda_box_grown(*s->window, -1);
  uint32_t n = 0, points = 0;
  for (size_t i = 0; i < r->count; i++) {
    eda_box b = eda_shape_box(r, i);
    uint32_t from = r->start[i], to = r->start[i + 1];
    if (b.x0 < inner.x0 || b.y0 < inner.y0 || b.x1 > inner.x1 ||
        b.y1 > inner.y1)
      continue;
    for (uint32_t k = from; k < to; k++) r->points[points++] = r->points[k];
    r->hole[n] = r->hole[i];
    r->start[++n] = points;
  }
  r->count = n;
  if (!n) eda_shapes_clear(r);
}

/* ---- a window ---- */

int eda_segment_window(const eda_layout *layout, int32_t top,
                       const eda_segment_settings *settings,
                       const eda_box *window, eda_gates **gates,
                       opc_error *error) {
  segment s = segment_new(NULL, layout, top, settings, error);
  eda_box w = *window;
  int code = segment_begin(&s);
  window_clip(&w, s.bounds);
  s.window = &w;
  if (!code) code = segment_layers(&s);
  if (!code) code = segment_regions(&s);
  if (!code) drop_cut(&s);
  if (!code) code = segment_finish(&s);
  *gates = segment_end(&s, code);
  return code;
}

/* ---- a core and its environment ---- */

static int32_t larger_of(int32_t a, int32_t b) { return a > b ? a : b; }

/* Return the largest distance of a relevant shape from a transistor. */
static int32_t reach_of(const segment *s) {
  /* The overhang and line end of a gate are at most half of the reach. */
  return larger_of(s->reach, 2 * larger_of(s->overhang, s->line_end));
}

int32_t eda_segment_halo(const eda_segment_settings *settings) {
  opc_error error;
  segment s = segment_new(NULL, NULL, 0, settings, &error);
  free(s.source);
  return reach_of(&s) + (int32_t)(BEYOND / settings->grid) + 1;
}

/* Extend `wanted` to the smallest window that region i needs: a region that
   touches the core needs its full reach; a region within reach of such a region
   must be complete. */
static void window_extend(const segment *s, eda_box core, size_t i,
                          eda_box *wanted) {
  eda_box b = eda_shape_box(&s->regions, i);
  int32_t reach = reach_of(s);
  if (!eda_boxes_touch(b, eda_box_grown(core, reach))) return;
  b = eda_box_grown(b, eda_boxes_touch(b, core) ? reach : 1);
  if (b.x0 < wanted->x0) wanted->x0 = b.x0;
  if (b.y0 < wanted->y0) wanted->y0 = b.y0;
  if (b.x1 > wanted->x1) wanted->x1 = b.x1;
  if (b.y1 > wanted->y1) wanted->y1 = b.y1;
}

/* Double the margin on the sides on which `wanted` exceeds the window. Return 0
   if the window is sufficient. */
static int window_widen(const segment *s, eda_box core, eda_box *window) {
  eda_box w = *window, wanted = w;
  for (size_t i = 0; i < s->regions.count; i++)
    window_extend(s, core, i, &wanted);
  window_clip(&wanted, s->bounds);
  eda_box far = {2 * w.x0 - core.x0, 2 * w.y0 - core.y0, 2 * w.x1 - core.x1,
                 2 * w.y1 - core.y1};
  if (wanted.x0 < w.x0) window->x0 = far.x0;
  if (wanted.y0 < w.y0) window->y0 = far.y0;
  if (wanted.x1 > w.x1) window->x1 = far.x1;
  if (wanted.y1 > w.y1) window->y1 = far.y1;
  window_clip(window, s->bounds);
  return window->x0 != w.x0 || window->y0 != w.y0 || window->x1 != w.x1 ||
         window->y1 != w.y1;
}

int eda_segment_core(const eda_layout *layout, int32_t top,
                     const eda_segment_settings *settings, eda_box core,
                     int32_t halo, eda_gates **gates, opc_error *error) {
  segment s = segment_new(NULL, layout, top, settings, error);
  eda_box w = eda_box_grown(core, larger_of(halo, eda_segment_halo(settings)));
  int code = segment_begin(&s);
  window_clip(&w, s.bounds);
  s.window = &w;
  do {
    segment_clear_layers(&s);
    if (!code) code = segment_layers(&s);
    if (!code) code = segment_regions(&s);
  } while (!code && window_widen(&s, core, &w));
  if (!code) drop_cut(&s);
  if (!code) code = segment_finish(&s);
  *gates = segment_end(&s, code);
  return code;
}
