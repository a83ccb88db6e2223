/* SPDX-License-Identifier: BSD-3-Clause */
/* Extents of a layer in cells and instances, computed from children to parents.
   Cells with many items have a spatial index. */
#include "layout/reach.h"

#include <stdlib.h>

/* Up to this number of items, a linear search replaces the index. */
enum { FEW = 32 };

static const extent nothing = {INFINITY, INFINITY, -INFINITY, -INFINITY};
static const extent everything = {-INFINITY, -INFINITY, INFINITY, INFINITY};

/* ---- extents ---- */

static void extent_add(extent *to, extent e) {
  to->x0 = fmin(to->x0, e.x0);
  to->y0 = fmin(to->y0, e.y0);
  to->x1 = fmax(to->x1, e.x1);
  to->y1 = fmax(to->y1, e.y1);
}

static int32_t coordinate(double v) {
  return (int32_t)fmin(fmax(v, INT32_MIN), INT32_MAX);
}

eda_box extent_box(extent e) {
  if (extent_empty(e)) return (eda_box){0, 0, -1, -1};
  return (eda_box){coordinate(floor(e.x0)), coordinate(floor(e.y0)),
                   coordinate(ceil(e.x1)), coordinate(ceil(e.y1))};
}

/* Return the bounding box of e after the transform. */
static extent extent_through(const transform *t, extent e) {
  if (extent_empty(e)) return nothing;
  extent out = nothing;
  for (int k = 0; k < 4; k++) {
    double x = k & 1 ? e.x1 : e.x0, y = k & 2 ? e.y1 : e.y0;
    double p = t->xx * x + t->xy * y + t->dx;
    double q = t->yx * x + t->yy * y + t->dy;
    if (!isfinite(p) || !isfinite(q)) return everything;
    extent_add(&out, (extent){p, q, p, q});
  }
  return out;
}

extent extent_back(const transform *t, extent window) {
  double det = t->xx * t->yy - t->xy * t->yx;
  transform back = {t->yy / det, -t->xy / det, -t->yx / det, t->xx / det, 0, 0};
  back.dx = -(back.xx * t->dx + back.xy * t->dy);
  back.dy = -(back.yx * t->dx + back.yy * t->dy);
  return extent_through(&back, window);
}

extent extent_of_first(const reach *r, const instance *in) {
  transform t = transform_of(&in->placement);
  t.dx = in->placement.origin.x;
  t.dy = in->placement.origin.y;
  return extent_through(&t, r->below[in->child]);
}

extent extent_of_all(const reach *r, const instance *in) {
  const eda_placement *p = &in->placement;
  extent first = extent_of_first(r, in), out = first;
  for (int k = 1; k < 4; k++) {
    double column = k & 1 ? p->columns - 1 : 0, row = k & 2 ? p->rows - 1 : 0;
    double x = column * p->column_step.x + row * p->row_step.x;
    double y = column * p->column_step.y + row * p->row_step.y;
    extent_add(
        &out, (extent){first.x0 + x, first.y0 + y, first.x1 + x, first.y1 + y});
  }
  return out;
}

extent extent_of_shape(const sheet *s, size_t i) {
  eda_box b;
  if (i < sheet_boxes(s)) {
    b = sheet_box(s, i);
  } else {
    i -= sheet_boxes(s);
    size_t start = i ? s->end[i - 1] : 0;
    b = eda_bounds(s->points + start, s->end[i] - start);
  }
  return (extent){b.x0, b.y0, b.x1, b.y1};
}

/* ---- arrays ---- */

/* Return the numbers k in `in` with low <= k * step <= high, to within
   rounding. Infinite limits restrict nothing. */
static span steps_within(span in, double step, double low, double high) {
  if (step == 0) return low <= 0 && high >= 0 ? in : (span){0, 0};
  double a = low / step, b = high / step;
  double from = ceil(fmin(a, b) - 1e-6), to = floor(fmax(a, b) + 1e-6) + 1;
  if (from > in.from) in.from = from < in.to ? (uint32_t)from : in.to;
  if (to < in.to) in.to = to > in.from ? (uint32_t)to : in.from;
  return in;
}

span extent_columns(const eda_placement *p, extent first, extent window,
                    uint32_t row) {
  double x = (double)row * p->row_step.x, y = (double)row * p->row_step.y;
  span all = {0, p->columns};
  all = steps_within(all, p->column_step.x, window.x0 - first.x1 - x,
                     window.x1 - first.x0 - x);
  return steps_within(all, p->column_step.y, window.y0 - first.y1 - y,
                      window.y1 - first.y0 - y);
}

/* Restrict the rows by x and by y separately. For slanted arrays, also require
   that the line through the members of a row meets the window. */
span extent_rows(const eda_placement *p, extent first, extent window) {
  double last = p->columns - 1.0;
  double ux = last > 0 ? p->column_step.x : 0;
  double uy = last > 0 ? p->column_step.y : 0;
  double vx = p->row_step.x, vy = p->row_step.y;
  extent w = {window.x0 - first.x1, window.y0 - first.y1, window.x1 - first.x0,
              window.y1 - first.y0};
  span all = {0, p->rows};
  all = steps_within(all, vx, w.x0 - fmax(0, last * ux),
                     w.x1 - fmin(0, last * ux));
  all = steps_within(all, vy, w.y0 - fmax(0, last * uy),
                     w.y1 - fmin(0, last * uy));
  double det = ux * vy - uy * vx;
  if (det == 0 || !isfinite(w.x0 + w.x1 + w.y0 + w.y1)) return all;
  transform across = {-uy, ux, 0, 0, 0, 0};
  extent e = extent_through(&across, w);
  return steps_within(all, det, e.x0, e.x1);
}

/* ---- cells ---- */

/* Return an index of n boxes, and free the boxes. Return NULL if `boxes` is
   NULL, which means that there are too few items for an index. */
static eda_index *reach_index(eda_box *boxes, size_t n) {
  eda_index *index = boxes ? eda_index_new(boxes, n, 0) : NULL;
  free(boxes);
  return index;
}

static void reach_shapes(reach *r, const cell *c, int32_t layer, size_t k) {
  const sheet *s = eda_layout_sheet(c, layer);
  if (!s) return;
  size_t n = sheet_boxes(s) + s->n_polygons;
  eda_box *boxes = n > FEW ? eda_alloc(n, sizeof *boxes) : NULL;
  for (size_t i = 0; i < n; i++) {
    extent e = extent_of_shape(s, i);
    extent_add(&r->below[k], e);
    if (boxes) boxes[i] = extent_box(e);
  }
  r->own[k] = reach_index(boxes, n);
}

static void reach_texts(reach *r, const cell *c, int32_t layer, size_t k) {
  size_t n = c->n_labels;
  eda_box *boxes = n > FEW ? eda_alloc(n, sizeof *boxes) : NULL;
  for (size_t i = 0; i < n; i++) {
    const label *l = &c->labels[i];
    extent e = {l->at.x, l->at.y, l->at.x, l->at.y};
    if (l->layer != layer) e = nothing;
    extent_add(&r->below[k], e);
    if (boxes) boxes[i] = extent_box(e);
  }
  r->own[k] = reach_index(boxes, n);
}

static void reach_instances(reach *r, const cell *c, size_t k) {
  size_t n = c->n_instances;
  eda_box *boxes = n > FEW ? eda_alloc(n, sizeof *boxes) : NULL;
  for (size_t i = 0; i < n; i++) {
    extent e = extent_of_all(r, &c->instances[i]);
    extent_add(&r->below[k], e);
    if (boxes) boxes[i] = extent_box(e);
  }
  r->instances[k] = reach_index(boxes, n);
}

/* ---- computation and release ---- */

typedef struct kept {
  reach of;
  size_t cells;
} kept;

static kept *reach_make(const eda_layout *layout, int32_t layer, bool texts) {
  kept *x = eda_alloc(1, sizeof *x);
  reach *r = &x->of;
  x->cells = layout->n_cells;
  r->below = eda_alloc(x->cells, sizeof *r->below);
  r->own = eda_alloc(x->cells, sizeof(eda_index *));
  r->instances = eda_alloc(x->cells, sizeof(eda_index *));
  for (size_t i = 0; i < x->cells; i++) r->below[i] = nothing;
  for (size_t i = 0; i < x->cells; i++) {
    size_t k = (size_t)layout->order[i];
    const cell *c = &layout->cells[k];
    if (texts)
      reach_texts(r, c, layer, k);
    else
      reach_shapes(r, c, layer, k);
    reach_instances(r, c, k);
  }
  return x;
}

static void reach_free(void *object) {
  kept *x = object;
  for (size_t i = 0; i < x->cells; i++) {
    eda_index_free(x->of.own[i]);
    eda_index_free(x->of.instances[i]);
  }
  free(x->of.below);
  free(x->of.own);
  free(x->of.instances);
  free(x);
}

const reach *eda_layout_reach(const eda_layout *layout, int32_t layer,
                              bool texts) {
  eda_layout *writable = (eda_layout *)layout;
  gpointer key = GINT_TO_POINTER(layer);
  GHashTable **all = &writable->reach[texts];
  eda_layout_order(layout);
  g_mutex_lock(&writable->lock);
  if (!*all) *all = g_hash_table_new_full(NULL, NULL, NULL, reach_free);
  kept *x = g_hash_table_lookup(*all, key);
  if (!x) {
    x = reach_make(layout, layer, texts);
    g_hash_table_insert(*all, key, x);
  }
  g_mutex_unlock(&writable->lock);
  return &x->of;
}
