/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures: drawing surfaces, text, legends, charts and colours. Not part of
   <eda/eda.h>, because these functions need cairo. Coordinates are pixels
   (points in .svg and .pdf), y downwards. All functions are [any]
   (opcflow/plugin.h); use each surface from one thread at a time. */
#pragma once

#include <cairo.h>
#include <opcflow/base.h>

OPC_C_BEGIN

/* ---- colours ---------------------------------------------------------- */

/* A colour; components from 0 to 1. */
typedef struct eda_colour {
  double r, g, b;
} eda_colour;

/* Initialise a colour from a literal like 0xe07000. */
#define EDA_COLOUR(hex)                                      \
  {                                                          \
    ((hex) >> 16 & 255) / 255.0, ((hex) >> 8 & 255) / 255.0, \
        ((hex)&255) / 255.0                                  \
  }

/* Colours of text and frames, of grid lines and outlines, of transistors
   without a value, and of rings (eda_ring). */
OPC_EXPORT extern const eda_colour eda_ink, eda_faint, eda_unknown,
    eda_ring_colour;

/* Colours of contacts and of a layer (number as in eda_gates): fill of drawn
   shapes, outline of the mask, simulated contour. */
OPC_EXPORT extern const eda_colour eda_contact_fill;
OPC_EXPORT eda_colour eda_layer_fill(size_t layer);
OPC_EXPORT eda_colour eda_layer_outline(size_t layer);
OPC_EXPORT eda_colour eda_layer_contour(size_t layer);

/* Return a colour as 0xRRGGBB. */
OPC_EXPORT uint32_t eda_colour_packed(eda_colour colour);

/* Return the colour of a deviation: blue at t = 0, white at 0.5, red at 1; t is
   clamped to this range. */
OPC_EXPORT eda_colour eda_diverging(double t);

/* Return the colour of an intensity: dark at t = 0 to light at t = 1, with
   monotone lightness, also when printed in grey; t is clamped. */
OPC_EXPORT eda_colour eda_sequential(double t);

/* Set the current colour of a drawing context. */
OPC_EXPORT void eda_use(cairo_t *cairo, eda_colour colour);

/* ---- paper ------------------------------------------------------------ */

/* A drawing surface with its file. After each function below, lines are solid
   and the font is normal; the current colour is unchanged or eda_ink. */
typedef struct eda_paper {
  cairo_t *cairo; /* drawing context */
  double width, height;
  double font;   /* text height */
  double margin; /* left and right of titles and legends; the caller may change
                    it */
  int pixels;    /* 1 for a .png: align lines to pixels */
} eda_paper;

/* Check that a file name ends in .png, .svg or .pdf. Otherwise return
   OPC_INVALID and an error of the parameter `parameter`. */
OPC_EXPORT int eda_paper_check(const char *file, const char *parameter,
                               opc_error *error);

/* Create a file with a white surface; return NULL and *error if the file cannot
   be created. `path` must outlive the surface. Equal drawing commands produce
   equal files. `font`: height of text. */
OPC_EXPORT eda_paper *eda_paper_open(const char *path, double width,
                                     double height, double font,
                                     opc_error *error);

/* Set the height and clear the surface. A surface opened with height 0 only
   measures texts and legends; drawing on such a surface has no effect. */
OPC_EXPORT void eda_paper_cut(eda_paper *paper, double height);

/* Write and close the file and free the surface. Return `code`, the result of
   drawing, or the code of a write error. On an error remove the file. */
OPC_EXPORT int eda_paper_close(eda_paper *paper, int code, opc_error *error);

/* ---- text and signs --------------------------------------------------- */

/* Alignment of a text. */
enum { EDA_LEFT, EDA_MIDDLE, EDA_RIGHT };

/* Draw a line of text in the current colour. `place` is EDA_LEFT, EDA_MIDDLE or
   EDA_RIGHT: the part of the text at x. Longer texts are truncated to `width`,
   which may be INFINITY. */
OPC_EXPORT void eda_text(const eda_paper *paper, double x, double baseline,
                         int place, double width, const char *text);

/* Draw a title below `top`; return the height of the title. */
OPC_EXPORT double eda_heading(const eda_paper *paper, double top,
                              const char *text);

/* Draw a cross through a rectangle. */
OPC_EXPORT void eda_cross(const eda_paper *paper, double x, double y,
                          double width, double height);

/* Draw a ring around a point, visible on any background. */
OPC_EXPORT void eda_ring(const eda_paper *paper, double x, double y);

/* ---- legends ---------------------------------------------------------- */

/* Symbol before the text of a legend entry. */
typedef struct eda_sign {
  enum {
    EDA_SIGN_FILL,
    EDA_SIGN_LINE,
    EDA_SIGN_CROSS,
    EDA_SIGN_RING,
    EDA_SIGN_BAR,
    EDA_SIGN_RAMP
  } kind;
  eda_colour colour;
  double line, dash;            /* LINE: width; length of dashes, 0: solid */
  eda_colour behind;            /* LINE: colour of a second line behind it */
  double behind_line;           /* width of that line; 0: no such line */
  double size;                  /* BAR: size */
  eda_colour (*ramp)(double t); /* RAMP: colour at position t, 0 to 1 */
  const char *low, *high;       /* RAMP: labels of both ends */
} eda_sign;

/* A legend. Entries are placed from left to right, in lines as needed. */
typedef struct eda_legend {
  const eda_paper *paper;
  double top, height; /* upper end; height of all lines so far */
  double x;           /* position of the next entry */
} eda_legend;

/* Start a legend whose upper end is `top`. */
OPC_EXPORT void eda_legend_init(eda_legend *legend, const eda_paper *paper,
                                double top);
/* Draw an entry: a symbol (NULL: none) and a text formatted as by printf. */
OPC_EXPORT void eda_legend_add(eda_legend *legend, const eda_sign *sign,
                               const char *format, ...) OPC_PRINTF(3, 4);

/* ---- charts ----------------------------------------------------------- */

/* An axis, or a colour scale. */
typedef struct eda_axis {
  double low, high;         /* values at both ends */
  int log;                  /* 1: logarithmic */
  const char *unit;         /* unit of the numbers, written with a prefix ("20
                               mA"); NULL: no unit */
  const char *title;        /* may be NULL */
  const char *const *label; /* texts at the values 0, 1, ... in place of
                               numbers; may be NULL */
  size_t labels;
} eda_axis;

/* Set the range to the smallest and the largest of n values, NAN ignored; low >
   high if all are NAN. */
OPC_EXPORT void eda_axis_fit(eda_axis *axis, const double *value, size_t n);

/* Extend the range at both ends by the fraction `share` of the range, at least
   by `least` (in decades for a logarithmic axis). An empty range becomes a
   range around 0 (logarithmic axis: 1). */
OPC_EXPORT void eda_axis_widen(eda_axis *axis, double share, double least);

/* Set the texts of an axis, and a range in which each text has an equal part.
 */
OPC_EXPORT void eda_axis_label(eda_axis *axis, const char *const *label,
                               size_t labels);

/* Return the relative position of a value: 0 at the low, 1 at the high end. */
OPC_EXPORT double eda_axis_place(const eda_axis *axis, double value);

/* Return the width of the numbers, or texts, and the title of a y axis. */
OPC_EXPORT double eda_axis_width(const eda_paper *paper, const eda_axis *axis);

/* A chart; the rectangle is that of the frame, without numbers and titles. */
typedef struct eda_chart {
  const eda_paper *paper;
  double left, top, width, height;
  const char *title; /* may be NULL */
  eda_axis x, y;
} eda_chart;

/* Return the position of a value on the surface. */
OPC_EXPORT double eda_chart_x(const eda_chart *chart, double x);
OPC_EXPORT double eda_chart_y(const eda_chart *chart, double y);

/* Draw the frame, the grid lines, the numbers or texts, and the titles. */
OPC_EXPORT void eda_chart_axes(const eda_chart *chart);

/* Draw a line through n points, clipped at the frame. NAN leaves a gap. */
OPC_EXPORT void eda_chart_line(const eda_chart *chart, eda_colour colour,
                               double width, double dash, const double *x,
                               const double *y, size_t n);
/* Draw filled circles at n points, as eda_chart_line. */
OPC_EXPORT void eda_chart_dots(const eda_chart *chart, eda_colour colour,
                               double radius, const double *x, const double *y,
                               size_t n);
/* Fill the band between `low` and `high`, 60 % opaque. */
OPC_EXPORT void eda_chart_band(const eda_chart *chart, eda_colour colour,
                               const double *x, const double *low,
                               const double *high, size_t n);

/* Draw a heat map: one rectangle for each pair of an x text and a y text. The
   colour scale `of` maps figure[x * y.labels + y] to the colour; NAN is grey
   with a cross. Also draw the colour scale to the right of the chart. Call this
   before eda_chart_axes. */
OPC_EXPORT void eda_chart_field(const eda_chart *chart, const eda_axis *of,
                                const double *figure);

OPC_C_END
