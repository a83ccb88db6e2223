/* SPDX-License-Identifier: BSD-3-Clause */
/* Waves of simulated outputs, points (t[i], h[i]) with t rising: when they pass
   a level. A height is 0 where the output begins and 1 where it ends, for
   rising and for falling outputs. */
#pragma once

#include <opcflow/base.h>

OPC_C_BEGIN

/* Turn n voltages into heights. [any] */
OPC_EXPORT void eda_wave_heights(const double *v, size_t n, double supply,
                                 int rises, double *height);

/* Return the last point before `before` from which the height rises past a
   level to the next point; `none` if there is none. [any] */
OPC_EXPORT size_t eda_wave_last_rise(const double *h, size_t before,
                                     double level, size_t none);

/* The points from which an edge passes its levels for the next point. */
typedef struct eda_wave_edge {
  size_t low, half, high;
} eda_wave_edge;

/* Find the last edge of n points: where the height passes 0.5 for the last
   time, `low` for the last time before that, and `high` for the first time
   after that. Return 0 if it does not pass all three. [any] */
OPC_EXPORT int eda_wave_find(const double *h, size_t n, double low, double high,
                             eda_wave_edge *out);

/* Return when the wave passes a level between points i and i + 1, on a straight
   line. [any] */
OPC_EXPORT double eda_wave_time(const double *t, const double *h, size_t i,
                                double level);

/* The same on the cubic through four of the n >= 4 points. On straight lines
   slews would deviate by 0.5 % at five points to a slew. [any] */
OPC_EXPORT double eda_wave_smooth_time(const double *t, const double *h,
                                       size_t n, size_t i, double level);

OPC_C_END
