/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the picture of a mask by classes: a map of all transistors, whose
   colours show the deviation or the size of the class. Each pixel shows the
   worst of the transistors that it covers. */
#include <eda/chip.h>
#include <eda/memory.h>
#include <eda/print.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "drawer.h"

/* ---- state ---- */

/* Values of the pixels. NAN: the pixel covers no transistor; INFINITY: a
   transistor of the pixel does not print. */
typedef struct raster {
  int width, height;
  double scale; /* pixels per grid step */
  double *value;
} raster;

/* ---- work: figures ---- */

/* Count the transistors of each mask. The caller frees the array. */
static uint32_t *count_classes(const eda_chip *c) {
  uint32_t *size = eda_alloc(c->masks, sizeof *size);
  for (size_t i = 0; i < c->count; i++) size[c->gate[i].mask]++;
  return size;
}

static double gate_figure(const drawer *d, const uint32_t *size, size_t i) {
  const eda_chip_gate *g = &d->mask->chip->gate[i];
  if (d->state == CLASSES) return log2(size[g->mask]);
  if (drawer_fails(d, g->print)) return INFINITY;
  return drawer_figure(d, g->print);
}

/* Return the value that a pixel shows: larger deviation or smaller class. */
static double worse_of(int show, double a, double b) {
  if (isnan(a)) return b;
  if (show == CLASSES) return fmin(a, b);
  return fabs(b) > fabs(a) ? b : a;
}

static int pixel_at(double at, int most) {
  return (int)fmin(fmax(floor(at), 0), most - 1);
}

static void raster_put(raster *r, int show, eda_box extent, eda_box b,
                       double v) {
  int x0 = pixel_at(((double)b.x0 - extent.x0) * r->scale, r->width);
  int x1 = pixel_at(((double)b.x1 - extent.x0) * r->scale, r->width);
  int y0 = pixel_at(((double)extent.y1 - b.y1) * r->scale, r->height);
  int y1 = pixel_at(((double)extent.y1 - b.y0) * r->scale, r->height);
  for (int y = y0; y <= y1; y++)
    for (int x = x0; x <= x1; x++) {
      double *to = &r->value[(size_t)y * (size_t)r->width + (size_t)x];
      *to = worse_of(show, *to, v);
    }
}

static void raster_fill(const drawer *d, raster *r) {
  const eda_chip *c = d->mask->chip;
  uint32_t *size = count_classes(c);
  for (int i = 0; i < r->width * r->height; i++) r->value[i] = NAN;
  for (size_t i = 0; i < c->count; i++)
    raster_put(r, d->state, c->extent, c->gate[i].box, gate_figure(d, size, i));
  free(size);
}

/* ---- work: colours ---- */

/* Return the deviation at the ends of the colour scale, a round number. */
static double find_range(const drawer *d, const raster *r) {
  double most = 0;
  if (d->asked > 0) return d->asked;
  for (int i = 0; i < r->width * r->height; i++)
    if (isfinite(r->value[i])) most = fmax(most, fabs(r->value[i]));
  if (d->state == CLASSES) return fmax(1, ceil(most));
  double unit = pow(10, floor(log10(fmax(most, 0.01))));
  return unit * fmax(1, ceil(most / unit - 1e-6));
}

static eda_colour colour_of(const drawer *d, double v, double range) {
  if (isinf(v)) return eda_ink;
  return d->state == CLASSES ? eda_sequential(v / range)
                             : eda_diverging((v / range + 1) / 2);
}

static int raster_paint(const drawer *d, const eda_paper *paper,
                        const raster *r, double left, double top, double range,
                        opc_error *error) {
  cairo_surface_t *s =
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, r->width, r->height);
  if (cairo_surface_status(s)) {
    cairo_surface_destroy(s);
    return opc_fail(error, OPC_FAILED, NULL,
                    "cannot create a picture of %d x %d pixels", r->width,
                    r->height);
  }
  uint32_t faint = eda_colour_packed(eda_faint);
  unsigned char *data = cairo_image_surface_get_data(s);
  size_t stride = (size_t)cairo_image_surface_get_stride(s);
  for (int y = 0; y < r->height; y++)
    for (int x = 0; x < r->width; x++) {
      double v = r->value[(size_t)y * (size_t)r->width + (size_t)x];
      uint32_t c = isnan(v) ? faint : eda_colour_packed(colour_of(d, v, range));
      memcpy(data + (size_t)y * stride + 4 * (size_t)x, &c, 4);
    }
  cairo_surface_mark_dirty(s);
  cairo_set_source_surface(paper->cairo, s, left, top);
  cairo_pattern_set_filter(cairo_get_source(paper->cairo),
                           CAIRO_FILTER_NEAREST);
  cairo_paint(paper->cairo);
  eda_use(paper->cairo, eda_ink);
  cairo_surface_destroy(s);
  return OPC_OK;
}

/* ---- work: the picture ---- */

static double draw_head(const drawer *d, const eda_paper *paper, double range) {
  static const char *const titles[] = {
      "Ion deviation as drawn", "Ion deviation after correction",
      "|Ion deviation|, after minus before: below 0 is better",
      "Number of transistors with the same mask"};
  char low[32], high[32];
  int classes = d->state == CLASSES;
  (void)snprintf(low, sizeof low, classes ? "1" : "%g %%", -range);
  (void)snprintf(high, sizeof high, classes ? "%.0f" : "%g %%",
                 classes ? exp2(range) : range);
  const eda_sign ramp = {.kind = EDA_SIGN_RAMP,
                         .ramp = classes ? eda_sequential : eda_diverging,
                         .low = low,
                         .high = high};
  const eda_sign black = {.kind = EDA_SIGN_FILL, .colour = eda_ink};
  double top = paper->margin;
  top += eda_heading(paper, top, titles[d->state]);
  eda_legend l;
  eda_legend_init(&l, paper, top);
  eda_legend_add(&l, &ramp, "%s", classes ? "transistors" : "");
  if (!classes) eda_legend_add(&l, &black, "does not print");
  const eda_chip *c = d->mask->chip;
  eda_box e = c->extent;
  eda_legend_add(&l, NULL, "%zu transistors in %zu classes, %.4g x %.4g um",
                 c->count, c->prints, ((double)e.x1 - e.x0) * c->grid / 1000,
                 ((double)e.y1 - e.y0) * c->grid / 1000);
  return ceil(top + l.height + paper->margin / 2);
}

static int map_write(const drawer *d, raster *r, const char *path,
                     opc_error *error) {
  double font = fmax(9, (double)d->view.asked.width / 70), margin = font;
  double range = find_range(d, r);
  eda_paper *paper =
      eda_paper_open(path, (double)d->view.asked.width, 0, font, error);
  if (!paper) return error->code;
  paper->margin = margin;
  double top = draw_head(d, paper, range);
  eda_paper_cut(paper, top + r->height + margin);
  draw_head(d, paper, range);
  int code = raster_paint(d, paper, r, floor(margin), top, range, error);
  return eda_paper_close(paper, code, error);
}

int drawer_map(const drawer *d, opc_error *error) {
  double font = fmax(9, (double)d->view.asked.width / 70);
  eda_box e = d->mask->chip->extent;
  double wide = (double)e.x1 - e.x0, high = (double)e.y1 - e.y0;
  const char *path = d->host->output_path(d->host, d->view.asked.file, error);
  if (!path) return error->code;
  raster r = {.width = (int)((double)d->view.asked.width - 2 * ceil(font))};
  /* The scale of a tall layout is limited: the picture is at most square. */
  r.scale = r.width / fmax(fmax(wide, high), 1);
  r.height = (int)fmax(1, ceil(high * r.scale));
  r.width = (int)fmax(1, ceil(wide * r.scale));
  r.value = eda_alloc((size_t)r.width * (size_t)r.height, sizeof *r.value);
  raster_fill(d, &r);
  int code = map_write(d, &r, path, error);
  free(r.value);
  return code;
}
