/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the distance between the contours of two models. For each point of
   one contour, the nearest point of the other contour is found. An iteration
   from this point finds the foot of the perpendicular on the exact level set.
   Distances are measured from each contour to the other, so that features that
   only one model prints are included. */
#include <eda/index.h>
#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>

#include "image.h"

enum { MAX_NODES = 4000000 };
static const double finest = 2;   /* smallest distance of contour points, nm */
static const double beyond = 200; /* margin around the window for nearest
                                     points, nm */
static const double near = 10;    /* first search radius, nm */

/* ---- the points of a contour ---- */

/* Points of all contours of a model. `place` has x and y of each point, nm;
   `weight` the length of the contour that the point represents, nm, 0 outside
   of the window. The boxes of the index are in nm. */
typedef struct line {
  const eda_field *print;
  size_t n;
  double *place, *weight;
  eda_frame frame;
  eda_index *index;
} line;

static void line_clear(line *l) {
  free(l->place);
  free(l->weight);
  eda_index_free(l->index);
}

/* Return 1 for a point on the frame's border, along which contours are
   closed. */
static int on_border(eda_frame f, const double *p) {
  const double slack = 1e-6;
  return p[0] - f.x0 < slack || f.x0 + f.width - p[0] < slack ||
         p[1] - f.y0 < slack || f.y0 + f.height - p[1] < slack;
}

static double points_distance(const double *a, const double *b) {
  return hypot(a[0] - b[0], a[1] - b[1]);
}

/* Append a closed line of n points. */
static void line_add(const view *v, line *l, const double *p, size_t n) {
  for (size_t i = 0; i < n; i++) {
    const double *at = p + 2 * i;
    const double *last = p + 2 * ((i + n - 1) % n);
    const double *next = p + 2 * ((i + 1) % n);
    if (on_border(l->frame, at)) continue;
    double length = 0;
    if (!on_border(l->frame, last)) length += points_distance(at, last) / 2;
    if (!on_border(l->frame, next)) length += points_distance(at, next) / 2;
    l->place[2 * l->n] = at[0];
    l->place[2 * l->n + 1] = at[1];
    l->weight[l->n++] = view_contains(v, at[0], at[1]) ? length : 0;
  }
}

/* Return the box of all points within `reach` of p. */
static eda_box box_around(const double *p, double reach) {
  const double most = 1 << 30;
  return (eda_box){(int32_t)fmax(floor(p[0] - reach), -most),
                   (int32_t)fmax(floor(p[1] - reach), -most),
                   (int32_t)fmin(ceil(p[0] + reach), most),
                   (int32_t)fmin(ceil(p[1] + reach), most)};
}

static void make_index(line *l) {
  eda_box *boxes = eda_alloc(l->n, sizeof *boxes);
  for (size_t i = 0; i < l->n; i++) boxes[i] = box_around(l->place + 2 * i, 0);
  l->index = eda_index_new(boxes, l->n, (int32_t)(2 * near));
  free(boxes);
}

static int make_line(const view *v, const eda_field *print, line *l,
                     opc_error *error) {
  double *points;
  uint32_t *start;
  size_t count;
  *l = (line){.print = print, .frame = view_part(v, print->frame, beyond)};
  if (!(l->frame.width > 0 && l->frame.height > 0)) return OPC_OK;
  double step =
      fmax(finest, sqrt(l->frame.width * l->frame.height / MAX_NODES));
  int code = eda_contours(v->context, print, l->frame, step, &points, &start,
                          &count, error);
  if (code) return code;
  size_t n = count ? start[count] : 0;
  l->place = eda_alloc(2 * n, sizeof *l->place);
  l->weight = eda_alloc(n, sizeof *l->weight);
  for (size_t i = 0; i < count; i++)
    line_add(v, l, points + 2 * (size_t)start[i], start[i + 1] - start[i]);
  free(points);
  free(start);
  make_index(l);
  return OPC_OK;
}

/* ---- the nearest place ---- */

/* Return the distance to the nearest point, and the index of that point in
 *best. The line must have points. */
static double nearest_point(const line *l, const double *p, uint32_t *best) {
  double least = INFINITY;
  for (double reach = near; least > reach; reach *= 2) {
    eda_finder found = eda_index_find(l->index, box_around(p, reach));
    for (uint32_t i; eda_index_next(&found, &i);) {
      double d = points_distance(l->place + 2 * (size_t)i, p);
      if (d < least) least = d, *best = i;
    }
  }
  return least;
}

/* Return the distance of p from the level set, measured along a perpendicular
   to the level set. The foot of the perpendicular is found from the start point
   `from` by steps along the gradient and along the level set. */
static double foot_distance(const line *l, const double *p,
                            const double *from) {
  double x = from[0], y = from[1];
  for (int i = 0; i < 30; i++) {
    double value, gx, gy;
    eda_field_gradient(l->print, &x, &y, 1, &value, &gx, &gy);
    double square = gx * gx + gy * gy;
    if (!(square > 0)) break;
    double along = ((p[0] - x) * gx + (p[1] - y) * gy + value) / square;
    double dx = p[0] - x - along * gx, dy = p[1] - y - along * gy;
    x += dx;
    y += dy;
    if (fabs(dx) + fabs(dy) < 1e-6) break;
  }
  const double at[] = {x, y};
  return points_distance(p, at);
}

/* ---- from one line to another ---- */

typedef struct approach {
  const line *from, *to;
  double *distance; /* distances of the points of `from`; positive outside of
                       `to` */
} approach;

static void approach_point(void *data, size_t i) {
  const approach *w = data;
  if (w->from->weight[i] == 0) return;
  const double *p = w->from->place + 2 * i;
  uint32_t best = 0;
  double d = nearest_point(w->to, p, &best), value;
  /* For points beyond the centre of curvature, the iteration may find another
     foot; the shorter distance is used. */
  if (d > 0)
    d = fmin(d, foot_distance(w->to, p, w->to->place + 2 * (size_t)best));
  eda_field_sample(w->to->print, p, p + 1, 1, &value);
  w->distance[i] = value > 0 ? -d : d;
}

typedef struct sums {
  double length, first, second; /* sums of weight, weight * distance, weight *
                                   distance^2 */
} sums;

/* Add the distances of the points of `from` from the line `to`; `sign` is the
   sign for points of `from` outside of `to`. */
static void sums_add(const opc_context *context, const line *from,
                     const line *to, double sign, sums *s,
                     image_distance *out) {
  approach w = {from, to, eda_alloc(from->n, sizeof *w.distance)};
  opc_parallel(context, from->n, approach_point, &w);
  for (size_t i = 0; i < from->n; i++) {
    double d = sign * w.distance[i], weight = from->weight[i];
    s->length += weight;
    s->first += weight * d;
    s->second += weight * d * d;
    if (weight == 0 || fabs(d) <= out->max) continue;
    out->max = fabs(d);
    out->x = from->place[2 * i];
    out->y = from->place[2 * i + 1];
  }
  free(w.distance);
}

static image_distance lines_compare(const opc_context *context,
                                    const line *first, const line *other) {
  sums s = {0};
  image_distance d = {0, 0, 0, NAN, NAN};
  static const image_distance none = {NAN, NAN, NAN, NAN, NAN};
  if (!first->n || !other->n) return none;
  sums_add(context, other, first, 1, &s, &d);
  sums_add(context, first, other, -1, &s, &d);
  if (!(s.length > 0)) return none;
  d.mean = s.first / s.length;
  d.rms = sqrt(s.second / s.length);
  return d;
}

/* Find the range of intensities along a line. */
static void find_levels(image_model *m, const line *l) {
  m->low = m->high = NAN;
  for (size_t i = 0; i < l->n; i++) {
    const double *p = l->place + 2 * i;
    double value;
    if (l->weight[i] == 0) continue;
    eda_field_sample(&m->image, p, p + 1, 1, &value);
    m->low = fmin(m->low, value); /* value if `low` is NAN */
    m->high = fmax(m->high, value);
  }
}

int image_measure_contours(image_run *r, opc_error *error) {
  line first;
  int code = make_line(&r->view, &r->model[0].print, &first, error);
  for (size_t k = 0; k < r->n && !code; k++) {
    line other;
    image_model *m = &r->model[k];
    code = make_line(&r->view, &m->print, &other, error);
    if (code) break;
    find_levels(m, &other);
    m->distance = lines_compare(r->host->context, &first, &other);
    line_clear(&other);
  }
  line_clear(&first);
  return code;
}
