/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of draw.surface. Places are in pixels (points of a vector format),
   y downwards. */
#ifndef OPCFLOW_DRAW_PLOT_H
#define OPCFLOW_DRAW_PLOT_H

#include <cairo.h>
#include <opcflow/settings.h>

typedef struct colour {
  double r, g, b;
} colour;

typedef struct box {
  double left, top, width, height;
} box;

/* ---- scale.c: figures to lengths and colours ---- */

typedef struct scale {
  double low, high;
  int log;
} scale;

/* Of all figures that are there; `low` is `high` if they are equal. */
scale scale_of(const opc_settings *s, int log);

/* 0 at the low end, 1 at the high one. */
double scale_place(const scale *s, double figure);

colour scale_colour(double place);

/* Round numbers from low to high, at most `room`; how many. */
int scale_ticks(const scale *s, double *ticks, int room);

/* ---- plot.c ---- */

typedef struct plot {
  cairo_t *cairo;
  const opc_settings *settings;
  size_t block; /* settings with one value of the first parameter */
  size_t last;  /* values of the last one */
  scale scale;
  double width, height, font;
} plot;

/* The height of the picture of a width. */
double plot_height(double width);

/* A heat map over the first and the last parameter, where there is one alone a
   curve. All others are at the best setting. */
void plot_draw(const plot *p);

#endif
