/* SPDX-License-Identifier: BSD-3-Clause */
/* Draws shapes and printed contours within a window of a layout. */
#include <math.h>
#include <stdlib.h>

#include "view.h"

/* Contours are exact where they cross the lines of their sampling grid. A chord
   between two crossings has an error of step^2 / (8 r) for an arc of radius r.
   The step is chosen for an error of a tenth of a pixel, with at most MAX_NODES
   grid nodes. */
enum { MAX_NODES = 4000000 };
static const double least_radius = 40; /* radius of a printed corner, nm */
static const double max_step = 20;     /* nm; finer than any line */

/* ---- places ---- */

double view_x(const view *v, double x) {
  return v->left + (x - v->x0) * v->scale;
}

double view_y(const view *v, double y) {
  return v->top + (v->y1 - y) * v->scale;
}

int view_contains(const view *v, double x, double y) {
  return x >= v->x0 && x <= v->x1 && y >= v->y0 && y <= v->y1;
}

eda_frame view_part(const view *v, eda_frame f, double around) {
  double x0 = fmax(v->x0 - around, f.x0), y0 = fmax(v->y0 - around, f.y0);
  return (eda_frame){x0, y0, fmin(v->x1 + around, f.x0 + f.width) - x0,
                     fmin(v->y1 + around, f.y0 + f.height) - y0};
}

double view_outline_width(const view *v) {
  double line = fmin(0.075 * v->paper->font, 5 * v->scale);
  return v->paper->pixels && line >= 0.5 ? round(line) : fmax(line, 0.25);
}

double view_contour_width(const view *v) {
  return fmax(fmin(fmax(0.11 * v->paper->font, 1.5), 5 * v->scale), 0.25);
}

/* Align a line with the pixel grid. */
static double place_sharp(const view *v, double place, double line) {
  if (!v->paper->pixels || line != round(line)) return place;
  double half = fmod(line, 2) / 2;
  return floor(place + 0.5 - half) + half;
}

/* ---- shapes ---- */

static int32_t clamp_to_int(double x) {
  return (int32_t)fmax(-(1 << 30), fmin(1 << 30, x));
}

eda_box view_clip(const view *v) {
  double grid = v->grid;
  double x = (v->x1 - v->x0) / 8, y = (v->y1 - v->y0) / 8;
  return (eda_box){clamp_to_int(floor((v->x0 - x) / grid) - 1),
                   clamp_to_int(floor((v->y0 - y) / grid) - 1),
                   clamp_to_int(ceil((v->x1 + x) / grid) + 1),
                   clamp_to_int(ceil((v->y1 + y) / grid) + 1)};
}

/* Clip shapes to the visible part. *out is a copy, or `shapes` itself. */
static int shapes_cut(const view *v, const eda_shapes *shapes, eda_shapes *out,
                      opc_error *error) {
  eda_box b = view_clip(v);
  eda_box all = eda_bounds(shapes->points,
                           shapes->count ? shapes->start[shapes->count] : 0);
  *out = *shapes;
  if (all.x0 >= b.x0 && all.y0 >= b.y0 && all.x1 <= b.x1 && all.y1 <= b.y1)
    return OPC_OK;
  eda_point points[] = {{b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
  uint32_t start[] = {0, 4};
  eda_shapes window = {.count = 1, .start = start, .points = points};
  return eda_boolean(EDA_AND, shapes, &window, out, error);
}

static void polygon_path(const view *v, const eda_shapes *s, size_t i,
                         double line) {
  cairo_new_sub_path(v->paper->cairo);
  for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++)
    cairo_line_to(v->paper->cairo,
                  place_sharp(v, view_x(v, s->points[k].x * v->grid), line),
                  place_sharp(v, view_y(v, s->points[k].y * v->grid), line));
  cairo_close_path(v->paper->cairo);
}

int view_fill(const view *v, const eda_shapes *shapes, eda_colour colour,
              opc_error *error) {
  eda_shapes s;
  int code = shapes_cut(v, shapes, &s, error);
  if (code) return code;
  for (size_t i = 0; i < s.count; i++) polygon_path(v, &s, i, 0);
  eda_use(v->paper->cairo, colour);
  cairo_set_fill_rule(v->paper->cairo, CAIRO_FILL_RULE_EVEN_ODD);
  cairo_fill(v->paper->cairo);
  if (s.points != shapes->points) eda_shapes_clear(&s);
  return OPC_OK;
}

int view_outline(const view *v, const eda_shapes *shapes, eda_colour colour,
                 opc_error *error) {
  double line = view_outline_width(v);
  eda_shapes s;
  int code = shapes_cut(v, shapes, &s, error);
  if (code) return code;
  eda_use(v->paper->cairo, colour);
  cairo_set_line_width(v->paper->cairo, line);
  cairo_set_line_join(v->paper->cairo, CAIRO_LINE_JOIN_MITER);
  for (size_t i = 0; i < s.count; i++) {
    polygon_path(v, &s, i, line);
    cairo_stroke(
        v->paper
            ->cairo); /* one at a time, because cairo is slow for long paths */
  }
  if (s.points != shapes->points) eda_shapes_clear(&s);
  return OPC_OK;
}

/* ---- contours ---- */

int view_find_contours(const view *v, const eda_field *print,
                       view_contours *out, opc_error *error) {
  *out = (view_contours){0};
  if (!print->coefficients) return OPC_OK;
  double around = 4 / v->scale; /* hides the lines along the border */
  eda_frame w = view_part(v, print->frame, around);
  if (!(w.width > 0 && w.height > 0)) return OPC_OK;
  double step = fmin(sqrt(0.8 * least_radius / v->scale), max_step);
  step = fmax(step, sqrt(w.width * w.height / MAX_NODES));
  return eda_contours(v->context, print, w, step, &out->points, &out->start,
                      &out->count, error);
}

/* Smallest distance of contour points, in pixels. */
static const double too_near = 0.4;

static void draw_contour(const view *v, const double *points, size_t n) {
  double x = 0, y = 0;
  for (size_t i = 0; i < n; i++) {
    double to_x = view_x(v, points[2 * i]);
    double to_y = view_y(v, points[2 * i + 1]);
    if (i && fabs(to_x - x) + fabs(to_y - y) < too_near) continue;
    x = to_x;
    y = to_y;
    cairo_line_to(v->paper->cairo, x, y);
  }
  cairo_close_path(v->paper->cairo);
  cairo_stroke(v->paper->cairo);
}

void view_draw_contours(const view *v, const view_contours *contours,
                        eda_colour colour) {
  eda_use(v->paper->cairo, colour);
  cairo_set_line_width(v->paper->cairo, view_contour_width(v));
  cairo_set_line_join(v->paper->cairo, CAIRO_LINE_JOIN_ROUND);
  for (size_t i = 0; i < contours->count; i++) {
    uint32_t first = contours->start[i];
    draw_contour(v, contours->points + 2 * (size_t)first,
                 contours->start[i + 1] - first);
  }
}

void view_clear_contours(view_contours *contours) {
  free(contours->points);
  free(contours->start);
  *contours = (view_contours){0};
}
