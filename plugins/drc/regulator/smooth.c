/* SPDX-License-Identifier: BSD-3-Clause */
/* What was mended is not there to be found again, and what mended it may stick out
   once the edges beside it have moved: it stays while its edge is one of the
   mask. */
#include "smooth.h"

#include <math.h>
#include <stdlib.h>

#include "bins.h"

/* nm: jogs of synthesizers and steps between patches are so deep; deeper ones have
   a meaning of their own. */
static const double shallow = 10;

/* So that it comes to an end. */
enum { PATIENCE = 1000 };

void smoothing_clear(smoothing *s) {
  for (int layer = 0; layer < OPC_MASKS; layer++) free(s->at[layer]);
  *s = (smoothing){0};
}

static int add(smoothing *s, int layer, mend one) {
  if (s->n[layer] == s->most[layer]) {
    size_t most = s->most[layer] ? 2 * s->most[layer] : 64;
    mend *more = realloc(s->at[layer], most * sizeof *more);
    if (!more) return 0;
    s->at[layer] = more;
    s->most[layer] = most;
  }
  s->at[layer][s->n[layer]++] = one;
  return 1;
}

static opc_box box_of(opc_point a, opc_point b) {
  return (opc_box){a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y,
                   a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y};
}

static int turns_left(opc_point a, opc_point b, opc_point c) {
  return ((int64_t)b.x - a.x) * ((int64_t)c.y - b.y) >
         ((int64_t)b.y - a.y) * ((int64_t)c.x - b.x);
}

/* ---- what stays ---- */

typedef struct edge {
  mend *at;
  const opc_point *q;      /* the edge is q[1] to q[2] */
} edge;

static int between(int32_t v, int32_t a, int32_t b) {
  return a < b ? v >= a && v <= b : v >= b && v <= a;
}

/* An end of the mended edge that is one of the mask's: what is beside it must lie
   further out than a notch did, or further in than a bump. */
static int good_corner(const mend *m, opc_point end, opc_point a, opc_point b,
                       opc_point c) {
  return end.x != b.x || end.y != b.y || turns_left(a, b, c) == m->bump;
}

static void confirm(void *data, uint32_t i) {
  const edge *e = data;
  const opc_point *q = e->q;
  mend *m = &e->at[i];
  int same_way = q[1].y == q[2].y
                     ? m->from.y == q[1].y && m->to.y == q[1].y &&
                           (m->to.x > m->from.x) == (q[2].x > q[1].x)
                     : m->from.x == q[1].x && m->to.x == q[1].x &&
                           (m->to.y > m->from.y) == (q[2].y > q[1].y);
  if (same_way && between(m->from.x, q[1].x, q[2].x) &&
      between(m->from.y, q[1].y, q[2].y) && between(m->to.x, q[1].x, q[2].x) &&
      between(m->to.y, q[1].y, q[2].y) &&
      good_corner(m, m->from, q[0], q[1], q[2]) &&
      good_corner(m, m->to, q[1], q[2], q[3]))
    m->stays = 1;
}

static void corners(const opc_shapes *mask, size_t p, uint32_t i,
                    opc_point q[4]) {
  const opc_point *at = mask->points + mask->start[p];
  uint32_t n = mask->start[p + 1] - mask->start[p];
  for (uint32_t k = 0; k < 4; k++) q[k] = at[(i + k) % n];
}

/* Mark those that stay. */
static int look(smoothing *s, int layer, const opc_shapes *mask, double grid) {
  size_t n = s->n[layer];
  mend *at = s->at[layer];
  bins b = {0};
  if (!n) return 1;
  opc_box *box = malloc(n * sizeof *box);
  for (size_t i = 0; box && i < n; i++) {
    box[i] = box_of(at[i].from, at[i].to);
    at[i].stays = 0;
  }
  if (!bins_make(&b, box, n, (int32_t)(1000 / grid) + 1)) {
    bins_clear(&b);
    return 0;
  }
  for (size_t p = 0; p < mask->count; p++)
    for (uint32_t i = 0; i < mask->start[p + 1] - mask->start[p]; i++) {
      opc_point q[4];
      corners(mask, p, i, q);
      edge e = {at, q};
      bins_visit(&b, box_of(q[1], q[2]), confirm, &e);
    }
  bins_clear(&b);
  return 1;
}

/* ---- what is found ---- */

static int32_t length(opc_point a, opc_point b) {
  return abs(b.x - a.x) + abs(b.y - a.y);
}

static int touch(const mend *a, const mend *b) {
  return a->box.x0 <= b->box.x1 && b->box.x0 <= a->box.x1 &&
         a->box.y0 <= b->box.y1 && b->box.y0 <= a->box.y1;
}

/* A bump beside a notch may be wide enough once that is filled, and the next look
   tells. A notch beside what was a bump comes of its having gone: that returns, and
   both are looked at again. `before`: how many there were before this look. */
static int must_wait(smoothing *s, int layer, const mend *m, size_t before) {
  int wait = 0;
  for (size_t i = m->bump ? before : 0; i < s->n[layer]; i++) {
    mend *o = &s->at[layer][i];
    if (!o->stays || o->bump == m->bump || !touch(o, m)) continue;
    wait = 1;
    if (m->bump || s->undone >= PATIENCE) continue;
    o->stays = 0;
    s->undone++;
  }
  return wait;
}

/* Of those that do not stay, what is found now may be the other half. */
static void drop(smoothing *s, int layer, size_t before) {
  mend *at = s->at[layer];
  size_t kept = 0;
  for (size_t i = 0; i < s->n[layer]; i++) {
    for (size_t k = before; !at[i].stays && k < s->n[layer]; k++)
      at[i].stays = at[i].bump == at[k].bump && touch(&at[i], &at[k]);
    if (at[i].stays) at[kept++] = at[i];
  }
  s->n[layer] = kept;
}

/* From q[1] to q[2], if it is the bottom of a notch or the top of a bump, as deep
   as both of its jogs are. */
static int find(smoothing *s, int layer, const opc_point q[4],
                const limits *rules, double grid, int bump, size_t before) {
  double least = bump ? rules->mask_width : rules->min_space;
  int32_t first = length(q[0], q[1]), last = length(q[2], q[3]);
  int32_t depth = first < last ? first : last;
  if (turns_left(q[0], q[1], q[2]) != bump ||
      turns_left(q[1], q[2], q[3]) != bump || depth * grid > shallow ||
      length(q[1], q[2]) * grid > least - 1e-9)
    return 1;
  int32_t dx = depth * ((q[0].x > q[1].x) - (q[0].x < q[1].x));
  int32_t dy = depth * ((q[0].y > q[1].y) - (q[0].y < q[1].y));
  mend one = {.from = {q[1].x + dx, q[1].y + dy},
              .to = {q[2].x + dx, q[2].y + dy},
              .bump = (uint8_t)bump, .stays = 1};
  one.box = box_of(one.from, q[2]);
  return must_wait(s, layer, &one, before) || add(s, layer, one);
}

int smoothing_follow(smoothing *s, const opc_printed *p, const limits *rules) {
  int good = 1;
  double grid = p->gates->grid;
  for (int layer = 0; layer < OPC_MASKS && good && p->mask; layer++) {
    const opc_shapes *mask = &p->mask[layer];
    size_t before = s->n[layer];
    good = look(s, layer, mask, grid);
    for (int bump = 0; bump < 2; bump++)
      for (size_t k = 0; k < mask->count; k++) {
        uint32_t n = mask->start[k + 1] - mask->start[k];
        for (uint32_t i = 0; n > 4 && i < n && good; i++) {
          opc_point q[4];
          corners(mask, k, i, q);
          good = find(s, layer, q, rules, grid, bump, before);
        }
      }
    drop(s, layer, before);
  }
  return good;
}

int smoothing_boxes(const smoothing *s, box_list patch[OPC_MASKS],
                    box_list bite[OPC_MASKS]) {
  int good = 1;
  for (int layer = 0; layer < OPC_MASKS; layer++)
    for (size_t i = 0; i < s->n[layer] && good; i++) {
      const mend *m = &s->at[layer][i];
      good = boxes_add(m->bump ? &bite[layer] : &patch[layer], m->box);
    }
  return good;
}
