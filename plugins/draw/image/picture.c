/* SPDX-License-Identifier: BSD-3-Clause */
/* The picture: the first model's image below, shapes and contours above. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "../legend.h"
#include "../mask/paper.h"
#include "image.h"

/* ---- colours ---- */

/* Of contours, on the blue half of the scale, where they lie. */
static const rgb contour[IMAGE_MODELS] = {RGB(0xffffff), RGB(0xff9a1f),
                                          RGB(0xff6fcf), RGB(0xffee33)};
static const rgb drawn_colour = RGB(0xa9b8d6), mask_colour = RGB(0x101010),
                 other_colour = RGB(0x0b6b3a);

static const char *const layer_name[OPC_MASKS] = {"poly", "active"};

/* ---- the image ---- */

enum { PROBES = 200 };

/* The end of the scale: the brightest place of the window, rounded up. */
static double find_brightest(const image_run *r) {
  const view *v = &r->view;
  double brightest = 0;
  for (int j = 0; j <= PROBES; j++) {
    double x[PROBES + 1], y[PROBES + 1], value[PROBES + 1];
    for (int i = 0; i <= PROBES; i++) {
      x[i] = v->x0 + (v->x1 - v->x0) * i / PROBES;
      y[i] = v->y0 + (v->y1 - v->y0) * j / PROBES;
    }
    v->host->imaging->sample(&r->model[0].image, x, y, PROBES + 1, value);
    for (int i = 0; i <= PROBES; i++) brightest = fmax(brightest, value[i]);
  }
  return fmax(0.1, ceil(10 * brightest - 1e-3) / 10);
}

typedef struct pixels {
  const image_run *run;
  int width, stride;
  unsigned char *data;
} pixels;

static uint32_t packed(rgb c) {
  return (uint32_t)lround(255 * c.r) << 16 | (uint32_t)lround(255 * c.g) << 8 |
         (uint32_t)lround(255 * c.b);
}

/* The image is periodic: what is beyond its frame is not of this layout. */
static int inside(opc_frame f, double x, double y) {
  return x >= f.x0 && x <= f.x0 + f.width && y >= f.y0 && y <= f.y0 + f.height;
}

static void paint_row(void *data, size_t row) {
  enum { CHUNK = 128, BEYOND = 0xffffff };
  const pixels *p = data;
  const view *v = &p->run->view;
  const opc_field *image = &p->run->model[0].image;
  double x[CHUNK], y[CHUNK], value[CHUNK];
  uint32_t *out = (uint32_t *)(void *)(p->data + row * (size_t)p->stride);
  for (int first = 0; first < p->width; first += CHUNK) {
    int n = p->width - first < CHUNK ? p->width - first : CHUNK;
    for (int i = 0; i < n; i++) {
      x[i] = v->x0 + (first + i + 0.5) / v->scale;
      y[i] = v->y1 - ((double)row + 0.5) / v->scale;
    }
    v->host->imaging->sample(image, x, y, (size_t)n, value);
    for (int i = 0; i < n; i++)
      out[first + i] =
          inside(image->frame, x[i], y[i])
              ? packed(picture_sequential(value[i] / p->run->brightest))
              : BEYOND;
  }
}

/* A pixel of the image for each of the window, whatever the format. */
static void paint_image(const image_run *r) {
  const view *v = &r->view;
  cairo_surface_t *s = cairo_image_surface_create(
      CAIRO_FORMAT_RGB24, (int)v->width, (int)v->height);
  cairo_surface_flush(s);
  pixels p = {r, cairo_image_surface_get_width(s),
              cairo_image_surface_get_stride(s),
              cairo_image_surface_get_data(s)};
  size_t rows = p.data ? (size_t)cairo_image_surface_get_height(s) : 0;
  v->host->parallel(v->host, rows, paint_row, &p);
  cairo_surface_mark_dirty(s);
  cairo_set_source_surface(v->cairo, s, v->left, v->top);
  cairo_paint(v->cairo);
  cairo_surface_destroy(s);
}

/* ---- lines ---- */

static int outlines(const image_run *r, opc_error *error) {
  const view *v = &r->view;
  double line = view_outline_width(v);
  const opc_shapes *other = &r->gates->drawn[OPC_POLY + OPC_ACTIVE - r->layer];
  picture_use(v->cairo, other_colour);
  int code = view_outline(v, other, line, error);
  picture_use(v->cairo, drawn_colour);
  if (!code) code = view_outline(v, &r->gates->drawn[r->layer], line, error);
  picture_use(v->cairo, mask_colour);
  if (!code && r->corrected) code = view_outline(v, r->mask, line, error);
  return code;
}

static int draw_contours(const image_run *r, size_t k, opc_error *error) {
  const view *v = &r->view;
  view_contours found;
  int code = view_find_contours(v, &r->model[k].print, &found, error);
  cairo_set_line_width(v->cairo, view_contour_width(v));
  picture_use(v->cairo, contour[k]);
  if (!code) view_draw_contours(v, &found);
  view_release_contours(v, &found);
  return code;
}

/* The first one all along, the others in dashes that take turns: contours that
   lie upon each other are all seen. */
static int dashed_contours(const image_run *r, opc_error *error) {
  const view *v = &r->view;
  double period = 2.2 * v->font, dash = period / (double)r->n;
  const double dashes[] = {dash, period - dash};
  int code = OPC_OK;
  for (size_t k = 0; k < r->n && !code; k++) {
    cairo_set_dash(v->cairo, dashes, k ? 2 : 0, -(double)k * dash);
    code = draw_contours(r, k, error);
  }
  cairo_set_dash(v->cairo, NULL, 0, 0);
  return code;
}

/* ---- lenses ---- */

/* Below the window, for each model but the first one: where it is furthest from
   the first one, so large that the distance is seen. */

static int has_lens(const image_run *r, size_t k) {
  return k && r->model[k].distance.max >= 1e-3;
}

static int any_lens(const image_run *r) {
  for (size_t k = 0; k < r->n; k++)
    if (has_lens(r, k)) return 1;
  return 0;
}

static double lens_gap(const view *v) { return ceil(0.8 * v->font); }

/* Their width, the same for any number of models. */
static double lens_width(const view *v) {
  double room = v->paper - 2 * view_margin(v);
  return floor((room - (IMAGE_MODELS - 2) * lens_gap(v)) / (IMAGE_MODELS - 1));
}

static double lens_height(const view *v) { return floor(0.6 * lens_width(v)); }

/* What is seen of the layout: a round width of ten distances or more. */
static double lens_nm(const image_model *m) {
  double wanted = 10 * m->distance.max, unit = pow(10, floor(log10(wanted)));
  if (wanted <= unit) return unit;
  return wanted <= 2 * unit   ? 2 * unit
         : wanted <= 5 * unit ? 5 * unit
                              : 10 * unit;
}

/* The view of a lens, number `place` of them. */
static view lens_view(const image_run *r, size_t k, size_t place) {
  view v = r->view;
  const image_model *m = &r->model[k];
  v.width = lens_width(&v);
  v.height = lens_height(&v);
  v.left = view_margin(&v) + (double)place * (v.width + lens_gap(&v));
  v.top = r->view.top + r->view.height + lens_gap(&v);
  v.scale = v.width / lens_nm(m);
  v.x0 = m->distance.x - v.width / 2 / v.scale;
  v.y0 = m->distance.y - v.height / 2 / v.scale;
  v.x1 = v.x0 + v.width / v.scale;
  v.y1 = v.y0 + v.height / v.scale;
  return v;
}

/* A sharp frame around a place, in the model's colour between thin dark
   lines. */
static void frame(const view *v, rgb colour, double x, double y, double width,
                  double height) {
  double line = fmax(1, round(0.12 * v->font));
  cairo_rectangle(v->cairo, floor(x) - line / 2, floor(y) - line / 2,
                  round(width) + line, round(height) + line);
  picture_use(v->cairo, picture_ink);
  cairo_set_line_width(v->cairo, line + 2);
  cairo_stroke_preserve(v->cairo);
  picture_use(v->cairo, colour);
  cairo_set_line_width(v->cairo, line);
  cairo_stroke(v->cairo);
}

static int lens(const image_run *r, size_t k, size_t place, opc_error *error) {
  image_run part = *r;
  part.view = lens_view(r, k, place);
  const view *v = &part.view;
  cairo_save(v->cairo);
  cairo_reset_clip(v->cairo);
  cairo_rectangle(v->cairo, v->left, v->top, v->width, v->height);
  cairo_clip(v->cairo);
  paint_image(&part);
  int code = outlines(&part, error);
  if (!code) code = draw_contours(&part, 0, error);
  if (!code) code = draw_contours(&part, k, error);
  cairo_reset_clip(v->cairo);
  frame(v, contour[k], v->left, v->top, v->width, v->height);
  cairo_restore(v->cairo);
  const image_distance *d = &r->model[k].distance;
  double side = 1.1 * v->font;
  frame(&r->view, contour[k], view_x(&r->view, d->x) - side / 2,
        view_y(&r->view, d->y) - side / 2, side, side);
  return code;
}

static int lenses(const image_run *r, opc_error *error) {
  size_t place = 0;
  int code = OPC_OK;
  for (size_t k = 0; k < r->n && !code; k++)
    if (has_lens(r, k)) code = lens(r, k, place++, error);
  return code;
}

/* What stands below them; returns the height of all. */
static double lens_texts(const image_run *r, double top, int draw) {
  const view *v = &r->view;
  if (!any_lens(r)) return 0;
  double text = top + lens_gap(v) + lens_height(v) + 1.3 * v->font;
  size_t place = 0;
  for (size_t k = 0; k < r->n && draw; k++) {
    const image_model *m = &r->model[k];
    char line[LEGEND_TEXT];
    if (!has_lens(r, k)) continue;
    (void)snprintf(line, sizeof line, "%.3g nm apart, %g nm wide",
                   m->distance.max, lens_nm(m));
    legend_text(v, line, lens_view(r, k, place++).left, floor(text),
                lens_width(v));
  }
  return lens_gap(v) + lens_height(v) + 1.9 * v->font;
}

/* ---- the parts of a view ---- */

static int content(const void *data, opc_error *error) {
  const image_run *r = data;
  const opc_host *host = r->view.host;
  paint_image(r);
  int code = outlines(r, error);
  if (!code && host->cancelled(host))
    code = host->fail(host, error, OPC_CANCELLED, NULL, "stopped");
  if (!code) code = dashed_contours(r, error);
  if (!code) code = lenses(r, error);
  return code;
}

static double title(const void *data, double top, int draw) {
  const image_run *r = data;
  const view *v = &r->view;
  legend l = {.n = 0};
  char name[LEGEND_TEXT];
  (void)snprintf(name, sizeof name, "%s: %s",
                 r->gates->name ? r->gates->name : "", layer_name[r->layer]);
  double height = legend_heading(v, name, top, draw);
  legend_add(&l, LEGEND_PLAIN, picture_ink, "aerial image: %s",
             r->model[0].label);
  if (r->n > 1)
    legend_add(&l, LEGEND_PLAIN, picture_ink,
               "contours: distance from the first (rms, largest)");
  return height + legend_flow(v, &l, top + height, draw) + 0.4 * v->font;
}

/* A light line is seen on the blue that it is drawn for. */
static void lay_on_ground(const view *v, legend_entry *e) {
  e->behind = picture_sequential(0.3);
  e->behind_line = 0.8 * v->font;
}

/* "label: I = 0.404; 0.03, 0.12 nm" */
static void add_model(const image_run *r, size_t k, legend *l) {
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
  legend_entry *e =
      legend_add(l, LEGEND_LINE, contour[k], "%s: %s%s", m->label, level, away);
  e->line = fmax(0.14 * v->font, view_contour_width(v));
  lay_on_ground(v, e);
}

static legend_entry *add_outline(const view *v, legend *l, rgb colour,
                                 const char *layer, const char *what) {
  legend_entry *e = legend_add(l, LEGEND_LINE, colour, "%s %s", layer, what);
  e->line = fmax(0.08 * v->font, view_outline_width(v));
  return e;
}

static double legend_of(const void *data, double top, int draw) {
  const image_run *r = data;
  const view *v = &r->view;
  legend l = {.n = 0};
  int other = OPC_POLY + OPC_ACTIVE - r->layer;
  double gap = 0.6 * v->font + lens_texts(r, top, draw);
  legend_use_font(v);
  for (size_t k = 0; k < r->n; k++) add_model(r, k, &l);
  legend_entry *e =
      legend_add(&l, LEGEND_RAMP, picture_ink, "intensity, clear field 1");
  e->ramp = picture_sequential;
  (void)snprintf(e->low, sizeof e->low, "0");
  (void)snprintf(e->high, sizeof e->high, "%.1f", r->brightest);
  legend_add_scale_bar(&l, v);
  lay_on_ground(
      v, add_outline(v, &l, drawn_colour, layer_name[r->layer], "as drawn"));
  if (r->corrected)
    add_outline(v, &l, mask_colour, layer_name[r->layer], "mask");
  if (r->gates->drawn[other].count)
    add_outline(v, &l, other_colour, layer_name[other], "as drawn");
  return gap + legend_flow(v, &l, top + gap, draw);
}

/* ---- all of it ---- */

int image_draw(image_run *r, int format, const char *path, opc_error *error) {
  static const view_parts parts = {title, legend_of, content};
  r->brightest = find_brightest(r);
  return view_write(&r->view, &parts, r, format, path, error);
}
