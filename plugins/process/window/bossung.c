/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws charts over focus: quantities with one curve per dose (J. W. Bossung,
   SPIE 100, 1977), and the doses within the limits. */
#include <eda/drawing.h>
#include <eda/memory.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "window.h"

/* Width of the picture, height of a row of two charts, and positions of the
   charts in the row, pixels. */
enum { WIDTH = 1200, ROW = 560, TOP = 50, LEFT = 80, RIGHT = 690, SIDE = 430 };
static const double font = 15;

/* Margin at the ends of an axis, relative to the range of the values; smallest
   margin; and smallest margin of a logarithmic axis, in decades. */
static const double share = 0.06, least = 1, least_decades = 0.1;

/* Lines per interval of foci that fill the area within the limits. */
enum { LINES = 8 };

static eda_colour colour_of(const window *w, size_t dose) {
  if (dose == w->nominal_dose) return eda_ink;
  double t = (double)dose / (double)(w->dose.count - 1);
  return eda_diverging(t < 0.5 ? fmin(t, 0.25) : fmax(t, 0.75));
}

/* Draw the legend: doses and their colours. */
static void draw_key(const eda_chart *c, const window *w) {
  double x = c->left + c->width + 0.6 * font, y = c->top + font;
  size_t skip = 1 + w->dose.count / 25;
  for (size_t i = w->dose.count; i-- > 0;) {
    if (i % skip && i != w->nominal_dose) continue;
    char text[32];
    (void)snprintf(text, sizeof text, "%+g %%", w->dose.values[i]);
    eda_use(c->paper->cairo, colour_of(w, i));
    eda_text(c->paper, x, y, EDA_LEFT, INFINITY, text);
    y += 1.2 * font;
  }
  eda_use(c->paper->cairo, eda_ink);
}

/* ---- curves ---- */

typedef double figure(const window *w, const window_print *print);

static double length_of(const window *w, const window_print *p) {
  return window_summarise(w, p).mean;
}

static double ion_of(const window *w, const window_print *p) {
  (void)w;
  return 1 + p->spread.ion_mean[2] / 100;
}

/* Return the larger standard deviation of Ion of the two types. */
static double ion_sd_of(const window *w, const window_print *p) {
  (void)w;
  double sd = fmax(p->spread.ion_sd[EDA_NMOS], p->spread.ion_sd[EDA_PMOS]);
  return sd > 0 ? sd : NAN; /* the axis is logarithmic */
}

static double leakage_of(const window *w, const window_print *p) {
  (void)w;
  return p->spread.leakage[2];
}

static void draw_curves(eda_chart *c, const window *w, const char *title,
                        figure *of, int log) {
  size_t foci = w->focus.count, doses = w->dose.count;
  double *y = eda_alloc(doses * foci, sizeof *y);
  for (size_t d = 0; d < doses; d++)
    for (size_t f = 0; f < foci; f++)
      y[d * foci + f] = of(w, window_at(w, f, d));
  c->y = (eda_axis){.log = log};
  eda_axis_fit(&c->y, y, doses * foci);
  if (log && !(c->y.low <= c->y.high)) c->y.low = c->y.high = 1;
  eda_axis_widen(&c->y, share, log ? least_decades : least);
  c->title = title;
  eda_chart_axes(c);
  for (size_t d = 0; d < doses; d++) {
    eda_chart_line(c, colour_of(w, d), d == w->nominal_dose ? 2.5 : 1.8, 0,
                   w->focus.values, y + d * foci, foci);
    eda_chart_dots(c, colour_of(w, d), 3, w->focus.values, y + d * foci, foci);
  }
  draw_key(c, w);
  free(y);
}

/* ---- windows ---- */

static void doses_axis(eda_chart *c, const window *w, const char *title) {
  c->y = (eda_axis){0};
  eda_axis_fit(&c->y, w->dose.values, w->dose.count);
  eda_axis_widen(&c->y, share, least);
  c->title = title;
  eda_chart_axes(c);
  c->title = NULL;
}

static void draw_doses(eda_chart *c, const window *w) {
  char title[96];
  (void)snprintf(title, sizeof title,
                 "doses that keep all gates within %g %% of drawn, %%",
                 w->tolerance);
  doses_axis(c, w, title);
  eda_chart_band(c, eda_diverging(0.3), w->focus.values, w->low, w->high,
                 w->focus.count);
  for (size_t f = 0; f < w->focus.count; f++) {
    const double x[] = {w->focus.values[f], w->focus.values[f]};
    const double y[] = {w->low[f], w->high[f]};
    eda_chart_line(c, eda_diverging(0), 3, 0, x, y, 2);
  }
}

/* Draw the area within the limits. */
static void draw_kept(const eda_chart *c, const window *w, int limits,
                      eda_colour colour, double width) {
  for (size_t f = 0; f + 1 < w->focus.count; f++)
    for (size_t d = 0; d + 1 < w->dose.count; d++)
      for (int k = 0; k < LINES; k++) {
        double at = (k + 0.5) / LINES, low, high;
        if (!window_keeps(w, limits, f, at, d, &low, &high)) continue;
        double x = w->focus.values[f] +
                   at * (w->focus.values[f + 1] - w->focus.values[f]);
        const double both[] = {x, x}, y[] = {low, high};
        eda_chart_line(c, colour, width, 0, both, y, 2);
      }
}

static void draw_areas(eda_chart *c, const window *w) {
  static const struct {
    int limits;
    double t, width;
    const char *text;
  } kinds[] = {{WINDOW_ION, 0.15, 6, "Ion"},
               {WINDOW_IOFF, 0.85, 3.5, "Ioff"},
               {WINDOW_BOTH, -1, 1.5, "both"}};
  char title[96];
  (void)snprintf(title, sizeof title,
                 "doses that keep Ion within %g %%, Ioff below +%g %%",
                 w->ion_limit, w->ioff_limit);
  doses_axis(c, w, title);
  for (size_t k = 0; k < 3; k++) {
    eda_colour colour = kinds[k].t < 0 ? eda_ink : eda_diverging(kinds[k].t);
    draw_kept(c, w, kinds[k].limits, colour, kinds[k].width);
    eda_use(c->paper->cairo, colour);
    eda_text(c->paper, c->left + c->width + 0.6 * font,
             c->top + (1 + 1.2 * (double)k) * font, EDA_LEFT, INFINITY,
             kinds[k].text);
  }
  eda_use(c->paper->cairo, eda_ink);
}

/* ---- the picture ---- */

static void draw_currents(eda_chart *c, const window *w) {
  c->top += ROW;
  c->left = LEFT;
  draw_curves(c, w, "mean of Ion over drawn, by dose", ion_of, 1);
  c->left = RIGHT;
  draw_curves(c, w, "standard deviation of Ion of n or p, %, by dose",
              ion_sd_of, 0);
  c->top += ROW;
  c->left = LEFT;
  draw_curves(c, w, "total leakage over drawn, by dose", leakage_of, 1);
  c->left = RIGHT;
  draw_areas(c, w);
}

int window_draw(const window *w, opc_error *error) {
  const char *path = w->host->output_path(w->host, w->file, error);
  eda_paper *paper =
      path ? eda_paper_open(path, WIDTH, w->extractor ? 3 * ROW : ROW, font,
                            error)
           : NULL;
  if (!paper) return error->code;
  eda_chart c = {.paper = paper,
                 .left = LEFT,
                 .top = TOP,
                 .width = SIDE,
                 .height = SIDE,
                 .x.title = "defocus, nm"};
  eda_axis_fit(&c.x, w->focus.values, w->focus.count);
  eda_axis_widen(&c.x, share, least);
  draw_curves(&c, w, "mean deviation of the gate length, nm, by dose",
              length_of, 0);
  c.left = RIGHT;
  draw_doses(&c, w);
  if (w->extractor) draw_currents(&c, w);
  return eda_paper_close(paper, OPC_OK, error);
}
