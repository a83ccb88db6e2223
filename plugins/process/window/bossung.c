/* SPDX-License-Identifier: BSD-3-Clause */
/* Two charts over focus: the mean deviation of the gates, one curve a dose (J.
   W. Bossung, SPIE 100, 1977), and the doses within tolerance. */
#include <eda/drawing.h>
#include <eda/memory.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "window.h"

static const double paper_width = 1200, paper_height = 560, font = 15;

/* What a range is widened by. */
static const double share = 0.06, least = 1;

static eda_colour colour_of(const window *w, size_t dose) {
  if (dose == w->nominal) return eda_ink;
  double t = (double)dose / (double)(w->dose.count - 1);
  return eda_diverging(t < 0.5 ? fmin(t, 0.25) : fmax(t, 0.75));
}

/* The doses, in their colours. */
static void draw_key(const eda_chart *c, const window *w) {
  double x = c->left + c->width + 0.6 * font, y = c->top + font;
  size_t skip = 1 + w->dose.count / 25;
  for (size_t i = w->dose.count; i-- > 0;) {
    if (i % skip && i != w->nominal) continue;
    char text[32];
    (void)snprintf(text, sizeof text, "%+g %%", w->dose.values[i]);
    eda_use(c->paper->cairo, colour_of(w, i));
    eda_text(c->paper, x, y, EDA_LEFT, INFINITY, text);
    y += 1.2 * font;
  }
  eda_use(c->paper->cairo, eda_ink);
}

static void draw_deviations(eda_chart *c, const window *w) {
  size_t foci = w->focus.count, doses = w->dose.count;
  double *mean = eda_alloc(doses * foci, sizeof *mean);
  for (size_t d = 0; d < doses; d++)
    for (size_t f = 0; f < foci; f++)
      mean[d * foci + f] = window_summarise(w, f, d).mean;
  eda_axis_fit(&c->y, mean, doses * foci);
  eda_axis_widen(&c->y, share, least);
  c->title = "mean deviation of the gate length, nm, by dose";
  eda_chart_axes(c);
  for (size_t d = 0; d < doses; d++) {
    eda_chart_line(c, colour_of(w, d), d == w->nominal ? 2.5 : 1.8, 0,
                   w->focus.values, mean + d * foci, foci);
    eda_chart_dots(c, colour_of(w, d), 3, w->focus.values, mean + d * foci,
                   foci);
  }
  draw_key(c, w);
  free(mean);
}

static void draw_doses(eda_chart *c, const window *w) {
  char title[96];
  (void)snprintf(title, sizeof title,
                 "doses that keep all gates within %g %% of drawn, %%",
                 w->tolerance);
  eda_axis_fit(&c->y, w->dose.values, w->dose.count);
  eda_axis_widen(&c->y, share, least);
  c->title = title;
  eda_chart_axes(c);
  c->title = NULL;
  eda_chart_band(c, eda_diverging(0.3), w->focus.values, w->low, w->high,
                 w->focus.count);
  for (size_t f = 0; f < w->focus.count; f++) {
    const double x[] = {w->focus.values[f], w->focus.values[f]};
    const double y[] = {w->low[f], w->high[f]};
    eda_chart_line(c, eda_diverging(0), 3, 0, x, y, 2);
  }
}

int window_draw(const window *w, opc_error *error) {
  const char *path = w->host->output_path(w->host, w->file, error);
  eda_paper *paper =
      path ? eda_paper_open(path, paper_width, paper_height, font, error)
           : NULL;
  if (!paper) return error->code;
  eda_chart c = {.paper = paper,
                 .left = 70,
                 .top = 50,
                 .width = 430,
                 .height = 430,
                 .x.title = "defocus, nm"};
  eda_axis_fit(&c.x, w->focus.values, w->focus.count);
  eda_axis_widen(&c.x, share, least);
  draw_deviations(&c, w);
  c.left = 680;
  draw_doses(&c, w);
  return eda_paper_close(paper, OPC_OK, error);
}
