/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the placement of a cell's displacements. Each transistor is
   matched separately, because the rounding to the grid, and the fragments next
   to a neighbour, may differ between cell and circuit. */
#include "stitch.h"

#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Tolerance when the centres of two boxes are compared, in half grid steps.
   Each edge may be rounded by half a step in the cell and in the circuit, and
   the sums of two edges are compared. */
enum { NEAR = 4 };

void stitch_init(stitch *s, const eda_gates *gates, double unit) {
  *s = (stitch){.gates = gates, .unit = unit};
  s->moved = eda_moved_new(gates->layers, gates->count);
  s->known = eda_alloc(gates->count, 1);
  s->index = eda_index_new(gates->box, gates->count, 0);
  eda_performance_init(&s->cell, gates->count);
}

void stitch_clear(stitch *s) {
  eda_moved_free(s->moved);
  free(s->known);
  eda_index_free(s->index);
  eda_performance_clear(&s->cell);
}

/* ---- positions ---- */

/* Return a box of a cell, rotated about the cell's origin. */
static eda_box box_turned(const turn *t, eda_box b) {
  int32_t x0 = t->xx * b.x0 + t->xy * b.y0, x1 = t->xx * b.x1 + t->xy * b.y1,
          y0 = t->yx * b.x0 + t->yy * b.y0, y1 = t->yx * b.x1 + t->yy * b.y1;
  return (eda_box){x0 < x1 ? x0 : x1, y0 < y1 ? y0 : y1, x0 < x1 ? x1 : x0,
                   y0 < y1 ? y1 : y0};
}

static int same_size(double a, double b) { return fabs(a - b) < 1e-6 * b; }

/* Return the transistor of the circuit that matches transistor j of the cell;
   -1: none. */
static int64_t find_gate(const stitch *s, const entry *e, const turn *t,
                         size_t j) {
  const eda_gates *g = s->gates;
  double steps = s->unit / g->grid;
  eda_box b = box_turned(t, e->box[j]);
  /* twice the coordinates of the centre */
  double x = (double)b.x0 + b.x1 + 2 * steps * (double)t->dx,
         y = (double)b.y0 + b.y1 + 2 * steps * (double)t->dy;
  int axis = t->xy ? EDA_X + EDA_Y - e->axis[j] : e->axis[j];
  int32_t cx = (int32_t)lround(x / 2), cy = (int32_t)lround(y / 2);
  eda_finder f = eda_index_find(s->index, (eda_box){cx, cy, cx, cy});
  for (uint32_t i; eda_index_next(&f, &i);) {
    eda_box o = g->box[i];
    if (fabs((double)o.x0 + o.x1 - x) <= NEAR &&
        fabs((double)o.y0 + o.y1 - y) <= NEAR && g->axis[i] == axis &&
        g->type[i] == e->type[j] &&
        !strcmp(eda_gates_flavour(g, i), e->flavour[j]) &&
        same_size(g->length[i], e->length[j]) &&
        same_size(g->width[i], e->width[j]))
      return i;
  }
  return -1;
}

/* ---- displacements ---- */

/* Copy the parts of a gate, in ascending order from the LOW end in the circuit.
   `backwards`: 1: the placement exchanges the ends of the width. */
static void turn_parts(const eda_part *from, int32_t width, int backwards,
                       eda_part *to) {
  int n = 0;
  while (n < EDA_PARTS && from[n].from < from[n].to) n++;
  for (int k = 0; k < n; k++) {
    const eda_part *p = &from[backwards ? n - 1 - k : k];
    to[k] = backwards ? (eda_part){width - p->to, width - p->from, p->by} : *p;
  }
}

static void take_gate(stitch *s, const entry *e, const turn *t, size_t j,
                      size_t i) {
  const eda_moved *from = e->moved;
  eda_moved *to = s->moved;
  int upright = e->axis[j] == EDA_X;
  int x_back = t->xx + t->yx < 0, y_back = t->xy + t->yy < 0;
  int l_back = upright ? x_back : y_back, w_back = upright ? y_back : x_back;
  eda_box b = s->gates->box[i];
  int32_t width = s->gates->axis[i] == EDA_X ? b.y1 - b.y0 : b.x1 - b.x0;
  to->w[i] = from->w[j];
  to->aside[i] = w_back ? -from->aside[j] : from->aside[j];
  to->l[i] = from->l[j];
  to->jog[i] = from->jog[j];
  to->end[2 * i] = from->end[2 * j + (size_t)w_back];
  to->end[2 * i + 1] = from->end[2 * j + !w_back];
  to->flip[i] =
      (uint8_t)((l_back ? EDA_FLIP_L : 0) | (w_back ? EDA_FLIP_W : 0));
  turn_parts(from->part + EDA_PARTS * j, width, w_back,
             to->part + EDA_PARTS * i);
  to->seen[i] = from->seen[j];
  s->known[i] = 1;
  for (int k = 0; k < 6; k++) (&s->cell.ion)[k][i] = (&e->after.ion)[k][j];
}

/* ---- added shapes ---- */

/* Return the displacement, along one axis, of a transistor's edge from the
   rotated cell (low, high) to the circuit (to_low, to_high). The edge is the
   one nearer to `middle`, the centre of an added shape, so that edge and shape
   stay in contact. */
static int32_t edge_offset(int32_t middle, int32_t low, int32_t high,
                           int32_t to_low, int32_t to_high) {
  return 2 * (int64_t)middle > (int64_t)low + high ? to_high - high
                                                   : to_low - low;
}

/* Copy an added shape or a cut-out of the cell to the circuit. The shape moves
   with the nearest matched transistor, whose edges were rounded to the grid.
   Without a matched transistor, the shape is omitted. */
static void take_box(const stitch *s, const entry *e, const turn *t,
                     const int64_t *match, eda_box box, eda_box_list *to) {
  size_t nearest = e->gates;
  double least = INFINITY;
  for (size_t j = 0; j < e->gates; j++) {
    double d = match[j] < 0 ? INFINITY : eda_box_distance(box, e->box[j]);
    if (!(d < least)) continue;
    least = d;
    nearest = j;
  }
  if (nearest == e->gates) return;
  eda_box b = box_turned(t, box), from = box_turned(t, e->box[nearest]),
          at = s->gates->box[match[nearest]];
  int32_t dx = edge_offset((b.x0 + b.x1) / 2, from.x0, from.x1, at.x0, at.x1);
  int32_t dy = edge_offset((b.y0 + b.y1) / 2, from.y0, from.y1, at.y0, at.y1);
  eda_box_list_add(to, (eda_box){b.x0 + dx, b.y0 + dy, b.x1 + dx, b.y1 + dy});
}

static void take_boxes(stitch *s, const entry *e, const turn *t,
                       const int64_t *match) {
  for (size_t k = 0; k < e->layers; k++) {
    const eda_box_list *added = &e->moved->added[k],
                       *cutouts = &e->moved->cutouts[k];
    int layer = eda_gates_layer(s->gates, e->layer[k]);
    if (layer < 0) continue;
    for (size_t i = 0; i < added->count; i++)
      take_box(s, e, t, match, added->box[i], &s->moved->added[layer]);
    for (size_t i = 0; i < cutouts->count; i++)
      take_box(s, e, t, match, cutouts->box[i], &s->moved->cutouts[layer]);
  }
}

size_t stitch_place(stitch *s, const entry *e, const turn *t) {
  size_t lost = 0;
  int64_t *match = eda_alloc(e->gates, sizeof *match);
  for (size_t j = 0; j < e->gates; j++) {
    match[j] = find_gate(s, e, t, j);
    if (match[j] < 0)
      lost++;
    else
      take_gate(s, e, t, j, (size_t)match[j]);
  }
  take_boxes(s, e, t, match);
  free(match);
  return lost;
}
