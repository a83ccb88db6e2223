/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements covering by recursive bisection: a box is divided if the sum of
   the areas of its halves is smaller. */
#include "cover.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct maker {
  const eda_box *places;
  uint32_t *spare;
  int32_t reach, most;
  cover *out;
} maker;

static eda_box places_box(const maker *m, size_t first, size_t count) {
  eda_box all = m->places[m->out->place[first]];
  for (size_t k = first + 1; k < first + count; k++)
    eda_box_join(&all, m->places[m->out->place[k]]);
  return eda_box_grown(all, m->reach);
}

static double area_of(eda_box b) {
  return ((double)b.x1 - b.x0) * ((double)b.y1 - b.y0);
}

/* Move the places in the lower half of the box to the front without changing
   their order. Return their number. */
static size_t places_halve(const maker *m, size_t first, size_t count,
                           eda_box box) {
  uint32_t *place = m->out->place + first;
  int wide = (int64_t)box.x1 - box.x0 >= (int64_t)box.y1 - box.y0;
  int64_t middle = wide ? (int64_t)box.x0 + box.x1 : (int64_t)box.y0 + box.y1;
  size_t low = 0, high = 0;
  for (size_t k = 0; k < count; k++) {
    eda_box b = m->places[place[k]];
    int64_t at = wide ? (int64_t)b.x0 + b.x1 : (int64_t)b.y0 + b.y1;
    if (at < middle)
      place[low++] = place[k];
    else
      m->spare[high++] = place[k];
  }
  memcpy(place + low, m->spare, high * sizeof *place);
  return low;
}

static int box_fits(const maker *m, eda_box b) {
  return b.x1 - b.x0 <= m->most && b.y1 - b.y0 <= m->most;
}

/* Append the clips of places first to first + count - 1. Return the sum of the
   areas of the clips. */
static double places_divide(maker *m, size_t first, size_t count) {
  cover *c = m->out;
  eda_box box = places_box(m, first, count);
  double whole = box_fits(m, box) ? area_of(box) : INFINITY, parts = INFINITY;
  size_t before = c->count,
         low = count > 1 ? places_halve(m, first, count, box) : 0;
  if (low && low < count) {
    parts = places_divide(m, first, low);
    parts += places_divide(m, first + low, count - low);
  }
  if (parts < whole) return parts;
  c->count = before;
  EDA_PUSH(c->clip, c->count, c->capacity, (clip){box, first, count});
  return area_of(box);
}

void cover_make(const eda_box *places, size_t n, int32_t reach, int32_t most,
                cover *out) {
  *out = (cover){.place = eda_alloc(n, sizeof *out->place)};
  maker m = {places, eda_alloc(n, sizeof *m.spare), reach, most, out};
  for (size_t i = 0; i < n; i++) out->place[i] = (uint32_t)i;
  if (n) (void)places_divide(&m, 0, n);
  free(m.spare);
}

void cover_clear(cover *c) {
  free(c->clip);
  free(c->place);
  *c = (cover){0};
}
