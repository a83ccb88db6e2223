/* SPDX-License-Identifier: BSD-3-Clause */
/* Text, headings, symbols and legends. */
#include <eda/drawing.h>
#include <glib.h>
#include <math.h>
#include <string.h>

/* Largest number of bytes in a line of text; longer texts are truncated. */
enum { LINE = 200 };

/* ---- text ---- */

static double width_of(const eda_paper *p, const char *text) {
  cairo_text_extents_t extents;
  cairo_text_extents(p->cairo, text, &extents);
  return extents.x_advance;
}

/* Return the text, truncated with "..." to the given width (g_free). */
static char *text_fit(const eda_paper *p, const char *text, double width) {
  g_autofree char *all = g_utf8_make_valid(text, (gssize)strnlen(text, LINE));
  for (char *c = all; *c; c++)
    if ((unsigned char)*c < ' ') *c = '?';
  char *out = g_strdup(all);
  for (glong n = g_utf8_strlen(all, -1); n > 1 && width_of(p, out) > width;) {
    g_autofree char *begin = g_utf8_substring(all, 0, --n);
    g_free(out);
    out = g_strconcat(begin, "...", NULL);
  }
  return out;
}

void eda_text(const eda_paper *p, double x, double baseline, int place,
              double width, const char *text) {
  g_autofree char *line = text_fit(p, text, width);
  cairo_move_to(p->cairo, x - width_of(p, line) * place / 2, baseline);
  cairo_show_text(p->cairo, line);
  cairo_new_path(p->cairo); /* otherwise the next line would start here */
}

double eda_heading(const eda_paper *p, double top, const char *text) {
  cairo_select_font_face(p->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_BOLD);
  cairo_set_font_size(p->cairo, 1.4 * p->font);
  eda_text(p, p->margin, floor(top + 1.2 * p->font), EDA_LEFT,
           p->width - 2 * p->margin, text);
  cairo_select_font_face(p->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(p->cairo, p->font);
  return 1.9 * p->font;
}

/* ---- symbols ---- */

static void line_stroke(const eda_paper *p, eda_colour colour, double line,
                        double dash) {
  eda_use(p->cairo, colour);
  cairo_set_line_width(p->cairo, line);
  cairo_set_dash(p->cairo, &dash, dash > 0, 0);
  cairo_stroke(p->cairo);
  cairo_set_dash(p->cairo, NULL, 0, 0);
  eda_use(p->cairo, eda_ink);
}

void eda_cross(const eda_paper *p, double x, double y, double width,
               double height) {
  cairo_move_to(p->cairo, x, y);
  cairo_rel_line_to(p->cairo, width, height);
  cairo_move_to(p->cairo, x, y + height);
  cairo_rel_line_to(p->cairo, width, -height);
  line_stroke(p, eda_ink, fmin(0.07 * p->font, 0.2 * width), 0);
}

void eda_ring(const eda_paper *p, double x, double y) {
  const eda_colour white_red[] = {EDA_COLOUR(0xffffff), eda_ring_colour};
  static const double lines[] = {0.32, 0.17};
  for (int i = 0; i < 2; i++) {
    cairo_arc(p->cairo, x, y, 0.55 * p->font, 0, 2 * M_PI);
    line_stroke(p, white_red[i], lines[i] * p->font, 0);
  }
}

static double sign_width(const eda_paper *p, const eda_sign *s) {
  if (s->kind == EDA_SIGN_BAR) return s->size;
  if (s->kind == EDA_SIGN_RING) return 1.2 * p->font;
  if (s->kind != EDA_SIGN_RAMP) return 1.6 * p->font;
  return width_of(p, s->low) + width_of(p, s->high) + 8 * p->font;
}

/* Fill a box with the current colour, and draw a thin outline on whole
   pixels. */
static void draw_box(const eda_paper *p, double x, double y, double width,
                     double height) {
  cairo_rectangle(p->cairo, floor(x) + 0.5, floor(y) + 0.5, floor(width),
                  floor(height));
  cairo_fill_preserve(p->cairo);
  line_stroke(p, eda_faint, 1, 0);
}

static void draw_bar(const eda_paper *p, double width, double x,
                     double baseline) {
  double line = fmax(1, round(0.07 * p->font)), high = 0.28 * p->font;
  double y = floor(baseline - 0.22 * p->font) + fmod(line, 2) / 2;
  cairo_move_to(p->cairo, x, y - high);
  cairo_line_to(p->cairo, x, y);
  cairo_line_to(p->cairo, x + width, y);
  cairo_line_to(p->cairo, x + width, y - high);
  line_stroke(p, eda_ink, line, 0);
}

static void draw_ramp(const eda_paper *p, const eda_sign *s, double x,
                      double baseline) {
  enum { STOPS = 32 };
  double width = 7 * p->font;
  eda_text(p, x, baseline, EDA_LEFT, INFINITY, s->low);
  x += width_of(p, s->low) + 0.5 * p->font;
  cairo_pattern_t *ramp = cairo_pattern_create_linear(x, 0, x + width, 0);
  for (int i = 0; i <= STOPS; i++) {
    eda_colour c = s->ramp((double)i / STOPS);
    cairo_pattern_add_color_stop_rgb(ramp, (double)i / STOPS, c.r, c.g, c.b);
  }
  cairo_set_source(p->cairo, ramp);
  cairo_pattern_destroy(ramp);
  draw_box(p, x, baseline - 0.8 * p->font, width, 0.9 * p->font);
  eda_text(p, x + width + 0.5 * p->font, baseline, EDA_LEFT, INFINITY, s->high);
}

static void draw_line(const eda_paper *p, eda_colour colour, double line,
                      double dash, double x, double baseline) {
  if (!(line > 0)) return;
  cairo_move_to(p->cairo, x, floor(baseline - 0.35 * p->font) + 0.5);
  cairo_rel_line_to(p->cairo, 1.6 * p->font, 0);
  line_stroke(p, colour, line, dash);
}

static void draw_sign(const eda_paper *p, const eda_sign *s, double x,
                      double baseline) {
  double width = sign_width(p, s), height = 0.9 * p->font;
  double y = baseline - 0.8 * p->font;
  switch (s->kind) {
    case EDA_SIGN_BAR:
      draw_bar(p, width, x, baseline);
      break;
    case EDA_SIGN_RAMP:
      draw_ramp(p, s, x, baseline);
      break;
    case EDA_SIGN_LINE:
      draw_line(p, s->behind, s->behind_line, 0, x, baseline);
      draw_line(p, s->colour, s->line, s->dash, x, baseline);
      break;
    case EDA_SIGN_RING:
      eda_ring(p, x + 0.6 * p->font, baseline - 0.35 * p->font);
      break;
    default:
      eda_use(p->cairo, s->colour);
      draw_box(p, x, y, width, height);
      if (s->kind == EDA_SIGN_CROSS)
        eda_cross(p, floor(x) + 0.5, floor(y) + 0.5, floor(width),
                  floor(height));
  }
}

/* ---- legends ---- */

void eda_legend_init(eda_legend *l, const eda_paper *paper, double top) {
  *l = (eda_legend){.paper = paper, .top = top, .x = paper->margin};
}

void eda_legend_add(eda_legend *l, const eda_sign *sign, const char *format,
                    ...) {
  const eda_paper *p = l->paper;
  double line = 1.6 * p->font, right = p->width - p->margin;
  double before = sign ? sign_width(p, sign) + 0.5 * p->font : 0;
  va_list arguments;
  va_start(arguments, format);
  g_autofree char *text = g_strdup_vprintf(format, arguments);
  va_end(arguments);
  g_autofree char *shown = text_fit(p, text, right - p->margin - before);
  double width = before + width_of(p, shown);
  if (!(l->height > 0)) l->height = line;
  if (l->x > p->margin && l->x + width > right) {
    l->x = p->margin;
    l->height += line;
  }
  double baseline = floor(l->top + l->height - 0.5 * p->font);
  if (sign) draw_sign(p, sign, l->x, baseline);
  eda_text(p, l->x + before, baseline, EDA_LEFT, INFINITY, shown);
  l->x += width + 1.6 * p->font;
}
