/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the coupling between fragments. Fragments are shorter than the
   optical resolution, so the shift of a fragment displaces the printed edges at
   all sites nearby. The effect is a Gaussian of the distance. */
#include "epe.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "tuning.h"

/* Return the effect of a unit shift of fragment j at a site at (x, y): the
   integral of the Gaussian over the fragment. An infinite straight edge through
   the site has the effect 1. */
static double coupling_weight(const epe_layer *l, double x, double y,
                              uint32_t j) {
  const epe_fragment *p = &l->fragments[j];
  double s = l->rules->blur;
  double across = p->axis == EDA_X ? x - p->from.x : y - p->from.y;
  double at = p->axis == EDA_X ? y : x;
  double a = (epe_along(p, p->from) - at) / (s * M_SQRT2);
  double b = (epe_along(p, p->to) - at) / (s * M_SQRT2);
  return exp(-across * across / (2 * s * s)) * fabs(erf(b) - erf(a)) / 2;
}

typedef struct coupler {
  epe_layer *layer;
  eda_index *index; /* centres of the fragments */
  double grid;      /* nm */
  double longest;   /* length of the longest fragment, grid steps */
} coupler;

/* Return the distance of v from the interval between a and b. */
static double distance_outside(double v, int32_t a, int32_t b) {
  int32_t low = a < b ? a : b, high = a < b ? b : a;
  return v < low ? low - v : v > high ? v - high : 0;
}

/* Return 1 if a part of the fragment is within `reach` of (x, y). */
static int fragment_is_near(const epe_fragment *p, double x, double y,
                            double reach) {
  double dx = distance_outside(x, p->from.x, p->to.x);
  double dy = distance_outside(y, p->from.y, p->to.y);
  return dx * dx + dy * dy < reach * reach;
}

/* In the first pass, in which m->weight is NULL, store the number of elements
   of row i in start[i + 1]. In the second pass, compute the elements. */
static void coupling_add_site(void *data, size_t i) {
  const coupler *c = data;
  epe_layer *l = c->layer;
  epe_coupling *m = &l->coupling;
  double x = l->site[2 * i] / c->grid, y = l->site[2 * i + 1] / c->grid;
  double reach = tuned.coupling_reach * l->rules->blur,
         far = reach + c->longest / 2;
  eda_finder f = eda_index_find(
      c->index, (eda_box){(int32_t)floor(x - far), (int32_t)floor(y - far),
                          (int32_t)ceil(x + far), (int32_t)ceil(y + far)});
  uint32_t n = m->weight ? m->start[i] : 0;
  for (uint32_t j; eda_index_next(&f, &j);) {
    if (!fragment_is_near(&l->fragments[j], x, y, reach)) continue;
    if (m->weight) {
      m->index[n] = j;
      m->weight[n] = (float)coupling_weight(l, x, y, j);
    }
    n++;
  }
  if (!m->weight) m->start[i + 1] = n;
}

/* Allocate n rows. Replace start[i + 1], the length of row i, by the end of row
   i. */
static void coupling_make_rows(epe_coupling *m, size_t n) {
  for (size_t i = 0; i < n; i++) m->start[i + 1] += m->start[i];
  m->index = eda_alloc(m->start[n], sizeof *m->index);
  m->weight = eda_alloc(m->start[n], sizeof *m->weight);
}

static void coupling_transpose(const epe_coupling *m, size_t n,
                               epe_coupling *out) {
  out->start = eda_alloc(n + 2, sizeof *out->start);
  for (uint32_t k = 0; k < m->start[n]; k++) out->start[m->index[k] + 1]++;
  coupling_make_rows(out, n);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = m->start[i]; k < m->start[i + 1]; k++) {
      uint32_t at = out->start[m->index[k]]++;
      out->index[at] = i;
      out->weight[at] = m->weight[k];
    }
  for (size_t i = n; i > 0; i--) out->start[i] = out->start[i - 1];
  out->start[0] = 0;
}

void epe_couple(epe_layer *l, double grid) {
  coupler c = {.layer = l, .grid = grid};
  eda_box *boxes = eda_alloc(l->count, sizeof *boxes);
  l->coupling.start = eda_alloc(l->count + 1, sizeof *l->coupling.start);
  for (size_t i = 0; i < l->count; i++) {
    const epe_fragment *p = &l->fragments[i];
    int32_t x = p->from.x + (p->to.x - p->from.x) / 2;
    int32_t y = p->from.y + (p->to.y - p->from.y) / 2;
    boxes[i] = (eda_box){x, y, x, y};
    c.longest = epe_max(c.longest, epe_length(p));
  }
  c.index = eda_index_new(boxes, l->count,
                          (int32_t)ceil(tuned.coupling_reach * l->rules->blur));
  opc_parallel(l->context, l->count, coupling_add_site, &c);
  coupling_make_rows(&l->coupling, l->count);
  opc_parallel(l->context, l->count, coupling_add_site, &c);
  coupling_transpose(&l->coupling, l->count, &l->transposed);
  eda_index_free(c.index);
  free(boxes);
}
