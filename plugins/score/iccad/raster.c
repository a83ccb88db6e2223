/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements targets and printed images as pixels, and the target's sites. */
#include "iccad.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the target ---- */

/* Return the first pixel whose centre is at or to the right of x, nm. */
static int32_t first_pixel(double x) { return (int32_t)ceil(x - 0.5); }

int iccad_fill(const eda_shapes *shapes, double grid, const iccad_tile *t,
               uint8_t *pixels, opc_error *error) {
  eda_box *boxes = NULL;
  size_t n = 0;
  int code = eda_fracture(shapes, &boxes, &n, error);
  if (code) return code;
  for (size_t i = 0; i < n; i++) {
    int32_t x0 = first_pixel(boxes[i].x0 * grid) - t->x0;
    int32_t x1 = first_pixel(boxes[i].x1 * grid) - t->x0;
    int32_t y0 = first_pixel(boxes[i].y0 * grid) - t->y0;
    int32_t y1 = first_pixel(boxes[i].y1 * grid) - t->y0;
    for (int32_t y = y0; y < y1; y++)
      memset(pixels + (size_t)y * (size_t)t->side + x0, 1, (size_t)(x1 - x0));
  }
  free(boxes);
  return OPC_OK;
}

/* ---- prints ---- */

static int print_image(const iccad_print *p, const eda_spectrum *mask,
                       double defocus, eda_field *out, opc_error *error) {
  const eda_litho *model = p->litho->functions;
  if (defocus == 0)
    return model->image(p->litho->self, EDA_POLY, mask, out, error);
  if (model->image_at)
    return model->image_at(p->litho->self, EDA_POLY, mask, defocus, out, error);
  return opc_fail(error, OPC_INVALID, "defocus",
                  "'%s' has one focus only: set defocus: 0 nm", p->litho->id);
}

/* Set the pixels by the sign of the level set at their centres. */
static int print_threshold(const iccad_print *p, eda_field *f, uint8_t *pixels,
                           opc_error *error) {
  double step = f->frame.width / p->tile->side;
  int code = eda_field_resample(p->context, f, step, error);
  if (code) return code;
  eda_field_samples(p->context, f);
  if (f->nx != p->tile->side || f->ny != p->tile->side)
    return opc_fail(error, OPC_INVALID, "tile",
                    "%d nm is not a size of a Fourier transform; use %d nm",
                    (int)p->tile->side, (int)f->nx);
  size_t n = (size_t)f->nx * (size_t)f->ny;
  for (size_t i = 0; i < n; i++) pixels[i] = f->coefficients[i] > 0;
  return OPC_OK;
}

int iccad_expose(const iccad_print *p, const eda_spectrum *mask, double dose,
                 double defocus, uint8_t *pixels, opc_error *error) {
  const eda_resist *resist = p->resist->functions;
  eda_field f = {0};
  int code = print_image(p, mask, defocus, &f, error);
  if (code) return code;
  size_t n = (size_t)f.nx * (size_t)f.ny;
  for (size_t i = 0; i < n; i++) f.coefficients[i] *= (float)dose;
  code = resist->print(p->resist->self, EDA_POLY, &f, error);
  if (!code) code = print_threshold(p, &f, pixels, error);
  eda_field_clear(&f);
  return code;
}

/* ---- sites ---- */

typedef struct collector {
  int32_t spacing;
  iccad_site *sites;
  size_t count, capacity;
} collector;

static void site_add(collector *c, iccad_site s) {
  eda_grow(&c->sites, &c->capacity, c->count + 1, sizeof s);
  c->sites[c->count++] = s;
}

/* Add the sites of the pixels from `first` to `last` along an edge: the centre
   of a short edge; otherwise sites from both ends towards the centre. `s` is
   the pixel `first`. */
static void sites_add_edge(collector *c, iccad_site s, int32_t first,
                           int32_t last) {
  int32_t middle = first + (last - first) / 2, *at = s.dx ? &s.y : &s.x;
  if (last - first <= 2 * c->spacing) {
    *at = middle;
    site_add(c, s);
    return;
  }
  for (*at = first + c->spacing; *at <= middle; *at += c->spacing)
    site_add(c, s);
  for (*at = last - c->spacing; *at > middle; *at -= c->spacing) site_add(c, s);
}

size_t iccad_sites(const eda_shapes *target, double grid, int32_t spacing,
                   iccad_site **sites) {
  collector c = {.spacing = spacing};
  for (size_t p = 0; p < target->count; p++)
    for (uint32_t i = target->start[p]; i < target->start[p + 1]; i++) {
      uint32_t next = i + 1 < target->start[p + 1] ? i + 1 : target->start[p];
      eda_point a = target->points[i], b = target->points[next];
      int upright = a.x == b.x, rises = upright ? b.y > a.y : b.x > a.x;
      /* The interior is to the left of the edge. The coordinates of a pixel are
         those of its lower left corner. */
      int out = upright == rises ? 1 : -1;
      int32_t line = first_pixel((upright ? a.x : a.y) * grid) - (out > 0);
      int32_t from = first_pixel((upright ? a.y : a.x) * grid);
      int32_t to = first_pixel((upright ? b.y : b.x) * grid);
      iccad_site s = {.x = line, .y = line};
      *(upright ? &s.dx : &s.dy) = (int8_t)out;
      sites_add_edge(&c, s, from < to ? from : to, (from < to ? to : from) - 1);
    }
  *sites = c.sites;
  return c.count;
}
