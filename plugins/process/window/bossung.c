/* SPDX-License-Identifier: BSD-3-Clause */
/* Two charts over focus: the mean deviation of the gates, one curve a dose (J.
   W. Bossung, SPIE 100, 1977), and the doses within tolerance. */
#include <math.h>
#include <stdio.h>

#include "../../draw/mask/paper.h"
#include "../../draw/mask/picture.h"
#include "window.h"

static const double paper_width = 1200, paper_height = 560, font = 15;

/* A chart: where it lies on the paper, and the ranges of its axes. */
typedef struct chart {
  cairo_t *cairo;
  double left, top, width, height;
  double x0, x1, y0, y1;
} chart;

static double px(const chart *c, double x) {
  return c->left + (x - c->x0) / (c->x1 - c->x0) * c->width;
}

static double py(const chart *c, double y) {
  return c->top + (c->y1 - y) / (c->y1 - c->y0) * c->height;
}

/* ---- text ---- */

enum { BEGIN, MIDDLE, END };

static void put_text(cairo_t *cairo, double x, double y, int place,
                     const char *text) {
  cairo_text_extents_t e;
  cairo_text_extents(cairo, text, &e);
  cairo_move_to(cairo, x - e.x_advance * place / 2, y);
  cairo_show_text(cairo, text);
}

/* ---- axes ---- */

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

static void draw_axes(const chart *c, const char *title, const char *of_x) {
  char text[32];
  double step = tick(c->x1 - c->x0), bottom = c->top + c->height;
  for (double i = ceil(c->x0 / step); i * step <= c->x1; i++) {
    double x = px(c, i * step);
    grid_line(c, x, c->top, x, bottom);
    (void)snprintf(text, sizeof text, "%g", i * step + 0.0);
    put_text(c->cairo, x, bottom + 1.3 * font, MIDDLE, text);
  }
  step = tick(c->y1 - c->y0);
  for (double i = ceil(c->y0 / step); i * step <= c->y1; i++) {
    double y = py(c, i * step);
    grid_line(c, c->left, y, c->left + c->width, y);
    (void)snprintf(text, sizeof text, "%g", i * step + 0.0);
    put_text(c->cairo, c->left - 0.5 * font, y + 0.35 * font, END, text);
  }
  put_text(c->cairo, c->left, c->top - 0.7 * font, BEGIN, title);
  put_text(c->cairo, c->left + c->width / 2, bottom + 2.8 * font, MIDDLE, of_x);
  cairo_set_line_width(c->cairo, 1);
  cairo_rectangle(c->cairo, c->left, c->top, c->width, c->height);
  cairo_stroke(c->cairo);
}

/* A range with something around it, never empty. */
static void widen(double *low, double *high) {
  if (!(*low <= *high)) *low = *high = 0;
  double room = fmax(0.06 * (*high - *low), 1);
  *low -= room;
  *high += room;
}

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
  double last = NAN, y;
  picture_use(c->cairo, colour_of(r, d));
  cairo_set_line_width(c->cairo, d == r->nominal ? 2.5 : 1.8);
  for (size_t f = 0; f < r->foci; f++, last = y) {
    y = mean(r, f, d);
    if (isnan(y)) continue;
    double x = px(c, r->focus[f]);
    if (!isnan(last)) {
      cairo_move_to(c->cairo, px(c, r->focus[f - 1]), py(c, last));
      cairo_line_to(c->cairo, x, py(c, y));
      cairo_stroke(c->cairo);
    }
    cairo_arc(c->cairo, x, py(c, y), 3, 0, 2 * M_PI);
    cairo_fill(c->cairo);
  }
}

static void draw_key(const chart *c, const window_results *r) {
  double x = c->left + c->width + 0.6 * font, y = c->top + font;
  size_t skip = 1 + r->doses / 25;
  for (size_t i = r->doses; i-- > 0;) {
    if (i % skip && i != r->nominal) continue;
    char text[32];
    (void)snprintf(text, sizeof text, "%+g %%", r->dose[i]);
    picture_use(c->cairo, colour_of(r, i));
    put_text(c->cairo, x, y, BEGIN, text);
    y += 1.2 * font;
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
  widen(&c->y0, &c->y1);
  draw_axes(c, "mean deviation of the gate length, nm, by dose", "defocus, nm");
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
  widen(&c->y0, &c->y1);
  draw_axes(c, title, "defocus, nm");
  rgb fill = picture_diverging(-0.4), edge = picture_diverging(-1);
  for (size_t f = 0; f < r->foci; f++) {
    if (isnan(r->low[f])) continue;
    double x = px(c, r->focus[f]);
    if (f + 1 < r->foci && !isnan(r->low[f + 1])) {
      double next = px(c, r->focus[f + 1]);
      cairo_move_to(c->cairo, x, py(c, r->low[f]));
      cairo_line_to(c->cairo, x, py(c, r->high[f]));
      cairo_line_to(c->cairo, next, py(c, r->high[f + 1]));
      cairo_line_to(c->cairo, next, py(c, r->low[f + 1]));
      cairo_close_path(c->cairo);
      cairo_set_source_rgba(c->cairo, fill.r, fill.g, fill.b, 0.6);
      cairo_fill(c->cairo);
    }
  }
  picture_use(c->cairo, edge);
  cairo_set_line_width(c->cairo, 3);
  for (size_t f = 0; f < r->foci; f++) {
    if (isnan(r->low[f])) continue;
    double x = px(c, r->focus[f]);
    cairo_move_to(c->cairo, x, py(c, r->low[f]));
    cairo_line_to(c->cairo, x, py(c, r->high[f]));
    cairo_stroke(c->cairo);
  }
}

int window_draw(const opc_host *host, const window_results *r, int format,
                const char *path, opc_error *error) {
  paper file;
  int code =
      paper_open(&file, host, format, path, paper_width, paper_height, error);
  if (code) return code;
  cairo_t *cairo = file.cairo;
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, font);
  chart c = {.cairo = cairo,
             .left = 70,
             .top = 50,
             .width = 430,
             .height = 430,
             .x0 = r->focus[0],
             .x1 = r->focus[r->foci - 1]};
  widen(&c.x0, &c.x1);
  draw_deviations(&c, r);
  c.left = 680;
  draw_window(&c, r);
  return paper_close(&file, OPC_OK, error);
}
