/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements smoothing: filling of notches and removal of bumps, which leaves a
   straight edge. A repaired notch can no longer be detected on the mask, and
   its filling may protrude after adjacent edges have moved. Therefore a
   smoothing is kept as long as the mask contains its straight edge. */
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "drc.h"
#include "tuning.h"

static int turns_left(eda_point a, eda_point b, eda_point c) {
  return ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) >
         ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x);
}

/* ---- smoothings to keep ---- */

static int is_between(int32_t v, int32_t a, int32_t b) {
  return a < b ? v >= a && v <= b : v >= b && v <= a;
}

/* Return 1 if an end of the straight edge of smoothing m is valid. Only an end
   at the corner b of the mask corners a, b, c can be invalid: b must turn left
   for a bump, right for a notch. Otherwise the smoothing would protrude from
   the mask. */
static int is_valid_corner(const smoothing *m, eda_point end, eda_point a,
                           eda_point b, eda_point c) {
  return end.x != b.x || end.y != b.y || turns_left(a, b, c) == m->bump;
}

/* Return 1 if the edge from q[1] to q[2] contains the straight edge of m. */
static int smoothing_confirmed_by(const eda_point *q, const smoothing *m) {
  int same_way = q[1].y == q[2].y
                     ? m->from.y == q[1].y && m->to.y == q[1].y &&
                           (m->to.x > m->from.x) == (q[2].x > q[1].x)
                     : m->from.x == q[1].x && m->to.x == q[1].x &&
                           (m->to.y > m->from.y) == (q[2].y > q[1].y);
  return same_way && is_between(m->from.x, q[1].x, q[2].x) &&
         is_between(m->from.y, q[1].y, q[2].y) &&
         is_between(m->to.x, q[1].x, q[2].x) &&
         is_between(m->to.y, q[1].y, q[2].y) &&
         is_valid_corner(m, m->from, q[0], q[1], q[2]) &&
         is_valid_corner(m, m->to, q[1], q[2], q[3]);
}

/* Copy four successive corners of a polygon, from corner i. */
static void polygon_corners(const eda_shapes *mask, size_t p, uint32_t i,
                            eda_point q[4]) {
  const eda_point *at = mask->points + mask->start[p];
  uint32_t n = mask->start[p + 1] - mask->start[p];
  for (uint32_t k = 0; k < 4; k++) q[k] = at[(i + k) % n];
}

/* Mark the smoothings whose straight edges are still on the mask. */
static void smoothings_mark(smoothings *s, const eda_shapes *mask,
                            double grid) {
  if (!s->n) return;
  places edges;
  eda_box *box = eda_alloc(s->n, sizeof *box);
  for (size_t i = 0; i < s->n; i++) {
    box[i] = box_between(s->at[i].from, s->at[i].to);
    s->at[i].stays = 0;
  }
  places_init(&edges, box, s->n, 1000, grid);
  for (size_t p = 0; p < mask->count; p++)
    for (uint32_t i = 0; i < mask->start[p + 1] - mask->start[p]; i++) {
      eda_point q[4];
      polygon_corners(mask, p, i, q);
      eda_finder f = eda_index_find(edges.index, box_between(q[1], q[2]));
      for (uint32_t k; eda_index_next(&f, &k);)
        if (smoothing_confirmed_by(q, &s->at[k])) s->at[k].stays = 1;
    }
  places_clear(&edges);
}

/* ---- new smoothings ---- */

static int32_t edge_length(eda_point a, eda_point b) {
  return abs(b.x - a.x) + abs(b.y - a.y);
}

static int smoothings_touch(const smoothing *a, const smoothing *b) {
  return a->box.x0 <= b->box.x1 && b->box.x0 <= a->box.x1 &&
         a->box.y0 <= b->box.y1 && b->box.y0 <= a->box.y1;
}

/* Return 1 if a smoothing must wait for the next iteration. A bump beside a
   notch may be wide enough after the notch is filled. A notch beside a removed
   bump results from the removal, so the bump is restored. `before`: number of
   smoothings before this iteration. */
static int smoothing_must_wait(drc *r, smoothings *s, const smoothing *m,
                               size_t before) {
  int wait = 0;
  for (size_t i = m->bump ? before : 0; i < s->n; i++) {
    smoothing *o = &s->at[i];
    if (!o->stays || o->bump == m->bump || !smoothings_touch(o, m)) continue;
    wait = 1;
    if (m->bump || r->reverted >= tuned.patience) continue;
    o->stays = 0;
    r->reverted++;
  }
  return wait;
}

/* Remove smoothings that are not marked. Keep those that touch a new smoothing
   of the same kind, because both may be parts of one notch or bump. */
static void smoothings_drop(smoothings *s, size_t before) {
  size_t kept = 0;
  for (size_t i = 0; i < s->n; i++) {
    smoothing *m = &s->at[i];
    for (size_t k = before; !m->stays && k < s->n; k++)
      m->stays = m->bump == s->at[k].bump && smoothings_touch(m, &s->at[k]);
    if (m->stays) s->at[kept++] = *m;
  }
  s->n = kept;
}

/* Add a smoothing if the edge from q[1] to q[2] is the bottom of a notch or the
   top of a bump. The depth is the length of the shorter adjacent edge. */
static void smoothing_find(drc *r, smoothings *s, const eda_point q[4],
                           int bump, size_t before) {
  double least = bump ? r->min_mask_width : r->min_space;
  int32_t first = edge_length(q[0], q[1]), last = edge_length(q[2], q[3]);
  int32_t depth = first < last ? first : last;
  if (turns_left(q[0], q[1], q[2]) != bump ||
      turns_left(q[1], q[2], q[3]) != bump || depth * r->grid > least ||
      edge_length(q[1], q[2]) * r->grid > least - 1e-9)
    return;
  int32_t dx = depth * ((q[0].x > q[1].x) - (q[0].x < q[1].x));
  int32_t dy = depth * ((q[0].y > q[1].y) - (q[0].y < q[1].y));
  smoothing one = {.from = {q[1].x + dx, q[1].y + dy},
                   .to = {q[2].x + dx, q[2].y + dy},
                   .bump = (uint8_t)bump,
                   .stays = 1};
  one.box = box_between(one.from, q[2]);
  if (smoothing_must_wait(r, s, &one, before)) return;
  eda_grow(&s->at, &s->capacity, s->n + 1, sizeof one);
  s->at[s->n++] = one;
}

void smooth_masks(drc *r, const eda_printed *p) {
  for (size_t layer = 0; layer < r->layers; layer++) {
    const eda_shapes *mask = &p->shapes[layer];
    smoothings *s = &r->smoothings[layer];
    size_t before = s->n;
    smoothings_mark(s, mask, r->grid);
    for (int bump = 0; bump < 2; bump++)
      for (size_t k = 0; k < mask->count; k++) {
        uint32_t n = mask->start[k + 1] - mask->start[k];
        for (uint32_t i = 0; n > 4 && i < n; i++) {
          eda_point q[4];
          polygon_corners(mask, k, i, q);
          smoothing_find(r, s, q, bump, before);
        }
      }
    smoothings_drop(s, before);
  }
}

void smooth_drop(drc *r, size_t layer, eda_box place) {
  smoothings *s = &r->smoothings[layer];
  size_t kept = 0;
  for (size_t i = 0; i < s->n; i++) {
    const smoothing other = {.box = place};
    if (!smoothings_touch(&s->at[i], &other)) s->at[kept++] = s->at[i];
  }
  s->n = kept;
}

/* Return the box of a smoothing, extended by min_mask_width into the polygon
   for a notch, or by min_space outwards for a bump. The extension prevents a
   slit or a sliver if the adjacent edge moves later. */
static eda_box smoothing_box(const drc *r, const smoothing *m) {
  int32_t by =
      (int32_t)((m->bump ? -r->min_space : r->min_mask_width) / r->grid);
  int32_t dx = by * ((m->from.y > m->to.y) - (m->from.y < m->to.y));
  int32_t dy = by * ((m->from.x < m->to.x) - (m->from.x > m->to.x));
  eda_box b = m->box;
  *(dx < 0 ? &b.x0 : &b.x1) += dx;
  *(dy < 0 ? &b.y0 : &b.y1) += dy;
  return b;
}

void smooth_add_boxes(drc *r) {
  for (size_t layer = 0; layer < r->layers; layer++)
    for (size_t i = 0; i < r->smoothings[layer].n; i++) {
      const smoothing *m = &r->smoothings[layer].at[i];
      eda_box_list_add(m->bump ? &r->cutouts[layer] : &r->added[layer],
                       smoothing_box(r, m));
    }
}
