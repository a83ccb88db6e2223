/* SPDX-License-Identifier: BSD-3-Clause */
/* Charts of lines, side by side on a sheet of paper. What draws them compiles
   chart.c, mask/paper.c and mask/colours.c. */
#ifndef OPCFLOW_DRAW_CHART_H
#define OPCFLOW_DRAW_CHART_H

#include "mask/colours.h"
#include "mask/paper.h"

/* Where it lies on the paper, and the ranges of its axes. */
typedef struct chart {
  cairo_t *cairo;
  double left, top, width, height, font;
  double x0, x1, y0, y1;
  const char *decades; /* y is above 0, in decades of this unit; NULL: plain */
} chart;

/* White paper, and a chart on it that has no place yet. If it fails there is
   nothing to close. */
int chart_open(paper *file, const opc_host *host, int format, const char *path,
               double width, double height, chart *c, opc_error *error);

/* Room around a range: a share of it, at least `least`. One without anything in
   it, low above high, is made of 0. */
void chart_widen(double *low, double *high, double share, double least);

/* Places on the paper. */
double chart_x(const chart *c, double x);
double chart_y(const chart *c, double y);

enum { CHART_BEGIN, CHART_MIDDLE, CHART_END };
void chart_text(const chart *c, double x, double y, int place,
                const char *text);
/* In letters a fifth larger. */
void chart_title(const chart *c, double x, double y, const char *text);

/* The frame, its grid and what stands around it; of_y may be NULL. */
void chart_axes(const chart *c, const char *title, const char *of_x,
                const char *of_y);

/* Clipped to the chart. A dash of 0 is none. */
void chart_line(const chart *c, rgb colour, double width, double dash,
                const double *x, const double *y, size_t count);

/* A row of the key at a place on paper; returns where the next one begins. */
double chart_key(const chart *c, double x, double y, rgb colour, double dash,
                 const char *text);

#endif
