/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements trims: inward displacements of poly edges at bridged gaps. */
#include <eda/memory.h>
#include <math.h>
#include <string.h>

#include "drc.h"
#include "tuning.h"

/* ---- limits of trims ---- */

/* The stretch of a drawn edge (wall) that may be trimmed; lengths in steps. */
typedef struct stretch {
  eda_box wall;
  int behind;              /* direction from the wall into the poly */
  int32_t at;              /* position of the gap along the wall */
  int32_t least, beside;   /* smallest depth; smallest distance along the wall
                              from gates and contacts */
  int32_t from, to, limit; /* ends of the stretch; largest depth */
} stretch;

/* Keep the distance `keep` between the trimmed wall and a box behind the wall:
   limit the depth or, if the depth would be less than `least`, end the stretch
   before the box. */
static void stretch_shorten(stretch *s, eda_box b, int32_t keep) {
  eda_box w = s->wall;
  int32_t d = s->behind == LEFT    ? w.x0 - b.x1
              : s->behind == RIGHT ? b.x0 - w.x1
              : s->behind == BELOW ? w.y0 - b.y1
                                   : b.y0 - w.y1;
  int32_t limit = (d > 0 ? d : 0) - keep;
  int32_t low = (side_upright(s->behind) ? b.y0 : b.x0) - s->beside;
  int32_t high = (side_upright(s->behind) ? b.y1 : b.x1) + s->beside;
  if (limit >= s->least) {
    if (limit < s->limit) s->limit = limit;
  } else if (high <= s->at) {
    if (high > s->from) s->from = high;
  } else if (low >= s->at) {
    if (low < s->to) s->to = low;
  } else {
    s->to = s->from;
  }
}

/* Keep the trimmed wall at the distance `nm` from all boxes behind the wall. */
static void stretch_keep_away(const drc *r, stretch *s, const places *what,
                              double nm) {
  int32_t keep = (int32_t)ceil(nm / r->grid);
  int32_t far = keep + (int32_t)(tuned.of_gate / r->grid);
  eda_finder f = eda_index_find(
      what->index, box_window(s->wall, s->behind, 0, far, s->beside));
  for (uint32_t i; eda_index_next(&f, &i);)
    stretch_shorten(s, what->box[i], keep);
}

/* Return the largest permitted trim of an edge at a gap; the limit is 0 if the
   stretch would be shorter than min_space. */
static trim trim_of(const drc *r, eda_box wall, int side, int32_t at) {
  int behind = side_opposite(side), along_y = side_upright(side);
  int32_t far = (int32_t)(tuned.of_gate / r->grid);
  stretch s = {.wall = wall,
               .behind = behind,
               .at = at,
               .least = (int32_t)ceil(tuned.back / r->grid),
               .beside = (int32_t)ceil(tuned.beside / r->grid),
               .from = along_y ? wall.y0 : wall.x0,
               .to = along_y ? wall.y1 : wall.x1,
               .limit = far};
  stretch_keep_away(r, &s, &r->pads, r->overlay);
  stretch_keep_away(r, &s, &r->boxes, tuned.of_gate);
  if (along_y)
    wall.y0 = s.from, wall.y1 = s.to;
  else
    wall.x0 = s.from, wall.x1 = s.to;
  trim t = {.wall = wall, .side = side};
  if ((s.to - s.from) * r->grid < r->min_space) return t;
  /* The opposite edge of the line may be trimmed by the same depth. */
  int32_t thick = places_nearest(&r->edges[EDA_POLY],
                                 box_window(wall, behind, 1, 3 * far, 0),
                                 behind, 3 * far, NULL) +
                  1;
  double most = fmin(s.limit, (thick - r->min_mask_width / r->grid) / 2);
  t.limit = most > 0 ? (int32_t)most : 0;
  return t;
}

/* ---- gaps ---- */

/* Find the poly edge on a side of the centre p of a gap. Return 0 if no
   straight edge is near. */
static int wall_at(const drc *r, eda_point p, int side, eda_box *wall) {
  int32_t far = (int32_t)(2 * tuned.of_gate / r->grid);
  eda_box dot = {p.x, p.y, p.x, p.y};
  int32_t found = places_nearest(
      &r->edges[EDA_POLY], box_window(dot, side, 0, far, 1), side, far, wall);
  return found < far &&
         (side_upright(side) ? wall->x0 == wall->x1 : wall->y0 == wall->y1);
}

/* Return the index of a trim; add the trim if it is new. */
static int32_t trim_index(drc *r, trim one) {
  for (size_t i = r->n_trims; i-- > 0;) {
    trim *t = &r->trims[i];
    if (t->side != one.side || memcmp(&t->wall, &one.wall, sizeof one.wall))
      continue;
    if (one.front < t->front) t->front = one.front;
    return (int32_t)i;
  }
  eda_grow(&r->trims, &r->trims_capacity, r->n_trims + 1, sizeof one);
  r->trims[r->n_trims] = one;
  return (int32_t)r->n_trims++;
}

static void add_pair(drc *r, site *gap) {
  eda_point p = {gap->box.x0, gap->box.y0};
  int low = gap->sides & 1 << LEFT ? LEFT : BELOW;
  eda_box wall[2];
  eda_grow(&r->pairs, &r->pairs_capacity, r->n_pairs + 1, sizeof *r->pairs);
  int32_t *pair = r->pairs[r->n_pairs];
  pair[0] = pair[1] = -1;
  gap->repair = (int32_t)r->n_pairs++;
  if (!wall_at(r, p, low, &wall[0]) || !wall_at(r, p, low + 1, &wall[1]))
    return;
  for (int i = 0; i < 2; i++) { /* trim both walls over their common extent */
    eda_box w = wall[i], o = wall[!i];
    if (low == LEFT) {
      w.y0 = o.y0 > w.y0 ? o.y0 : w.y0;
      w.y1 = o.y1 < w.y1 ? o.y1 : w.y1;
    } else {
      w.x0 = o.x0 > w.x0 ? o.x0 : w.x0;
      w.x1 = o.x1 < w.x1 ? o.x1 : w.x1;
    }
    trim one = trim_of(r, w, side_opposite(low + i), low == LEFT ? p.y : p.x);
    one.front =
        (low == LEFT ? wall[1].x0 - wall[0].x0 : wall[1].y0 - wall[0].y0) / 2;
    if (one.limit) pair[i] = trim_index(r, one);
  }
}

int trims_deepen(drc *r, site *gap) {
  int32_t step = (int32_t)ceil(tuned.back / r->grid);
  int moved = 0;
  if (gap->repair < 0) add_pair(r, gap);
  for (int i = 0; i < 2; i++) {
    int32_t number = r->pairs[gap->repair][i];
    if (number < 0) continue;
    trim *one = &r->trims[number];
    int32_t left = one->limit - one->depth;
    if (one->round != r->round && left > 0) {
      one->depth += left < step ? left : step;
      one->round = r->round;
    }
    moved |= one->round == r->round;
  }
  return moved;
}

int trims_revert(drc *r, const site *line) {
  int32_t step = (int32_t)ceil(tuned.back / r->grid);
  int32_t far = (int32_t)(tuned.wide / 2 / r->grid);
  int moved = 0;
  for (size_t i = 0; i < r->n_trims; i++) {
    trim *t = &r->trims[i];
    eda_box on = box_window(t->wall, side_opposite(t->side), 0, far, 0);
    if (!t->depth || !eda_boxes_touch(line->box, on)) continue;
    moved = 1;
    if (t->round == r->round) continue;
    t->depth -= t->depth < step ? t->depth : step;
    t->limit = t->depth;
    t->round = r->round;
  }
  return moved;
}

int trims_can_deepen(const drc *r, const site *gap) {
  if (gap->repair < 0) return 1; /* no trim has been tried yet */
  for (int i = 0; i < 2; i++) {
    int32_t number = r->pairs[gap->repair][i];
    if (number >= 0 && r->trims[number].depth < r->trims[number].limit)
      return 1;
  }
  return 0;
}

void trims_add_cutouts(drc *r) {
  for (size_t i = 0; i < r->n_trims; i++) {
    const trim *t = &r->trims[i];
    if (t->depth)
      eda_box_list_add(
          &r->cutouts[EDA_POLY],
          box_window(t->wall, side_opposite(t->side), -t->front, t->depth, 0));
  }
}
