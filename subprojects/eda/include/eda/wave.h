/* SPDX-License-Identifier: BSD-3-Clause */
/* Times at which simulated output waveforms cross a level. A waveform has the
   points (t[i], h[i]) with increasing times t; the height h is 0 before and 1
   after the transition, for rising and falling outputs. [any]:
   opcflow/plugin.h. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Convert n voltages v, V, of an output that rises (`rises` = 1) or falls (0)
   to heights; `supply`: supply voltage, V. [any] */
OPC_EXPORT void eda_wave_heights(const double *v, size_t n, double supply,
                                 int rises, double *height);

/* Return the largest i < `before` with h[i] < level <= h[i + 1]; return `none`
   if no i satisfies this condition. [any] */
OPC_EXPORT size_t eda_wave_last_rise(const double *h, size_t before,
                                     double level, size_t none);

/* Index i of each crossing, which is between points i and i + 1. */
typedef struct eda_wave_edge {
  size_t low, half, high;
} eda_wave_edge;

/* Find the last transition of n points: the last crossing of 0.5, the last
   crossing of `low` before it, and the first crossing of `high` after it.
   Return 1, or 0 if a crossing is missing. [any] */
OPC_EXPORT int eda_wave_find(const double *h, size_t n, double low, double high,
                             eda_wave_edge *out);

/* Return the time at which the waveform crosses a level between points i and i
   + 1, by linear interpolation. [any] */
OPC_EXPORT double eda_wave_time(const double *t, const double *h, size_t i,
                                double level);

/* As eda_wave_time, by the cubic through the four nearest of n >= 4 points.
   Linear interpolation of five points per slew has an error of 0.5 %. [any] */
OPC_EXPORT double eda_wave_smooth_time(const double *t, const double *h,
                                       size_t n, size_t i, double level);

OPC_C_END
