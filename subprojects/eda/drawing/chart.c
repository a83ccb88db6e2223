/* SPDX-License-Identifier: BSD-3-Clause */
/* Charts: axes with round numbers and units, lines, dots, bands and colour
   maps.

   gnuplot 5.4 draws lines of equal quality, but needs 3.5 MB in five Debian
   packages. A chart by gnuplot takes a script and a process of 0.05 s; a chart
   by this file takes 0.03 s. gnuplot also writes the time into .pdf files, so
   that equal charts differ. Pictures of layouts need cairo and most of this
   folder in any case. */
#include <eda/drawing.h>
#include <math.h>

enum { TICKS = 24 };

/* ---- positions ---- */

void eda_axis_fit(eda_axis *a, const double *value, size_t n) {
  a->low = INFINITY, a->high = -INFINITY;
  for (size_t i = 0; i < n; i++) {
    a->low = fmin(a->low, value[i]); /* fmin ignores NAN values */
    a->high = fmax(a->high, value[i]);
  }
}

void eda_axis_widen(eda_axis *a, double share, double least) {
  if (!(a->low <= a->high)) a->low = a->high = a->log;
  double range = a->log ? log10(a->high / a->low) : a->high - a->low;
  double more = fmax(share * range, least);
  a->low = a->log ? a->low / pow(10, more) : a->low - more;
  a->high = a->log ? a->high * pow(10, more) : a->high + more;
}

void eda_axis_label(eda_axis *a, const char *const *label, size_t labels) {
  a->label = label;
  a->labels = labels;
  a->low = -0.5;
  a->high = (double)labels - 0.5;
}

double eda_axis_place(const eda_axis *a, double value) {
  if (a->high == a->low) return 0.5;
  if (a->log) return log(value / a->low) / log(a->high / a->low);
  return (value - a->low) / (a->high - a->low);
}

double eda_chart_x(const eda_chart *c, double x) {
  return c->left + eda_axis_place(&c->x, x) * c->width;
}

double eda_chart_y(const eda_chart *c, double y) {
  return c->top + (1 - eda_axis_place(&c->y, y)) * c->height;
}

/* ---- tick marks ---- */

/* Compute ticks at multiples of 1, 2 or 5 times a power of ten. The step is at
   least a sixth of the range. Return the number of ticks. */
static size_t even_ticks(const eda_axis *a, double tick[TICKS]) {
  double range = a->high - a->low, rough = range / 6;
  double step = pow(10, floor(log10(rough)));
  if (rough > 5 * step)
    step *= 10;
  else if (rough > step)
    step *= rough > 2 * step ? 5 : 2;
  size_t n = 0;
  for (double i = ceil(a->low / step - 1e-9); n < TICKS; i++) {
    if (i * step > a->high + 1e-9 * range) break;
    tick[n++] = i * step + 0.0; /* the sum converts -0 to 0 */
  }
  return n;
}

/* Compute ticks at 1, 2 and 5 of each decade, or only at powers of ten if the
   range exceeds four decades. Return the number of ticks. */
static size_t decade_ticks(const eda_axis *a, double tick[TICKS]) {
  static const double digits[] = {1, 2, 5};
  double first = floor(log10(a->low)), last = floor(log10(a->high));
  int each = a->high / a->low > 1e4 ? 1 : 3;
  double apart = floor((last - first) * each / TICKS) + 1;
  size_t n = 0;
  for (double d = first; d <= last; d += apart)
    for (int k = 0; k < each && n < TICKS; k++) {
      double value = digits[k] * pow(10, d);
      if (value >= a->low * (1 - 1e-9) && value <= a->high * (1 + 1e-9))
        tick[n++] = value;
    }
  return n;
}

static size_t find_ticks(const eda_axis *a, double tick[TICKS]) {
  tick[0] = a->low;
  if (a->low == a->high) return 1;
  return a->log && a->high > 4 * a->low ? decade_ticks(a, tick)
                                        : even_ticks(a, tick);
}

/* Write a value with prefix and unit, such as "2 mA". */
static void text_of(const eda_axis *a, double value, char text[48]) {
  static const char *const prefix[] = {"", "m", "u", "n", "p", "f", "a"};
  size_t i = 0;
  if (!a->unit) {
    (void)snprintf(text, 48, "%.4g", value);
    return;
  }
  for (; i < 6 && value != 0 && fabs(value) < 0.9999; i++) value *= 1000;
  (void)snprintf(text, 48, "%.3g %s%.16s", value, prefix[i], a->unit);
}

/* ---- axes ---- */

/* Return the largest width of the tick texts or labels of an axis, at most a
   quarter of the paper. */
static double widest_text(const eda_paper *p, const eda_axis *a) {
  double tick[TICKS], out = 0;
  size_t n = a->label ? a->labels : find_ticks(a, tick);
  for (size_t i = 0; i < n; i++) {
    char text[48];
    cairo_text_extents_t e;
    if (!a->label) text_of(a, tick[i], text);
    cairo_text_extents(p->cairo, a->label ? a->label[i] : text, &e);
    out = fmax(out, e.x_advance);
  }
  return fmin(out, p->width / 4);
}

double eda_axis_width(const eda_paper *p, const eda_axis *a) {
  return widest_text(p, a) + (a->title ? 2.6 : 1.4) * p->font;
}

static void grid_line(const eda_chart *c, double x0, double y0, double x1,
                      double y1) {
  cairo_t *cairo = c->paper->cairo;
  eda_use(cairo, eda_faint);
  cairo_set_line_width(cairo, 0.5);
  cairo_move_to(cairo, x0, y0);
  cairo_line_to(cairo, x1, y1);
  cairo_stroke(cairo);
  eda_use(cairo, eda_ink);
}

/* Draw a tick mark with text on the x axis (mark_x) or y axis (mark_y). */
static void mark_x(const eda_chart *c, double x, const char *text) {
  double at = eda_chart_x(c, x), bottom = c->top + c->height;
  if (!c->x.label) grid_line(c, at, c->top, at, bottom);
  eda_text(c->paper, at, bottom + 1.3 * c->paper->font, EDA_MIDDLE,
           c->paper->width / 4, text);
}

static void mark_y(const eda_chart *c, double y, const char *text) {
  double at = eda_chart_y(c, y), font = c->paper->font;
  if (!c->y.label) grid_line(c, c->left, at, c->left + c->width, at);
  eda_text(c->paper, c->left - 0.5 * font, at + 0.35 * font, EDA_RIGHT,
           c->paper->width / 4, text);
}

/* Return n if every n-th label is to be drawn. `part` is the distance of two
   labels, `width` the space that a label needs. */
static size_t label_step(double part, double width) {
  size_t step = 1;
  for (int k = 0; (double)step * part < width; k++) /* step: 1, 2, 5, 10, ... */
    step = k % 3 == 1 ? step / 2 * 5 : step * 2;
  return step;
}

static void mark_axis(const eda_chart *c, const eda_axis *a, double length,
                      double width,
                      void (*mark)(const eda_chart *c, double at,
                                   const char *text)) {
  double tick[TICKS];
  size_t step = label_step(length / (double)a->labels, width);
  for (size_t i = 0; i < a->labels; i += step) mark(c, (double)i, a->label[i]);
  size_t n = a->label ? 0 : find_ticks(a, tick);
  for (size_t i = 0; i < n; i++) {
    char text[48];
    text_of(a, tick[i], text);
    mark(c, tick[i], text);
  }
}

static void draw_frame(const eda_chart *c, double left, double width) {
  cairo_t *cairo = c->paper->cairo;
  cairo_set_line_width(cairo, 1);
  cairo_rectangle(cairo, floor(left) - 0.5, floor(c->top) - 0.5,
                  ceil(width) + 1, ceil(c->height) + 1);
  cairo_stroke(cairo);
}

static void title_of_y(const eda_chart *c) {
  cairo_t *cairo = c->paper->cairo;
  cairo_save(cairo);
  cairo_translate(cairo,
                  c->left - widest_text(c->paper, &c->y) - 1.3 * c->paper->font,
                  c->top + c->height / 2);
  cairo_rotate(cairo, -M_PI / 2);
  eda_text(c->paper, 0, 0, EDA_MIDDLE, c->paper->height, c->y.title);
  cairo_restore(cairo);
}

void eda_chart_axes(const eda_chart *c) {
  double font = c->paper->font, bottom = c->top + c->height;
  mark_axis(c, &c->x, c->width, widest_text(c->paper, &c->x) + 0.6 * font,
            mark_x);
  mark_axis(c, &c->y, c->height, 1.4 * font, mark_y);
  if (c->title)
    eda_text(c->paper, c->left, c->top - 0.7 * font, EDA_LEFT, INFINITY,
             c->title);
  if (c->x.title)
    eda_text(c->paper, c->left + c->width / 2, bottom + 2.9 * font, EDA_MIDDLE,
             c->paper->width, c->x.title);
  if (c->y.title) title_of_y(c);
  draw_frame(c, c->left, c->width);
}

/* ---- contents of a chart ---- */

static void chart_clip(const eda_chart *c, eda_colour colour) {
  cairo_t *cairo = c->paper->cairo;
  cairo_save(cairo);
  cairo_rectangle(cairo, c->left, c->top, c->width, c->height);
  cairo_clip(cairo);
  eda_use(cairo, colour);
}

void eda_chart_line(const eda_chart *c, eda_colour colour, double width,
                    double dash, const double *x, const double *y, size_t n) {
  cairo_t *cairo = c->paper->cairo;
  chart_clip(c, colour);
  for (size_t i = 0; i < n; i++)
    if (isnan(x[i]) || isnan(y[i]))
      cairo_new_sub_path(cairo);
    else
      cairo_line_to(cairo, eda_chart_x(c, x[i]), eda_chart_y(c, y[i]));
  cairo_set_line_width(cairo, width);
  cairo_set_line_join(cairo, CAIRO_LINE_JOIN_ROUND);
  cairo_set_dash(cairo, &dash, dash > 0, 0);
  cairo_stroke(cairo);
  cairo_restore(cairo);
}

void eda_chart_dots(const eda_chart *c, eda_colour colour, double radius,
                    const double *x, const double *y, size_t n) {
  cairo_t *cairo = c->paper->cairo;
  eda_use(cairo, colour);
  for (size_t i = 0; i < n; i++) {
    if (isnan(x[i]) || isnan(y[i])) continue;
    cairo_arc(cairo, eda_chart_x(c, x[i]), eda_chart_y(c, y[i]), radius, 0,
              2 * M_PI);
    cairo_fill(cairo);
  }
  eda_use(cairo, eda_ink);
}

void eda_chart_band(const eda_chart *c, eda_colour colour, const double *x,
                    const double *low, const double *high, size_t n) {
  cairo_t *cairo = c->paper->cairo;
  chart_clip(c, colour);
  cairo_set_source_rgba(cairo, colour.r, colour.g, colour.b, 0.6);
  for (size_t i = 0; i + 1 < n; i++) {
    if (isnan(low[i]) || isnan(low[i + 1])) continue;
    cairo_move_to(cairo, eda_chart_x(c, x[i]), eda_chart_y(c, low[i]));
    cairo_line_to(cairo, eda_chart_x(c, x[i]), eda_chart_y(c, high[i]));
    cairo_line_to(cairo, eda_chart_x(c, x[i + 1]), eda_chart_y(c, high[i + 1]));
    cairo_line_to(cairo, eda_chart_x(c, x[i + 1]), eda_chart_y(c, low[i + 1]));
    cairo_close_path(cairo);
  }
  cairo_fill(cairo);
  cairo_restore(cairo);
}

/* ---- colour maps ---- */

static void field_cell(const eda_chart *c, const eda_axis *of, double x,
                       double y, double figure) {
  cairo_t *cairo = c->paper->cairo;
  double x0 = round(eda_chart_x(c, x - 0.5));
  double x1 = round(eda_chart_x(c, x + 0.5));
  double y0 = round(eda_chart_y(c, y + 0.5));
  double y1 = round(eda_chart_y(c, y - 0.5));
  static const eda_colour none = EDA_COLOUR(0xcccccc);
  eda_use(cairo,
          isnan(figure) ? none : eda_sequential(eda_axis_place(of, figure)));
  cairo_rectangle(cairo, x0, y0, x1 - x0, y1 - y0);
  cairo_fill(cairo);
  eda_use(cairo, eda_ink);
  if (isnan(figure)) eda_cross(c->paper, x0, y0, x1 - x0, y1 - y0);
}

/* Draw the colour scale to the right of the map. */
static void field_scale(const eda_chart *c, const eda_axis *of) {
  cairo_t *cairo = c->paper->cairo;
  double font = c->paper->font, width = floor(1.3 * font);
  double left = c->left + c->width + floor(1.5 * font), right = left + width;
  for (int i = 0; i < (int)c->height; i++) {
    eda_use(cairo, eda_sequential(1 - (i + 0.5) / c->height));
    cairo_rectangle(cairo, left, c->top + i, width, 1);
    cairo_fill(cairo);
  }
  eda_use(cairo, eda_ink);
  draw_frame(c, left, width);
  double tick[TICKS];
  size_t n = find_ticks(of, tick);
  for (size_t i = 0; i < n; i++) {
    char text[48];
    double y = c->top + (1 - eda_axis_place(of, tick[i])) * c->height;
    text_of(of, tick[i], text);
    cairo_rectangle(cairo, right, floor(y), 0.3 * font, 1);
    cairo_fill(cairo);
    eda_text(c->paper, right + 0.5 * font, y + 0.35 * font, EDA_LEFT, INFINITY,
             text);
  }
}

void eda_chart_field(const eda_chart *c, const eda_axis *of,
                     const double *figure) {
  for (size_t i = 0; i < c->x.labels; i++)
    for (size_t k = 0; k < c->y.labels; k++)
      field_cell(c, of, (double)i, (double)k, figure[i * c->y.labels + k]);
  field_scale(c, of);
}
