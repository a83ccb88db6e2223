/* SPDX-License-Identifier: BSD-3-Clause */
/* What is written upon each gate: the texts of the layer `notes`. A text in a
   cell is there in each of its instances; one of a higher cell, which knows the
   instance, goes before it. */
#include <stdlib.h>
#include <string.h>

#include "segment/segment.h"

static const char layer_name[] = "notes";

/* The gates with their right and upper edges, as points on them are in them. */
static eda_shapes get_boxes(const eda_gates *g) {
  eda_shapes out = {.count = g->count};
  out.start = eda_alloc(g->count + 1, sizeof *out.start);
  out.points = eda_alloc(g->count, 4 * sizeof *out.points);
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = g->box[i];
    eda_point *p = out.points + 4 * i;
    p[0] = (eda_point){b.x0, b.y0};
    p[1] = (eda_point){b.x1 + 1, b.y0};
    p[2] = (eda_point){b.x1 + 1, b.y1 + 1};
    p[3] = (eda_point){b.x0, b.y1 + 1};
    out.start[i + 1] = (uint32_t)(4 * (i + 1));
  }
  return out;
}

static int refuse_second(segment *s, const eda_flat_texts *t, size_t i,
                         uint32_t gate) {
  const eda_gates *g = s->gates;
  eda_point p = t->at.shapes.points[i];
  return opc_fail(
      s->error, OPC_INVALID, NULL,
      "transistor '%.200s:%u' has two notes: '%.100s', and at (%g, %g) nm "
      "'%.100s'",
      *g->instance[gate] ? g->instance[gate] : g->cell[gate], g->number[gate],
      g->note[gate], p.x * s->grid, p.y * s->grid, t->text[i]);
}

/* The text of the highest cell. Two of equal rank must say the same. */
static int give(segment *s, const eda_flat_texts *t, const uint32_t *which) {
  eda_gates *g = s->gates;
  size_t n = t->at.shapes.count;
  uint32_t *depth = eda_alloc(g->count, sizeof *depth);
  for (size_t i = 0; i < n; i++) {
    uint32_t gate = which[i];
    if (gate == UINT32_MAX || (g->note[gate] && depth[gate] <= t->depth[i]))
      continue;
    g->note[gate] = eda_gates_text(g, t->text[i]);
    depth[gate] = t->depth[i];
  }
  int code = OPC_OK;
  for (size_t i = 0; !code && i < n; i++) {
    uint32_t gate = which[i];
    if (gate != UINT32_MAX && depth[gate] == t->depth[i] &&
        strcmp(g->note[gate], t->text[i]) != 0)
      code = refuse_second(s, t, i, gate);
  }
  free(depth);
  return code;
}

static void warn(const segment *s, const eda_flat_texts *t,
                 const uint32_t *which) {
  size_t beside = 0, first = 0;
  for (size_t i = t->at.shapes.count; i-- > 0;)
    if (which[i] == UINT32_MAX) {
      first = i;
      beside++;
    }
  if (!beside) return;
  eda_point p = t->at.shapes.points[first];
  int32_t cell;
  char *path = segment_path(s, t->at.placement[first], &cell);
  segment_tell(s, 1,
               "texts of layer '%s' on no transistor: %zu, the first '%.100s' "
               "at (%g, %g) nm%s%.200s%s",
               layer_name, beside, t->text[first], p.x * s->grid, p.y * s->grid,
               *path ? ", instance '" : "", path, *path ? "'" : "");
  free(path);
}

int segment_notes(segment *s) {
  eda_gates *g = s->gates;
  int32_t layer = eda_layout_find_layer(s->layout, layer_name);
  if (layer < 0) return OPC_OK;
  eda_flat_texts texts;
  int code = eda_layout_flatten_texts_window(s->layout, s->top, layer, s->grid,
                                             s->window, &texts, s->error);
  if (code) return code;
  size_t n = texts.at.shapes.count;
  eda_shapes boxes = get_boxes(g);
  doubled *points = eda_alloc(n, sizeof *points);
  uint32_t *which = eda_alloc(n, sizeof *which);
  g->note = eda_alloc(g->count, sizeof *g->note);
  for (size_t i = 0; i < n; i++) {
    eda_point p = texts.at.shapes.points[i];
    points[i] = (doubled){2 * (int64_t)p.x, 2 * (int64_t)p.y};
  }
  segment_find(points, n, &boxes, which);
  code = give(s, &texts, which);
  if (!code) warn(s, &texts, which);
  eda_shapes_clear(&boxes);
  free(points);
  free(which);
  eda_flat_texts_clear(&texts);
  return code;
}
