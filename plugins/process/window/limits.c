/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>

#include "window.h"

double window_deviation(const window_results *r, size_t focus, size_t dose,
                        size_t gate) {
  size_t n = r->gates->count;
  double drawn = r->gates->length[gate];
  double length = r->cuts[(focus * r->doses + dose) * n + gate].length;
  return 100 * (length - drawn) / drawn;
}

/* A walk through the list of foci at the nominal dose, or through that of
   doses at one focus. */
typedef struct walk {
  const window_results *r;
  const double *place;
  size_t n, focus;
  int along_focus;
} walk;

static double at(const walk *w, size_t k, size_t gate) {
  return w->along_focus ? window_deviation(w->r, k, w->r->nominal, gate)
                        : window_deviation(w->r, w->focus, k, gate);
}

static int good(const walk *w, size_t k) {
  for (size_t i = 0; i < w->r->gates->count; i++)
    if (!(fabs(at(w, k, i)) <= w->r->tolerance)) return 0;
  return 1;
}

/* The place between the good k and its neighbour `to` where the first gate
   leaves the tolerance; that of k for gates that do not print at `to`. */
static double leaves(const walk *w, size_t k, size_t to) {
  double t = w->r->tolerance, least = 1;
  for (size_t i = 0; i < w->r->gates->count; i++) {
    double a = at(w, k, i), b = at(w, to, i);
    if (isnan(b)) return w->place[k];
    if (fabs(b) > t) least = fmin(least, (copysign(t, b) - a) / (b - a));
  }
  return w->place[k] + least * (w->place[to] - w->place[k]);
}

static void widest(const walk *w, double *low, double *high) {
  *low = *high = NAN;
  for (size_t k = 0; k < w->n; k++) {
    if (!good(w, k)) continue;
    size_t first = k;
    while (k + 1 < w->n && good(w, k + 1)) k++;
    double a = first ? leaves(w, first, first - 1) : w->place[first];
    double b = k + 1 < w->n ? leaves(w, k, k + 1) : w->place[k];
    if (isnan(*low) || b - a > *high - *low) *low = a, *high = b;
  }
}

void window_limits(window_results *r) {
  for (size_t f = 0; f < r->foci; f++) {
    walk w = {.r = r, .place = r->dose, .n = r->doses, .focus = f};
    widest(&w, &r->low[f], &r->high[f]);
  }
  walk w = {.r = r, .place = r->focus, .n = r->foci, .along_focus = 1};
  widest(&w, &r->depth_low, &r->depth_high);
}
