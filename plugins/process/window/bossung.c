/* SPDX-License-Identifier: BSD-3-Clause */
/* Two charts over focus: the mean deviation of the gates, one curve a dose (J.
   W. Bossung, SPIE 100, 1977), and the doses within tolerance. */
#include <math.h>
#include <stdio.h>

#include "../../draw/chart.h"
#include "window.h"

static const double paper_width = 1200, paper_height = 560;

/* What a range is widened by. */
static const double share = 0.06, least = 1;

/* ---- deviations ---- */

/* Mean over the gates that print, nm. */
static double mean(const window_results *r, size_t f, size_t d) {
  double sum = 0, n = 0;
  for (size_t i = 0; i < r->gates->count; i++) {
    double deviation = window_deviation(r, f, d, i);
    if (isnan(deviation)) continue;
    sum += deviation * r->gates->length[i] / 100;
    n++;
  }
  return n > 0 ? sum / n : (double)NAN;
}

static rgb colour_of(const window_results *r, size_t d) {
  if (d == r->nominal) return picture_ink;
  size_t n = r->doses - 1;
  double t = 2.0 * (double)d / (double)n - 1;
  return picture_diverging(t < 0 ? fmin(t, -0.5) : fmax(t, 0.5));
}

static void draw_curve(const chart *c, const window_results *r, size_t d) {
  rgb colour = colour_of(r, d);
  double y[2] = {NAN, NAN};
  for (size_t f = 0; f < r->foci; f++, y[0] = y[1]) {
    y[1] = mean(r, f, d);
    if (isnan(y[1])) continue;
    if (!isnan(y[0]))
      chart_line(c, colour, d == r->nominal ? 2.5 : 1.8, 0, &r->focus[f - 1], y,
                 2);
    picture_use(c->cairo, colour);
    cairo_arc(c->cairo, chart_x(c, r->focus[f]), chart_y(c, y[1]), 3, 0,
              2 * M_PI);
    cairo_fill(c->cairo);
  }
}

static void draw_key(const chart *c, const window_results *r) {
  double x = c->left + c->width + 0.6 * c->font, y = c->top + c->font;
  size_t skip = 1 + r->doses / 25;
  for (size_t i = r->doses; i-- > 0;) {
    if (i % skip && i != r->nominal) continue;
    char text[32];
    (void)snprintf(text, sizeof text, "%+g %%", r->dose[i]);
    picture_use(c->cairo, colour_of(r, i));
    chart_text(c, x, y, CHART_BEGIN, text);
    y += 1.2 * c->font;
  }
}

static void draw_deviations(chart *c, const window_results *r) {
  c->y0 = INFINITY, c->y1 = -INFINITY;
  for (size_t k = 0; k < r->foci * r->doses; k++) {
    double y = mean(r, k / r->doses, k % r->doses);
    if (isnan(y)) continue;
    c->y0 = fmin(c->y0, y);
    c->y1 = fmax(c->y1, y);
  }
  chart_widen(&c->y0, &c->y1, share, least);
  chart_axes(c, "mean deviation of the gate length, nm, by dose", "defocus, nm",
             NULL);
  for (size_t d = 0; d < r->doses; d++) draw_curve(c, r, d);
  draw_key(c, r);
}

/* ---- the window ---- */

static void draw_window(chart *c, const window_results *r) {
  char title[96];
  (void)snprintf(title, sizeof title,
                 "doses that keep all gates within %g %% of drawn, %%",
                 r->tolerance);
  c->y0 = r->dose[0];
  c->y1 = r->dose[r->doses - 1];
  chart_widen(&c->y0, &c->y1, share, least);
  chart_axes(c, title, "defocus, nm", NULL);
  rgb fill = picture_diverging(-0.4), edge = picture_diverging(-1);
  for (size_t f = 0; f + 1 < r->foci; f++) {
    if (isnan(r->low[f]) || isnan(r->low[f + 1])) continue;
    double x = chart_x(c, r->focus[f]), next = chart_x(c, r->focus[f + 1]);
    cairo_move_to(c->cairo, x, chart_y(c, r->low[f]));
    cairo_line_to(c->cairo, x, chart_y(c, r->high[f]));
    cairo_line_to(c->cairo, next, chart_y(c, r->high[f + 1]));
    cairo_line_to(c->cairo, next, chart_y(c, r->low[f + 1]));
    cairo_close_path(c->cairo);
    cairo_set_source_rgba(c->cairo, fill.r, fill.g, fill.b, 0.6);
    cairo_fill(c->cairo);
  }
  for (size_t f = 0; f < r->foci; f++) {
    if (isnan(r->low[f])) continue;
    const double x[] = {r->focus[f], r->focus[f]};
    const double y[] = {r->low[f], r->high[f]};
    chart_line(c, edge, 3, 0, x, y, 2);
  }
}

int window_draw(const opc_host *host, const window_results *r, int format,
                const char *path, opc_error *error) {
  paper file;
  chart c;
  int code = chart_open(&file, host, format, path, paper_width, paper_height,
                        &c, error);
  if (code) return code;
  c.left = 70;
  c.top = 50;
  c.width = c.height = 430;
  c.x0 = r->focus[0];
  c.x1 = r->focus[r->foci - 1];
  chart_widen(&c.x0, &c.x1, share, least);
  draw_deviations(&c, r);
  c.left = 680;
  draw_window(&c, r);
  return paper_close(&file, OPC_OK, error);
}
