/* SPDX-License-Identifier: BSD-3-Clause */
/* Assist features by rules: rows of bars beside drawn edges with open space (C.
   A. Mack, Fundamental Principles of Optical Lithography, 2007, chapter 10).
   They are too narrow to print by themselves and make an isolated edge print
   more like a dense one. */
#include "epe.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tuning.h"

/* ---- boxes ---- */

static eda_box grow(eda_box b, int32_t by) {
  return (eda_box){b.x0 - by, b.y0 - by, b.x1 + by, b.y1 + by};
}

static int meet(eda_box a, eda_box b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

static int32_t length_of(eda_box b) {
  int32_t w = b.x1 - b.x0, h = b.y1 - b.y0;
  return w > h ? w : h;
}

/* ---- where bars may be ---- */

/* A bar as the rule has it, before others cut it. */
typedef struct wish {
  eda_box box;
  uint32_t number; /* in the order of the edges */
  uint8_t upright;
  size_t first, end; /* what came of it, in `bars` */
} wish;

typedef struct planner {
  epe_layer *layer;
  const epe_assist *rule;
  wish *wishes;
  size_t count;
  eda_index *of_drawn, *of_wishes;
  eda_box *drawn; /* rectangles of the drawn shapes */
  size_t drawn_count;
  eda_box_list parts, next; /* of the wish at hand */
  eda_box_list bars;
} planner;

/* Row `row` beside edge e. It begins and ends where the edge does. */
static wish wish_of(const planner *p, size_t e, int row) {
  const epe_layer *l = p->layer;
  const epe_piece *first = &l->pieces[l->edge[e]];
  const epe_piece *last = &l->pieces[l->edge[e + 1] - 1];
  const epe_assist *r = p->rule;
  int32_t near = r->distance + row * (r->width + r->space);
  int32_t a = epe_along(first, first->from), b = epe_along(last, last->to);
  int32_t low = (a < b ? a : b) - r->overhang;
  int32_t high = (a < b ? b : a) + r->overhang;
  int32_t line = epe_line(first, NULL, 0);
  int32_t from = first->sign > 0 ? line + near : line - near - r->width;
  wish w = {.upright = first->axis == EDA_X};
  w.box = w.upright ? (eda_box){from, low, from + r->width, high}
                    : (eda_box){low, from, high, from + r->width};
  return w;
}

/* Take `keep_out` from all parts. */
static void cut_parts(planner *p, eda_box keep_out, int upright) {
  p->next.count = 0;
  for (size_t i = 0; i < p->parts.count; i++) {
    eda_box b = p->parts.box[i], low = b, high = b;
    if (!meet(b, keep_out)) {
      eda_box_list_add(&p->next, b);
      continue;
    }
    if (upright)
      low.y1 = keep_out.y0, high.y0 = keep_out.y1;
    else
      low.x1 = keep_out.x0, high.x0 = keep_out.x1;
    if (low.y1 > low.y0 && low.x1 > low.x0) eda_box_list_add(&p->next, low);
    if (high.y1 > high.y0 && high.x1 > high.x0)
      eda_box_list_add(&p->next, high);
  }
  eda_box_list t = p->parts;
  p->parts = p->next;
  p->next = t;
}

/* Cut the parts of a wish by the drawn shapes that are near. */
static void cut_by_drawn(planner *p, const wish *w) {
  int32_t off = p->rule->distance;
  eda_finder f = eda_index_find(p->of_drawn, grow(w->box, off));
  for (uint32_t i; eda_index_next(&f, &i);)
    cut_parts(p, grow(p->drawn[i], off), w->upright);
}

/* Cut them by the bars of wishes that were granted before. */
static void cut_by_bars(planner *p, const wish *w) {
  int32_t off = p->rule->space;
  eda_finder f = eda_index_find(p->of_wishes, grow(w->box, off));
  for (uint32_t i; eda_index_next(&f, &i);)
    for (size_t n = p->wishes[i].first; n < p->wishes[i].end; n++)
      cut_parts(p, grow(p->bars.box[n], off), w->upright);
}

/* What is left of a wish beside the drawn shapes and the bars there are. */
static void grant(planner *p, wish *w) {
  p->parts.count = 0;
  w->first = w->end = p->bars.count;
  eda_box_list_add(&p->parts, w->box);
  cut_by_drawn(p, w);
  cut_by_bars(p, w);
  for (size_t i = 0; i < p->parts.count; i++)
    if (length_of(p->parts.box[i]) >= p->rule->min_length)
      eda_box_list_add(&p->bars, p->parts.box[i]);
  w->end = p->bars.count;
}

/* First rows before others, then long ones first. */
static int by_rank(const void *a, const void *b) {
  const wish *p = *(const wish *const *)a, *q = *(const wish *const *)b;
  if (p->first != q->first) return p->first < q->first ? -1 : 1;
  int32_t m = length_of(p->box), n = length_of(q->box);
  if (m != n) return m > n ? -1 : 1;
  return (p->number > q->number) - (p->number < q->number);
}

static void grant_all(planner *p) {
  wish **order = eda_alloc(p->count, sizeof(wish *));
  for (size_t i = 0; i < p->count; i++) order[i] = &p->wishes[i];
  qsort(order, p->count, sizeof(wish *), by_rank);
  for (size_t i = 0; i < p->count; i++)
    p->wishes[i].first = p->wishes[i].end = 0;
  for (size_t i = 0; i < p->count; i++) grant(p, order[i]);
  free(order);
}

static void make_wishes(planner *p) {
  const epe_layer *l = p->layer;
  size_t room = l->edges * (size_t)p->rule->rows;
  p->wishes = eda_alloc(room, sizeof *p->wishes);
  eda_box *all = eda_alloc(room, sizeof *all);
  for (int row = 0; row < p->rule->rows; row++)
    for (size_t e = 0; e < l->edges; e++) {
      wish w = wish_of(p, e, row);
      w.number = (uint32_t)p->count;
      w.first = (size_t)row; /* by_rank */
      all[p->count] = w.box;
      p->wishes[p->count++] = w;
    }
  p->of_wishes = eda_index_new(all, p->count, p->rule->distance);
  free(all);
}

/* ---- room for the fragments beside them ---- */

/* A fragment, wherever its ends may go, stays min_space off the bars. */
static void leave_room(epe_layer *l, const eda_index *bars, uint32_t i) {
  const epe_rules *r = l->rules;
  const epe_piece *p = &l->pieces[i];
  int32_t space = r->min_space, most = r->max_shift, reach = most + space;
  int32_t line = epe_line(p, NULL, 0);
  int32_t m = epe_along(p, p->from), n = epe_along(p, p->to);
  int32_t low = (m < n ? m : n) - (p->corner ? most : 0) - space;
  int32_t high = (m < n ? n : m) + (p->corner ? most : 0) + space;
  int32_t near = p->sign > 0 ? line : line - reach;
  eda_box box = p->axis == EDA_X ? (eda_box){near, low, near + reach, high}
                                 : (eda_box){low, near, high, near + reach};
  eda_finder f = eda_index_find(bars, box);
  for (uint32_t k; eda_index_next(&f, &k);) {
    eda_box bar = l->bars.box[k];
    if (!meet(bar, box)) continue;
    int32_t off = p->axis == EDA_X
                      ? (p->sign > 0 ? bar.x0 - line : line - bar.x1)
                      : (p->sign > 0 ? bar.y0 - line : line - bar.y1);
    int32_t room = off > space ? off - space : 0;
    if (room < l->most[i]) l->most[i] = room;
  }
}

static void leave_rooms(epe_layer *l) {
  eda_index *bars = eda_index_new(l->bars.box, l->bars.count,
                                  l->rules->max_shift + l->rules->min_space);
  for (uint32_t i = 0; i < l->count; i++) leave_room(l, bars, i);
  eda_index_free(bars);
}

/* ---- all of it ---- */

int epe_place_bars(epe_layer *l, const epe_assist *rule,
                   const eda_shapes *drawn, opc_error *error) {
  planner p = {.layer = l, .rule = rule};
  if (!rule->rows) return OPC_OK;
  int code = eda_fracture(drawn, &p.drawn, &p.drawn_count, error);
  if (code) return code;
  p.of_drawn = eda_index_new(p.drawn, p.drawn_count, rule->distance);
  make_wishes(&p);
  grant_all(&p);
  free(p.drawn);
  free(p.wishes);
  free(p.parts.box);
  free(p.next.box);
  eda_index_free(p.of_drawn);
  eda_index_free(p.of_wishes);
  l->bars = p.bars;
  if (l->bars.count) leave_rooms(l);
  return OPC_OK;
}

/* ---- bars that print ---- */

/* The most of the level set on a bar: along its middle and its sides. */
static double brightest(const eda_field *print, eda_box b, double grid) {
  double x0 = b.x0 * grid, y0 = b.y0 * grid, w = b.x1 * grid - x0,
         h = b.y1 * grid - y0, most = -INFINITY;
  int nx = (int)ceil(w / tuned.bar_step), ny = (int)ceil(h / tuned.bar_step);
  for (int j = 0; j <= ny; j++)
    for (int i = 0; i <= nx; i++) {
      double x = x0 + w * i / nx, y = y0 + h * j / ny, value;
      eda_field_sample(print, &x, &y, 1, &value);
      most = epe_max(most, value);
    }
  return most;
}

typedef struct job {
  const epe_layer *layer;
  const eda_field *print;
  double grid, margin;
  uint8_t *bad;
} job;

static void look_at_bar(void *data, size_t i) {
  const job *j = data;
  j->bad[i] = brightest(j->print, j->layer->bars.box[i], j->grid) > -j->margin;
}

size_t epe_drop_bars(epe_layer *l, const eda_field *print, double grid,
                     double margin) {
  size_t all = l->bars.count, kept = 0;
  if (!all || !print) return 0;
  job j = {l, print, grid, margin, eda_alloc(all, 1)};
  opc_parallel(l->context, all, look_at_bar, &j);
  for (size_t i = 0; i < all; i++)
    if (!j.bad[i]) l->bars.box[kept++] = l->bars.box[i];
  l->bars.count = kept;
  free(j.bad);
  return all - kept;
}
