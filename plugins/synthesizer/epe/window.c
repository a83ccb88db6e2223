/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the process window in the feedback: the contour at another dose is
   another level of the same level set. At another dose, features may merge or
   vanish. The contour at that dose is then far from the drawn edge, so the
   feedback shifts the edge even if the nominal contour is correct. */
#include "epe.h"

#include <math.h>

#include "tuning.h"

/* Return the edge placement error of the contour at `level` at site i, nm,
   limited to +-tuned.window_reach. */
static double error_at(const epe_layer *l, uint32_t i, const eda_field *print,
                       double level) {
  const epe_fragment *p = &l->fragments[i];
  double look = tuned.window_step;
  double x = l->site[2 * i], y = l->site[2 * i + 1], before;
  eda_field_sample(print, &x, &y, 1, &before);
  before -= level;
  int sign = before > 0 ? 1 : -1;
  for (double at = look; at <= tuned.window_reach; at += look) {
    double value;
    *(p->axis == EDA_X ? &x : &y) += sign * p->sign * look;
    eda_field_sample(print, &x, &y, 1, &value);
    value -= level;
    if ((value > 0) != (sign > 0))
      return sign * (at - look * value / (value - before));
    before = value;
  }
  return sign * tuned.window_reach;
}

typedef struct weighing {
  epe_layer *layer;
  const eda_field *print;
  double weight, level, grid;
} weighing;

static void weigh_site(void *data, size_t i) {
  const weighing *j = data;
  epe_layer *l = j->layer;
  double w = j->weight;
  double outer = error_at(l, (uint32_t)i, j->print, -j->level);
  double inner = error_at(l, (uint32_t)i, j->print, j->level);
  l->cost[i] = (1 - w) * l->cost[i] + w * (fabs(outer) + fabs(inner)) / 2;
  l->error[i] = (1 - w) * l->error[i] + w * (outer + inner) / 2 / j->grid;
}

void epe_weigh(epe_layer *l, const eda_field *print, double weight,
               double level, double grid) {
  if (!print || weight <= 0) return;
  weighing j = {l, print, weight, level, grid};
  opc_parallel(l->context, l->count, weigh_site, &j);
}
