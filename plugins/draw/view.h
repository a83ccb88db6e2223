/* SPDX-License-Identifier: BSD-3-Clause */
/* Window of a layout on paper, with a title above and a legend below. Layout
   coordinates are in nm, y upwards. Compiled into each plugin that draws a
   layout. */
#pragma once

#include <eda/drawing.h>
#include <eda/gates.h>
#include <opcflow/step.h>

/* View of a picture. A view is the second member of each instance, named
   `view`; the first member is the host. */
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
  double x0, y0, x1, y1; /* window, nm */
  double left, top;      /* position of the window on the paper, pixels */
  double width, height;  /* size of the window on the paper, pixels */
  double scale;          /* pixels per nm */
} view;

/* Parameters of all pictures of layouts. */
#define VIEW_PARAMETERS(state, picture)                                        \
  OPC_PARAMETER_NAMED("file", state, view.asked.file, .type = OPC_OUTPUT,      \
                      .preset = (picture),                                     \
                      .summary = "Picture, .png, .svg or .pdf"),               \
      OPC_PARAMETER_NAMED(                                                     \
          "window", state, view.asked.window, .type = OPC_REALS, .unit = "nm", \
          .summary = "Window to draw, [x0, y0, x1, y1] (default: all)"),       \
      OPC_PARAMETER_NAMED(                                                     \
          "width", state, view.asked.width, .type = OPC_INT,                   \
          .flags = OPC_AT_LEAST | OPC_AT_MOST, .preset = "1600", .min = 200,   \
          .max = 8000,                                                         \
          .summary = "Width of the picture in pixels (.pdf: points)")

/* ---- view.c: the window and the paper ---- */

/* Return OPC_INVALID if a parameter is not valid. */
int view_check(const view *v, opc_error *error);

/* Set the window: the parameter `window`, or the whole layout with a margin.
   Return OPC_INVALID, with the parameter `source`, for an empty layout. */
int view_init(view *v, const opc_host *host, const eda_gates *gates,
              const char *source, opc_error *error);

/* Parts of a picture. view_write passes `picture` to the functions. Title and
   legend are drawn below `top` and return their height; the functions are
   called twice, first to measure the height. */
typedef struct view_parts {
  double (*title)(const void *picture, double top);
  double (*legend)(const void *picture, double top);
  int (*content)(const void *picture, opc_error *error); /* drawn inside the
                                                            window */
} view_parts;

/* Draw all parts and write the file; `v` is the view in which the picture
   draws. */
int view_write(view *v, const view_parts *parts, const void *picture,
               opc_error *error);

/* Add a scale bar of a round length, about a sixth of the window. */
void view_add_scale_bar(const view *v, eda_legend *legend);

/* ---- shapes.c: content of the window ---- */

/* Return the position on the paper, pixels, of the layout coordinate x or y,
   nm. */
double view_x(const view *v, double x);
double view_y(const view *v, double y);

/* Return 1 if a position is within the window. */
int view_contains(const view *v, double x, double y);

/* Return the part of a frame within the window enlarged by `around` nm on each
   side. */
eda_frame view_part(const view *v, eda_frame frame, double around);

/* Return the line width of outlines, smaller for small scales. */
double view_outline_width(const view *v);
/* Return the line width of contours. */
double view_contour_width(const view *v);

/* Return the window with a margin, in grid units. In the window, shapes clipped
   to this box look unclipped; coordinates stay within cairo's range. */
eda_box view_clip(const view *v);

/* Fill merged shapes with a colour; draw their outlines in a colour. */
int view_fill(const view *v, const eda_shapes *shapes, eda_colour colour,
              opc_error *error);
int view_outline(const view *v, const eda_shapes *shapes, eda_colour colour,
                 opc_error *error);

/* Zero lines of a level set, as from eda_contours. */
typedef struct view_contours {
  double *points;
  uint32_t *start;
  size_t count;
} view_contours;

/* Find the contours within the window with an error of at most a tenth of a
   pixel; no contours if `print` has no coefficients. The caller frees *out with
   view_clear_contours, also after an error. [any] */
int view_find_contours(const view *v, const eda_field *print,
                       view_contours *out, opc_error *error);
/* Draw the contours; free the arrays. */
void view_draw_contours(const view *v, const view_contours *contours,
                        eda_colour colour);
void view_clear_contours(view_contours *contours);
