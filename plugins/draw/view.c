/* SPDX-License-Identifier: BSD-3-Clause */
#include "view.h"

#include <math.h>

#include "mask/paper.h"

static const double margin = 100;      /* around all shapes, nm */
static const double max_place = 1e9;   /* of a window, nm */
static const double smallest_font = 9; /* pixels */

/* ---- the window ---- */

int view_check_window(const opc_host *host, const opc_value *window,
                      opc_error *error) {
  const double *w = window->reals;
  if (window->type == OPC_ABSENT) return OPC_OK;
  if (window->count != 4)
    return host->fail(host, error, OPC_INVALID, "window",
                      "'window' needs 4 lengths, [x0, y0, x1, y1], not %zu",
                      window->count);
  for (int i = 0; i < 4; i++)
    if (!(fabs(w[i]) <= max_place))
      return host->fail(host, error, OPC_INVALID, "window",
                        "'window': %g nm is too far away", w[i]);
  if (!(w[2] - w[0] >= 1 && w[3] - w[1] >= 1))
    return host->fail(host, error, OPC_INVALID, "window",
                      "'window': x1 and y1 must be at least 1 nm above "
                      "x0 and y0");
  return OPC_OK;
}

static int choose_window(view *v, opc_box e, const opc_value *window,
                         const char *source, opc_error *error) {
  if (e.x0 >= e.x1 || e.y0 >= e.y1)
    return v->host->fail(v->host, error, OPC_INVALID, source,
                         "the layout is empty, there is nothing to draw");
  double x0 = e.x0 * v->grid - margin, x1 = e.x1 * v->grid + margin;
  double y0 = e.y0 * v->grid - margin, y1 = e.y1 * v->grid + margin;
  if (window->type != OPC_ABSENT) {
    const double *w = window->reals;
    if (w[0] >= x1 || w[2] <= x0 || w[1] >= y1 || w[3] <= y0)
      return v->host->fail(
          v->host, error, OPC_INVALID, "window",
          "'window' lies beside the layout, which goes from (%g, %g) "
          "to (%g, %g) nm",
          x0 + margin, y0 + margin, x1 - margin, y1 - margin);
    x0 = w[0], y0 = w[1], x1 = w[2], y1 = w[3];
  } else {
    /* A tall or flat layout gets room at its sides, so that the picture does
       not become a strip. */
    double more = (y1 - y0) / 1.5 - (x1 - x0);
    if (more > 0) x0 -= more / 2, x1 += more / 2;
    more = (x1 - x0) / 4 - (y1 - y0);
    if (more > 0) y0 -= more / 2, y1 += more / 2;
  }
  v->x0 = x0, v->y0 = y0, v->x1 = x1, v->y1 = y1;
  return OPC_OK;
}

int view_make(view *v, const opc_host *host, const opc_gates *gates,
              const opc_value *window, int64_t width, const char *source,
              opc_error *error) {
  *v = (view){.host = host, .grid = gates->grid, .paper = (double)width};
  v->font = fmax(smallest_font, v->paper / 72);
  return choose_window(v, gates->extent, window, source, error);
}

/* ---- the paper ---- */

double view_margin(const view *v) { return ceil(0.9 * v->font); }

/* Where all lies on a paper of the width that was asked for; its height. */
static double lay_out(view *v, const view_parts *parts, const void *picture) {
  double room = v->paper - 2 * view_margin(v);
  double aspect = (v->y1 - v->y0) / (v->x1 - v->x0);
  double fit = fmin(room, 1.5 * room / aspect);
  v->scale = fit / (v->x1 - v->x0);
  v->width = fmax(1, round(fit));
  v->height = fmax(1, round(fit * aspect));
  v->left = floor((v->paper - v->width) / 2);
  double title = parts->title(picture, 0, 0);
  v->top = ceil(view_margin(v) + title);
  double bottom = v->top + v->height;
  return ceil(bottom + parts->legend(picture, bottom, 0) + view_margin(v));
}

/* The same letters on every screen. */
static void set_font(cairo_t *cairo) {
  cairo_font_options_t *options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  cairo_set_font_options(cairo, options);
  cairo_font_options_destroy(options);
}

/* The height of the paper, from a surface that is only there to measure. */
static double measure(view *v, const view_parts *parts, const void *picture) {
  cairo_surface_t *s = cairo_image_surface_create(CAIRO_FORMAT_A8, 1, 1);
  v->cairo = cairo_create(s);
  set_font(v->cairo);
  double height = lay_out(v, parts, picture);
  cairo_destroy(v->cairo);
  cairo_surface_destroy(s);
  return height;
}

static void border(const view *v) {
  picture_use(v->cairo, picture_faint);
  cairo_set_line_width(v->cairo, 1);
  cairo_rectangle(v->cairo, v->left - 0.5, v->top - 0.5, v->width + 1,
                  v->height + 1);
  cairo_stroke(v->cairo);
}

static int paint(const view *v, const view_parts *parts, const void *picture,
                 opc_error *error) {
  set_font(v->cairo);
  cairo_set_source_rgb(v->cairo, 1, 1, 1);
  cairo_paint(v->cairo);
  cairo_save(v->cairo);
  cairo_rectangle(v->cairo, v->left, v->top, v->width, v->height);
  cairo_clip(v->cairo);
  int code = parts->content(picture, error);
  cairo_restore(v->cairo);
  if (code) return code;
  border(v);
  parts->title(picture, view_margin(v), 1);
  parts->legend(picture, v->top + v->height, 1);
  return OPC_OK;
}

int view_write(view *v, const view_parts *parts, const void *picture,
               int format, const char *path, opc_error *error) {
  paper file;
  v->raster = format == PAPER_PNG;
  double height = measure(v, parts, picture);
  int code = paper_open(&file, v->host, format, path, v->paper, height, error);
  if (code) return code;
  v->cairo = file.cairo;
  return paper_close(&file, paint(v, parts, picture, error), error);
}
