/* SPDX-License-Identifier: BSD-3-Clause */
/* Assist features by rules: rows of bars beside drawn edges with open space (C.
   A. Mack, Fundamental Principles of Optical Lithography, 2007, chapter 10).
   They are too narrow to print by themselves and make an isolated edge print
   more like a dense one. */
#include "epe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Between places where a bar is looked at for light, nm. */
static const double look = 10;

/* ---- lists of boxes ---- */

typedef struct boxes {
  opc_box *box;
  size_t count, room;
} boxes;

static int add_box(boxes *b, opc_box box) {
  if (b->count == b->room) {
    size_t room = b->room ? 2 * b->room : 64;
    opc_box *grown = realloc(b->box, room * sizeof *grown);
    if (!grown) return 0;
    b->box = grown;
    b->room = room;
  }
  b->box[b->count++] = box;
  return 1;
}

static opc_box grow(opc_box b, int32_t by) {
  return (opc_box){b.x0 - by, b.y0 - by, b.x1 + by, b.y1 + by};
}

static int meet(opc_box a, opc_box b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

static int32_t length_of(opc_box b) {
  int32_t w = b.x1 - b.x0, h = b.y1 - b.y0;
  return w > h ? w : h;
}

/* ---- where bars may be ---- */

/* A bar as the rule has it, before others cut it. */
typedef struct wish {
  opc_box box;
  uint32_t number;         /* in the order of the edges */
  uint8_t upright;
  size_t first, end;       /* what came of it, in `bars` */
} wish;

typedef struct planner {
  epe_layer *layer;
  const epe_assist *rule;
  wish *wishes;
  size_t count;
  epe_bins drawn_bins, wish_bins;
  opc_box *drawn;          /* rectangles of the drawn shapes */
  size_t drawn_count;
  boxes parts, next;       /* of the wish at hand */
  boxes bars;
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
  wish w = {.upright = first->axis == OPC_X};
  w.box = w.upright ? (opc_box){from, low, from + r->width, high}
                    : (opc_box){low, from, high, from + r->width};
  return w;
}

/* Take `keep_out` from all parts. */
static int cut_parts(planner *p, opc_box keep_out, int upright) {
  p->next.count = 0;
  for (size_t i = 0; i < p->parts.count; i++) {
    opc_box b = p->parts.box[i], low = b, high = b;
    if (!meet(b, keep_out)) {
      if (!add_box(&p->next, b)) return 0;
      continue;
    }
    if (upright) low.y1 = keep_out.y0, high.y0 = keep_out.y1;
    else low.x1 = keep_out.x0, high.x0 = keep_out.x1;
    if ((upright ? low.y1 > low.y0 : low.x1 > low.x0) &&
        !add_box(&p->next, low))
      return 0;
    if ((upright ? high.y1 > high.y0 : high.x1 > high.x0) &&
        !add_box(&p->next, high))
      return 0;
  }
  boxes t = p->parts;
  p->parts = p->next;
  p->next = t;
  return 1;
}

/* Cut the parts by what lies in the cells that `around` meets: drawn shapes, or
   (wishes not NULL) the bars of wishes that were granted before. */
static int cut_by(planner *p, const epe_bins *b, opc_box around, int32_t space,
                  int upright, int bars) {
  for (int32_t r = epe_row(b, around.y0); r <= epe_row(b, around.y1); r++)
    for (int32_t c = epe_column(b, around.x0); c <= epe_column(b, around.x1);
         c++) {
      size_t at = (size_t)r * (size_t)b->columns + (size_t)c;
      for (uint32_t k = b->start[at]; k < b->start[at + 1]; k++) {
        uint32_t i = b->items[k];
        size_t first = bars ? p->wishes[i].first : i;
        size_t end = bars ? p->wishes[i].end : i + 1;
        const opc_box *box = bars ? p->bars.box : p->drawn;
        for (size_t n = first; n < end; n++)
          if (!cut_parts(p, grow(box[n], space), upright)) return 0;
      }
    }
  return 1;
}

/* What is left of a wish beside the drawn shapes and the bars there are. */
static int grant(planner *p, wish *w) {
  const epe_assist *r = p->rule;
  p->parts.count = 0;
  w->first = w->end = p->bars.count;
  if (!add_box(&p->parts, w->box) ||
      !cut_by(p, &p->drawn_bins, grow(w->box, r->distance), r->distance,
              w->upright, 0) ||
      !cut_by(p, &p->wish_bins, grow(w->box, r->space), r->space, w->upright,
              1))
    return 0;
  for (size_t i = 0; i < p->parts.count; i++)
    if (length_of(p->parts.box[i]) >= r->min_length &&
        !add_box(&p->bars, p->parts.box[i]))
      return 0;
  w->end = p->bars.count;
  return 1;
}

/* First rows before others, then long ones first. */
static int by_rank(const void *a, const void *b) {
  const wish *p = *(const wish *const *)a, *q = *(const wish *const *)b;
  if (p->first != q->first) return p->first < q->first ? -1 : 1;
  int32_t m = length_of(p->box), n = length_of(q->box);
  if (m != n) return m > n ? -1 : 1;
  return (p->number > q->number) - (p->number < q->number);
}

static int grant_all(planner *p) {
  wish **order = calloc(p->count ? p->count : 1, sizeof(wish *));
  if (!order) return 0;
  for (size_t i = 0; i < p->count; i++) order[i] = &p->wishes[i];
  qsort(order, p->count, sizeof(wish *), by_rank);
  for (size_t i = 0; i < p->count; i++)
    p->wishes[i].first = p->wishes[i].end = 0;
  int ok = 1;
  for (size_t i = 0; ok && i < p->count; i++) ok = grant(p, order[i]);
  free(order);
  return ok;
}

static int make_wishes(planner *p) {
  const epe_layer *l = p->layer;
  size_t room = l->edges * (size_t)p->rule->rows;
  p->wishes = calloc(room ? room : 1, sizeof *p->wishes);
  opc_box *all = calloc(room ? room : 1, sizeof *all);
  for (int row = 0; p->wishes && all && row < p->rule->rows; row++)
    for (size_t e = 0; e < l->edges; e++) {
      wish w = wish_of(p, e, row);
      w.number = (uint32_t)p->count;
      w.first = (size_t)row;   /* by_rank */
      all[p->count] = w.box;
      p->wishes[p->count++] = w;
    }
  int ok = p->wishes && all &&
           epe_bins_make(&p->wish_bins, all, p->count, p->rule->distance);
  free(all);
  return ok;
}

/* ---- room for the fragments beside them ---- */

/* A fragment, wherever its ends may go, stays min_space off the bars. */
static void leave_room(epe_layer *l, const epe_bins *b, uint32_t i) {
  const epe_rules *r = l->rules;
  const epe_piece *p = &l->pieces[i];
  int32_t space = r->min_space, most = r->max_shift, reach = most + space;
  int32_t line = epe_line(p, NULL, 0);
  int32_t m = epe_along(p, p->from), n = epe_along(p, p->to);
  int32_t low = (m < n ? m : n) - (p->corner ? most : 0) - space;
  int32_t high = (m < n ? n : m) + (p->corner ? most : 0) + space;
  int32_t near = p->sign > 0 ? line : line - reach;
  opc_box box = p->axis == OPC_X ? (opc_box){near, low, near + reach, high}
                                 : (opc_box){low, near, high, near + reach};
  for (int32_t row = epe_row(b, box.y0); row <= epe_row(b, box.y1); row++)
    for (int32_t c = epe_column(b, box.x0); c <= epe_column(b, box.x1); c++) {
      size_t at = (size_t)row * (size_t)b->columns + (size_t)c;
      for (uint32_t k = b->start[at]; k < b->start[at + 1]; k++) {
        opc_box bar = l->bars[b->items[k]];
        if (!meet(bar, box)) continue;
        int32_t off = p->axis == OPC_X
                          ? (p->sign > 0 ? bar.x0 - line : line - bar.x1)
                          : (p->sign > 0 ? bar.y0 - line : line - bar.y1);
        int32_t room = off > space ? off - space : 0;
        if (room < l->most[i]) l->most[i] = room;
      }
    }
}

static int leave_rooms(epe_layer *l) {
  epe_bins b;
  int ok = epe_bins_make(&b, l->bars, l->bar_count,
                         l->rules->max_shift + l->rules->min_space);
  for (uint32_t i = 0; ok && i < l->count; i++) leave_room(l, &b, i);
  epe_bins_clear(&b);
  return ok;
}

/* ---- all of it ---- */

int epe_place_bars(epe_layer *l, const epe_assist *rule,
                   const opc_shapes *drawn, opc_error *error) {
  planner p = {.layer = l, .rule = rule};
  if (!rule->rows) return OPC_OK;
  int code = l->host->geometry->fracture(l->host, drawn, &p.drawn,
                                         &p.drawn_count, error);
  if (code) return code;
  int ok = epe_bins_make(&p.drawn_bins, p.drawn, p.drawn_count,
                         rule->distance) &&
           make_wishes(&p) && grant_all(&p);
  l->host->free(l->host, p.drawn);
  free(p.wishes);
  free(p.parts.box);
  free(p.next.box);
  epe_bins_clear(&p.drawn_bins);
  epe_bins_clear(&p.wish_bins);
  l->bars = p.bars.box;
  l->bar_count = p.bars.count;
  if (ok && l->bar_count) ok = leave_rooms(l);
  if (ok) return OPC_OK;
  return l->host->fail(l->host, error, OPC_FAILED, NULL, "out of memory");
}

/* ---- bars that print ---- */

/* The most of the level set on a bar: along its middle and its sides. */
static double brightest(const epe_layer *l, const opc_field *print, opc_box b,
                        double grid) {
  double x0 = b.x0 * grid, y0 = b.y0 * grid, w = b.x1 * grid - x0,
         h = b.y1 * grid - y0, most = -INFINITY;
  int nx = (int)ceil(w / look), ny = (int)ceil(h / look);
  for (int j = 0; j <= ny; j++)
    for (int i = 0; i <= nx; i++) {
      double x = x0 + w * i / nx, y = y0 + h * j / ny, value;
      l->host->imaging->sample(print, &x, &y, 1, &value);
      most = epe_max(most, value);
    }
  return most;
}

typedef struct job {
  const epe_layer *layer;
  const opc_field *print;
  double grid, margin;
  uint8_t *bad;
} job;

enum { BARS_PER_BLOCK = 64 };

static void look_at_block(void *data, size_t block) {
  const job *j = data;
  size_t end = (block + 1) * BARS_PER_BLOCK;
  if (end > j->layer->bar_count) end = j->layer->bar_count;
  for (size_t i = block * BARS_PER_BLOCK; i < end; i++)
    j->bad[i] = brightest(j->layer, j->print, j->layer->bars[i], j->grid) >
                -j->margin;
}

size_t epe_drop_bars(epe_layer *l, const opc_field *print, double grid,
                     double margin) {
  if (!l->bar_count || !print) return 0;
  job j = {l, print, grid, margin, calloc(l->bar_count, 1)};
  if (!j.bad) return SIZE_MAX;
  size_t blocks = (l->bar_count + BARS_PER_BLOCK - 1) / BARS_PER_BLOCK, n = 0;
  l->host->parallel(l->host, blocks, look_at_block, &j);
  for (size_t i = 0; i < l->bar_count; i++)
    if (!j.bad[i]) l->bars[n++] = l->bars[i];
  size_t dropped = l->bar_count - n;
  l->bar_count = n;
  free(j.bad);
  return dropped;
}
