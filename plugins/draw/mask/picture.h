/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of draw.mask. Places on paper are in pixels (points of a vector
   format), y downwards; places of the layout in nm, y upwards. */
#ifndef OPCFLOW_DRAW_PICTURE_H
#define OPCFLOW_DRAW_PICTURE_H

#include <cairo.h>
#include <opcflow/opcflow.h>

typedef struct rgb {
  double r, g, b;
} rgb;

typedef struct picture {
  const opc_host *host;
  const opc_mask *mask;
  cairo_t *cairo;
  int raster;            /* whether lines should sit on pixels */
  double paper;          /* width of everything */
  double font;           /* height of the text */
  double range;          /* the deviation at the ends of the scale, % */
  double x0, y0, x1, y1; /* the window, nm */
  double left, top;      /* where it lies on the paper */
  double width, height;
  double scale; /* pixels per nm */
} picture;

/* ---- mask.c ---- */

/* 100 (a - b) / b of the drive current of a transistor, thesis eq. 3.1; NAN
   where it has none. */
double picture_deviation(const opc_performance *p, const opc_mask *mask,
                         size_t gate);

/* ---- colours.c ---- */

extern const rgb picture_drawn[OPC_LAYERS]; /* fills */
extern const rgb picture_mask[OPC_MASKS];   /* outlines */
extern const rgb picture_print[OPC_MASKS];  /* contours */
extern const rgb picture_ink, picture_faint, picture_unknown;

void picture_use(cairo_t *cairo, rgb colour);

/* Of a deviation, from blue by white to red; t from -1 to 1, clamped. */
rgb picture_diverging(double t);

/* ---- shapes.c ---- */

/* The widths of lines, in pixels: thinner where the layout is small. */
double picture_mask_line(const picture *p);
double picture_print_line(const picture *p);

/* Everything in the window, clipped to it. */
int picture_shapes(const picture *p, opc_error *error);

/* ---- legend.c ---- */

/* What stands above and below the window, from `top` on; returns its height.
   Only measured if `draw` is 0. */
double picture_title(const picture *p, double top, int draw);
double picture_legend(const picture *p, double top, int draw);

/* The margin around everything. */
double picture_margin(const picture *p);

/* The cross over a transistor that does not print, in a box on paper. */
void picture_cross(const picture *p, double x, double y, double width,
                   double height);

#endif
