/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the dissection of a window's mask into territories, the boxes
   around placed cells. The mask is fractured into rectangles once, and each
   territory takes the rectangles within its box. An overlap of two territories
   belongs to the territory placed first. */
#include "clips.h"

#include <eda/formats.h>
#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <correct/start.h>
#include "align.h"

/* Mask of a layer. */
typedef struct masked {
  eda_shapes shapes;
  eda_box *box; /* rectangles of `shapes` */
  size_t boxes;
  eda_index *index;
} masked;

typedef struct window {
  const cutter *cutter;
  eda_box core;
  territory *near; /* territories that touch the core or begin in it */
  size_t n_near;
  eda_index *index;   /* index of `near` */
  masked *mask;       /* [layers] */
  GHashTable *unions; /* of write_union */
  clips *out;
  opc_error *error;
} window;

/* ---- boxes ---- */

static eda_box box_common(eda_box a, eda_box b) {
  return (eda_box){a.x0 > b.x0 ? a.x0 : b.x0, a.y0 > b.y0 ? a.y0 : b.y0,
                   a.x1 < b.x1 ? a.x1 : b.x1, a.y1 < b.y1 ? a.y1 : b.y1};
}

static int has_area(eda_box b) { return b.x0 < b.x1 && b.y0 < b.y1; }

static eda_shapes shapes_of(const eda_box *box, size_t n) {
  eda_shapes s = eda_shapes_of_boxes(n);
  for (size_t i = 0; i < n; i++) eda_shapes_set_box(&s, i, box[i]);
  return s;
}

/* Combine two lists of boxes by an operation of eda_boolean. */
static int boxes_combine(int op, const eda_box *a, size_t n, const eda_box *b,
                         size_t m, eda_shapes *out, opc_error *error) {
  eda_shapes p = shapes_of(a, n), q = shapes_of(b, m);
  int code = eda_boolean(op, &p, &q, out, error);
  eda_shapes_clear(&p);
  eda_shapes_clear(&q);
  return code;
}

/* ---- the mask ---- */

static int territory_begins(const window *w, const territory *t) {
  eda_box c = w->core, b = t->box;
  return b.x0 >= c.x0 && b.x0 < c.x1 && b.y0 >= c.y0 && b.y0 < c.y1;
}

/* Find the territories that touch the core; *see receives the core, extended to
   contain the boxes of the territories that begin in the core. */
static int find_territories(window *w, eda_box *see) {
  const cutter *c = w->cutter;
  *see = w->core;
  int code = OPC_OK;
  for (int again = 0; again < 2 && !code; again++) {
    free(w->near);
    code = outline_find(c->outline, c->chip->top, c->chip->grid, see, &w->near,
                        &w->n_near, w->error);
    for (size_t i = 0; i < w->n_near && !code && !again; i++) {
      const territory *t = &w->near[i];
      if (!territory_begins(w, t)) continue;
      if (t->box.x1 > see->x1) see->x1 = t->box.x1;
      if (t->box.y1 > see->y1) see->y1 = t->box.y1;
    }
  }
  if (code) return code;
  eda_box *box = eda_alloc(w->n_near, sizeof *box);
  for (size_t i = 0; i < w->n_near; i++) box[i] = w->near[i].box;
  w->index = eda_index_new(box, w->n_near, 0);
  free(box);
  return OPC_OK;
}

static int masked_finish(masked *m, opc_error *error) {
  int code = eda_fracture(&m->shapes, &m->box, &m->boxes, error);
  if (!code) m->index = eda_index_new(m->box, m->boxes, 0);
  return code;
}

static int drawn_flatten(const eda_chip *chip, int32_t layer, eda_box see,
                         eda_shapes *out, opc_error *error) {
  eda_flat flat;
  int code = eda_layout_flatten_window(chip->layout, chip->top, layer,
                                       chip->grid, &see, &flat, error);
  if (code) return code;
  /* The segmentation of the layout straightens edges in the same way. */
  (void)eda_shapes_straighten(&flat.shapes,
                              (int32_t)lround(fmax(1, 1 / chip->grid)));
  code = eda_boolean(EDA_OR, &flat.shapes, NULL, out, error);
  eda_flat_clear(&flat);
  return code;
}

/* Make the drawn shapes around the core. They need no search for
   transistors. */
static int make_drawn(window *w, eda_box see) {
  const cutter *c = w->cutter;
  int code = OPC_OK;
  for (size_t k = 0; k < c->chip->layers && !code; k++) {
    masked *m = &w->mask[k];
    if (c->drawn[k] >= 0)
      code = drawn_flatten(c->chip, c->drawn[k], see, &m->shapes, w->error);
    if (!code) code = masked_finish(m, w->error);
  }
  return code;
}

static int make_mask(window *w, eda_box see) {
  const cutter *c = w->cutter;
  const eda_chip *chip = c->chip;
  eda_gates *g;
  int code = eda_segment_core(chip->layout, chip->top, &chip->segment,
                              eda_box_grown(see, c->margin), 0, &g, w->error);
  if (code) return code;
  eda_moved *moved = eda_chip_moved(chip, g);
  align_boxes(chip, g, moved);
  for (size_t k = 0; k < g->layers && !code; k++) {
    masked *m = &w->mask[k];
    code = g->corrected[k]
               ? correct_start_mask(g, moved, k, &m->shapes, w->error)
               : eda_boolean(EDA_OR, &g->drawn[k], NULL, &m->shapes, w->error);
    if (!code) code = masked_finish(m, w->error);
  }
  eda_moved_free(moved);
  eda_gates_free(g);
  return code;
}

/* ---- territories ---- */

/* Compute the region of a territory: its box minus the boxes of earlier
   territories. */
static int find_own(const window *w, const territory *t, eda_box_list *out) {
  eda_box_list taken = {0};
  eda_finder f = eda_index_find(w->index, t->box);
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box b = box_common(t->box, w->near[i].box);
    if (w->near[i].number < t->number && has_area(b))
      eda_box_list_add(&taken, b);
  }
  int code = OPC_OK;
  if (!taken.count) {
    eda_box_list_add(out, t->box);
  } else {
    eda_shapes left;
    code = boxes_combine(EDA_NOT, &t->box, 1, taken.box, taken.count, &left,
                         w->error);
    if (!code) code = eda_fracture(&left, &out->box, &out->count, w->error);
    eda_shapes_clear(&left);
  }
  free(taken.box);
  return code;
}

/* Any total order of boxes. */
static int by_corner(const void *a, const void *b) {
  return memcmp(a, b, sizeof(eda_box));
}

static int write_polygon(void *data, const eda_point *points, size_t n,
                         opc_error *error) {
  GByteArray *to = data;
  int32_t count = (int32_t)n;
  (void)error;
  g_byte_array_append(to, (const guint8 *)&count, sizeof count);
  g_byte_array_append(to, (const guint8 *)points, (guint)(n * sizeof *points));
  return OPC_OK;
}

/* Append the union of boxes as polygons, terminated by a polygon without
   points. Most territories of an array have equal boxes, whose union is
   computed once for each window: `unions` maps the sorted boxes to the
   polygons. */
static int write_union(const window *w, eda_box_list *parts, GByteArray *to) {
  if (parts->count)
    qsort(parts->box, parts->count, sizeof *parts->box, by_corner);
  GBytes *key = g_bytes_new(parts->box, parts->count * sizeof *parts->box),
         *known;
  int code = OPC_OK;
  known = g_hash_table_lookup(w->unions, key);
  if (!known) {
    eda_shapes merged;
    GByteArray *own = g_byte_array_new();
    const eda_polygon_taker take = {write_polygon, own, SIZE_MAX};
    code = boxes_combine(EDA_OR, parts->box, parts->count, NULL, 0, &merged,
                         w->error);
    if (!code) code = eda_polygons_without_holes(&merged, &take, w->error);
    (void)write_polygon(own, NULL, 0, w->error);
    eda_shapes_clear(&merged);
    known = g_byte_array_free_to_bytes(own);
    g_hash_table_insert(w->unions, g_bytes_ref(key), known);
  }
  gsize size;
  const guint8 *bytes = g_bytes_get_data(known, &size);
  g_byte_array_append(to, bytes, (guint)size);
  g_bytes_unref(key);
  return code;
}

/* Write the part of a layer that is in a territory. */
static int write_layer(const window *w, const territory *t,
                       const eda_box_list *own, size_t layer, GByteArray *to) {
  const masked *m = &w->mask[layer];
  eda_box_list parts = {0};
  for (size_t k = 0; k < own->count; k++) {
    eda_finder f = eda_index_find(m->index, own->box[k]);
    for (uint32_t i; eda_index_next(&f, &i);) {
      eda_box b = box_common(m->box[i], own->box[k]);
      if (has_area(b)) eda_box_list_add(&parts, territory_own(t, b));
    }
  }
  int code = write_union(w, &parts, to);
  free(parts.box);
  return code;
}

static int cut_one(window *w, const territory *t, GHashTable *known) {
  size_t layers = w->cutter->chip->layers;
  eda_box_list own = {0};
  int code = find_own(w, t, &own);
  GByteArray *bytes = g_byte_array_new();
  for (size_t k = 0; k < layers && !code; k++)
    code = write_layer(w, t, &own, k, bytes);
  GBytes *shapes = g_byte_array_free_to_bytes(bytes);
  free(own.box);
  if (!code && g_bytes_get_size(shapes) > layers * sizeof(int32_t)) {
    GBytes *same = g_hash_table_lookup(known, shapes);
    if (!same) g_hash_table_add(known, same = g_bytes_ref(shapes));
    w->out->clip[w->out->count++] =
        (clip){g_bytes_ref(same), t->at, t->number, t->orientation};
  }
  g_bytes_unref(shapes);
  return code;
}

static int cut_territories(window *w) {
  w->unions = g_hash_table_new_full(g_bytes_hash, g_bytes_equal,
                                    (GDestroyNotify)g_bytes_unref,
                                    (GDestroyNotify)g_bytes_unref);
  GHashTable *known = g_hash_table_new_full(
      g_bytes_hash, g_bytes_equal, (GDestroyNotify)g_bytes_unref, NULL);
  w->out->clip = eda_alloc(w->n_near, sizeof *w->out->clip);
  int code = OPC_OK;
  for (size_t i = 0; i < w->n_near && !code; i++)
    if (territory_begins(w, &w->near[i])) code = cut_one(w, &w->near[i], known);
  g_hash_table_destroy(known);
  g_hash_table_destroy(w->unions);
  return code;
}

static int cut_rest(window *w) {
  eda_box *box = eda_alloc(w->n_near, sizeof *box);
  eda_shapes free_place;
  for (size_t i = 0; i < w->n_near; i++) box[i] = w->near[i].box;
  int code = boxes_combine(EDA_NOT, &w->core, 1, box, w->n_near, &free_place,
                           w->error);
  for (size_t k = 0; k < w->cutter->chip->layers && !code; k++)
    code = eda_boolean(EDA_AND, &w->mask[k].shapes, &free_place,
                       &w->out->rest[k], w->error);
  eda_shapes_clear(&free_place);
  free(box);
  return code;
}

/* ---- run ---- */

int clips_cut(const cutter *by, eda_box core, clips *out, opc_error *error) {
  size_t layers = by->chip->layers;
  window w = {.cutter = by,
              .core = core,
              .mask = eda_alloc(layers, sizeof(masked)),
              .out = out,
              .error = error};
  eda_box see;
  *out = (clips){.rest = eda_alloc(layers, sizeof *out->rest)};
  int code = find_territories(&w, &see);
  if (!code) code = by->drawn ? make_drawn(&w, see) : make_mask(&w, see);
  if (!code) code = cut_territories(&w);
  if (!code) code = cut_rest(&w);
  for (size_t k = 0; k < layers; k++) {
    eda_shapes_clear(&w.mask[k].shapes);
    free(w.mask[k].box);
    eda_index_free(w.mask[k].index);
  }
  free(w.mask);
  free(w.near);
  eda_index_free(w.index);
  return code;
}

void clips_clear(clips *c, size_t layers) {
  for (size_t i = 0; i < c->count; i++) g_bytes_unref(c->clip[i].shapes);
  for (size_t k = 0; c->rest && k < layers; k++) eda_shapes_clear(&c->rest[k]);
  free(c->clip);
  free(c->rest);
  *c = (clips){0};
}
