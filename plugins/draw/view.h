/* SPDX-License-Identifier: BSD-3-Clause */
/* A window of a layout on paper, with a title above and a legend below. Places
   on paper are in pixels (points of a vector format), y downwards; places of
   the layout in nm, y upwards. Compiled into each plugin that draws a layout.
 */
#ifndef OPCFLOW_DRAW_VIEW_H
#define OPCFLOW_DRAW_VIEW_H

#include <cairo.h>
#include <opcflow/opcflow.h>

#include "mask/colours.h"

typedef struct view {
  const opc_host *host;
  cairo_t *cairo;
  double grid;           /* nm per unit of shapes */
  int raster;            /* whether lines should sit on pixels */
  double paper;          /* width of everything */
  double font;           /* height of the text */
  double x0, y0, x1, y1; /* the window, nm */
  double left, top;      /* where it lies on the paper */
  double width, height;
  double scale; /* pixels per nm */
} view;

/* ---- view.c: the window and the paper ---- */

/* The parameters of every picture of a layout. */
#define VIEW_WINDOW                                            \
  {                                                            \
    .name = "window", .type = OPC_REALS, .unit = "nm",         \
    .summary = "What to draw, [x0, y0, x1, y1] (default: all)" \
  }
#define VIEW_WIDTH                                                         \
  {                                                                        \
    .name = "width", .type = OPC_INT, .flags = OPC_AT_LEAST | OPC_AT_MOST, \
    .preset = "1600", .min = 200, .max = 8000,                             \
    .summary = "The width of the picture in pixels (.pdf: points)"         \
  }

/* Does the value of VIEW_WINDOW make sense? */
int view_check_window(const opc_host *host, const opc_value *window,
                      opc_error *error);

/* A view of the gates' layout: the window, or all of it with some room. The
   error of an empty layout is that of the parameter `source`. */
int view_make(view *v, const opc_host *host, const opc_gates *gates,
              const opc_value *window, int64_t width, const char *source,
              opc_error *error);

/* What a picture consists of; `picture` is what view_write was given. Title
   and legend return their height, and are only measured if `draw` is 0. */
typedef struct view_parts {
  double (*title)(const void *picture, double top, int draw);
  double (*legend)(const void *picture, double top, int draw);
  int (*content)(const void *picture, opc_error *error); /* clipped */
} view_parts;

/* Draw it all and write it as PAPER_PNG or what else is `format`. `v` is the
   view that the picture draws in. */
int view_write(view *v, const view_parts *parts, const void *picture,
               int format, const char *path, opc_error *error);

/* The margin around everything. */
double view_margin(const view *v);

/* ---- shapes.c: what is in the window ---- */

double view_x(const view *v, double x);
double view_y(const view *v, double y);

/* The width of an outline: thinner where the layout is small. */
double view_outline_width(const view *v);
/* That of a print's contour. */
double view_contour_width(const view *v);

/* The window with something around it, in units of the grid: what is cut there
   is not seen, and nothing leaves the range of cairo's coordinates. */
opc_box view_clip(const view *v);

/* Merged shapes in the present colour. */
int view_fill(const view *v, const opc_shapes *shapes, opc_error *error);
int view_outline(const view *v, const opc_shapes *shapes, double line,
                 opc_error *error);

/* The zero lines of a print, as imaging->contours gives them. */
typedef struct view_contours {
  double *points;
  uint32_t *start;
  size_t count;
} view_contours;

/* Those in the window, exact to a tenth of a pixel; none if the print has no
   coefficients. To be released whatever comes back. Any thread. */
int view_find_contours(const view *v, const opc_field *print,
                       view_contours *out, opc_error *error);
void view_draw_contours(const view *v, const view_contours *contours);
void view_release_contours(const view *v, view_contours *contours);

#endif
