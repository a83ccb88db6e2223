/* SPDX-License-Identifier: BSD-3-Clause */
/* A chart of lines. */
#ifndef OPCFLOW_CIRCUIT_CHART_H
#define OPCFLOW_CIRCUIT_CHART_H

#include "../../draw/mask/colours.h"
#include "../../draw/mask/paper.h"

/* Where it lies on the paper, and the ranges of its axes. */
typedef struct chart {
  cairo_t *cairo;
  double left, top, width, height, font;
  double x0, x1, y0, y1;
} chart;

enum { CHART_BEGIN, CHART_MIDDLE, CHART_END };
void chart_text(const chart *c, double x, double y, int place,
                const char *text);
void chart_axes(const chart *c, const char *title, const char *of_x,
                const char *of_y);

/* Clipped to the chart; a dash of 0 is none. */
void chart_line(const chart *c, rgb colour, double width, double dash,
                const double *x, const double *y, size_t count);

/* A row of the key at a place on paper; returns where the next one begins. */
double chart_key(const chart *c, double x, double y, rgb colour, double dash,
                 const char *text);

#endif
