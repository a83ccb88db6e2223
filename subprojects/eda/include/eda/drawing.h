/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures: drawing surface, text, legends, charts and their colours. Not part
   of <eda/eda.h>, because these functions need cairo. Coordinates are pixels
   (points in a vector format), y downwards. All functions are [any]; use each
   surface from one thread at a time. */
#pragma once

#include <cairo.h>
#include <opcflow/base.h>

OPC_C_BEGIN

/* ---- colours ---------------------------------------------------------- */

typedef struct eda_colour {
  double r, g, b;
} eda_colour;

/* Initialise a colour from a literal like 0xe07000. */
#define EDA_COLOUR(hex)                                      \
  {                                                          \
    ((hex) >> 16 & 255) / 255.0, ((hex) >> 8 & 255) / 255.0, \
        ((hex)&255) / 255.0                                  \
  }

OPC_EXPORT extern const eda_colour eda_ink, eda_faint, eda_unknown,
    eda_ring_colour;

/* Colours of a layer, by its number: drawn shape (fill), mask (outline),
   simulated contour. */
OPC_EXPORT extern const eda_colour eda_contact_fill;
OPC_EXPORT eda_colour eda_layer_fill(size_t layer);
OPC_EXPORT eda_colour eda_layer_outline(size_t layer);
OPC_EXPORT eda_colour eda_layer_contour(size_t layer);

/* Return the colour of a deviation, from blue through white to red; t from 0 to
   1, clamped. */
OPC_EXPORT eda_colour eda_diverging(double t);

/* Return the colour of an intensity, from dark to light with monotone
   lightness, readable in grey; t from 0 to 1, clamped. */
OPC_EXPORT eda_colour eda_sequential(double t);

OPC_EXPORT void eda_use(cairo_t *cairo, eda_colour colour);

/* ---- paper ------------------------------------------------------------ */

/* A file that is drawn on. All functions below except eda_use leave the ink
   colour, no dashes and the normal font in place. */
typedef struct eda_paper {
  cairo_t *cairo; /* drawing context */
  double width, height;
  double font;   /* text height */
  double margin; /* margin of titles and legends; may be changed */
  int pixels;    /* 1 for a .png: align lines to pixels */
} eda_paper;

/* Check the name of a picture: .png, .svg or .pdf. Otherwise return OPC_INVALID
   with an error of `parameter`. */
OPC_EXPORT int eda_paper_check(const char *file, const char *parameter,
                               opc_error *error);

/* Open a white surface; return NULL and *error if the file cannot be written.
   `path` must live until the surface is closed. Equal pictures produce equal
   files. */
OPC_EXPORT eda_paper *eda_paper_open(const char *path, double width,
                                     double height, double font,
                                     opc_error *error);

/* Set the height of a surface that was opened with height 0 for measuring
   (drawing on such a surface has no effect) and start drawing anew. */
OPC_EXPORT void eda_paper_cut(eda_paper *paper, double height);

/* Write and close the file, unless `code` reports that drawing has failed.
   Return `code` or the error of writing. On failure no file remains. */
OPC_EXPORT int eda_paper_close(eda_paper *paper, int code, opc_error *error);

/* ---- text and signs --------------------------------------------------- */

enum { EDA_LEFT, EDA_MIDDLE, EDA_RIGHT };

/* Draw a line of text whose left end, middle or right end is at x, in the
   current colour, truncated to the width `width`, which may be INFINITY. */
OPC_EXPORT void eda_text(const eda_paper *paper, double x, double baseline,
                         int place, double width, const char *text);

/* Draw a line of large text below `top`; return its height. */
OPC_EXPORT double eda_heading(const eda_paper *paper, double top,
                              const char *text);

/* Draw a cross through a rectangle. */
OPC_EXPORT void eda_cross(const eda_paper *paper, double x, double y,
                          double width, double height);

/* Draw a ring around a place, visible on any background. */
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
  double line, dash;  /* width and dash length of a LINE; 0: none */
  eda_colour behind;  /* colour of the line behind a LINE */
  double behind_line; /* its width; 0: none */
  double size;        /* size of a BAR */
  eda_colour (*ramp)(double t);
  const char *low, *high; /* labels of the ends of a RAMP */
} eda_sign;

/* A legend. Entries flow from left to right, then down, to fit any width. */
typedef struct eda_legend {
  const eda_paper *paper;
  double top, height; /* position, and current height */
  double x;
} eda_legend;

OPC_EXPORT void eda_legend_init(eda_legend *legend, const eda_paper *paper,
                                double top);
/* Draw an entry: a symbol (NULL: none) and a text formatted as by printf. */
OPC_EXPORT void eda_legend_add(eda_legend *legend, const eda_sign *sign,
                               const char *format, ...) OPC_PRINTF(3, 4);

/* ---- charts ----------------------------------------------------------- */

/* An axis, or a colour scale. */
typedef struct eda_axis {
  double low, high; /* values at the ends */
  int log;
  const char *unit;         /* unit after each number, with a prefix as in "20
                               mA"; NULL: plain numbers */
  const char *title;        /* may be NULL */
  const char *const *label; /* labels at 0, 1, ... in place of numbers; may be
                               NULL */
  size_t labels;
} eda_axis;

/* Set the range to the smallest and largest value that is a number; low > high
   if none is. */
OPC_EXPORT void eda_axis_fit(eda_axis *axis, const double *value, size_t n);

/* Extend the range at both ends by a fraction `share`, at least by `least`
   (decades of a logarithmic axis). An empty range is extended around 0. */
OPC_EXPORT void eda_axis_widen(eda_axis *axis, double share, double least);

/* Set labels; each gets an equal part of the axis. */
OPC_EXPORT void eda_axis_label(eda_axis *axis, const char *const *label,
                               size_t labels);

/* Return the position of a value, from 0 at the low end to 1 at the high
   end. */
OPC_EXPORT double eda_axis_place(const eda_axis *axis, double value);

/* Return the width of labels and title at the left of a chart with this y
   axis. */
OPC_EXPORT double eda_axis_width(const eda_paper *paper, const eda_axis *axis);

typedef struct eda_chart {
  const eda_paper *paper;
  double left, top, width, height;
  const char *title; /* may be NULL */
  eda_axis x, y;
} eda_chart;

/* Return a position on the surface. */
OPC_EXPORT double eda_chart_x(const eda_chart *chart, double x);
OPC_EXPORT double eda_chart_y(const eda_chart *chart, double y);

/* Draw the frame, the grid, labels and titles. */
OPC_EXPORT void eda_chart_axes(const eda_chart *chart);

/* Draw a line, clipped at the frame of the chart. A NAN value leaves a gap. */
OPC_EXPORT void eda_chart_line(const eda_chart *chart, eda_colour colour,
                               double width, double dash, const double *x,
                               const double *y, size_t n);
OPC_EXPORT void eda_chart_dots(const eda_chart *chart, eda_colour colour,
                               double radius, const double *x, const double *y,
                               size_t n);
/* Fill the band between `low` and `high`, half transparent. */
OPC_EXPORT void eda_chart_band(const eda_chart *chart, eda_colour colour,
                               const double *x, const double *low,
                               const double *high, size_t n);

/* Draw a rectangle for each pair of labels of the axes, x first, in the colour
   of its figure on the scale `of`, crossed out if NAN. Draw the colour scale at
   the right. Call before eda_chart_axes. */
OPC_EXPORT void eda_chart_field(const eda_chart *chart, const eda_axis *of,
                                const double *figure);

OPC_C_END
