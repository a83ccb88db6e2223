/* SPDX-License-Identifier: BSD-3-Clause */
/* Two charts over length: the on and the off currents, on logarithmic axes, as
   both change by their share with each nm. */
#include <math.h>
#include <stdio.h>

#include "../../draw/mask/paper.h"
#include "../../draw/mask/picture.h"
#include "ngspice.h"

static const double paper_width = 1200, paper_height = 560, font = 15;

/* A chart: where it lies on the paper; lengths, and logarithms to base 10 of
   currents. */
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

enum { BEGIN, MIDDLE, END };

static void put_text(cairo_t *cairo, double x, double y, int place,
                     const char *text) {
  cairo_text_extents_t e;
  cairo_text_extents(cairo, text, &e);
  cairo_move_to(cairo, x - e.x_advance * place / 2, y);
  cairo_show_text(cairo, text);
}

/* ---- axes ---- */

static void line(const chart *c, double x0, double y0, double x1, double y1,
                 double width) {
  cairo_set_line_width(c->cairo, width);
  cairo_move_to(c->cairo, x0, y0);
  cairo_line_to(c->cairo, x1, y1);
  cairo_stroke(c->cairo);
}

/* 1, 2 or 5 times a power of ten, about a sixth of a range. */
static double tick(double range) {
  double rough = range / 6, unit = pow(10, floor(log10(rough)));
  if (rough > 5 * unit) return 10 * unit;
  if (rough > 2 * unit) return 5 * unit;
  return rough > unit ? 2 * unit : unit;
}

/* "2 mA". */
static void current_text(char text[32], double current) {
  static const char *const units[] = {"A", "mA", "uA", "nA", "pA", "fA", "aA"};
  size_t i = 0;
  while (i + 1 < sizeof units / sizeof *units && current < 0.9999)
    current *= 1000, i++;
  (void)snprintf(text, 32, "%.3g %s", current, units[i]);
}

/* Lines at 1, 2 and 5 of each decade, or at powers of ten if there are many. */
static void draw_decades(const chart *c) {
  static const double marks[] = {1, 2, 5};
  int many = c->y1 - c->y0 > 4;
  char text[32];
  for (double d = floor(c->y0); d <= c->y1; d++)
    for (int i = 0; i < (many ? 1 : 3); i++) {
      double y = d + log10(marks[i]);
      if (y < c->y0 || y > c->y1) continue;
      picture_use(c->cairo, picture_faint);
      line(c, c->left, py(c, y), c->left + c->width, py(c, y), 0.5);
      picture_use(c->cairo, picture_ink);
      current_text(text, marks[i] * pow(10, d));
      put_text(c->cairo, c->left - 0.5 * font, py(c, y) + 0.35 * font, END,
               text);
    }
}

static void draw_axes(const chart *c, const char *title) {
  char text[32];
  double step = tick(c->x1 - c->x0), bottom = c->top + c->height;
  for (double i = ceil(c->x0 / step); i * step <= c->x1; i++) {
    double x = px(c, i * step);
    picture_use(c->cairo, picture_faint);
    line(c, x, c->top, x, bottom, 0.5);
    picture_use(c->cairo, picture_ink);
    (void)snprintf(text, sizeof text, "%g", i * step);
    put_text(c->cairo, x, bottom + 1.3 * font, MIDDLE, text);
  }
  draw_decades(c);
  put_text(c->cairo, c->left, c->top - 0.7 * font, BEGIN, title);
  put_text(c->cairo, c->left + c->width / 2, bottom + 2.8 * font, MIDDLE,
           "drawn length, nm");
  cairo_set_line_width(c->cairo, 1);
  cairo_rectangle(c->cairo, c->left, c->top, c->width, c->height);
  cairo_stroke(c->cairo);
}

/* ---- curves ---- */

static rgb colour_of(int type) {
  return picture_mask[type == OPC_NMOS ? OPC_POLY : OPC_ACTIVE];
}

static void draw_curve(const chart *c, const plan *p, const currents *all,
                       int type, int current) {
  const double *y = all->at[type][current];
  picture_use(c->cairo, colour_of(type));
  for (size_t i = all->first; i < p->count; i++)
    cairo_line_to(c->cairo, px(c, p->length[i]), py(c, log10(y[i])));
  cairo_set_line_width(c->cairo, 2.5);
  cairo_stroke(c->cairo);
}

static void draw_chart(chart *c, const plan *p, const currents *all,
                       int current) {
  char title[96], width[32];
  c->y0 = INFINITY, c->y1 = -INFINITY;
  for (int type = 0; type < TYPES; type++) {
    const double *y = all->at[type][current];
    c->y1 = fmax(c->y1, log10(y[all->first]));
    c->y0 = fmin(c->y0, log10(y[p->count - 1]));
  }
  double room = fmax(0.05 * (c->y1 - c->y0), 0.02);
  c->y0 -= room;
  c->y1 += room;
  (void)snprintf(width, sizeof width, "%.6g um", p->width / 1000);
  (void)snprintf(title, sizeof title, "%s of W = %s, Vgs %g V, Vds %g V",
                 current == ION ? "Ion" : "Ioff", width, p->bias[current].gate,
                 p->bias[current].drain);
  draw_axes(c, title);
  if (p->reference_length > c->x0 && p->reference_length < c->x1) {
    static const double dashes[] = {4, 4};
    double x = px(c, p->reference_length);
    picture_use(c->cairo, picture_ink);
    cairo_set_dash(c->cairo, dashes, 2, 0);
    line(c, x, c->top, x, c->top + c->height, 1);
    cairo_set_dash(c->cairo, NULL, 0, 0);
  }
  for (int type = 0; type < TYPES; type++) draw_curve(c, p, all, type, current);
}

static void draw_key(cairo_t *cairo, const plan *p, double y) {
  double x = 70;
  for (int type = 0; type < TYPES; type++) {
    char text[160];
    cairo_text_extents_t e;
    (void)snprintf(text, sizeof text, "%s-transistor, model %.120s",
                   type == OPC_NMOS ? "n" : "p", p->model[type]);
    picture_use(cairo, colour_of(type));
    cairo_set_line_width(cairo, 2.5);
    cairo_move_to(cairo, x, y - 0.35 * font);
    cairo_rel_line_to(cairo, 1.6 * font, 0);
    cairo_stroke(cairo);
    picture_use(cairo, picture_ink);
    put_text(cairo, x + 2.1 * font, y, BEGIN, text);
    cairo_text_extents(cairo, text, &e);
    x += 4 * font + e.x_advance;
  }
}

int curves_draw(const opc_host *host, const plan *p, const currents *all,
                const char *name, int format, const char *path,
                opc_error *error) {
  paper file;
  int code =
      paper_open(&file, host, format, path, paper_width, paper_height, error);
  if (code) return code;
  cairo_t *cairo = file.cairo;
  cairo_set_source_rgb(cairo, 1, 1, 1);
  cairo_paint(cairo);
  cairo_select_font_face(cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(cairo, 1.2 * font);
  picture_use(cairo, picture_ink);
  put_text(cairo, 70, 1.8 * font, BEGIN, name);
  cairo_set_font_size(cairo, font);
  draw_key(cairo, p, 3.4 * font);
  chart c = {.cairo = cairo,
             .left = 100,
             .top = 90,
             .width = 460,
             .height = 410,
             .x0 = p->length[all->first],
             .x1 = p->length[p->count - 1]};
  draw_chart(&c, p, all, ION);
  c.left = 690;
  draw_chart(&c, p, all, IOFF);
  return paper_close(&file, OPC_OK, error);
}
