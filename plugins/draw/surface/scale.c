/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>

#include "plot.h"

scale scale_of(const opc_settings *s, int log) {
  scale out = {INFINITY, -INFINITY, log};
  for (size_t i = 0; i < s->count; i++) {
    out.low = fmin(out.low, s->figure[i]); /* not if it is NAN */
    out.high = fmax(out.high, s->figure[i]);
  }
  return out;
}

double scale_place(const scale *s, double figure) {
  if (s->high == s->low) return 0.5;
  if (s->log) return log(figure / s->low) / log(s->high / s->low);
  return (figure - s->low) / (s->high - s->low);
}

/* Dark to light, of growing lightness: it reads in grey as well. */
colour scale_colour(double place) {
  static const colour stops[] = {{0.10, 0.13, 0.33}, {0.14, 0.31, 0.48},
                                 {0.19, 0.50, 0.54}, {0.41, 0.68, 0.51},
                                 {0.75, 0.83, 0.47}, {0.99, 0.95, 0.72}};
  enum { LAST = sizeof stops / sizeof stops[0] - 1 };
  double t = fmin(fmax(place, 0), 1) * LAST;
  int i = t < LAST ? (int)t : LAST - 1;
  double f = t - i;
  const colour *a = &stops[i], *b = &stops[i + 1];
  return (colour){a->r + f * (b->r - a->r), a->g + f * (b->g - a->g),
                  a->b + f * (b->b - a->b)};
}

static int put(const scale *s, double tick, double *ticks, int n, int room) {
  double slack = 1e-9 * fmax(fabs(s->low), fabs(s->high));
  if (n < room && tick >= s->low - slack && tick <= s->high + slack)
    ticks[n++] = tick;
  return n;
}

/* 1, 2 and 5 of every decade, or of fewer where there are many. */
static int log_ticks(const scale *s, double *ticks, int room) {
  static const double digits[] = {1, 2, 5};
  int first = (int)floor(log10(s->low)), last = (int)ceil(log10(s->high)),
      n = 0;
  int each = (last - first) * 3 <= room ? 3 : 1;
  int apart = each == 1 ? (last - first) / room + 1 : 1;
  for (int d = first; d <= last; d += apart)
    for (int k = 0; k < each; k++)
      n = put(s, digits[k] * pow(10, d), ticks, n, room);
  return n;
}

int scale_ticks(const scale *s, double *ticks, int room) {
  double range = s->high - s->low;
  if (s->high == s->low) {
    ticks[0] = s->low;
    return 1;
  }
  if (s->log && s->high > 4 * s->low) return log_ticks(s, ticks, room);
  double step = pow(10, floor(log10(range / room)));
  while (range / step + 1 > room)
    step *= fabs(log10(2 * step) - round(log10(2 * step))) < 1e-6 ? 2 : 2.5;
  int n = 0;
  for (double k = ceil(s->low / step - 1e-9); n < room; k++) {
    if (k * step > s->high + 1e-9 * range) break;
    n = put(s, k * step, ticks, n, room);
  }
  return n;
}
