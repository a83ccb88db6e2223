/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes exposure latitude and depth of focus from the printed lengths of all
   gates at all simulated conditions. */
#include <math.h>

#include "window.h"

/* Conditions on a line: foci at the nominal dose, or doses at one focus. */
typedef struct line_scan {
  const window *w;
  opc_reals place;
  size_t focus;
  int along_focus;
} line_scan;

/* Return the length deviation of a gate at condition i of the line, % of the
   drawn length; NAN if the gate does not print. */
static double gate_deviation(const line_scan *k, size_t i, size_t gate) {
  const window *w = k->w;
  size_t focus = k->along_focus ? i : k->focus;
  size_t dose = k->along_focus ? w->nominal_dose : i;
  return eda_deviation(window_at(w, focus, dose)->cuts[gate].length,
                       w->gates->length[gate]);
}

static int place_valid(const line_scan *k, size_t i) {
  for (size_t gate = 0; gate < k->w->gates->count; gate++)
    if (!(fabs(gate_deviation(k, i, gate)) <= k->w->tolerance)) return 0;
  return 1;
}

/* Return the position between the valid position i and the adjacent position
   `to` where the first gate leaves the tolerance. Return position i if a gate
   does not print at `to`. */
static double place_leaves(const line_scan *k, size_t i, size_t to) {
  const double *place = k->place.values;
  double t = k->w->tolerance, least = 1;
  for (size_t gate = 0; gate < k->w->gates->count; gate++) {
    double a = gate_deviation(k, i, gate), b = gate_deviation(k, to, gate);
    if (isnan(b)) return place[i];
    if (fabs(b) > t) least = fmin(least, (copysign(t, b) - a) / (b - a));
  }
  return place[i] + least * (place[to] - place[i]);
}

static void interval_widest(const line_scan *k, double *low, double *high) {
  const double *place = k->place.values;
  size_t n = k->place.count;
  *low = *high = NAN;
  for (size_t i = 0; i < n; i++) {
    if (!place_valid(k, i)) continue;
    size_t first = i;
    while (i + 1 < n && place_valid(k, i + 1)) i++;
    double a = first ? place_leaves(k, first, first - 1) : place[first];
    double b = i + 1 < n ? place_leaves(k, i, i + 1) : place[i];
    if (isnan(*low) || b - a > *high - *low) *low = a, *high = b;
  }
}

void window_limits(window *w) {
  for (size_t f = 0; f < w->focus.count; f++) {
    line_scan k = {.w = w, .place = w->dose, .focus = f};
    interval_widest(&k, &w->low[f], &w->high[f]);
  }
  line_scan k = {.w = w, .place = w->focus, .along_focus = 1};
  interval_widest(&k, &w->depth_low, &w->depth_high);
}
