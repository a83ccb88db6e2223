/* SPDX-License-Identifier: BSD-3-Clause */
#include "rules.h"

#include <math.h>
#include <stdlib.h>

/* nm of print for each nm of mask: what is taken at first, and what a secant
   may say (prints that come and go have any). */
static const double usual = 0.8, least = 0.3, most = 2;

/* A mask edge moves at most so far at a time, nm. */
static const double largest_step = 60;

/* What is aimed at beyond the target, nm, so that what the synthesizer moves
   later does not undo it at once. */
static const double spare = 1;

int32_t rules_advance(response *r, int32_t bias, double value, double target,
                      double steep, double grid) {
  double slope = usual * steep;
  if (r->seen && bias != r->bias)
    slope = (value - r->value) / ((bias - (double)r->bias) * grid);
  slope = fmin(fmax(slope, least * steep), most * steep);
  *r = (response){bias, value, 1};
  double step = fmin((target + spare - value) / slope, largest_step);
  return bias + (int32_t)ceil(fmax(step, 0) / grid - 1e-9);
}

int boxes_add(box_list *b, opc_box one) {
  if (b->n == b->most) {
    size_t room = b->most ? 2 * b->most : 64;
    opc_box *more = realloc(b->at, room * sizeof *more);
    if (!more) return 0;
    b->at = more;
    b->most = room;
  }
  b->at[b->n++] = one;
  return 1;
}

void violations_add(violations *l, opc_violation v) {
  if (l->count < l->room) l->v[l->count] = v;
  l->count++;
}
