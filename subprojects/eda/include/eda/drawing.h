/* SPDX-License-Identifier: BSD-3-Clause */
/* Pictures: paper of some format, text, legends, charts, and the colours of all
   of them. Not part of <eda/eda.h>, as it needs cairo. Places on paper are in
   pixels (points of a vector format), y downwards. All [any], each paper by one
   thread at a time. */
#ifndef EDA_DRAWING_H
#define EDA_DRAWING_H

#include <cairo.h>
#include <opcflow/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- colours ---------------------------------------------------------- */

typedef struct eda_colour {
  double r, g, b;
} eda_colour;

/* Of a literal like 0xe07000, for initialisers. */
#define EDA_COLOUR(hex)                                      \
  {                                                          \
    ((hex) >> 16 & 255) / 255.0, ((hex) >> 8 & 255) / 255.0, \
        ((hex)&255) / 255.0                                  \
  }

OPC_EXPORT extern const eda_colour eda_ink, eda_faint, eda_unknown,
    eda_ring_colour;

/* Of a layer, by its number: what is drawn (a fill), its mask (an outline),
   its print (a contour). */
OPC_EXPORT extern const eda_colour eda_contact_fill;
OPC_EXPORT eda_colour eda_layer_fill(size_t layer);
OPC_EXPORT eda_colour eda_layer_outline(size_t layer);
OPC_EXPORT eda_colour eda_layer_contour(size_t layer);

/* Of a deviation, from blue by white to red; t from 0 to 1, clamped. */
OPC_EXPORT eda_colour eda_diverging(double t);

/* Of an intensity, from dark to light, of growing lightness, so that it reads
   in grey as well; t from 0 to 1, clamped. */
OPC_EXPORT eda_colour eda_sequential(double t);

OPC_EXPORT void eda_use(cairo_t *cairo, eda_colour colour);

/* ---- paper ------------------------------------------------------------ */

/* A file that is drawn on. All below but eda_use leave the ink in the pen, no
   dashes, and the normal font. */
typedef struct eda_paper {
  cairo_t *cairo; /* draw here */
  double width, height;
  double font;   /* height of the text */
  double margin; /* of titles and legends; may be changed */
  int pixels;    /* a .png: lines should sit on pixels */
} eda_paper;

/* Whether a picture can have that name: .png, .svg or .pdf. OPC_INVALID and
 *error, put down to `parameter`, if not. */
OPC_EXPORT int eda_paper_check(const char *file, const char *parameter,
                               opc_error *error);

/* White paper; NULL and *error if the file cannot be written. `path` lives
   until it is closed. Equal pictures are equal files. */
OPC_EXPORT eda_paper *eda_paper_open(const char *path, double width,
                                     double height, double font,
                                     opc_error *error);

/* Paper that was opened with a height of 0 is for measuring, what is drawn is
   not seen. This gives it the height, and all begins anew. */
OPC_EXPORT void eda_paper_cut(eda_paper *paper, double height);

/* Write the rest, unless `code` says that drawing has failed; returns `code` or
   what went wrong here. On failure no file is left. */
OPC_EXPORT int eda_paper_close(eda_paper *paper, int code, opc_error *error);

/* ---- text and signs --------------------------------------------------- */

enum { EDA_LEFT, EDA_MIDDLE, EDA_RIGHT };

/* A line of text whose left end, middle or right end is at x, in the present
   colour; cut to `room`, which may be INFINITY. */
OPC_EXPORT void eda_text(const eda_paper *paper, double x, double baseline,
                         int place, double room, const char *text);

/* A line of large letters below `top`; returns its height. */
OPC_EXPORT double eda_heading(const eda_paper *paper, double top,
                              const char *text);

/* A cross through a rectangle. */
OPC_EXPORT void eda_cross(const eda_paper *paper, double x, double y,
                          double width, double height);

/* A ring around a place that is worth a look, seen on any ground. */
OPC_EXPORT void eda_ring(const eda_paper *paper, double x, double y);

/* ---- legends ---------------------------------------------------------- */

/* What stands before the text of an entry. */
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
  double line, dash;  /* of a LINE: width, and dashes; 0: none */
  eda_colour behind;  /* of a LINE that is drawn upon another one */
  double behind_line; /* its width; 0: there is none */
  double size;        /* of a BAR */
  eda_colour (*ramp)(double t);
  const char *low, *high; /* what the ends of the RAMP mean */
} eda_sign;

/* Entries flow from left to right, then down, so that any width of the paper
   will do. */
typedef struct eda_legend {
  const eda_paper *paper;
  double top, height; /* that it has so far */
  double x;
} eda_legend;

OPC_EXPORT void eda_legend_init(eda_legend *legend, const eda_paper *paper,
                                double top);
/* Draw an entry; no sign if that is NULL, the text as by printf. */
OPC_EXPORT void eda_legend_add(eda_legend *legend, const eda_sign *sign,
                               const char *format, ...) OPC_PRINTF(3, 4);

/* ---- charts ----------------------------------------------------------- */

/* An axis, or a scale of colours. */
typedef struct eda_axis {
  double low, high; /* at its ends */
  int log;
  const char *unit;         /* stands behind each number, with a prefix as in
                               "20 mA"; NULL: plain numbers */
  const char *title;        /* may be NULL */
  const char *const *label; /* not numbers, but these at 0, 1, ...; NULL */
  size_t labels;
} eda_axis;

/* From the least to the greatest of the values that are numbers; low above high
   if there is none. */
OPC_EXPORT void eda_axis_fit(eda_axis *axis, const double *value, size_t n);

/* More room at both ends: a share of the range, at least `least` (decades of a
   logarithmic axis). A range of nothing is made of 0. */
OPC_EXPORT void eda_axis_widen(eda_axis *axis, double share, double least);

/* Each label gets an equal part of the axis. */
OPC_EXPORT void eda_axis_label(eda_axis *axis, const char *const *label,
                               size_t labels);

/* From 0 at the low end to 1 at the high one. */
OPC_EXPORT double eda_axis_place(const eda_axis *axis, double value);

/* The room that what stands at the left of a chart takes, if that is its axis
   of y. */
OPC_EXPORT double eda_axis_width(const eda_paper *paper, const eda_axis *axis);

typedef struct eda_chart {
  const eda_paper *paper;
  double left, top, width, height;
  const char *title; /* may be NULL */
  eda_axis x, y;
} eda_chart;

/* Places on paper. */
OPC_EXPORT double eda_chart_x(const eda_chart *chart, double x);
OPC_EXPORT double eda_chart_y(const eda_chart *chart, double y);

/* The frame, its grid and what stands around it. */
OPC_EXPORT void eda_chart_axes(const eda_chart *chart);

/* What is in a chart is cut at its frame. A value that is NAN leaves a gap. */
OPC_EXPORT void eda_chart_line(const eda_chart *chart, eda_colour colour,
                               double width, double dash, const double *x,
                               const double *y, size_t n);
OPC_EXPORT void eda_chart_dots(const eda_chart *chart, eda_colour colour,
                               double radius, const double *x, const double *y,
                               size_t n);
/* All between `low` and `high`, half transparent. */
OPC_EXPORT void eda_chart_band(const eda_chart *chart, eda_colour colour,
                               const double *x, const double *low,
                               const double *high, size_t n);

/* A rectangle for each pair of labels of the axes, x first: in the colour of
   its figure on the scale `of`, crossed out where that is NAN; and that scale
   at the right. Before the axes. */
OPC_EXPORT void eda_chart_field(const eda_chart *chart, const eda_axis *of,
                                const double *figure);

#ifdef __cplusplus
}
#endif
#endif
