/* SPDX-License-Identifier: BSD-3-Clause */
/* Times at which simulated outputs cross a level. */
#include <eda/wave.h>

enum { CUBIC = 4, BISECTIONS = 50 /* resolves an interval to the last bit */ };

void eda_wave_heights(const double *v, size_t n, double supply, int rises,
                      double *height) {
  for (size_t i = 0; i < n; i++)
    height[i] = rises ? v[i] / supply : 1 - v[i] / supply;
}

size_t eda_wave_last_rise(const double *h, size_t before, double level,
                          size_t none) {
  for (size_t i = before; i-- > 0;)
    if (h[i] < level && h[i + 1] >= level) return i;
  return none;
}

int eda_wave_find(const double *h, size_t n, double low, double high,
                  eda_wave_edge *out) {
  if (n < 2) return 0;
  out->half = eda_wave_last_rise(h, n - 1, 0.5, n);
  if (out->half == n) return 0;
  out->low = eda_wave_last_rise(h, out->half + 1, low, n);
  out->high = out->half;
  while (out->high + 1 < n && h[out->high + 1] < high) out->high++;
  return out->low < n && out->high + 1 < n;
}

double eda_wave_time(const double *t, const double *h, size_t i, double level) {
  return t[i] + (level - h[i]) / (h[i + 1] - h[i]) * (t[i + 1] - t[i]);
}

/* Evaluate the cubic through four points by Neville's scheme. */
static double cubic_through(const double *t, const double *v, double at) {
  double p[CUBIC] = {v[0], v[1], v[2], v[3]};
  for (int n = 1; n < CUBIC; n++)
    for (int i = 0; i + n < CUBIC; i++)
      p[i] =
          ((at - t[i + n]) * p[i] + (t[i] - at) * p[i + 1]) / (t[i] - t[i + n]);
  return p[0];
}

double eda_wave_smooth_time(const double *t, const double *h, size_t n,
                            size_t i, double level) {
  double low = t[i], high = t[i + 1];
  size_t first = i ? i - 1 : 0;
  if (first + CUBIC > n) first = n - CUBIC;
  for (int k = 0; k < BISECTIONS; k++) {
    double middle = (low + high) / 2;
    if (cubic_through(t + first, h + first, middle) < level)
      low = middle;
    else
      high = middle;
  }
  return low;
}
