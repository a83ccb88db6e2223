/* SPDX-License-Identifier: BSD-3-Clause */
#include "legend.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* ---- text ---- */

static double text_width(cairo_t *cairo, const char *text) {
  cairo_text_extents_t extents;
  cairo_text_extents(cairo, text, &extents);
  return extents.x_advance;
}

/* Cut a text to the room it has. What is not plain ASCII, in the names of
   cells, becomes a question mark. */
static void fit_text(cairo_t *cairo, char *text, double room) {
  for (char *c = text; *c; c++)
    if (*c < 32 || *c > 126) *c = '?';
  size_t n = strlen(text);
  while (n > 4 && text_width(cairo, text) > room)
    memcpy(&text[--n - 3], "...", 4);
}

static void show(cairo_t *cairo, double x, double baseline, const char *text) {
  cairo_move_to(cairo, x, baseline);
  cairo_show_text(cairo, text);
}

static void use_font(const view *v, double size, int bold) {
  cairo_select_font_face(
      v->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
      bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(v->cairo, size);
}

void legend_use_font(const view *v) { use_font(v, v->font, 0); }

void legend_text(const view *v, const char *text, double x, double baseline,
                 double room) {
  char line[LEGEND_TEXT];
  snprintf(line, sizeof line, "%s", text);
  legend_use_font(v);
  fit_text(v->cairo, line, room);
  picture_use(v->cairo, picture_ink);
  show(v->cairo, x, baseline, line);
}

double legend_heading(const view *v, const char *text, double top, int draw) {
  char name[LEGEND_TEXT];
  double margin = view_margin(v);
  use_font(v, 1.4 * v->font, 1);
  snprintf(name, sizeof name, "%s", text);
  fit_text(v->cairo, name, v->paper - 2 * margin);
  picture_use(v->cairo, picture_ink);
  if (draw) show(v->cairo, margin, floor(top + 1.2 * v->font), name);
  legend_use_font(v);
  return 1.9 * v->font;
}

/* ---- signs ---- */

static double sign_width(const view *v, const legend_entry *e) {
  switch (e->sign) {
    case LEGEND_PLAIN:
      return 0;
    case LEGEND_BAR:
      return e->size;
    case LEGEND_RAMP:
      return text_width(v->cairo, e->low) + text_width(v->cairo, e->high) +
             8 * v->font;
    default:
      return 1.6 * v->font;
  }
}

void legend_cross(const view *v, double x, double y, double width,
                  double height) {
  picture_use(v->cairo, picture_ink);
  cairo_set_line_width(v->cairo, fmin(0.07 * v->font, 0.2 * width));
  cairo_move_to(v->cairo, x, y);
  cairo_rel_line_to(v->cairo, width, height);
  cairo_move_to(v->cairo, x, y + height);
  cairo_rel_line_to(v->cairo, width, -height);
  cairo_stroke(v->cairo);
}

/* A box on paper, sharp, with a thin line around. */
static void box(const view *v, double x, double y, double width,
                double height) {
  cairo_rectangle(v->cairo, floor(x) + 0.5, floor(y) + 0.5, floor(width),
                  floor(height));
}

static void draw_bar(const view *v, const legend_entry *e, double x,
                     double baseline) {
  double line = fmax(1, round(0.07 * v->font)), high = 0.28 * v->font;
  double y = floor(baseline - 0.22 * v->font) + fmod(line, 2) / 2;
  picture_use(v->cairo, picture_ink);
  cairo_set_line_width(v->cairo, line);
  cairo_move_to(v->cairo, x, y - high);
  cairo_line_to(v->cairo, x, y);
  cairo_line_to(v->cairo, x + e->size, y);
  cairo_line_to(v->cairo, x + e->size, y - high);
  cairo_stroke(v->cairo);
}

static void draw_ramp(const view *v, const legend_entry *e, double x,
                      double baseline) {
  enum { STOPS = 32 };
  picture_use(v->cairo, picture_ink);
  show(v->cairo, x, baseline, e->low);
  x += text_width(v->cairo, e->low) + 0.5 * v->font;
  double width = 7 * v->font;
  cairo_pattern_t *ramp = cairo_pattern_create_linear(x, 0, x + width, 0);
  for (int i = 0; i <= STOPS; i++) {
    rgb c = e->ramp((double)i / STOPS);
    cairo_pattern_add_color_stop_rgb(ramp, (double)i / STOPS, c.r, c.g, c.b);
  }
  box(v, x, baseline - 0.8 * v->font, width, 0.9 * v->font);
  cairo_set_source(v->cairo, ramp);
  cairo_fill_preserve(v->cairo);
  cairo_pattern_destroy(ramp);
  picture_use(v->cairo, picture_faint);
  cairo_set_line_width(v->cairo, 1);
  cairo_stroke(v->cairo);
  picture_use(v->cairo, picture_ink);
  show(v->cairo, x + width + 0.5 * v->font, baseline, e->high);
}

static void draw_line(const view *v, rgb colour, double line, double x,
                      double baseline, double width) {
  picture_use(v->cairo, colour);
  cairo_set_line_width(v->cairo, line);
  cairo_move_to(v->cairo, x, floor(baseline - 0.35 * v->font) + 0.5);
  cairo_rel_line_to(v->cairo, width, 0);
  cairo_stroke(v->cairo);
}

static void draw_sign(const view *v, const legend_entry *e, double x,
                      double baseline) {
  double width = sign_width(v, e);
  double y = baseline - 0.8 * v->font, high = 0.9 * v->font;
  if (e->sign == LEGEND_BAR) draw_bar(v, e, x, baseline);
  if (e->sign == LEGEND_RAMP) draw_ramp(v, e, x, baseline);
  if (e->sign == LEGEND_LINE) {
    if (e->behind_line > 0)
      draw_line(v, e->behind, e->behind_line, x, baseline, width);
    draw_line(v, e->colour, e->line, x, baseline, width);
  }
  if (e->sign != LEGEND_FILL && e->sign != LEGEND_CROSS) return;
  box(v, x, y, width, high);
  picture_use(v->cairo, e->colour);
  cairo_fill_preserve(v->cairo);
  picture_use(v->cairo, picture_faint);
  cairo_set_line_width(v->cairo, 1);
  cairo_stroke(v->cairo);
  if (e->sign == LEGEND_CROSS)
    legend_cross(v, floor(x) + 0.5, floor(y) + 0.5, floor(width), floor(high));
}

/* ---- flow ---- */

double legend_flow(const view *v, legend *l, double top, int draw) {
  double margin = view_margin(v), line = 1.6 * v->font;
  double right = v->paper - margin, x = margin, height = l->n ? line : 0;
  for (size_t i = 0; i < l->n; i++) {
    legend_entry *e = &l->entry[i];
    double sign = sign_width(v, e) + (e->sign ? 0.5 * v->font : 0);
    fit_text(v->cairo, e->text, right - margin - sign);
    double width = sign + text_width(v->cairo, e->text);
    if (x > margin && x + width > right) {
      x = margin;
      height += line;
    }
    double baseline = floor(top + height - 0.5 * v->font);
    if (draw) {
      draw_sign(v, e, x, baseline);
      picture_use(v->cairo, picture_ink);
      show(v->cairo, x + sign, baseline, e->text);
    }
    x += width + 1.6 * v->font;
  }
  return height;
}

legend_entry *legend_add(legend *l, int sign, rgb colour, const char *format,
                         ...) {
  legend_entry *e = &l->entry[l->n++];
  *e = (legend_entry){.sign = sign, .colour = colour};
  va_list arguments;
  va_start(arguments, format);
  (void)vsnprintf(e->text, sizeof e->text, format, arguments);
  va_end(arguments);
  return e;
}

void legend_add_scale_bar(legend *l, const view *v) {
  double room = (v->x1 - v->x0) / 6;
  double unit = pow(10, floor(log10(room))), nm = unit;
  if (room >= 2 * unit) nm = 2 * unit;
  if (room >= 5 * unit) nm = 5 * unit;
  legend_add(l, LEGEND_BAR, picture_ink, "%g %s", nm < 1000 ? nm : nm / 1000,
             nm < 1000 ? "nm" : "um")
      ->size = nm * v->scale;
}
