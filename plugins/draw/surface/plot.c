/* SPDX-License-Identifier: BSD-3-Clause */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "plot.h"

enum { MAX_TEXT = 200, MAX_TICKS = 12 };

static const colour ink = {0.13, 0.13, 0.13}, faint = {0.6, 0.6, 0.6},
                    unknown = {0.8, 0.8, 0.8}, white = {1, 1, 1},
                    mark = {0.85, 0.25, 0.1};

double plot_height(double width) { return ceil(0.68 * width); }

static void use(cairo_t *cairo, colour c) {
  cairo_set_source_rgb(cairo, c.r, c.g, c.b);
}

/* ---- text ---- */

static double text_width(cairo_t *cairo, const char *text) {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text, &extents);
  return extents.x_advance;
}

/* Aligned by `at`: 0 its left, 1 its right end is at x. */
static void show(const plot *p, double x, double baseline, double at,
                 const char *text) {
  char plain[MAX_TEXT];
  snprintf(plain, sizeof plain, "%s", text);
  for (char *c = plain; *c; c++)
    if (*c < 32 || *c > 126) *c = '?';
  cairo_move_to(p->cairo, x - at * text_width(p->cairo, plain), baseline);
  cairo_show_text(p->cairo, plain);
  cairo_new_path(p->cairo); /* its end is no part of a line */
}

static void with_unit(char out[MAX_TEXT], const char *name, const char *unit) {
  snprintf(out, MAX_TEXT, "%s%s%s%s", name, unit ? " (" : "", unit ? unit : "",
           unit ? ")" : "");
}

/* ---- settings ---- */

/* The setting with these values of the first and the last parameter, the others
   as at the best one. */
static size_t setting_at(const plot *p, size_t first, size_t last) {
  size_t others = p->settings->best % p->block / p->last;
  return first * p->block + others * p->last + last;
}

/* ---- axes ---- */

static void value_text(char out[MAX_TEXT], const opc_setting *a, size_t i) {
  if (a->values)
    snprintf(out, MAX_TEXT, "%g", a->values[i]);
  else
    snprintf(out, MAX_TEXT, "%.40s", a->texts[i]);
}

static double longest(const plot *p, const opc_setting *a) {
  double most = 0;
  char text[MAX_TEXT];
  for (size_t i = 0; i < a->count; i++) {
    value_text(text, a, i);
    most = fmax(most, text_width(p->cairo, text));
  }
  return most;
}

/* Of how many values one has a label. */
static size_t label_step(const opc_setting *a, double length, double room) {
  static const size_t steps[] = {1, 2, 5, 10, 20, 50, 100, 200, 500, 1000};
  enum { STEPS = sizeof steps / sizeof steps[0] };
  for (size_t k = 0; k < STEPS; k++)
    if (length / (double)a->count * (double)steps[k] >= room) return steps[k];
  return a->count;
}

static void x_axis(const plot *p, const box *b, const opc_setting *a) {
  char text[MAX_TEXT];
  size_t step = label_step(a, b->width, longest(p, a) + 0.6 * p->font);
  double base = b->top + b->height;
  use(p->cairo, ink);
  for (size_t i = 0; i < a->count; i += step) {
    value_text(text, a, i);
    double x = b->left + b->width * ((double)i + 0.5) / (double)a->count;
    show(p, x, base + 1.3 * p->font, 0.5, text);
  }
  with_unit(text, a->name, a->unit);
  show(p, b->left + b->width / 2, base + 2.9 * p->font, 0.5, text);
}

static void y_name(const plot *p, const char *name) {
  cairo_save(p->cairo);
  cairo_translate(p->cairo, 1.6 * p->font, p->height / 2);
  cairo_rotate(p->cairo, -M_PI / 2);
  show(p, 0, 0, 0.5, name);
  cairo_restore(p->cairo);
}

static void y_axis(const plot *p, const box *b, const opc_setting *a) {
  char text[MAX_TEXT];
  size_t step = label_step(a, b->height, 1.4 * p->font);
  use(p->cairo, ink);
  for (size_t i = 0; i < a->count; i += step) {
    value_text(text, a, i);
    double y = b->top + b->height * (1 - ((double)i + 0.5) / (double)a->count);
    show(p, b->left - 0.5 * p->font, y + 0.35 * p->font, 1, text);
  }
  with_unit(text, a->name, a->unit);
  y_name(p, text);
}

static void frame(const plot *p, const box *b) {
  use(p->cairo, faint);
  cairo_set_line_width(p->cairo, 1);
  cairo_rectangle(p->cairo, floor(b->left) - 0.5, floor(b->top) - 0.5,
                  ceil(b->width) + 1, ceil(b->height) + 1);
  cairo_stroke(p->cairo);
}

/* ---- the mark of the best one ---- */

static void ring(const plot *p, double x, double y) {
  double radius = 0.55 * p->font;
  cairo_arc(p->cairo, x, y, radius, 0, 2 * M_PI);
  use(p->cairo, white);
  cairo_set_line_width(p->cairo, 0.32 * p->font);
  cairo_stroke(p->cairo);
  cairo_arc(p->cairo, x, y, radius, 0, 2 * M_PI);
  use(p->cairo, mark);
  cairo_set_line_width(p->cairo, 0.17 * p->font);
  cairo_stroke(p->cairo);
}

/* What is shown, and below it the best setting. */
static void title(const plot *p) {
  const opc_settings *s = p->settings;
  char text[MAX_TEXT];
  double x = 1.2 * p->font, y = 1.9 * p->font;
  cairo_select_font_face(p->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_BOLD);
  cairo_set_font_size(p->cairo, 1.2 * p->font);
  use(p->cairo, ink);
  with_unit(text, s->name, s->unit);
  show(p, x, y, 0, text);
  cairo_select_font_face(p->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(p->cairo, p->font);
  y += 1.7 * p->font;
  ring(p, x + 0.6 * p->font, y - 0.35 * p->font);
  size_t n =
      (size_t)snprintf(text, sizeof text, "best: %.4g%s%s", s->figure[s->best],
                       s->unit ? " " : "", s->unit ? s->unit : "");
  size_t stride = s->count;
  for (size_t a = 0; a < s->n_parameters && n < sizeof text; a++) {
    const opc_setting *q = &s->parameters[a];
    const char *dot = strrchr(q->name, '.');
    stride /= q->count;
    n += (size_t)snprintf(text + n, sizeof text - n, ", %s %s",
                          dot ? dot + 1 : q->name,
                          q->texts[s->best / stride % q->count]);
  }
  use(p->cairo, ink);
  show(p, x + 1.8 * p->font, y, 0, text);
}

/* ---- heat map ---- */

static void no_figure(const plot *p, double x, double y, double w, double h) {
  use(p->cairo, ink);
  cairo_set_line_width(p->cairo, 1);
  cairo_move_to(p->cairo, x, y);
  cairo_rel_line_to(p->cairo, w, h);
  cairo_move_to(p->cairo, x, y + h);
  cairo_rel_line_to(p->cairo, w, -h);
  cairo_stroke(p->cairo);
}

static void cell(const plot *p, const box *b, size_t i, size_t k) {
  const opc_settings *s = p->settings;
  const opc_setting *first = &s->parameters[0];
  const opc_setting *last = &s->parameters[s->n_parameters - 1];
  double figure = s->figure[setting_at(p, i, k)];
  double dx = b->width / (double)first->count;
  double dy = b->height / (double)last->count;
  double x0 = round(b->left + dx * (double)i);
  double x1 = round(b->left + dx * (double)(i + 1));
  double y0 = round(b->top + b->height - dy * (double)(k + 1));
  double y1 = round(b->top + b->height - dy * (double)k);
  use(p->cairo,
      isnan(figure) ? unknown : scale_colour(scale_place(&p->scale, figure)));
  cairo_rectangle(p->cairo, x0, y0, x1 - x0, y1 - y0);
  cairo_fill(p->cairo);
  if (isnan(figure)) no_figure(p, x0, y0, x1 - x0, y1 - y0);
}

static void bar(const plot *p, const box *b) {
  double ticks[MAX_TICKS];
  int n = scale_ticks(&p->scale, ticks, MAX_TICKS);
  for (int i = 0; i < (int)b->height; i++) {
    use(p->cairo, scale_colour(1 - (i + 0.5) / b->height));
    cairo_rectangle(p->cairo, b->left, b->top + i, b->width, 1);
    cairo_fill(p->cairo);
  }
  frame(p, b);
  use(p->cairo, ink);
  for (int i = 0; i < n; i++) {
    char text[MAX_TEXT];
    double y = b->top + b->height * (1 - scale_place(&p->scale, ticks[i]));
    snprintf(text, sizeof text, "%.4g", ticks[i]);
    cairo_rectangle(p->cairo, b->left + b->width, floor(y), 0.3 * p->font, 1);
    cairo_fill(p->cairo);
    show(p, b->left + b->width + 0.5 * p->font, y + 0.35 * p->font, 0, text);
  }
}

static void heat_map(const plot *p) {
  const opc_settings *s = p->settings;
  const opc_setting *first = &s->parameters[0];
  const opc_setting *last = &s->parameters[s->n_parameters - 1];
  double left = fmin(longest(p, last), p->width / 4) + 3 * p->font;
  double top = 5 * p->font, right = 7 * p->font;
  const box b = {floor(left), floor(top), floor(p->width - left - right),
                 floor(p->height - top - 4 * p->font)};
  for (size_t i = 0; i < first->count; i++)
    for (size_t k = 0; k < last->count; k++) cell(p, &b, i, k);
  frame(p, &b);
  x_axis(p, &b, first);
  y_axis(p, &b, last);
  const box side = {b.left + b.width + 1.5 * p->font, b.top, 1.3 * p->font,
                    b.height};
  bar(p, &side);
  size_t x = s->best / p->block, y = s->best % p->last;
  ring(p, b.left + b.width * ((double)x + 0.5) / (double)first->count,
       b.top + b.height * (1 - ((double)y + 0.5) / (double)last->count));
}

/* ---- curve ---- */

static void figure_axis(const plot *p, const box *b) {
  double ticks[MAX_TICKS];
  char text[MAX_TEXT];
  int n = scale_ticks(&p->scale, ticks, MAX_TICKS);
  for (int i = 0; i < n; i++) {
    double y = b->top + b->height * (1 - scale_place(&p->scale, ticks[i]));
    snprintf(text, sizeof text, "%.4g", ticks[i]);
    use(p->cairo, unknown);
    cairo_rectangle(p->cairo, b->left, floor(y), b->width, 1);
    cairo_fill(p->cairo);
    use(p->cairo, ink);
    show(p, b->left - 0.5 * p->font, y + 0.35 * p->font, 1, text);
  }
  with_unit(text, p->settings->name, p->settings->unit);
  y_name(p, text);
}

static double curve_x(const plot *p, const box *b, size_t i) {
  return b->left + b->width * ((double)i + 0.5) / (double)p->settings->count;
}

static double curve_y(const plot *p, const box *b, size_t i) {
  return b->top +
         b->height * (1 - scale_place(&p->scale, p->settings->figure[i]));
}

/* Dots, and lines between those that are neighbours. */
static void curve(const plot *p) {
  const opc_settings *s = p->settings;
  const box b = {floor(6 * p->font), floor(5 * p->font),
                 floor(p->width - 7.5 * p->font),
                 floor(p->height - 9 * p->font)};
  figure_axis(p, &b);
  frame(p, &b);
  x_axis(p, &b, &s->parameters[0]);
  use(p->cairo, scale_colour(0.3));
  cairo_set_line_width(p->cairo, 2);
  for (size_t i = 0; i < s->count; i++) {
    if (isnan(s->figure[i])) continue;
    double x = curve_x(p, &b, i), y = curve_y(p, &b, i);
    cairo_arc(p->cairo, x, y, 0.2 * p->font, 0, 2 * M_PI);
    cairo_fill(p->cairo);
    if (!i || isnan(s->figure[i - 1])) continue;
    cairo_move_to(p->cairo, curve_x(p, &b, i - 1), curve_y(p, &b, i - 1));
    cairo_line_to(p->cairo, x, y);
    cairo_stroke(p->cairo);
  }
  ring(p, curve_x(p, &b, s->best), curve_y(p, &b, s->best));
}

/* ---- all of it ---- */

void plot_draw(const plot *p) {
  use(p->cairo, white);
  cairo_paint(p->cairo);
  title(p);
  if (p->settings->n_parameters > 1)
    heat_map(p);
  else
    curve(p);
}
