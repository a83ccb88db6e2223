/* SPDX-License-Identifier: BSD-3-Clause */
/* What stands around the window: title, legend, scales. Entries flow from left
   to right, then down, so that any width will do. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "picture.h"

enum { MAX_TEXT = 128, MAX_ENTRIES = 12 };

/* An entry: a sign, then a text. */
enum { PLAIN, FILL, LINE, CROSS, BAR, RAMP };

typedef struct entry {
  int sign;
  char text[MAX_TEXT];
  rgb colour;
  double line; /* width of a LINE */
  double size; /* of a BAR, pixels; of a RAMP, the deviation at its ends */
} entry;

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

static void use_font(const picture *p, double size, int bold) {
  cairo_select_font_face(
      p->cairo, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
      bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(p->cairo, size);
}

double picture_margin(const picture *p) { return ceil(0.9 * p->font); }

/* ---- signs ---- */

static void ramp_ends(const entry *e, char low[16], char high[16]) {
  snprintf(low, 16, "-%g %%", e->size);
  snprintf(high, 16, "+%g %%", e->size);
}

static double sign_width(const picture *p, const entry *e) {
  char low[16], high[16];
  switch (e->sign) {
    case PLAIN:
      return 0;
    case BAR:
      return e->size;
    case RAMP:
      ramp_ends(e, low, high);
      return text_width(p->cairo, low) + text_width(p->cairo, high) +
             8 * p->font;
    default:
      return 1.6 * p->font;
  }
}

void picture_cross(const picture *p, double x, double y, double width,
                   double height) {
  picture_use(p->cairo, picture_ink);
  cairo_set_line_width(p->cairo, fmin(0.07 * p->font, 0.2 * width));
  cairo_move_to(p->cairo, x, y);
  cairo_rel_line_to(p->cairo, width, height);
  cairo_move_to(p->cairo, x, y + height);
  cairo_rel_line_to(p->cairo, width, -height);
  cairo_stroke(p->cairo);
}

/* A box on paper, sharp, with a thin line around. */
static void box(const picture *p, double x, double y, double width,
                double height) {
  cairo_rectangle(p->cairo, floor(x) + 0.5, floor(y) + 0.5, floor(width),
                  floor(height));
}

static void draw_bar(const picture *p, const entry *e, double x,
                     double baseline) {
  double line = fmax(1, round(0.07 * p->font)), high = 0.28 * p->font;
  double y = floor(baseline - 0.22 * p->font) + fmod(line, 2) / 2;
  picture_use(p->cairo, picture_ink);
  cairo_set_line_width(p->cairo, line);
  cairo_move_to(p->cairo, x, y - high);
  cairo_line_to(p->cairo, x, y);
  cairo_line_to(p->cairo, x + e->size, y);
  cairo_line_to(p->cairo, x + e->size, y - high);
  cairo_stroke(p->cairo);
}

static void draw_ramp(const picture *p, const entry *e, double x,
                      double baseline) {
  enum { STOPS = 32 };
  char low[16], high[16];
  ramp_ends(e, low, high);
  picture_use(p->cairo, picture_ink);
  show(p->cairo, x, baseline, low);
  x += text_width(p->cairo, low) + 0.5 * p->font;
  double width = 7 * p->font;
  cairo_pattern_t *ramp = cairo_pattern_create_linear(x, 0, x + width, 0);
  for (int i = 0; i <= STOPS; i++) {
    rgb c = picture_diverging(2.0 * i / STOPS - 1);
    cairo_pattern_add_color_stop_rgb(ramp, (double)i / STOPS, c.r, c.g, c.b);
  }
  box(p, x, baseline - 0.8 * p->font, width, 0.9 * p->font);
  cairo_set_source(p->cairo, ramp);
  cairo_fill_preserve(p->cairo);
  cairo_pattern_destroy(ramp);
  picture_use(p->cairo, picture_faint);
  cairo_set_line_width(p->cairo, 1);
  cairo_stroke(p->cairo);
  picture_use(p->cairo, picture_ink);
  show(p->cairo, x + width + 0.5 * p->font, baseline, high);
}

static void draw_sign(const picture *p, const entry *e, double x,
                      double baseline) {
  double width = sign_width(p, e);
  double y = baseline - 0.8 * p->font, high = 0.9 * p->font;
  if (e->sign == BAR) draw_bar(p, e, x, baseline);
  if (e->sign == RAMP) draw_ramp(p, e, x, baseline);
  if (e->sign == LINE) {
    picture_use(p->cairo, e->colour);
    cairo_set_line_width(p->cairo, e->line);
    cairo_move_to(p->cairo, x, floor(baseline - 0.35 * p->font) + 0.5);
    cairo_rel_line_to(p->cairo, width, 0);
    cairo_stroke(p->cairo);
  }
  if (e->sign != FILL && e->sign != CROSS) return;
  box(p, x, y, width, high);
  picture_use(p->cairo, e->colour);
  cairo_fill_preserve(p->cairo);
  picture_use(p->cairo, picture_faint);
  cairo_set_line_width(p->cairo, 1);
  cairo_stroke(p->cairo);
  if (e->sign == CROSS)
    picture_cross(p, floor(x) + 0.5, floor(y) + 0.5, floor(width), floor(high));
}

/* ---- flow ---- */

/* The entries from `top` on, each with the sign it has and a gap before its
   text. Returns how high they stand. */
static double flow(const picture *p, entry *entries, size_t n, double top,
                   int draw) {
  double margin = picture_margin(p), line = 1.6 * p->font;
  double right = p->paper - margin, x = margin, height = n ? line : 0;
  for (size_t i = 0; i < n; i++) {
    entry *e = &entries[i];
    double sign = sign_width(p, e) + (e->sign ? 0.5 * p->font : 0);
    fit_text(p->cairo, e->text, right - margin - sign);
    double width = sign + text_width(p->cairo, e->text);
    if (x > margin && x + width > right) {
      x = margin;
      height += line;
    }
    double baseline = floor(top + height - 0.5 * p->font);
    if (draw) {
      draw_sign(p, e, x, baseline);
      picture_use(p->cairo, picture_ink);
      show(p->cairo, x + sign, baseline, e->text);
    }
    x += width + 1.6 * p->font;
  }
  return height;
}

static entry *add(entry entries[MAX_ENTRIES], size_t *n, int sign, rgb colour,
                  const char *text) {
  entry *e = &entries[(*n)++];
  *e = (entry){.sign = sign, .colour = colour};
  snprintf(e->text, sizeof e->text, "%s", text);
  return e;
}

/* ---- title ---- */

/* Mean and largest deviation, of those that have one. */
static void deviations(const picture *p, const opc_performance *of,
                       double *mean, double *max) {
  size_t n = 0;
  *mean = *max = 0;
  for (size_t i = 0; i < p->mask->gates->count; i++) {
    double d = fabs(picture_deviation(of, p->mask, i));
    if (isnan(d)) continue;
    *mean += d;
    *max = fmax(*max, d);
    n++;
  }
  if (n) *mean /= (double)n;
}

static const char *plural(double n) { return n == 1 ? "" : "s"; }

double picture_title(const picture *p, double top, int draw) {
  entry e[MAX_ENTRIES];
  size_t n = 0;
  const opc_gates *g = p->mask->gates;
  use_font(p, 1.4 * p->font, 1);
  double height = 1.9 * p->font, margin = picture_margin(p);
  char name[MAX_TEXT];
  snprintf(name, sizeof name, "%s", g->name ? g->name : "");
  fit_text(p->cairo, name, p->paper - 2 * margin);
  picture_use(p->cairo, picture_ink);
  if (draw) show(p->cairo, margin, floor(top + 1.2 * p->font), name);
  use_font(p, p->font, 0);
  char *text = add(e, &n, PLAIN, picture_ink, "")->text;
  snprintf(text, MAX_TEXT, "%zu transistor%s", g->count,
           plural((double)g->count));
  if (g->count) {
    double mean, max;
    deviations(p, &p->mask->before, &mean, &max);
    text = add(e, &n, PLAIN, picture_ink, "")->text;
    snprintf(text, MAX_TEXT, "|Ion deviation| as drawn: mean %.2f, max %.2f %%",
             mean, max);
    deviations(p, &p->mask->after, &mean, &max);
    text = add(e, &n, PLAIN, picture_ink, "")->text;
    snprintf(text, MAX_TEXT, "after %u iteration%s: mean %.2f, max %.2f %%",
             p->mask->iterations, plural(p->mask->iterations), mean, max);
  }
  return height + flow(p, e, n, top + height, draw) + 0.4 * p->font;
}

/* ---- legend ---- */

/* A round length of about a sixth of the window. */
static entry scale_bar(const picture *p) {
  double room = (p->x1 - p->x0) / 6;
  double unit = pow(10, floor(log10(room))), nm = unit;
  if (room >= 2 * unit) nm = 2 * unit;
  if (room >= 5 * unit) nm = 5 * unit;
  entry e = {.sign = BAR, .size = nm * p->scale};
  if (nm < 1000)
    snprintf(e.text, sizeof e.text, "%g nm", nm);
  else
    snprintf(e.text, sizeof e.text, "%g um", nm / 1000);
  return e;
}

static int any_fails(const opc_mask *mask) {
  for (size_t i = 0; i < mask->gates->count; i++)
    if (mask->flags[i]) return 1;
  return 0;
}

static void add_layers(const picture *p, entry *e, size_t *n) {
  static const char *const drawn[OPC_LAYERS] = {
      [OPC_POLY] = "poly as drawn",
      [OPC_ACTIVE] = "active as drawn",
      [OPC_CONTACT] = "contact"};
  static const char *const mask[OPC_MASKS] = {
      [OPC_POLY] = "poly mask", [OPC_ACTIVE] = "active mask"};
  static const char *const print[OPC_MASKS] = {
      [OPC_POLY] = "printed poly", [OPC_ACTIVE] = "printed active"};
  for (int layer = 0; layer < OPC_LAYERS; layer++) {
    if (p->mask->gates->drawn[layer].count)
      add(e, n, FILL, picture_drawn[layer], drawn[layer]);
    if (layer >= OPC_MASKS) continue;
    if (p->mask->shapes[layer].count)
      add(e, n, LINE, picture_mask[layer], mask[layer])->line =
          fmax(0.08 * p->font, picture_mask_line(p));
    if (p->mask->print[layer].coefficients)
      add(e, n, LINE, picture_print[layer], print[layer])->line =
          fmax(0.08 * p->font, picture_print_line(p));
  }
}

double picture_legend(const picture *p, double top, int draw) {
  entry e[MAX_ENTRIES];
  size_t n = 0;
  use_font(p, p->font, 0);
  add_layers(p, e, &n);
  double gap = 0.6 * p->font;
  e[n++] = scale_bar(p);
  if (p->mask->gates->count)
    add(e, &n, RAMP, picture_ink, "Ion deviation after correction")->size =
        p->range;
  if (any_fails(p->mask))
    add(e, &n, CROSS, picture_unknown, "does not print well");
  return gap + flow(p, e, n, top + gap, draw);
}
