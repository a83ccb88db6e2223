/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the dissection of a layer's edges into fragments, their
   displacement by whole grid steps and the reconstruction of polygons. */
#include <correct/edges.h>

#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

/* Largest number of positions at which the displacement of a side changes: ends
   of parts and of the jog. */
enum { CUTS = 2 * EDA_PARTS + 2 };

/* ---- allocation ---- */

static void pieces_allocate(size_t polygons, size_t count, pieces *out) {
  out->polygons = polygons;
  out->capacity = count;
  out->start = eda_alloc(polygons + 1, sizeof *out->start);
  out->from = eda_alloc(count, sizeof *out->from);
  out->by = eda_alloc(count, sizeof *out->by);
}

void correct_pieces_of_edges(const eda_edges *edges, int base, pieces *out) {
  size_t n = edges->polygons ? edges->start[edges->polygons] : 0, sides = 0;
  for (size_t i = 0; i < n; i++)
    sides += edges->fragments[i].role == EDA_L_LOW ||
             edges->fragments[i].role == EDA_L_HIGH;
  pieces_allocate(edges->polygons, n + (base ? 2 : 1) * CUTS * sides, out);
}

void correct_pieces_of_cuts(const eda_cuts *cuts, pieces *out) {
  size_t n = cuts->start[cuts->polygons];
  pieces_allocate(cuts->polygons, n, out);
  memcpy(out->start, cuts->start, (cuts->polygons + 1) * sizeof *out->start);
  memcpy(out->from, cuts->from, n * sizeof *out->from);
}

void correct_pieces_clear(pieces *p) {
  free(p->start);
  free(p->from);
  free(p->by);
  *p = (pieces){0};
}

void correct_pieces_alloc(const pieces *p, eda_shapes *out) {
  *out = (eda_shapes){.count = p->polygons};
  out->start = eda_alloc(p->polygons + 1, sizeof *out->start);
  out->points = eda_alloc(2 * p->capacity, sizeof *out->points);
}

/* ---- from the biases of gates to fragments ---- */

/* Return the coordinate along a gate's width. */
static int32_t along_w(const eda_gates *g, int32_t gate, eda_point p) {
  return g->axis[gate] == EDA_X ? p.y : p.x;
}

/* Return the part of a bias that a side receives: half, and on the HIGH side
   also the odd step. */
static int32_t half_of(int32_t all, int high) {
  int32_t low = all >> 1;
  return high ? all - low : low;
}

/* Return the outward displacement of an active edge at an end of a gate's
   width. */
static int32_t width_move(const biases *b, size_t i, int high) {
  const eda_moved *base = b->base;
  int32_t aside = b->aside[i] + (base ? base->aside[i] : 0), by = 0;
  if (base) by = half_of(base->w[i], high != !!(base->flip[i] & EDA_FLIP_W));
  return by + half_of(b->w[i], high) + (high ? aside : -aside);
}

void correct_biases_add_base(const biases *b, size_t gates, biases *out) {
  for (size_t i = 0; i < gates; i++) {
    int32_t low = width_move(b, i, 0);
    out->w[i] = low + width_move(b, i, 1);
    out->aside[i] = half_of(out->w[i], 0) - low;
    out->l[i] = b->l[i] + b->base->l[i];
  }
}

/* Return the outward displacement of a fragment at a gate's width or line end;
   0 for a fixed fragment. */
static int32_t move_of(const eda_fragment *f, const biases *b) {
  const eda_moved *base = b->base;
  int32_t i = f->gate;
  if (f->role == EDA_W_LOW || f->role == EDA_W_HIGH)
    return width_move(b, (size_t)i, f->role == EDA_W_HIGH);
  if (f->role != EDA_END_LOW && f->role != EDA_END_HIGH) return 0;
  int32_t end = 2 * i + (f->role == EDA_END_HIGH);
  return b->end[end] + (base ? base->end[end] : 0);
}

static void piece_add(pieces *out, uint32_t *n, eda_point from, int32_t by) {
  out->from[*n] = from;
  out->by[(*n)++] = by;
}

/* A poly edge of a gate, from `low` to `high` along W, with its displacements
   along L. */
typedef struct side {
  int32_t low, high, box; /* ends of the side along W; box: LOW end of the
                             gate's box */
  int32_t l;
  int32_t jog_from, jog_to; /* ends of the jog along W; equal: the jog is in the
                               opposite side */
  int upper;                /* 1: the side receives the odd step */
  const eda_part *part;
} side;

/* Return the side of a fragment; `flip` is EDA_FLIP_*. */
static side side_of(const eda_gates *g, const eda_fragment *f, eda_point next,
                    int32_t l, int32_t jog, const eda_part *parts,
                    uint8_t flip) {
  int32_t from = along_w(g, f->gate, f->from), to = along_w(g, f->gate, next);
  eda_box box = g->box[f->gate];
  int upper = (f->role == EDA_L_HIGH) != !!(flip & EDA_FLIP_L);
  side s = {.low = from < to ? from : to,
            .high = from < to ? to : from,
            .box = g->axis[f->gate] == EDA_X ? box.y0 : box.x0,
            .l = l,
            .upper = upper,
            .part = parts + (size_t)EDA_PARTS * (size_t)f->gate};
  s.jog_from = s.jog_to = s.low;
  if (upper == (l & 1)) return s;
  if (jog > s.high - s.low) jog = s.high - s.low;
  if (flip & EDA_FLIP_W)
    s.jog_from = s.high - jog, s.jog_to = s.high;
  else
    s.jog_to = s.low + jog;
  return s;
}

static int is_part(const side *s, int k) {
  return k < EDA_PARTS && s->part[k].from < s->part[k].to;
}

/* Return the displacement at position `at`: half of the length bias, half of
   the bias of the part at this position, and the jog. The side with the jog
   does not depend on the parts. */
static int32_t move_at(const side *s, int32_t at) {
  int32_t l = s->l;
  for (int k = 0; is_part(s, k); k++)
    if (s->part[k].from <= at - s->box && at - s->box < s->part[k].to)
      l += s->part[k].by;
  return half_of(l, s->upper) + (s->jog_from <= at && at < s->jog_to);
}

/* Insert into the sorted list `cut` a position at which the displacement
   changes. Returns the new count. */
static int cut_at(const side *s, int32_t at, int32_t *cut, int n) {
  int k = n;
  if (at <= s->low || at >= s->high) return n;
  for (; k > 0 && cut[k - 1] > at; k--) cut[k] = cut[k - 1];
  cut[k] = at;
  return n + 1;
}

/* Insert all positions at which a side's displacement changes. Returns the new
   count. */
static int cut_side(const side *s, int32_t *cut, int n) {
  for (int k = 0; is_part(s, k); k++) {
    n = cut_at(s, s->box + s->part[k].from, cut, n);
    n = cut_at(s, s->box + s->part[k].to, cut, n);
  }
  n = cut_at(s, s->jog_from, cut, n);
  return cut_at(s, s->jog_to, cut, n);
}

/* Append a side along L, dissected where its displacement changes. */
static void put_side(const eda_gates *g, const eda_fragment *f, eda_point next,
                     const biases *b, pieces *out, uint32_t *n) {
  const eda_moved *base = b->base;
  int32_t cut[2 * CUTS + 2], i = f->gate;
  side s = side_of(g, f, next, b->l[i], b->jog[i], b->part, 0), under = {0};
  int upright = g->axis[i] == EDA_X;
  int rising = along_w(g, i, f->from) == s.low, cuts;
  cut[0] = s.low;
  cuts = cut_side(&s, cut, 1);
  if (base) {
    under = side_of(g, f, next, base->l[i], base->jog[i], base->part,
                    base->flip[i]);
    cuts = cut_side(&under, cut, cuts);
  }
  cut[cuts] = s.high;
  int32_t before = INT32_MAX;
  for (int c = 0; c < cuts; c++) {
    int k = rising ? c : cuts - 1 - c;
    int32_t by = move_at(&s, cut[k]) + (base ? move_at(&under, cut[k]) : 0);
    int32_t at = rising ? cut[k] : cut[k + 1];
    if (by != before)
      piece_add(
          out, n,
          upright ? (eda_point){f->from.x, at} : (eda_point){at, f->from.y},
          by);
    before = by;
  }
}

void correct_pieces_follow(const eda_gates *g, size_t layer, const biases *b,
                           pieces *out) {
  const eda_edges *e = &g->edges[layer];
  uint32_t n = 0;
  for (size_t p = 0; p < e->polygons; p++) {
    const eda_fragment *f = e->fragments + e->start[p];
    uint32_t count = e->start[p + 1] - e->start[p];
    out->start[p] = n;
    for (uint32_t i = 0; i < count; i++) {
      if (f[i].role == EDA_L_LOW || f[i].role == EDA_L_HIGH)
        put_side(g, &f[i], f[(i + 1) % count].from, b, out, &n);
      else
        piece_add(out, &n, f[i].from, move_of(&f[i], b));
    }
  }
  out->start[e->polygons] = n;
}

/* ---- from fragments to polygons ---- */

/* The line on which a displaced fragment is located. */
typedef struct moved {
  int horizontal;
  int32_t line; /* y if horizontal, else x */
} moved;

static moved line_moved(eda_point from, eda_point next, int32_t by) {
  if (from.y == next.y) /* the outward direction is down if the edge runs to the
                           right */
    return (moved){1, from.y + (next.x > from.x ? -by : by)};
  return (moved){0, from.x + (next.y > from.y ? by : -by)};
}

/* Return 1 if b equals a neighbour or is collinear with a and c. */
static int is_idle(eda_point a, eda_point b, eda_point c) {
  return (a.x == b.x && b.x == c.x) || (a.y == b.y && b.y == c.y);
}

/* Append a corner to a polygon of n corners. Returns the new count. */
static uint32_t polygon_add(eda_point *polygon, uint32_t n, eda_point p) {
  while (n > 1 && is_idle(polygon[n - 2], polygon[n - 1], p)) n--;
  if (n == 1 && polygon[0].x == p.x && polygon[0].y == p.y) n = 0;
  polygon[n] = p;
  return n + 1;
}

/* Remove redundant corners where the end of a polygon meets its start. Return
   the remaining count; 0: the polygon vanished. */
static uint32_t polygon_join(eda_point *polygon, uint32_t n) {
  uint32_t first = 0;
  for (int found = 1; found && n - first > 2;) {
    found = 1;
    if (is_idle(polygon[n - 2], polygon[n - 1], polygon[first]))
      n--;
    else if (is_idle(polygon[n - 1], polygon[first], polygon[first + 1]))
      first++;
    else
      found = 0;
  }
  if (n - first < 4) return 0;
  for (uint32_t i = first; i < n; i++) polygon[i - first] = polygon[i];
  return n - first;
}

static uint32_t polygon_build(const eda_point *from, const int32_t *by,
                              uint32_t count, eda_point *polygon) {
  uint32_t n = 0;
  moved before = line_moved(from[count - 1], from[0], by[count - 1]);
  for (uint32_t i = 0; i < count; i++) {
    moved m = line_moved(from[i], from[(i + 1) % count], by[i]);
    if (m.horizontal != before.horizontal) {
      n = polygon_add(polygon, n,
                      m.horizontal ? (eda_point){before.line, m.line}
                                   : (eda_point){m.line, before.line});
    } else if (m.line != before.line) { /* parallel fragments on different
                                           lines: insert a jog */
      int32_t at = m.horizontal ? from[i].x : from[i].y;
      for (int k = 0; k < 2; k++) {
        int32_t line = k ? m.line : before.line;
        n = polygon_add(
            polygon, n,
            m.horizontal ? (eda_point){at, line} : (eda_point){line, at});
      }
    }
    before = m;
  }
  return polygon_join(polygon, n);
}

void correct_pieces_build(const pieces *in, eda_shapes *out) {
  uint32_t n = 0;
  for (size_t p = 0; p < in->polygons; p++) {
    uint32_t first = in->start[p], count = in->start[p + 1] - first;
    out->start[p] = n;
    if (count)
      n += polygon_build(in->from + first, in->by + first, count,
                         out->points + n);
  }
  out->start[in->polygons] = n;
  out->count = in->polygons;
}

/* ---- from polygons to the mask ---- */

void correct_shapes_of_boxes(boxes_lists from, eda_shapes *out) {
  size_t n = 0, i = 0;
  for (size_t k = 0; k < from.count; k++) n += from.list[k].count;
  *out = eda_shapes_of_boxes(n);
  for (size_t k = 0; k < from.count; k++)
    for (size_t b = 0; b < from.list[k].count; b++)
      eda_shapes_set_box(out, i++, from.list[k].box[b]);
}

int correct_mask_merge(const eda_shapes *polygons, boxes_lists added,
                       boxes_lists cutouts, eda_shapes *out, opc_error *error) {
  eda_shapes more, less, whole;
  correct_shapes_of_boxes(added, &more);
  correct_shapes_of_boxes(cutouts, &less);
  int code = eda_boolean(EDA_OR, polygons, more.count ? &more : NULL,
                         less.count ? &whole : out, error);
  if (!code && less.count) {
    code = eda_boolean(EDA_NOT, &whole, &less, out, error);
    eda_shapes_clear(&whole);
  }
  eda_shapes_clear(&more);
  eda_shapes_clear(&less);
  return code;
}
