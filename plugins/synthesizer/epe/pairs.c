/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the mask rules for width, space and edge length. Pairs of
   fragments that may violate a rule are found once and checked after every
   change of shifts. Distances are Euclidean, as in a mask rule check. If a pair
   is drawn closer than the rule, the limit is the drawn distance. */
#include "epe.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

/* Distance from fragment a to fragment b, which is at larger coordinates. */
typedef struct gap {
  double across; /* along the axis of both fragments */
  double along;  /* between the nearest ends; at most 0 if they overlap */
} gap;

static gap gap_of(const epe_fragment *p, const int32_t *shift, uint32_t a,
                  uint32_t b) {
  int32_t a0 = epe_begin(p, shift, a), a1 = epe_end(p, shift, a);
  int32_t b0 = epe_begin(p, shift, b), b1 = epe_end(p, shift, b);
  int32_t low_a = a0 < a1 ? a0 : a1, high_a = a0 < a1 ? a1 : a0;
  int32_t low_b = b0 < b1 ? b0 : b1, high_b = b0 < b1 ? b1 : b0;
  return (gap){(double)epe_line(p, shift, b) - epe_line(p, shift, a),
               epe_max((double)low_b - high_a, (double)low_a - high_b)};
}

/* ---- search ---- */

typedef struct finder {
  epe_layer *layer;
  eda_index *index;
  size_t capacity;
} finder;

static void pair_add(finder *f, epe_pair pair) {
  epe_layer *l = f->layer;
  eda_grow(&l->pairs, &f->capacity, l->pair_count + 1, sizeof pair);
  l->pairs[l->pair_count++] = pair;
}

/* Return the largest displacement of a fragment's ends along the edge. */
static double end_reach(const epe_layer *l, uint32_t i) {
  return l->fragments[i].corner ? l->rules->max_shift : 0;
}

/* Add the pair of fragments i and j if their distance may become smaller than
   the limit. The outside of fragment i is towards larger coordinates, that of
   fragment j towards smaller coordinates. If j is at larger coordinates than i,
   a space is between them, otherwise the inside of the mask. */
static void pair_consider(finder *f, uint32_t i, uint32_t j) {
  epe_layer *l = f->layer;
  const epe_fragment *p = l->fragments;
  int32_t off = epe_line(p, NULL, j) - epe_line(p, NULL, i);
  if (!off) return;
  int inside = off < 0;
  uint32_t a = inside ? j : i, b = inside ? i : j;
  double limit = inside ? l->rules->min_width : l->rules->min_space;
  gap g = gap_of(p, NULL, a, b);
  if (g.across > limit + 2 * l->rules->max_shift ||
      g.along > limit + end_reach(l, a) + end_reach(l, b))
    return;
  /* The area between diagonal corners of polygons is outside of the mask. */
  if (inside && g.along >= 0 && p[i].polygon != p[j].polygon && !p[i].hole &&
      !p[j].hole)
    return;
  double drawn = g.along > 0 ? hypot(g.across, g.along) : g.across;
  pair_add(f,
           (epe_pair){a, b, (uint16_t)inside, 0, (float)epe_min(limit, drawn)});
}

static eda_box box_of(const epe_fragment *p, int32_t grown) {
  const eda_point ends[] = {p->from, p->to};
  eda_box b = eda_bounds(ends, 2);
  return eda_box_grown(b, grown);
}

static void pairs_find_around(finder *f, uint32_t i, int32_t reach) {
  const epe_fragment *p = f->layer->fragments;
  eda_finder near = eda_index_find(f->index, box_of(&p[i], reach));
  for (uint32_t j; eda_index_next(&near, &j);)
    if (p[j].axis == p[i].axis && p[j].sign < 0) pair_consider(f, i, j);
}

/* Return the distance of the begin (side 0) or end (side 1) of fragment i from
   the corner of its edge at that side. */
static int32_t corner_distance(const epe_layer *l, uint32_t i, int side) {
  const epe_fragment *p = l->fragments;
  uint32_t first = l->edge[p[i].edge], last = l->edge[p[i].edge + 1] - 1;
  return side ? abs(epe_along(&p[i], p[last].to) - epe_along(&p[i], p[i].to))
              : abs(epe_along(&p[i], p[first].from) -
                    epe_along(&p[i], p[i].from));
}

/* Add pairs of fragments on different sides of the corner at the end of
   fragment i, except the pair that meets at the corner. Jogs of a pair approach
   each other if shifted outwards at a concave corner, or inwards at a convex
   corner. */
static void pairs_find_at_corner(finder *f, uint32_t i) {
  epe_layer *l = f->layer;
  const epe_fragment *p = l->fragments;
  uint32_t j = p[i].next;
  if (!(p[i].corner & EPE_TO)) return;
  int inside = (p[i].sign * p[j].sign > 0) == (p[i].axis == EDA_X);
  int32_t limit = inside ? l->rules->min_width : l->rules->min_space;
  int32_t reach = limit + l->rules->max_shift;
  for (uint32_t a = i; !(p[a].corner & EPE_FROM);) {
    a = p[a].previous;
    if (corner_distance(l, a, 1) >= reach) break;
    for (uint32_t b = j; !(p[b].corner & EPE_TO);) {
      b = p[b].next;
      if (corner_distance(l, b, 0) >= reach) break;
      double drawn = hypot(corner_distance(l, a, 1), corner_distance(l, b, 0));
      pair_add(f, (epe_pair){a, b, (uint16_t)inside, 1,
                             (float)epe_min(limit, drawn)});
    }
  }
}

void epe_find_pairs(epe_layer *l) {
  const epe_rules *r = l->rules;
  finder f = {.layer = l};
  int32_t most = r->min_width > r->min_space ? r->min_width : r->min_space;
  int32_t reach = most + 2 * r->max_shift;
  if (!most) return;
  eda_box *boxes = eda_alloc(l->count, sizeof *boxes);
  for (uint32_t i = 0; i < l->count; i++)
    boxes[i] = box_of(&l->fragments[i], 0);
  f.index = eda_index_new(boxes, l->count, reach);
  for (uint32_t i = 0; i < l->count; i++) {
    if (l->fragments[i].sign > 0) pairs_find_around(&f, i, reach);
    pairs_find_at_corner(&f, i);
  }
  eda_index_free(f.index);
  free(boxes);
  l->broken = eda_alloc(l->pair_count, 1);
}

/* ---- separation ---- */

/* Narrow the bounds of fragment i so that its shift is reduced by `by` steps.
 */
static void fragment_move_back(epe_layer *l, const int32_t *shift, uint32_t i,
                               int32_t by) {
  int32_t out = shift[i] > 0, left = abs(shift[i]) - by;
  if (left < 0) left = 0;
  if (!shift[i] || (out ? l->high[i] <= left : l->low[i] >= -left)) return;
  *(out ? &l->high[i] : &l->low[i]) = out ? left : -left;
  l->state[l->fragments[i].edge] |= EPE_NARROWED;
}

/* Reduce by one step the shifts of the adjacent fragments around both corners
   of a fragment, because these shifts lengthened the fragment towards the other
   fragment of a pair. */
static void neighbours_move_back(epe_layer *l, const int32_t *shift,
                                 uint32_t i) {
  const epe_fragment *p = &l->fragments[i];
  if (p->corner & EPE_FROM) fragment_move_back(l, shift, p->previous, 1);
  if (p->corner & EPE_TO) fragment_move_back(l, shift, p->next, 1);
}

static void fragment_keep_drawn(epe_layer *l, uint32_t i) {
  const epe_fragment *p = &l->fragments[i];
  uint32_t all[3] = {i, p->previous, p->next};
  for (int k = 0; k < 3; k++) {
    l->low[all[k]] = l->high[all[k]] = 0;
    l->state[l->fragments[all[k]].edge] |= EPE_WHOLE | EPE_NARROWED;
  }
}

/* Reduce the shifts of both fragments so that their distance grows by
   `missing`. Each reduction is proportional to the shift of the fragment. */
static void pair_separate(epe_layer *l, const int32_t *shift,
                          const epe_pair *pair, double missing) {
  int sign =
      pair->inside ? -1 : 1; /* sign of shifts that reduce the distance */
  uint32_t who[2] = {pair->a, pair->b};
  double part[2], all = 0;
  for (int k = 0; k < 2; k++) all += part[k] = epe_max(0, sign * shift[who[k]]);
  for (int k = 0; k < 2; k++) {
    if (part[k] <= 0) continue;
    fragment_move_back(l, shift, who[k],
                       (int32_t)ceil(missing * part[k] / all));
  }
  if (all >= missing) return;
  for (int k = 0; k < 2; k++) neighbours_move_back(l, shift, who[k]);
}

/* Tolerance, grid steps, because limits are rounded to float. */
static const double slack = 1e-3;

/* Return the distance between the jogs of two fragments on different sides of a
   corner; INFINITY unless both fragments protrude. */
static double corner_gap(const epe_layer *l, const int32_t *shift,
                         const epe_pair *pair) {
  uint32_t a = pair->a, b = pair->b;
  int sign = pair->inside ? -1 : 1;
  int32_t by_a = sign * shift[a], by_b = sign * shift[b];
  if (by_a <= sign * shift[l->fragments[a].next] ||
      by_b <= sign * shift[l->fragments[b].previous])
    return INFINITY;
  return hypot(epe_max(0, corner_distance(l, b, 0) - by_a),
               epe_max(0, corner_distance(l, a, 1) - by_b));
}

static int too_near(const epe_layer *l, const int32_t *shift,
                    const epe_pair *pair) {
  const epe_fragment *p = l->fragments;
  double limit = pair->limit - slack;
  if (pair->corner) return corner_gap(l, shift, pair) < limit;
  if (epe_line(p, shift, pair->b) - epe_line(p, shift, pair->a) >= limit)
    return 0;
  gap g = gap_of(p, shift, pair->a, pair->b);
  /* Overlapping fragments closer than the limit violate the rule. */
  return g.along <= 0 || hypot(epe_max(g.across, 0), g.along) < limit;
}

typedef struct search {
  epe_layer *layer;
  const int32_t *shift;
} search;

static void pair_check(void *data, size_t k) {
  const search *s = data;
  epe_layer *l = s->layer;
  l->broken[k] = (uint8_t)too_near(l, s->shift, &l->pairs[k]);
}

/* If edge e is reversed or shorter than min_edge, reduce the shifts of the
   edges before and after it. If edge e is drawn shorter than min_edge, the
   drawn length is the limit. `hard`: 1: keep all three edges as drawn. Return 1
   if edge e was too short. */
static int edge_lengthen(epe_layer *l, const int32_t *shift, size_t e,
                         int hard) {
  const epe_fragment *p = l->fragments;
  uint32_t first = l->edge[e], last = l->edge[e + 1] - 1;
  int sign = (p[first].axis == EDA_X) == (p[first].sign > 0) ? 1 : -1;
  double begin = epe_begin(p, shift, first), end = epe_end(p, shift, last);
  double drawn_begin = epe_begin(p, NULL, first);
  double drawn_end = epe_end(p, NULL, last);
  double least = epe_min(sign * (drawn_end - drawn_begin), l->rules->min_edge);
  double missing = least - sign * (end - begin);
  if (missing <= 0) return 0;
  if (hard) {
    fragment_keep_drawn(l, first);
    fragment_keep_drawn(l, last);
    return 1;
  }
  double from = epe_max(0, sign * (begin - drawn_begin));
  double to = epe_max(0, sign * (drawn_end - end));
  /* Each edge is moved back in proportion to its shift. */
  double part = missing / (from + to);
  fragment_move_back(l, shift, p[first].previous, (int32_t)ceil(from * part));
  fragment_move_back(l, shift, p[last].next, (int32_t)ceil(to * part));
  return 1;
}

size_t epe_separate(epe_layer *l, const int32_t *shift, int hard) {
  search s = {l, shift};
  size_t found = 0;
  opc_parallel(l->context, l->pair_count, pair_check, &s);
  for (size_t k = 0; k < l->pair_count; k++) {
    if (!l->broken[k]) continue;
    const epe_pair *pair = &l->pairs[k];
    found++;
    if (hard) {
      fragment_keep_drawn(l, pair->a);
      fragment_keep_drawn(l, pair->b);
      continue;
    }
    if (pair->corner) {
      pair_separate(l, shift, pair, pair->limit - corner_gap(l, shift, pair));
      continue;
    }
    gap g = gap_of(l->fragments, shift, pair->a, pair->b);
    double limit = pair->limit;
    double needed =
        g.along > 0 ? sqrt(limit * limit - g.along * g.along) : limit;
    pair_separate(l, shift, pair, epe_max(needed - slack - g.across, slack));
  }
  for (size_t e = 0; e < l->edges; e++)
    found += (size_t)edge_lengthen(l, shift, e, hard);
  return found;
}
