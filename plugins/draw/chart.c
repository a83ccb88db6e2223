/* SPDX-License-Identifier: BSD-3-Clause */
#include "chart.h"

#include <math.h>
#include <stdio.h>

double chart_x(const chart *c, double x) {
  return c->left + (x - c->x0) / (c->x1 - c->x0) * c->width;
}

double chart_y(const chart *c, double y) {
  double down = c->decades ? log(c->y1 / y) / log(c->y1 / c->y0)
                           : (c->y1 - y) / (c->y1 - c->y0);
  return c->top + down * c->height;
}

void chart_widen(double *low, double *high, double share, double least) {
  if (!(*low <= *high)) *low = *high = 0;
  double room = fmax(share * (*high - *low), least);
  *low -= room;
  *high += room;
}

int chart_open(paper *file, const opc_host *host, int format, const char *path,
               double width, double height, chart *c, opc_error *error) {
  static const double font = 15;
  int code = paper_open(file, host, format, path, width, height, error);
  if (code) return code;
  *c = (chart){.cairo = file->cairo, .font = font};
  cairo_set_source_rgb(c->cairo, 1, 1, 1);
  cairo_paint(c->cairo);
  cairo_select_font_face(c->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(c->cairo, font);
  picture_use(c->cairo, picture_ink);
  return OPC_OK;
}

/* ---- text ---- */

void chart_text(const chart *c, double x, double y, int place,
                const char *text) {
  cairo_text_extents_t e;
  cairo_text_extents(c->cairo, text, &e);
  cairo_move_to(c->cairo, x - e.x_advance * place / 2, y);
  cairo_show_text(c->cairo, text);
}

void chart_title(const chart *c, double x, double y, const char *text) {
  cairo_set_font_size(c->cairo, 1.2 * c->font);
  chart_text(c, x, y, CHART_BEGIN, text);
  cairo_set_font_size(c->cairo, c->font);
}

static void upright_text(const chart *c, double x, double y, const char *text) {
  cairo_save(c->cairo);
  cairo_translate(c->cairo, x, y);
  cairo_rotate(c->cairo, -M_PI / 2);
  chart_text(c, 0, 0, CHART_MIDDLE, text);
  cairo_restore(c->cairo);
}

/* ---- axes ---- */

static void grid_line(const chart *c, double x0, double y0, double x1,
                      double y1) {
  picture_use(c->cairo, picture_faint);
  cairo_set_line_width(c->cairo, 0.5);
  cairo_move_to(c->cairo, x0, y0);
  cairo_line_to(c->cairo, x1, y1);
  cairo_stroke(c->cairo);
  picture_use(c->cairo, picture_ink);
}

static void mark_x(const chart *c, double x, const char *text) {
  double at = chart_x(c, x), bottom = c->top + c->height;
  grid_line(c, at, c->top, at, bottom);
  chart_text(c, at, bottom + 1.3 * c->font, CHART_MIDDLE, text);
}

static void mark_y(const chart *c, double y, const char *text) {
  double at = chart_y(c, y);
  grid_line(c, c->left, at, c->left + c->width, at);
  chart_text(c, c->left - 0.5 * c->font, at + 0.35 * c->font, CHART_END, text);
}

/* At steps of 1, 2 or 5 times a power of ten, about a sixth of the range. */
static void mark_range(const chart *c, double low, double high,
                       void (*mark)(const chart *c, double at,
                                    const char *text)) {
  char text[32];
  double rough = (high - low) / 6, step = pow(10, floor(log10(rough)));
  if (rough > 5 * step)
    step *= 10;
  else if (rough > step)
    step *= rough > 2 * step ? 5 : 2;
  for (double i = ceil(low / step); i * step <= high + step / 100; i++) {
    (void)snprintf(text, sizeof text, "%g", i * step + 0.0);
    mark(c, i * step, text);
  }
}

/* "2 mA" */
static void text_of(char text[32], double value, const char *unit) {
  static const char *const prefix[] = {"", "m", "u", "n", "p", "f", "a"};
  size_t i = 0;
  while (i + 1 < sizeof prefix / sizeof *prefix && value < 0.9999)
    value *= 1000, i++;
  (void)snprintf(text, 32, "%.3g %s%.16s", value, prefix[i], unit);
}

/* At 1, 2 and 5 of each decade, or at powers of ten if there are many. */
static void mark_decades(const chart *c) {
  static const double marks[] = {1, 2, 5};
  int many = c->y1 / c->y0 > 1e4;
  char text[32];
  for (double d = floor(log10(c->y0)); d <= log10(c->y1); d++)
    for (int i = 0; i < (many ? 1 : 3); i++) {
      double y = marks[i] * pow(10, d);
      if (y < c->y0 || y > c->y1) continue;
      text_of(text, y, c->decades);
      mark_y(c, y, text);
    }
}

void chart_axes(const chart *c, const char *title, const char *of_x,
                const char *of_y) {
  double font = c->font, bottom = c->top + c->height;
  mark_range(c, c->x0, c->x1, mark_x);
  if (c->decades)
    mark_decades(c);
  else
    mark_range(c, c->y0, c->y1, mark_y);
  chart_text(c, c->left, c->top - 0.7 * font, CHART_BEGIN, title);
  chart_text(c, c->left + c->width / 2, bottom + 2.8 * font, CHART_MIDDLE,
             of_x);
  if (of_y)
    upright_text(c, c->left - 3 * font, c->top + c->height / 2, of_y);
  cairo_set_line_width(c->cairo, 1);
  cairo_rectangle(c->cairo, c->left, c->top, c->width, c->height);
  cairo_stroke(c->cairo);
}

/* ---- lines ---- */

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
    cairo_line_to(c->cairo, chart_x(c, x[i]), chart_y(c, y[i]));
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
