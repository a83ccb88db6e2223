/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart.h"

#include <math.h>
#include <stdio.h>

static double px(const chart *c, double x) {
  return c->left + (x - c->x0) / (c->x1 - c->x0) * c->width;
}

static double py(const chart *c, double y) {
  return c->top + (c->y1 - y) / (c->y1 - c->y0) * c->height;
}

void chart_text(const chart *c, double x, double y, int place,
                const char *text) {
  cairo_text_extents_t e;
  cairo_text_extents(c->cairo, text, &e);
  cairo_move_to(c->cairo, x - e.x_advance * place / 2, y);
  cairo_show_text(c->cairo, text);
}

/* 1, 2 or 5 times a power of ten, about a sixth of a range. */
static double tick(double range) {
  double rough = range / 6, unit = pow(10, floor(log10(rough)));
  if (rough > 5 * unit) return 10 * unit;
  if (rough > 2 * unit) return 5 * unit;
  return rough > unit ? 2 * unit : unit;
}

static void grid_line(const chart *c, double x0, double y0, double x1,
                      double y1) {
  picture_use(c->cairo, picture_faint);
  cairo_set_line_width(c->cairo, 0.5);
  cairo_move_to(c->cairo, x0, y0);
  cairo_line_to(c->cairo, x1, y1);
  cairo_stroke(c->cairo);
  picture_use(c->cairo, picture_ink);
}

static void upright_text(const chart *c, double x, double y, const char *text) {
  cairo_save(c->cairo);
  cairo_translate(c->cairo, x, y);
  cairo_rotate(c->cairo, -M_PI / 2);
  chart_text(c, 0, 0, CHART_MIDDLE, text);
  cairo_restore(c->cairo);
}

void chart_axes(const chart *c, const char *title, const char *of_x,
                const char *of_y) {
  char text[32];
  double font = c->font, bottom = c->top + c->height;
  double step = tick(c->x1 - c->x0);
  for (double i = ceil(c->x0 / step); i * step <= c->x1 + step / 100; i++) {
    double x = px(c, i * step);
    grid_line(c, x, c->top, x, bottom);
    (void)snprintf(text, sizeof text, "%g", i * step + 0.0);
    chart_text(c, x, bottom + 1.3 * font, CHART_MIDDLE, text);
  }
  step = tick(c->y1 - c->y0);
  for (double i = ceil(c->y0 / step); i * step <= c->y1 + step / 100; i++) {
    double y = py(c, i * step);
    grid_line(c, c->left, y, c->left + c->width, y);
    (void)snprintf(text, sizeof text, "%g", i * step + 0.0);
    chart_text(c, c->left - 0.5 * font, y + 0.35 * font, CHART_END, text);
  }
  chart_text(c, c->left, c->top - 0.7 * font, CHART_BEGIN, title);
  chart_text(c, c->left + c->width / 2, bottom + 2.8 * font, CHART_MIDDLE,
             of_x);
  upright_text(c, c->left - 3 * font, c->top + c->height / 2, of_y);
  cairo_set_line_width(c->cairo, 1);
  cairo_rectangle(c->cairo, c->left, c->top, c->width, c->height);
  cairo_stroke(c->cairo);
}

static void set_pen(cairo_t *cairo, rgb colour, double width, double dash) {
  picture_use(cairo, colour);
  cairo_set_line_width(cairo, width);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_dash(cairo, &dash, dash > 0, 0);
}

void chart_line(const chart *c, rgb colour, double width, double dash,
                const double *x, const double *y, size_t count) {
  cairo_save(c->cairo);
  cairo_rectangle(c->cairo, c->left, c->top, c->width, c->height);
  cairo_clip(c->cairo);
  for (size_t i = 0; i < count; i++)
    cairo_line_to(c->cairo, px(c, x[i]), py(c, y[i]));
  set_pen(c->cairo, colour, width, dash);
  cairo_stroke(c->cairo);
  cairo_restore(c->cairo);
}

double chart_key(const chart *c, double x, double y, rgb colour, double dash,
                 const char *text) {
  cairo_text_extents_t e;
  cairo_save(c->cairo);
  cairo_move_to(c->cairo, x, y - 0.35 * c->font);
  cairo_rel_line_to(c->cairo, 2 * c->font, 0);
  set_pen(c->cairo, colour, 2.5, dash);
  cairo_stroke(c->cairo);
  cairo_restore(c->cairo);
  picture_use(c->cairo, picture_ink);
  chart_text(c, x + 2.5 * c->font, y, CHART_BEGIN, text);
  cairo_text_extents(c->cairo, text, &e);
  return x + 4.5 * c->font + e.x_advance;
}
