/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the search for the displacement of a mask edge at which a printed
   length or distance meets its limit. */
#include <math.h>

#include "drc.h"
#include "tuning.h"

int32_t rules_advance(response *r, int32_t bias, double value, double target,
                      double steep, double grid) {
  double slope = tuned.usual * steep;
  if (r->seen && bias != r->bias)
    slope = (value - r->value) / ((bias - (double)r->bias) * grid);
  slope = fmin(fmax(slope, tuned.least * steep), tuned.most * steep);
  *r = (response){bias, value, 1};
  double missing = target + tuned.spare - value;
  double step = fmin(missing / slope, tuned.largest_step);
  return bias + (int32_t)ceil(step / grid - 1e-9);
}

void violations_add(violations *l, eda_violation v) {
  if (l->count < l->capacity) l->v[l->count] = v;
  l->count++;
}
