/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the segments of drawn edges that repair shapes displace, and the
   limits of the displacement. */
#include <math.h>

#include "drc.h"
#include "tuning.h"

/* Return the outward displacement of a corner by a change of a gate's width:
   half of the change, plus the lateral shift of the gate towards the corner.
   The high side has the odd grid step of the change. */
static int32_t corner_move(const eda_printed *p, const eda_fragment *f) {
  if (!f) return 0;
  int32_t w = p->w[f->gate], low = w >> 1;
  int32_t aside = p->aside ? p->aside[f->gate] : 0;
  return f->role == EDA_W_LOW ? low - aside : w - low + aside;
}

void repair_veto(const drc *r, const eda_printed *p, const repair *one,
                 uint32_t *vetoes) {
  const site *s = &r->sites[one->site];
  if (s->layer != EDA_ACTIVE) return;
  for (int k = 0; k < SIDES; k++) {
    if (!(s->failing & 1 << k) || one->grow[k] < one->limit[k]) continue;
    eda_finder f = eda_index_find(
        r->widths.index, box_window(s->box, k, one->edge[k], one->edge[k], 0));
    for (uint32_t i; eda_index_next(&f, &i);)
      if (corner_move(p, r->width[i]) < 0)
        vetoes[r->width[i]->gate] |= EDA_VETO_NARROWER;
  }
}

/* Return 1 if the segment on `side` ends at the edge on the side `next`. */
static int segment_reaches(const drc *r, const repair *one, int side,
                           int next) {
  eda_box b = r->sites[one->site].box;
  switch (next) {
    case LEFT:
      return one->from[side] == b.x0 - one->edge[next];
    case RIGHT:
      return one->to[side] == b.x1 + one->edge[next];
    case BELOW:
      return one->from[side] == b.y0 - one->edge[next];
    default:
      return one->to[side] == b.y1 + one->edge[next];
  }
}

/* Return the extension of the repair shape on `side` over a corner shared with
   the repair shape on the adjacent side `next`; 0 if no corner is shared. */
static int32_t segment_overlap(const drc *r, const repair *one, int side,
                               int next) {
  return segment_reaches(r, one, side, next) &&
                 segment_reaches(r, one, next, side)
             ? one->grow[next]
             : 0;
}

/* Return the extension of the end of a repair shape into a concave corner,
   whose adjacent edge may have been displaced inwards; 0 if the corner is not
   concave. */
static int32_t segment_into_corner(const drc *r, const repair *one, int side,
                                   int32_t at) {
  eda_box c = r->sites[one->site].box;
  const places *edges = &r->edges[r->sites[one->site].layer];
  c = box_window(c, side, one->edge[side], one->edge[side], 0);
  if (side_upright(side))
    c.y0 = c.y1 = at;
  else
    c.x0 = c.x1 = at;
  eda_finder f = eda_index_find(edges->index, c);
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box e = edges->box[i];
    if (side == LEFT    ? e.x0 < c.x0
        : side == RIGHT ? e.x1 > c.x0
        : side == BELOW ? e.y0 < c.y0
                        : e.y1 > c.y0)
      return (int32_t)ceil(tuned.into / r->grid);
  }
  return 0;
}

eda_box repair_shape(const drc *r, const eda_printed *printed,
                     const repair *one, int side) {
  int32_t in = (int32_t)ceil(r->min_mask_width / r->grid - 1e-9);
  int32_t out = one->edge[side] + one->grow[side];
  int low = side_upright(side) ? BELOW : LEFT;
  eda_box b = r->sites[one->site].box;
  eda_box p = box_window(b, side, one->edge[side] - in, out, 0);
  int32_t from = one->from[side] - corner_move(printed, one->corner[side][0]) -
                 segment_overlap(r, one, side, low) -
                 segment_into_corner(r, one, side, one->from[side]);
  int32_t to = one->to[side] + corner_move(printed, one->corner[side][1]) +
               segment_overlap(r, one, side, low + 1) +
               segment_into_corner(r, one, side, one->to[side]);
  if (side_upright(side))
    p.y0 = from, p.y1 = to;
  else
    p.x0 = from, p.x1 = to;
  return p;
}

/* Return the distance to the next edge of the same layer. Edges that only touch
   the border of the window are ignored: they form a concave corner, which the
   mask may fill. */
static int32_t layer_spacing(const places *edges, eda_box window, int side,
                             int32_t none) {
  eda_finder f = eda_index_find(edges->index, window);
  int32_t found = none;
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box e = edges->box[i], w = window;
    if (e.x0 >= w.x1 || e.x1 <= w.x0 || e.y0 >= w.y1 || e.y1 <= w.y0) continue;
    int32_t d = side == LEFT    ? w.x1 - e.x1
                : side == RIGHT ? e.x0 - w.x0
                : side == BELOW ? w.y1 - e.y1
                                : e.y0 - w.y0;
    if (d >= 0 && d < found) found = d;
  }
  return found;
}

/* Return the largest outward displacement on a side. A facing edge of the same
   layer may move as far, so half of the spacing is available. Contacts, and
   active for poly or poly for active, are assumed not to move. */
static int32_t outward_limit(const drc *r, const site *s, const repair *one,
                             int side) {
  double grid = r->grid;
  int32_t beside = (int32_t)ceil(r->min_space / grid);
  int32_t range = (int32_t)ceil((2 * r->max_growth + r->min_space) / grid) + 1;
  eda_box edge = box_window(s->box, side, one->edge[side], one->edge[side], 0);
  if (side_upright(side))
    edge.y0 = one->from[side], edge.y1 = one->to[side];
  else
    edge.x0 = one->from[side], edge.x1 = one->to[side];
  eda_box window = box_window(edge, side, 1, range, beside);
  double own = layer_spacing(&r->edges[s->layer], window, side, range) + 1;
  double other = range;
  window = box_window(edge, side, 0, range, beside);
  if (s->layer <= EDA_ACTIVE && r->layers > EDA_ACTIVE)
    other = places_nearest(&r->edges[!s->layer], window, side, range, NULL);
  if (s->layer == EDA_POLY)
    other =
        fmin(other, places_nearest(&r->contacts, window, side, range, NULL));
  double most =
      fmin((own * grid - r->min_space) / 2, other * grid - r->min_space);
  return (int32_t)floor(fmax(0, fmin(r->max_growth, most)) / grid + 1e-9);
}

/* Return the active edge that displaces the corner (x, y) of the edge on
   `side`, or NULL if the corner is not displaced. */
static const eda_fragment *corner_edge(const drc *r, int side, int32_t x,
                                       int32_t y) {
  const eda_fragment *found = NULL;
  eda_finder f = eda_index_find(r->widths.index, (eda_box){x, y, x, y});
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box e = r->widths.box[i];
    if (side_upright(side) ? e.y0 == e.y1 : e.x0 == e.x1) found = r->width[i];
  }
  return found;
}

/* Extend a segment to the corners of its drawn edge within tuned.corner. */
static void segment_snap(const drc *r, repair *one, int side, eda_box edge) {
  int32_t low = side_upright(side) ? edge.y0 : edge.x0;
  int32_t high = side_upright(side) ? edge.y1 : edge.x1;
  int32_t near = (int32_t)(tuned.corner / r->grid);
  if (one->from[side] - low <= near) one->from[side] = low;
  if (high - one->to[side] <= near) one->to[side] = high;
}

/* Compute the segment of the drawn edge in front of a side of the site,
   extended to corners within tuned.corner. Return 1 if the site is a contact
   and the edge (in `edge`) is parallel to the side. */
static int repair_find_segment(const drc *r, const site *s, repair *one,
                               int side, eda_box *edge) {
  double grid = r->grid;
  int32_t far = (int32_t)(2 * tuned.reach / grid), more = 0;
  eda_box b = s->box;
  /* The window begins one step inside, to include an edge on the side. */
  one->edge[side] =
      places_nearest(&r->edges[s->layer], box_window(b, side, -1, far, 0), side,
                     far + 1, edge) -
      1;
  if (s->kind == SITE_LINE) more = (int32_t)(tuned.half_added / grid);
  one->from[side] = (side_upright(side) ? b.y0 : b.x0) - more;
  one->to[side] = (side_upright(side) ? b.y1 : b.x1) + more;
  if (s->kind == SITE_LINE || one->edge[side] == far ||
      (side_upright(side) ? edge->x0 != edge->x1 : edge->y0 != edge->y1))
    return 0;
  segment_snap(r, one, side, *edge);
  return 1;
}

/* Find the active edges that displace the corners at the segment's ends. */
static void repair_find_corners(const drc *r, const site *s, repair *one,
                                int side, eda_box edge) {
  int32_t low = side_upright(side) ? edge.y0 : edge.x0;
  int32_t high = side_upright(side) ? edge.y1 : edge.x1;
  if (s->layer != EDA_ACTIVE) return;
  one->corner[side][0] =
      one->from[side] == low ? corner_edge(r, side, edge.x0, edge.y0) : NULL;
  one->corner[side][1] =
      one->to[side] == high ? corner_edge(r, side, edge.x1, edge.y1) : NULL;
}

void repair_find_edge(const drc *r, const site *s, repair *one, int side) {
  eda_box edge = {0};
  int straight = repair_find_segment(r, s, one, side, &edge);
  one->limit[side] = outward_limit(r, s, one, side);
  if (!straight) return;
  repair whole = *one;
  whole.from[side] = side_upright(side) ? edge.y0 : edge.x0;
  whole.to[side] = side_upright(side) ? edge.y1 : edge.x1;
  whole.whole[side] =
      whole.from[side] < one->from[side] || whole.to[side] > one->to[side];
  whole.limit[side] = outward_limit(r, s, &whole, side);
  if (whole.limit[side] >= one->limit[side]) *one = whole;
  repair_find_corners(r, s, one, side, edge);
}

void repair_keep_segment(const drc *r, const site *s, repair *one, int side) {
  eda_box edge = {0};
  repair_find_segment(r, s, one, side, &edge);
  repair_find_corners(r, s, one, side, edge);
  one->whole[side] = 0;
  one->limit[side] = outward_limit(r, s, one, side);
}

/* Find the drawn edge that contains a part of a segment. Return 0 if there is
   none. */
static int segment_find_edge(const drc *r, const repair *one, int side,
                             eda_box *edge) {
  const site *s = &r->sites[one->site];
  const places *edges = &r->edges[s->layer];
  int32_t at = one->edge[side];
  int upright = side_upright(side);
  eda_finder f =
      eda_index_find(edges->index, box_window(s->box, side, at, at, 0));
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box e = edges->box[i];
    if ((upright ? e.x0 != e.x1 : e.y0 != e.y1) ||
        (upright ? e.y0 : e.x0) >= one->to[side] ||
        (upright ? e.y1 : e.x1) <= one->from[side])
      continue;
    *edge = e;
    return 1;
  }
  return 0;
}

/* Extend a segment over an edge of the mask if that is a part of the drawn edge
   and begins at an end of `shape`, the shape of the segment. `x`, `y`: middle
   of the edge; `n`: its length; grid units. */
static void segment_cover(eda_box shape, repair *one, int side, double x,
                          double y, double n) {
  int upright = side_upright(side);
  double middle = upright ? y : x, beside = upright ? x : y;
  double drawn = side == LEFT    ? shape.x0 + one->grow[side]
                 : side == RIGHT ? shape.x1 - one->grow[side]
                 : side == BELOW ? shape.y0 + one->grow[side]
                                 : shape.y1 - one->grow[side];
  if (fabs(beside - drawn) > 1) return;
  if (fabs(middle - n / 2 - (upright ? shape.y1 : shape.x1)) < 0.1)
    one->to[side] += (int32_t)lround(n);
  if (fabs(middle + n / 2 - (upright ? shape.y0 : shape.x0)) < 0.1)
    one->from[side] -= (int32_t)lround(n);
}

void repair_extend(const drc *r, const eda_printed *printed, repair *one,
                   int side, const eda_rule_fault *at) {
  const site *s = &r->sites[one->site];
  repair longer = *one;
  eda_box edge;
  if (!segment_find_edge(r, one, side, &edge)) return;
  segment_snap(r, &longer, side, edge);
  if (longer.from[side] > one->from[side]) longer.from[side] = one->from[side];
  if (longer.to[side] < one->to[side]) longer.to[side] = one->to[side];
  if (s->layer == EDA_POLY && longer.from[side] == one->from[side] &&
      longer.to[side] == one->to[side])
    segment_cover(repair_shape(r, printed, one, side), &longer, side,
                  at->x / r->grid, at->y / r->grid, at->value / r->grid);
  if (longer.from[side] == one->from[side] && longer.to[side] == one->to[side])
    return;
  int32_t most = outward_limit(r, s, &longer, side);
  if (most < one->grow[side]) return;
  if (most < one->limit[side]) longer.limit[side] = most;
  repair_find_corners(r, s, &longer, side, edge);
  *one = longer;
}
