/* SPDX-License-Identifier: BSD-3-Clause */
/* What is written upon each gate: the texts of the layer `notes`. A text in a
   cell is there in each of its instances; one of a higher cell, which knows the
   instance, goes before it. */
#include <opcflow/opcflow.h>
#include <string.h>

#include "segment.h"

static const char layer_name[] = "notes";

/* The gates with their right and upper edges, as points on them are in them. */
static int get_boxes(segment *s, opc_shapes *out) {
  const opc_gates *g = s->gates;
  out->start = s->host->alloc(s->host, g->count + 1, sizeof *out->start);
  out->points = s->host->alloc(s->host, g->count, 4 * sizeof *out->points);
  if (!out->start || !out->points) return segment_no_memory(s);
  out->count = g->count;
  for (size_t i = 0; i < g->count; i++) {
    opc_box b = g->box[i];
    opc_point *p = out->points + 4 * i;
    p[0] = (opc_point){b.x0, b.y0};
    p[1] = (opc_point){b.x1 + 1, b.y0};
    p[2] = (opc_point){b.x1 + 1, b.y1 + 1};
    p[3] = (opc_point){b.x0, b.y1 + 1};
    out->start[i + 1] = (uint32_t)(4 * (i + 1));
  }
  return OPC_OK;
}

static int refuse_second(segment *s, const opc_flat_texts *t, size_t i,
                         uint32_t gate) {
  const opc_gates *g = s->gates;
  opc_point p = t->at.shapes.points[i];
  return s->host->fail(
      s->host, s->error, OPC_INVALID, NULL,
      "transistor '%.200s:%u' has two notes: '%.100s', and at (%g, %g) nm "
      "'%.100s'",
      *g->instance[gate] ? g->instance[gate] : g->cell[gate], g->number[gate],
      g->note[gate], p.x * s->grid, p.y * s->grid, t->text[i]);
}

/* The text of the highest cell. Two of equal rank must say the same. */
static int give(segment *s, const opc_flat_texts *t, const uint32_t *which) {
  opc_gates *g = s->gates;
  size_t n = t->at.shapes.count;
  uint32_t *depth = s->host->alloc(s->host, g->count, sizeof *depth);
  if (!depth) return segment_no_memory(s);
  for (size_t i = 0; i < n; i++) {
    uint32_t gate = which[i];
    if (gate == UINT32_MAX || (g->note[gate] && depth[gate] <= t->depth[i]))
      continue;
    g->note[gate] = t->text[i];
    depth[gate] = t->depth[i];
  }
  int code = OPC_OK;
  for (size_t i = 0; !code && i < n; i++) {
    uint32_t gate = which[i];
    if (gate != UINT32_MAX && depth[gate] == t->depth[i] &&
        strcmp(g->note[gate], t->text[i]) != 0)
      code = refuse_second(s, t, i, gate);
  }
  s->host->free(s->host, depth);
  return code;
}

static void warn(const segment *s, const opc_flat_texts *t,
                 const uint32_t *which) {
  size_t beside = 0, first = 0;
  for (size_t i = t->at.shapes.count; i-- > 0;)
    if (which[i] == UINT32_MAX) {
      first = i;
      beside++;
    }
  if (!beside) return;
  opc_point p = t->at.shapes.points[first];
  int32_t cell;
  char *path = segment_path(s, t->at.placement[first], &cell);
  s->host->log(s->host, OPC_LOG_WARNING,
               "segment.transistors: texts of layer '%s' on no transistor: "
               "%zu, the first '%.100s' at (%g, %g) nm%s%.200s%s",
               layer_name, beside, t->text[first], p.x * s->grid,
               p.y * s->grid, path && *path ? ", instance '" : "",
               path ? path : "", path && *path ? "'" : "");
  s->host->free(s->host, path);
}

int segment_notes(segment *s) {
  const opc_host *host = s->host;
  const opc_layout_service *l = host->layout;
  int32_t layer = l->find_layer(s->layout, layer_name);
  if (layer < 0 || !OPC_HAS(l, flatten_texts)) return OPC_OK;
  opc_flat_texts texts;
  int code = l->flatten_texts(host, s->layout, s->top, layer, s->grid, &texts,
                              s->error);
  if (code) return code;
  size_t n = texts.at.shapes.count;
  opc_shapes boxes = {0};
  doubled *points = host->alloc(host, n + 1, sizeof *points);
  uint32_t *which = host->alloc(host, n + 1, sizeof *which);
  s->gates->note = host->alloc(host, s->gates->count, sizeof *s->gates->note);
  code = points && which && s->gates->note ? get_boxes(s, &boxes)
                                           : segment_no_memory(s);
  for (size_t i = 0; !code && i < n; i++) {
    opc_point p = texts.at.shapes.points[i];
    points[i] = (doubled){2 * (int64_t)p.x, 2 * (int64_t)p.y};
  }
  if (!code) code = segment_find(s, points, n, &boxes, which);
  if (!code) code = give(s, &texts, which);
  if (!code) warn(s, &texts, which);
  host->geometry->release(&boxes);
  host->free(host, points);
  host->free(host, which);
  l->release_texts(&texts);
  return code;
}
