/* SPDX-License-Identifier: BSD-3-Clause */
#include "trims.h"

#include <math.h>
#include <stdlib.h>

/* nm: edges so near before a gate belong to it, or to its line end; beside
   contacts and gates a stretch ends so far off. */
static const double of_gate = 100, beside_it = 20;

void trims_clear(trims *t) {
  free(t->at);
  free(t->pair);
  *t = (trims){0};
}

void trims_begin(trims *t) { t->round++; }

static int upright(int side) { return side == LEFT || side == RIGHT; }

/* ---- how far a wall may go back ---- */

/* A stretch of a wall and what lies behind it. */
typedef struct stretch {
  opc_box wall;
  int behind;            /* the side of it that poly lies on */
  int32_t at;            /* of the gap, along the wall */
  const bins *what;
  int32_t keep, least, beside;
  int32_t from, to, room;
} stretch;

static void shorten(void *data, uint32_t i) {
  stretch *s = data;
  opc_box b = s->what->box[i], w = s->wall;
  int32_t d = s->behind == LEFT    ? w.x0 - b.x1
              : s->behind == RIGHT ? b.x0 - w.x1
              : s->behind == BELOW ? w.y0 - b.y1
                                   : b.y0 - w.y1;
  int32_t room = (d > 0 ? d : 0) - s->keep;
  int32_t low = (upright(s->behind) ? b.y0 : b.x0) - s->beside;
  int32_t high = (upright(s->behind) ? b.y1 : b.x1) + s->beside;
  if (room >= s->least) {
    if (room < s->room) s->room = room;
  } else if (high <= s->at) {
    if (high > s->from) s->from = high;
  } else if (low >= s->at) {
    if (low < s->to) s->to = low;
  } else {
    s->to = s->from;
  }
}

/* Keep away from what lies behind the wall, by `keep` nm. */
static void keep_away(stretch *s, const bins *what, double keep, double grid) {
  s->what = what;
  s->keep = (int32_t)ceil(keep / grid);
  bins_visit(what,
             bins_window(s->wall, s->behind, 0,
                         s->keep + (int32_t)(of_gate / grid), s->beside),
             shorten, s);
}

/* The piece of an edge that may go back before a gap. */
static trim trim_of(const drawing *d, const limits *rules, double grid,
                    opc_box wall, int side, int32_t at) {
  int behind = side ^ 1, along_y = upright(side);
  int32_t far = (int32_t)(of_gate / grid);
  stretch s = {.wall = wall, .behind = behind, .at = at,
               .least = (int32_t)ceil(rules_back / grid),
               .beside = (int32_t)ceil(beside_it / grid),
               .from = along_y ? wall.y0 : wall.x0,
               .to = along_y ? wall.y1 : wall.x1, .room = far};
  keep_away(&s, &d->pads, rules->overlay, grid);
  keep_away(&s, &d->gates, of_gate, grid);
  if (along_y) wall.y0 = s.from, wall.y1 = s.to;
  else wall.x0 = s.from, wall.x1 = s.to;
  trim t = {.wall = wall, .side = side};
  if ((s.to - s.from) * grid < rules->min_space) return t;
  /* The other side of the line may go back as far. */
  int32_t thick = bins_nearest(&d->edges[OPC_POLY],
                               bins_window(wall, behind, 1, 3 * far, 0), behind,
                               3 * far, NULL) + 1;
  double most = fmin(s.room, (thick - rules->mask_width / grid) / 2);
  t.room = most > 0 ? (int32_t)most : 0;
  return t;
}

/* ---- gaps ---- */

/* The edge of poly seen from the middle of a gap. 0 if there is none. */
static int wall_at(const drawing *d, opc_point p, int side, double grid,
                   opc_box *wall) {
  int32_t far = (int32_t)(2 * of_gate / grid);
  opc_box dot = {p.x, p.y, p.x, p.y};
  int32_t found = bins_nearest(&d->edges[OPC_POLY],
                               bins_window(dot, side, 0, far, 1), side, far,
                               wall);
  return found < far &&
         (upright(side) ? wall->x0 == wall->x1 : wall->y0 == wall->y1);
}

/* The number of that trim, which may be there already. -1: no memory. */
static int32_t number_of(trims *t, trim one) {
  for (size_t i = t->n; i-- > 0;) {
    opc_box a = t->at[i].wall, b = one.wall;
    if (t->at[i].side == one.side && a.x0 == b.x0 && a.y0 == b.y0 &&
        a.x1 == b.x1 && a.y1 == b.y1) {
      if (one.front < t->at[i].front) t->at[i].front = one.front;
      return (int32_t)i;
    }
  }
  if (t->n == t->most) {
    size_t most = t->most ? 2 * t->most : 64;
    trim *more = realloc(t->at, most * sizeof *more);
    if (!more) return -1;
    t->at = more;
    t->most = most;
  }
  t->at[t->n] = one;
  return (int32_t)t->n++;
}

static int add_pair(trims *t, const drawing *d, const limits *rules,
                    double grid, site *gap) {
  if (t->pairs == t->most_pairs) {
    size_t most = t->most_pairs ? 2 * t->most_pairs : 64;
    void *more = realloc(t->pair, most * sizeof *t->pair);
    if (!more) return 0;
    t->pair = more;
    t->most_pairs = most;
  }
  int32_t *pair = t->pair[t->pairs];
  opc_point p = {gap->box.x0, gap->box.y0};
  int low = gap->sides & 1 << LEFT ? LEFT : BELOW;
  opc_box wall[2];
  pair[0] = pair[1] = -1;
  gap->repair = (int32_t)t->pairs++;
  if (!wall_at(d, p, low, grid, &wall[0]) ||
      !wall_at(d, p, low + 1, grid, &wall[1]))
    return 1;
  for (int i = 0; i < 2; i++) {   /* as far as they face each other */
    opc_box w = wall[i], o = wall[!i];
    if (low == LEFT) w.y0 = o.y0 > w.y0 ? o.y0 : w.y0, w.y1 = o.y1 < w.y1 ? o.y1 : w.y1;
    else w.x0 = o.x0 > w.x0 ? o.x0 : w.x0, w.x1 = o.x1 < w.x1 ? o.x1 : w.x1;
    trim one = trim_of(d, rules, grid, w, (low + i) ^ 1, low == LEFT ? p.y : p.x);
    one.front = (low == LEFT ? wall[1].x0 - wall[0].x0 : wall[1].y0 - wall[0].y0) / 2;
    if (one.room && (pair[i] = number_of(t, one)) < 0) return 0;
  }
  return 1;
}

int trims_deepen(trims *t, const opc_host *host, const drawing *d,
                 const limits *rules, double grid, site *gap, int *moved,
                 opc_error *error) {
  int32_t step = (int32_t)ceil(rules_back / grid);
  if (gap->repair < 0 && !add_pair(t, d, rules, grid, gap))
    return host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  *moved = 0;
  for (int i = 0; i < 2; i++) {
    int32_t number = t->pair[gap->repair][i];
    if (number < 0) continue;
    trim *one = &t->at[number];
    if (one->round != t->round && one->depth < one->room) {
      one->depth += one->room - one->depth < step ? one->room - one->depth : step;
      one->round = t->round;
    }
    *moved |= one->round == t->round;
  }
  return OPC_OK;
}

int trims_could(const trims *t, const site *gap) {
  if (gap->repair < 0) return 1;   /* never tried */
  for (int i = 0; i < 2; i++) {
    int32_t number = t->pair[gap->repair][i];
    if (number >= 0 && t->at[number].depth < t->at[number].room) return 1;
  }
  return 0;
}

int trims_bites(const trims *t, box_list *out) {
  int good = 1;
  for (size_t i = 0; i < t->n && good; i++) {
    const trim *one = &t->at[i];
    if (one->depth)
      good = boxes_add(out, bins_window(one->wall, one->side ^ 1, -one->front,
                                        one->depth, 0));
  }
  return good;
}
