/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes the range of dose and focus in which all transistors meet the
   limits, and their response to mask errors. */
#include <math.h>

#include "window.h"

/* Number of lines per interval of foci for the integration of dose ranges
   (midpoint rule). In an interval of 140 nm in which a limit becomes active and
   inactive again, 32 lines have an error of 0.005 % of the area, 16 lines 0.012
   %. */
enum { LINES = 32 };

/* ---- ranges within the limits ---- */

/* Reduce the interval [low, high] of t to the part in which a + (b - a) t is in
   [least, most]. */
static void interval_clip(double a, double b, double least, double most,
                          double *low, double *high) {
  if (a > b) {
    interval_clip(-a, -b, -most, -least, low, high);
    return;
  }
  if (a == b) {
    if (!(a >= least && a <= most)) *high = -INFINITY;
    return;
  }
  *low = fmax(*low, (least - a) / (b - a));
  *high = fmin(*high, (most - a) / (b - a));
}

/* Interpolation of a current between four simulated conditions. */
typedef struct grid_cell {
  const window_print *corner[2][2]; /* [focus][dose] */
  double at;                        /* focus between the corners, 0 to 1 */
} grid_cell;

static void clip_gate(const grid_cell *p, int ioff, size_t i, double least,
                      double most, double *low, double *high) {
  double end[2];
  for (int d = 0; d < 2; d++) {
    const window_print *a = p->corner[0][d], *b = p->corner[1][d];
    double from = ioff ? a->ioff[i] : a->ion[i];
    double to = ioff ? b->ioff[i] : b->ion[i];
    end[d] = p->at == 0 ? from : from + p->at * (to - from);
  }
  if (isnan(end[0]) || isnan(end[1]))
    *high = -INFINITY;
  else
    interval_clip(end[0], end[1], least, most, low, high);
}

int window_keeps(const window *w, int limits, size_t focus, double at,
                 size_t dose, double *low, double *high) {
  size_t next = focus + 1 < w->focus.count ? focus + 1 : focus;
  const grid_cell p = {
      {{window_at(w, focus, dose), window_at(w, focus, dose + 1)},
       {window_at(w, next, dose), window_at(w, next, dose + 1)}},
      at};
  double least = log1p(-fmin(w->ion_limit, 100) / 100);
  double most = log1p(w->ion_limit / 100), leak = log1p(w->ioff_limit / 100);
  double from = 0, to = 1;
  for (size_t i = 0; i < w->gates->count && from < to; i++) {
    if (limits & WINDOW_ION) clip_gate(&p, 0, i, least, most, &from, &to);
    if (limits & WINDOW_IOFF) clip_gate(&p, 1, i, -INFINITY, leak, &from, &to);
  }
  if (!(from < to)) return 0;
  double begin = w->dose.values[dose], step = w->dose.values[dose + 1] - begin;
  *low = begin + from * step;
  *high = begin + to * step;
  return 1;
}

static double length_kept(const window *w, int limits, size_t focus,
                          double at) {
  double sum = 0, low, high;
  for (size_t d = 0; d + 1 < w->dose.count; d++)
    if (window_keeps(w, limits, focus, at, d, &low, &high)) sum += high - low;
  return sum;
}

double window_kept_doses(const window *w, int limits, size_t focus) {
  return length_kept(w, limits, focus, 0);
}

double window_kept_area(const window *w, int limits) {
  double area = 0;
  for (size_t f = 0; f + 1 < w->focus.count; f++) {
    double step = (w->focus.values[f + 1] - w->focus.values[f]) / LINES;
    for (int k = 0; k < LINES; k++)
      area += step * length_kept(w, limits, f, (k + 0.5) / LINES);
  }
  return area;
}

/* ---- mask errors ---- */

/* Return the slope of a gate's length, or of the logarithm of its Ion, over
   mask_error. NAN if the gate fails at any mask error. */
static double gate_slope(const window *w, size_t i, int ion) {
  const double *x = w->mask_error.values;
  size_t n = w->mask_error.count;
  double mean = 0, sxy = 0, sxx = 0;
  for (size_t k = 0; k < n; k++) mean += x[k] / (double)n;
  for (size_t k = 0; k < n; k++) {
    const window_print *p = &w->wrong[k];
    sxy += (x[k] - mean) * (ion ? p->ion[i] : p->cuts[i].length);
    sxx += (x[k] - mean) * (x[k] - mean);
  }
  return sxy / sxx;
}

static void mean_and_max(const window *w, int ion, double unit, double *mean,
                         double *max) {
  double n = 0;
  *mean = *max = 0;
  for (size_t i = 0; i < w->gates->count; i++) {
    double s = fabs(gate_slope(w, i, ion)) * unit;
    if (isnan(s)) continue;
    n += window_count(w, i);
    *mean += window_count(w, i) * s;
    *max = fmax(*max, s);
  }
  *mean = n > 0 ? *mean / n : NAN;
  if (n == 0) *max = NAN;
}

window_response window_respond(const window *w) {
  window_response r = {NAN, NAN, NAN, NAN};
  if (w->mask_error.count < 2) return r;
  mean_and_max(w, 0, 0.5, &r.meef_mean, &r.meef_max);
  if (w->extractor) mean_and_max(w, 1, 100, &r.ion_mean, &r.ion_max);
  return r;
}
