/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the picture: the aerial image of the first model, under the shapes
   and the contours. */
#include <glib.h>
#include <math.h>
#include <stdio.h>

#include "image.h"

/* ---- colours ---- */

/* Colours of contours, visible on the blue part of the colour scale. */
static const eda_colour contour[IMAGE_MODELS] = {
    EDA_COLOUR(0xffffff), EDA_COLOUR(0xff9a1f), EDA_COLOUR(0xff6fcf),
    EDA_COLOUR(0xffee33)};
static const eda_colour drawn_colour = EDA_COLOUR(0xa9b8d6),
                        mask_colour = EDA_COLOUR(0x101010),
                        other_colour = EDA_COLOUR(0x0b6b3a);

/* Return active if the simulated layer is poly; otherwise, or without active,
   return poly. */
static size_t other_layer(const image_run *r) {
  return r->layer == EDA_POLY && r->gates->layers > EDA_ACTIVE ? EDA_ACTIVE
                                                               : EDA_POLY;
}

/* ---- the image ---- */

enum { PROBES = 200 };

/* Return the largest intensity in the window, rounded up, as the end of the
   scale. */
static double find_brightest(const image_run *r) {
  const view *v = &r->view;
  double brightest = 0;
  for (int j = 0; j <= PROBES; j++) {
    double x[PROBES + 1], y[PROBES + 1], value[PROBES + 1];
    for (int i = 0; i <= PROBES; i++) {
      x[i] = v->x0 + (v->x1 - v->x0) * i / PROBES;
      y[i] = v->y0 + (v->y1 - v->y0) * j / PROBES;
    }
    eda_field_sample(&r->model[0].image, x, y, PROBES + 1, value);
    for (int i = 0; i <= PROBES; i++) brightest = fmax(brightest, value[i]);
  }
  return fmax(0.1, ceil(10 * brightest - 1e-3) / 10);
}

typedef struct pixels {
  const image_run *run;
  int width, stride;
  unsigned char *data;
} pixels;

/* Return 1 for a position within the frame. The periodic image outside of the
   frame is not shown. */
static int frame_contains(eda_frame f, double x, double y) {
  return x >= f.x0 && x <= f.x0 + f.width && y >= f.y0 && y <= f.y0 + f.height;
}

static void paint_row(void *data, size_t row) {
  enum { CHUNK = 128, BEYOND = 0xffffff };
  const pixels *p = data;
  const view *v = &p->run->view;
  const eda_field *image = &p->run->model[0].image;
  double x[CHUNK], y[CHUNK], value[CHUNK];
  uint32_t *out = (uint32_t *)(void *)(p->data + row * (size_t)p->stride);
  for (int first = 0; first < p->width; first += CHUNK) {
    int n = p->width - first < CHUNK ? p->width - first : CHUNK;
    for (int i = 0; i < n; i++) {
      x[i] = v->x0 + (first + i + 0.5) / v->scale;
      y[i] = v->y1 - ((double)row + 0.5) / v->scale;
    }
    eda_field_sample(image, x, y, (size_t)n, value);
    for (int i = 0; i < n; i++)
      out[first + i] =
          frame_contains(image->frame, x[i], y[i])
              ? eda_colour_packed(eda_sequential(value[i] / p->run->brightest))
              : BEYOND;
  }
}

/* Draw the image with one sample for each pixel of the window, also in vector
   files. */
static void paint_image(const image_run *r) {
  const view *v = &r->view;
  cairo_surface_t *s = cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, (int)v->width, (int)v->height);
  cairo_surface_flush(s);
  pixels p = {r, cairo_image_surface_get_width(s),
              cairo_image_surface_get_stride(s),
              cairo_image_surface_get_data(s)};
  size_t rows = p.data ? (size_t)cairo_image_surface_get_height(s) : 0;
  opc_parallel(v->context, rows, paint_row, &p);
  cairo_surface_mark_dirty(s);
  cairo_set_source_surface(v->paper->cairo, s, v->left, v->top);
  cairo_paint(v->paper->cairo);
  cairo_surface_destroy(s);
}

/* ---- lines ---- */

static int draw_outlines(const image_run *r, opc_error *error) {
  const view *v = &r->view;
  const eda_shapes *drawn = r->gates->drawn;
  int code = view_outline(v, &drawn[other_layer(r)], other_colour, error);
  if (!code) code = view_outline(v, &drawn[r->layer], drawn_colour, error);
  if (!code && r->corrected)
    code = view_outline(v, r->shapes, mask_colour, error);
  return code;
}

static int draw_contours(const image_run *r, size_t k, opc_error *error) {
  view_contours found;
  int code = view_find_contours(&r->view, &r->model[k].print, &found, error);
  if (!code) view_draw_contours(&r->view, &found, contour[k]);
  view_clear_contours(&found);
  return code;
}

/* Draw the contour of the first model as a solid line and those of other models
   in alternating dashes, so that coincident contours are all visible. */
static int dashed_contours(const image_run *r, opc_error *error) {
  const view *v = &r->view;
  double period = 2.2 * v->paper->font, dash = period / (double)r->n;
  const double dashes[] = {dash, period - dash};
  int code = OPC_OK;
  for (size_t k = 0; k < r->n && !code; k++) {
    cairo_set_dash(v->paper->cairo, dashes, k ? 2 : 0, -(double)k * dash);
    code = draw_contours(r, k, error);
  }
  cairo_set_dash(v->paper->cairo, NULL, 0, 0);
  return code;
}

/* ---- lenses ---- */

/* Return 1 if a model has a lens below the window. Each model but the first has
   a lens if its contours are 1e-3 nm or more from those of the first model. The
   lens magnifies the position of the largest distance. */
static int has_lens(const image_run *r, size_t k) {
  return k && r->model[k].distance.max >= 1e-3;
}

static int any_lens(const image_run *r) {
  for (size_t k = 0; k < r->n; k++)
    if (has_lens(r, k)) return 1;
  return 0;
}

static double lens_gap(const view *v) { return ceil(0.8 * v->paper->font); }

/* Return the width of a lens, equal for any number of models. */
static double lens_width(const view *v) {
  double width = v->paper->width - 2 * v->paper->margin;
  return floor((width - (IMAGE_MODELS - 2) * lens_gap(v)) / (IMAGE_MODELS - 1));
}

static double lens_height(const view *v) { return floor(0.6 * lens_width(v)); }

/* Return the width of the region in a lens, nm: a round number of at least ten
   times the largest distance. */
static double lens_nm(const image_model *m) {
  double wanted = 10 * m->distance.max, unit = pow(10, floor(log10(wanted)));
  if (wanted <= unit) return unit;
  return wanted <= 2 * unit   ? 2 * unit
         : wanted <= 5 * unit ? 5 * unit
                              : 10 * unit;
}

/* Return the view of model k in lens number `place`. */
static view lens_view(const image_run *r, size_t k, size_t place) {
  view v = r->view;
  const image_model *m = &r->model[k];
  v.width = lens_width(&v);
  v.height = lens_height(&v);
  v.left = v.paper->margin + (double)place * (v.width + lens_gap(&v));
  v.top = r->view.top + r->view.height + lens_gap(&v);
  v.scale = v.width / lens_nm(m);
  v.x0 = m->distance.x - v.width / 2 / v.scale;
  v.y0 = m->distance.y - v.height / 2 / v.scale;
  v.x1 = v.x0 + v.width / v.scale;
  v.y1 = v.y0 + v.height / v.scale;
  return v;
}

/* Draw a frame in the model's colour between thin dark lines. */
static void draw_frame(const view *v, eda_colour colour, double x, double y,
                       double width, double height) {
  double line = fmax(1, round(0.12 * v->paper->font));
  cairo_rectangle(v->paper->cairo, floor(x) - line / 2, floor(y) - line / 2,
                  round(width) + line, round(height) + line);
  eda_use(v->paper->cairo, eda_ink);
  cairo_set_line_width(v->paper->cairo, line + 2);
  cairo_stroke_preserve(v->paper->cairo);
  eda_use(v->paper->cairo, colour);
  cairo_set_line_width(v->paper->cairo, line);
  cairo_stroke(v->paper->cairo);
}

static int draw_lens(const image_run *r, size_t k, size_t place,
                     opc_error *error) {
  image_run part = *r;
  part.view = lens_view(r, k, place);
  const view *v = &part.view;
  cairo_save(v->paper->cairo);
  cairo_reset_clip(v->paper->cairo);
  cairo_rectangle(v->paper->cairo, v->left, v->top, v->width, v->height);
  cairo_clip(v->paper->cairo);
  paint_image(&part);
  int code = draw_outlines(&part, error);
  if (!code) code = draw_contours(&part, 0, error);
  if (!code) code = draw_contours(&part, k, error);
  cairo_reset_clip(v->paper->cairo);
  draw_frame(v, contour[k], v->left, v->top, v->width, v->height);
  cairo_restore(v->paper->cairo);
  const image_distance *d = &r->model[k].distance;
  double side = 1.1 * v->paper->font;
  draw_frame(&r->view, contour[k], view_x(&r->view, d->x) - side / 2,
             view_y(&r->view, d->y) - side / 2, side, side);
  return code;
}

static int draw_lenses(const image_run *r, opc_error *error) {
  size_t place = 0;
  int code = OPC_OK;
  for (size_t k = 0; k < r->n && !code; k++)
    if (has_lens(r, k)) code = draw_lens(r, k, place++, error);
  return code;
}

/* Draw the captions of the lenses. Returns the height of lenses and
   captions. */
static double lens_texts(const image_run *r, double top) {
  const view *v = &r->view;
  if (!any_lens(r)) return 0;
  double text = top + lens_gap(v) + lens_height(v) + 1.3 * v->paper->font;
  size_t place = 0;
  for (size_t k = 0; k < r->n; k++) {
    const image_model *m = &r->model[k];
    char line[80];
    if (!has_lens(r, k)) continue;
    (void)snprintf(line, sizeof line, "contours %.3g nm apart; view %g nm wide",
                   m->distance.max, lens_nm(m));
    eda_text(v->paper, lens_view(r, k, place++).left, floor(text), EDA_LEFT,
             lens_width(v), line);
  }
  return lens_gap(v) + lens_height(v) + 1.9 * v->paper->font;
}

/* ---- the parts of a view ---- */

static int image_content(const void *self, opc_error *error) {
  const image_run *r = self;
  paint_image(r);
  int code = draw_outlines(r, error);
  if (!code && opc_cancelled(r->view.context))
    code = opc_fail(error, OPC_CANCELLED, NULL, "stopped");
  if (!code) code = dashed_contours(r, error);
  if (!code) code = draw_lenses(r, error);
  return code;
}

static double image_title(const void *self, double top) {
  const image_run *r = self;
  const eda_paper *paper = r->view.paper;
  g_autofree char *name =
      g_strdup_printf("%s: %s", r->gates->name ? r->gates->name : "",
                      r->gates->layer[r->layer]);
  double height = eda_heading(paper, top, name);
  eda_legend l;
  eda_legend_init(&l, paper, top + height);
  eda_legend_add(&l, NULL, "aerial image: %s", r->model[0].label);
  if (r->n > 1)
    eda_legend_add(&l, NULL,
                   "contours: distance from the first (rms, largest)");
  return height + l.height + 0.4 * paper->font;
}

/* Return the legend sign of a line; light lines get a blue background. */
static eda_sign sign_of(const view *v, eda_colour colour, double line,
                        int light) {
  return (eda_sign){.kind = EDA_SIGN_LINE,
                    .colour = colour,
                    .line = line,
                    .behind = eda_sequential(0.3),
                    .behind_line = light ? 0.8 * v->paper->font : 0};
}

/* Add a model to the legend: "label: I = 0.404; 0.03, 0.12 nm" (intensity; rms
   and largest distance). */
static void add_model(const image_run *r, size_t k, eda_legend *l) {
  const view *v = &r->view;
  const image_model *m = &r->model[k];
  char level[48] = "no contour", away[64] = "";
  if (m->high - m->low < 5e-4)
    (void)snprintf(level, sizeof level, "I = %.3f", (m->low + m->high) / 2);
  else if (m->high >= m->low)
    (void)snprintf(level, sizeof level, "I = %.3f to %.3f", m->low, m->high);
  if (k && !isnan(m->distance.rms))
    (void)snprintf(away, sizeof away, "; %.2f, %.2f nm", m->distance.rms,
                   m->distance.max);
  double line = fmax(0.14 * v->paper->font, view_contour_width(v));
  eda_sign sign = sign_of(v, contour[k], line, 1);
  eda_legend_add(l, &sign, "%s: %s%s", m->label, level, away);
}

static double image_legend(const void *self, double top) {
  const image_run *r = self;
  const view *v = &r->view;
  double line = fmax(0.08 * v->paper->font, view_outline_width(v));
  double gap = 0.6 * v->paper->font + lens_texts(r, top);
  char high[16];
  eda_legend l;
  eda_legend_init(&l, v->paper, top + gap);
  for (size_t k = 0; k < r->n; k++) add_model(r, k, &l);
  (void)snprintf(high, sizeof high, "%.1f", r->brightest);
  eda_sign sign = {
      .kind = EDA_SIGN_RAMP, .ramp = eda_sequential, .low = "0", .high = high};
  eda_legend_add(&l, &sign, "intensity, relative to the clear field");
  view_add_scale_bar(v, &l);
  sign = sign_of(v, drawn_colour, line, 1);
  eda_legend_add(&l, &sign, "%s as drawn", r->gates->layer[r->layer]);
  sign = sign_of(v, mask_colour, line, 0);
  if (r->corrected)
    eda_legend_add(&l, &sign, "%s mask", r->gates->layer[r->layer]);
  sign = sign_of(v, other_colour, line, 0);
  size_t other = other_layer(r);
  if (other != r->layer && r->gates->drawn[other].count)
    eda_legend_add(&l, &sign, "%s as drawn", r->gates->layer[other]);
  return gap + l.height;
}

/* ---- run ---- */

int image_draw(image_run *r, opc_error *error) {
  static const view_parts parts = {image_title, image_legend, image_content};
  r->brightest = find_brightest(r);
  return view_write(&r->view, &parts, r, error);
}
