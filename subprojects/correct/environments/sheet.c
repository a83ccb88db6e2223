/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the extraction of clips from a layout and their placement. */
#include "sheet.h"

#include <eda/check.h>
#include <eda/memory.h>
#include <glib.h>
#include <stdlib.h>
#include <string.h>

#include <correct/start.h>
#include "align.h"

/* ---- placement ---- */

/* A clip to place. */
typedef struct item {
  uint32_t number;
  int32_t wide, high;
} item;

EDA_COMPARE_FALLING(by_height, item, high, number);

void pages_make(const cover *c, int32_t most, int32_t gap, pages *out) {
  item *all = eda_alloc(c->count, sizeof *all);
  *out = (pages){.page = eda_alloc(c->count, sizeof *out->page),
                 .corner = eda_alloc(c->count, sizeof *out->corner),
                 .area = eda_alloc(c->count, sizeof *out->area)};
  for (size_t i = 0; i < c->count; i++) {
    eda_box b = c->clip[i].box;
    all[i] = (item){(uint32_t)i, b.x1 - b.x0, b.y1 - b.y0};
  }
  if (c->count) qsort(all, c->count, sizeof *all, by_height);
  int64_t x = 0, y = 0, row = 0; /* next position; height of the current row */
  for (size_t k = 0; k < c->count; k++) {
    const item *t = &all[k];
    if (x && x + t->wide > most) {
      x = 0;
      y += row + gap;
    }
    if (!k || (!x && y + t->high > most)) {
      out->count++;
      y = 0;
    }
    if (!x) row = t->high;
    out->page[t->number] = (uint32_t)(out->count - 1);
    out->corner[t->number] = (eda_point){(int32_t)x, (int32_t)y};
    out->area[out->count - 1] += (double)t->wide * t->high;
    x += t->wide + gap;
  }
  free(all);
}

void pages_clear(pages *p) {
  free(p->page);
  free(p->corner);
  free(p->area);
  *p = (pages){0};
}

/* ---- cutting ---- */

typedef struct piece {
  size_t clip;
  eda_gates *gates;
  eda_point by;    /* offset from the layout to the sheet */
  int32_t *number; /* [gates], number on the sheet; -1: not on the sheet */
} piece;

typedef struct maker {
  const eda_chip *chip;
  const cover *cover;
  const uint32_t *number;
  int32_t rim;
  piece *piece;
  size_t count;
  sheet *out;
} maker;

static int cut_one(void *data, size_t i, opc_error *error) {
  maker *m = data;
  piece *p = &m->piece[i];
  const eda_box *box = &m->cover->clip[p->clip].box;
  return eda_segment_window(m->chip->layout, m->chip->top, &m->chip->segment,
                            box, &p->gates, error);
}

/* ---- joining ---- */

/* Gate or polygon i of a clip, with its position on the sheet. */
typedef struct ref {
  uint32_t piece, i;
  eda_point at;
} ref;

static int by_place(const void *a, const void *b) {
  const ref *p = a, *q = b;
  if (p->at.y != q->at.y) return p->at.y < q->at.y ? -1 : 1;
  if (p->at.x != q->at.x) return p->at.x < q->at.x ? -1 : 1;
  if (p->piece != q->piece) return p->piece < q->piece ? -1 : 1;
  return (p->i > q->i) - (p->i < q->i);
}

static eda_point point_on_sheet(const piece *p, eda_point at) {
  return (eda_point){at.x + p->by.x, at.y + p->by.y};
}

static eda_box put_box(const piece *p, eda_box b) {
  return (eda_box){b.x0 + p->by.x, b.y0 + p->by.y, b.x1 + p->by.x,
                   b.y1 + p->by.y};
}

static int is_within(eda_box b, eda_box w, int32_t rim) {
  return b.x0 >= w.x0 + rim && b.y0 >= w.y0 + rim && b.x1 <= w.x1 - rim &&
         b.y1 <= w.y1 - rim;
}

/* Find the gates of the sheet, sorted by position, and set piece.number. */
static ref *find_gates(maker *m, size_t *count) {
  size_t all = 0, n = 0;
  for (size_t k = 0; k < m->count; k++) all += m->piece[k].gates->count;
  ref *refs = eda_alloc(all, sizeof *refs);
  for (size_t k = 0; k < m->count; k++) {
    piece *p = &m->piece[k];
    eda_box shown = m->cover->clip[p->clip].box;
    p->number = eda_alloc(p->gates->count, sizeof *p->number);
    for (size_t i = 0; i < p->gates->count; i++) {
      eda_box b = p->gates->box[i];
      p->number[i] = -1;
      if (is_within(b, shown, m->rim))
        refs[n++] = (ref){(uint32_t)k, (uint32_t)i,
                          point_on_sheet(p, (eda_point){b.x0, b.y0})};
    }
  }
  if (n) qsort(refs, n, sizeof *refs, by_place);
  for (size_t i = 0; i < n; i++)
    m->piece[refs[i].piece].number[refs[i].i] = (int32_t)i;
  *count = n;
  return refs;
}

static int put_gate(maker *m, const ref *r, size_t k, opc_error *error) {
  const piece *p = &m->piece[r->piece];
  const eda_gates *from = p->gates;
  eda_gates *to = m->out->gates;
  size_t i = r->i, number = eda_chip_find(m->chip, from->box[i]);
  if (number == SIZE_MAX)
    return opc_fail(error, OPC_FAILED, NULL,
                    "transistor at (%d, %d) grid steps is on a sheet, but the "
                    "scan of the layout did not find it",
                    (int)from->box[i].x0, (int)from->box[i].y0);
  m->out->of[k] = (uint32_t)number;
  m->out->place[k] = UINT32_MAX;
  to->box[k] = put_box(p, from->box[i]);
  eda_gates_copy(to, k, from, i);
  to->instance[k] = to->cell[k] = to->name;
  to->number[k] = (uint32_t)(k + 1);
  return OPC_OK;
}

static void put_fragments(const piece *p, size_t layer, uint32_t polygon,
                          eda_edges *to, uint32_t *at) {
  const eda_edges *from = &p->gates->edges[layer];
  for (uint32_t i = from->start[polygon]; i < from->start[polygon + 1]; i++) {
    eda_fragment f = from->fragments[i];
    f.from = point_on_sheet(p, f.from);
    if (f.gate >= 0) f.gate = p->number[f.gate];
    if (f.gate < 0) f.role = EDA_FIXED;
    to->fragments[(*at)++] = f;
  }
}

static void count_layer(const maker *m, size_t layer, size_t *polygons,
                        size_t *points, size_t *fragments) {
  *polygons = *points = *fragments = 0;
  for (size_t k = 0; k < m->count; k++) {
    const eda_shapes *s = &m->piece[k].gates->drawn[layer];
    const eda_edges *e = &m->piece[k].gates->edges[layer];
    *polygons += s->count;
    *points += s->count ? s->start[s->count] : 0;
    *fragments += e->polygons ? e->start[e->polygons] : 0;
  }
}

static ref *find_polygons(const maker *m, size_t layer, size_t count) {
  ref *refs = eda_alloc(count, sizeof *refs);
  size_t n = 0;
  for (size_t k = 0; k < m->count; k++) {
    const eda_shapes *s = &m->piece[k].gates->drawn[layer];
    for (size_t i = 0; i < s->count; i++)
      refs[n++] = (ref){(uint32_t)k, (uint32_t)i,
                        point_on_sheet(&m->piece[k], s->points[s->start[i]])};
  }
  if (n) qsort(refs, n, sizeof *refs, by_place);
  return refs;
}

static void put_layer(maker *m, size_t layer) {
  size_t n, points, fragments;
  eda_shapes *to = &m->out->gates->drawn[layer];
  eda_edges *edges = &m->out->gates->edges[layer];
  count_layer(m, layer, &n, &points, &fragments);
  if (!n) return;
  *to = (eda_shapes){.count = n,
                     .start = eda_alloc(n + 1, sizeof *to->start),
                     .points = eda_alloc(points, sizeof *to->points),
                     .hole = eda_alloc(n, 1)};
  if (fragments) {
    edges->polygons = n;
    edges->start = eda_alloc(n + 1, sizeof *edges->start);
    edges->fragments = eda_alloc(fragments, sizeof *edges->fragments);
  }
  ref *refs = find_polygons(m, layer, n);
  uint32_t at = 0, fragment = 0;
  for (size_t k = 0; k < n; k++) {
    const piece *p = &m->piece[refs[k].piece];
    const eda_shapes *s = &p->gates->drawn[layer];
    uint32_t i = refs[k].i;
    for (uint32_t c = s->start[i]; c < s->start[i + 1]; c++)
      to->points[at++] = point_on_sheet(p, s->points[c]);
    to->start[k + 1] = at;
    to->hole[k] = s->hole ? s->hole[i] : 0;
    if (!fragments) continue;
    put_fragments(p, layer, i, edges, &fragment);
    edges->start[k + 1] = fragment;
  }
  free(refs);
}

/* Set sheet.place of all gates. */
static void mark_places(maker *m) {
  for (size_t k = 0; k < m->count; k++) {
    const piece *p = &m->piece[k];
    const clip *c = &m->cover->clip[p->clip];
    GHashTable *of = g_hash_table_new(NULL, NULL);
    for (size_t j = c->first; j < c->first + c->count; j++)
      g_hash_table_insert(of,
                          GUINT_TO_POINTER(m->number[m->cover->place[j]] + 1),
                          GUINT_TO_POINTER(m->cover->place[j] + 1));
    for (size_t i = 0; i < p->gates->count; i++) {
      int32_t n = p->number[i];
      if (n < 0) continue;
      guint place = GPOINTER_TO_UINT(
          g_hash_table_lookup(of, GUINT_TO_POINTER(m->out->of[n] + 1)));
      if (place) m->out->place[n] = place - 1;
    }
    g_hash_table_destroy(of);
  }
}

static int sheet_join(maker *m, opc_error *error) {
  const eda_chip *c = m->chip;
  sheet *out = m->out;
  size_t n;
  int code = OPC_OK;
  ref *refs = find_gates(m, &n);
  eda_gates *g = out->gates = eda_gates_new(c->layers, n);
  g->name = eda_gates_text(g, eda_layout_cell_name(c->layout, c->top));
  g->grid = c->grid;
  out->of = eda_alloc(n, sizeof *out->of);
  out->place = eda_alloc(n, sizeof *out->place);
  for (size_t i = 0; i < n && !code; i++)
    code = put_gate(m, &refs[i], i, error);
  free(refs);
  if (code) return code;
  for (size_t k = 0; k < c->layers; k++) {
    g->layer[k] = eda_gates_text(g, c->layer[k]);
    g->corrected[k] = c->corrected[k];
    put_layer(m, k);
  }
  g->extent = (eda_box)EDA_BOX_EMPTY;
  for (size_t k = 0; k < m->count; k++) {
    eda_box b = put_box(&m->piece[k], m->cover->clip[m->piece[k].clip].box);
    eda_box_join(&g->extent, b);
  }
  mark_places(m);
  return OPC_OK;
}

/* ---- a sheet ---- */

int sheet_make(const opc_context *context, const eda_chip *chip,
               const cover *from, const uint32_t *number, const pages *to,
               size_t page, int32_t rim, sheet *out, opc_error *error) {
  *out = (sheet){0};
  maker m = {.chip = chip,
             .cover = from,
             .number = number,
             .rim = rim,
             .piece = eda_alloc(from->count, sizeof *m.piece),
             .out = out};
  for (size_t i = 0; i < from->count; i++) {
    eda_box b = from->clip[i].box;
    eda_point at = to->corner[i];
    if (to->page[i] == page)
      m.piece[m.count++] = (piece){.clip = i, .by = {at.x - b.x0, at.y - b.y0}};
  }
  int code = eda_try_all(context, m.count, cut_one, &m, error);
  if (!code) code = sheet_join(&m, error);
  for (size_t k = 0; k < m.count; k++) {
    eda_gates_free(m.piece[k].gates);
    free(m.piece[k].number);
  }
  free(m.piece);
  return code;
}

int sheet_mask(const eda_chip *chip, const sheet *s, eda_mask **out,
               opc_error *error) {
  const eda_gates *g = s->gates;
  eda_mask *m = *out = eda_mask_new(g);
  m->moved = eda_moved_new(g->layers, g->count);
  for (size_t i = 0; i < g->count; i++)
    eda_chip_move(chip, s->of[i], g->box[i], m->moved, i);
  align_boxes(chip, g, m->moved);
  return correct_start_shapes(m, error);
}

void sheet_clear(sheet *s) {
  eda_gates_free(s->gates);
  free(s->of);
  free(s->place);
  *s = (sheet){0};
}
