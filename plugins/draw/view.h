/* SPDX-License-Identifier: BSD-3-Clause */
/* A window of a layout on paper, with a title above and a legend below. Places
   of the layout are in nm, y upwards. Compiled into each plugin that draws a
   layout. */
#ifndef OPCFLOW_DRAW_VIEW_H
#define OPCFLOW_DRAW_VIEW_H

#include <eda/drawing.h>
#include <eda/gates.h>
#include <opcflow/step.h>

/* The second member of an instance, named `view`, after its host. */
typedef struct view {
  struct {
    const char *file;
    opc_reals window;
    int64_t width;
  } asked; /* parameters */
  const opc_context *context;
  const char *path;
  eda_paper *paper;
  double grid;           /* nm per unit of shapes */
  double x0, y0, x1, y1; /* the window, nm */
  double left, top;      /* where it lies on the paper */
  double width, height;
  double scale; /* pixels per nm */
} view;

/* The parameters of every picture of a layout. */
#define VIEW_PARAMETERS(state, picture)                                        \
  OPC_PARAMETER_NAMED("file", state, view.asked.file, .type = OPC_OUTPUT,      \
                      .preset = (picture),                                     \
                      .summary = "The picture, .png, .svg or .pdf"),           \
      OPC_PARAMETER_NAMED(                                                     \
          "window", state, view.asked.window, .type = OPC_REALS, .unit = "nm", \
          .summary = "What to draw, [x0, y0, x1, y1] (default: all)"),         \
      OPC_PARAMETER_NAMED(                                                     \
          "width", state, view.asked.width, .type = OPC_INT,                   \
          .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1600", .min = 200,   \
          .max = 8000,                                                         \
          .summary = "The width of the picture in pixels (.pdf: points)")

/* ---- view.c: the window and the paper ---- */

/* Do the values of the parameters make sense? */
int view_check(const view *v, opc_error *error);

/* Choose the window of the gates' layout: that of the parameters, or all of it
   with some room. The error of an empty layout is that of the parameter
   `source`. */
int view_init(view *v, const opc_host *host, const eda_gates *gates,
              const char *source, opc_error *error);

/* What a picture consists of; `picture` is what view_write was given. Title and
   legend stand below `top` and return their height; they are drawn twice, the
   first time to measure them. */
typedef struct view_parts {
  double (*title)(const void *picture, double top);
  double (*legend)(const void *picture, double top);
  int (*content)(const void *picture, opc_error *error); /* clipped */
} view_parts;

/* Draw it all and write it. `v` is the view that the picture draws in. */
int view_write(view *v, const view_parts *parts, const void *picture,
               opc_error *error);

/* A round length of about a sixth of the window. */
void view_add_scale_bar(const view *v, eda_legend *legend);

/* ---- shapes.c: what is in the window ---- */

double view_x(const view *v, double x);
double view_y(const view *v, double y);

/* Whether a place of the layout is in the window. */
int view_contains(const view *v, double x, double y);

/* The part of a frame that the window covers, with so much around it, nm. */
eda_frame view_part(const view *v, eda_frame frame, double around);

/* The width of an outline: thinner where the layout is small. */
double view_outline_width(const view *v);
/* That of a print's contour. */
double view_contour_width(const view *v);

/* The window with something around it, in units of the grid: what is cut there
   is not seen, and nothing leaves the range of cairo's coordinates. */
eda_box view_clip(const view *v);

/* Merged shapes in that colour. */
int view_fill(const view *v, const eda_shapes *shapes, eda_colour colour,
              opc_error *error);
int view_outline(const view *v, const eda_shapes *shapes, eda_colour colour,
                 opc_error *error);

/* The zero lines of a print, as eda_contours gives them. */
typedef struct view_contours {
  double *points;
  uint32_t *start;
  size_t count;
} view_contours;

/* Those in the window, exact to a tenth of a pixel; none if the print has no
   coefficients. To be cleared whatever comes back. [any] */
int view_find_contours(const view *v, const eda_field *print,
                       view_contours *out, opc_error *error);
void view_draw_contours(const view *v, const view_contours *contours,
                        eda_colour colour);
void view_clear_contours(view_contours *contours);

#endif
