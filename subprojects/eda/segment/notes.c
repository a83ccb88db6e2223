/* SPDX-License-Identifier: BSD-3-Clause */
/* Goals of gates, from the texts of the layer `notes`. A text in a cell applies
   to each instance of the cell; a text of a higher cell replaces the text of a
   lower one. */
#include <eda/goals.h>
#include <stdlib.h>
#include <string.h>

#include "segment/segment.h"

static const char layer_name[] = "notes";

/* Return the gates with their right and upper edges, because points on these
   edges count as inside. */
static eda_shapes get_boxes(const eda_gates *g) {
  eda_shapes out = eda_shapes_of_boxes(g->count);
  for (size_t i = 0; i < g->count; i++) {
    eda_box b = g->box[i];
    eda_shapes_set_box(&out, i, (eda_box){b.x0, b.y0, b.x1 + 1, b.y1 + 1});
  }
  return out;
}

/* Text found for each gate. */
typedef struct note {
  const char *text; /* text of the note; NULL: none */
  uint32_t depth;   /* depth of the cell */
} note;

static int refuse_second(segment *s, const eda_flat_texts *t, size_t i,
                         uint32_t gate, const char *first) {
  const eda_gates *g = s->gates;
  eda_point p = t->at.shapes.points[i];
  return opc_fail(
      s->error, OPC_INVALID, NULL,
      "transistor '%.200s:%u' has two notes: '%.100s', and at (%g, %g) nm "
      "'%.100s'",
      eda_gates_owner(g, gate), g->number[gate], first, p.x * s->grid,
      p.y * s->grid, t->text[i]);
}

/* Find the text that applies to each gate: that of the highest cell. Two texts
   of equal depth on one gate must be equal. */
static int find_notes(segment *s, const eda_flat_texts *t,
                      const uint32_t *which, note *notes) {
  size_t n = t->at.shapes.count;
  for (size_t i = 0; i < n; i++) {
    if (which[i] == UINT32_MAX) continue;
    note *now = &notes[which[i]];
    if (!now->text || now->depth > t->depth[i])
      *now = (note){t->text[i], t->depth[i]};
  }
  for (size_t i = 0; i < n; i++) {
    if (which[i] == UINT32_MAX) continue;
    const note *now = &notes[which[i]];
    if (now->depth == t->depth[i] && strcmp(now->text, t->text[i]) != 0)
      return refuse_second(s, t, i, which[i], now->text);
  }
  return OPC_OK;
}

static int parse_notes(segment *s, const note *notes) {
  eda_gates *g = s->gates;
  g->goal = eda_alloc(g->count, sizeof *g->goal);
  for (size_t i = 0; i < g->count; i++) {
    char *fault =
        eda_goal_parse(notes[i].text ? notes[i].text : "", &g->goal[i]);
    if (!fault) continue;
    opc_fail(s->error, OPC_INVALID, NULL, "note of '%.300s:%u': %s",
             eda_gates_owner(g, i), g->number[i], fault);
    free(fault);
    return OPC_INVALID;
  }
  return OPC_OK;
}

static void notes_warn(const segment *s, const eda_flat_texts *t,
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
  segment_log(s, 1,
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
  note *notes = eda_alloc(g->count, sizeof *notes);
  for (size_t i = 0; i < n; i++) {
    eda_point p = texts.at.shapes.points[i];
    points[i] = (doubled){2 * (int64_t)p.x, 2 * (int64_t)p.y};
  }
  segment_find(points, n, &boxes, which);
  code = find_notes(s, &texts, which, notes);
  if (!code) code = parse_notes(s, notes);
  if (!code) notes_warn(s, &texts, which);
  eda_shapes_clear(&boxes);
  free(points);
  free(which);
  free(notes);
  eda_flat_texts_clear(&texts);
  return code;
}
