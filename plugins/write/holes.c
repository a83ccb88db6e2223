/* SPDX-License-Identifier: BSD-3-Clause */
/* Layout files know no holes: each hole is given to its outline, and outlines
   with holes are cut into rectangles. */
#include <string.h>

#include "polygons.h"

typedef struct sorting {
  const opc_host *host;
  const opc_shapes *shapes;
  opc_box *box;    /* of each polygon */
  uint32_t *owner; /* of each hole */
  uint32_t *first; /* of each outline: its holes in `holes` */
  uint32_t *holes;
} sorting;

static opc_box bounds(const opc_shapes *s, size_t i) {
  opc_box b = {INT32_MAX, INT32_MAX, INT32_MIN, INT32_MIN};
  for (uint32_t k = s->start[i]; k < s->start[i + 1]; k++) {
    opc_point p = s->points[k];
    if (p.x < b.x0) b.x0 = p.x;
    if (p.x > b.x1) b.x1 = p.x;
    if (p.y < b.y0) b.y0 = p.y;
    if (p.y > b.y1) b.y1 = p.y;
  }
  return b;
}

/* The lowest, then leftmost point: the unit square up and right of it lies in
   the polygon, also in a hole. */
static opc_point lowest(const opc_shapes *s, size_t i) {
  opc_point low = s->points[s->start[i]];
  for (uint32_t k = s->start[i] + 1; k < s->start[i + 1]; k++) {
    opc_point p = s->points[k];
    if (p.y < low.y || (p.y == low.y && p.x < low.x)) low = p;
  }
  return low;
}

/* Whether the middle of the unit square at p lies in outline i: edges left of
   it are counted. Vertical ones are all there are to count. */
static int inside(const opc_shapes *s, size_t i, opc_point p) {
  int in = 0;
  uint32_t start = s->start[i], end = s->start[i + 1];
  opc_point a = s->points[end - 1];
  for (uint32_t k = start; k < end; k++) {
    opc_point b = s->points[k];
    if ((a.y <= p.y) != (b.y <= p.y) && a.x <= p.x) in = !in;
    a = b;
  }
  return in;
}

static double area(opc_box b) {
  return ((double)b.x1 - b.x0) * ((double)b.y1 - b.y0);
}

/* The outline of hole h: the smallest one around it. -1 if there is none. */
static int64_t outline_of(const sorting *o, size_t h) {
  const opc_shapes *s = o->shapes;
  opc_point p = lowest(s, h);
  int64_t best = -1;
  for (size_t i = 0; i < s->count; i++) {
    opc_box b = o->box[i], c = o->box[h];
    if (s->hole[i] || b.x0 > c.x0 || b.y0 > c.y0 || b.x1 < c.x1 ||
        b.y1 < c.y1 || (best >= 0 && area(b) >= area(o->box[best])))
      continue;
    if (inside(s, i, p)) best = (int64_t)i;
  }
  return best;
}

/* first[i] .. first[i + 1] - 1 are the places of the holes of outline i. */
static int sort_holes(sorting *o, opc_error *error) {
  const opc_shapes *s = o->shapes;
  uint32_t total = 0;
  for (size_t i = 0; i < s->count; i++) o->box[i] = bounds(s, i);
  for (size_t h = 0; h < s->count; h++) {
    if (!s->hole[h]) continue;
    int64_t owner = outline_of(o, h);
    if (owner < 0)
      return o->host->fail(o->host, error, OPC_FAILED, NULL,
                           "a hole at (%d, %d) lies in no polygon",
                           o->box[h].x0, o->box[h].y0);
    o->owner[h] = (uint32_t)owner;
    o->first[owner + 1]++;
    total++;
  }
  for (size_t i = 0; i < s->count; i++) o->first[i + 1] += o->first[i];
  for (size_t h = s->count; h-- > 0;)
    if (s->hole[h]) o->holes[--o->first[o->owner[h] + 1]] = (uint32_t)h;
  /* first[i + 1] has come down to where the holes of outline i begin. */
  for (size_t i = 0; i < s->count; i++) o->first[i] = o->first[i + 1];
  o->first[s->count] = total;
  return OPC_OK;
}

/* An outline with its holes as shapes of their own. */
static int gather(const sorting *o, size_t i, uint32_t n_holes,
                  opc_shapes *out) {
  const opc_shapes *s = o->shapes;
  const opc_host *host = o->host;
  size_t points = s->start[i + 1] - s->start[i];
  for (uint32_t k = 0; k < n_holes; k++) {
    uint32_t h = o->holes[o->first[i] + k];
    points += s->start[h + 1] - s->start[h];
  }
  out->start = host->alloc(host, n_holes + 2, sizeof *out->start);
  out->points = host->alloc(host, points, sizeof *out->points);
  out->hole = host->alloc(host, n_holes + 1, 1);
  if (!out->start || !out->points || !out->hole) return 0;
  for (uint32_t k = 0; k <= n_holes; k++) {
    size_t from = k ? o->holes[o->first[i] + k - 1] : i;
    uint32_t n = s->start[from + 1] - s->start[from];
    memcpy(out->points + out->start[k], s->points + s->start[from],
           n * sizeof *out->points);
    out->start[k + 1] = out->start[k] + n;
    out->hole[k] = k > 0;
  }
  out->count = n_holes + 1;
  return 1;
}

static int put_boxes(const sorting *o, size_t i, uint32_t n_holes,
                     const polygon_taker *take, opc_error *error) {
  const opc_host *host = o->host;
  opc_shapes one = {0};
  opc_box *boxes = NULL;
  size_t n = 0;
  int code;
  if (gather(o, i, n_holes, &one))
    code = host->geometry->fracture(host, &one, &boxes, &n, error);
  else
    code = host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  host->free(host, one.start);
  host->free(host, one.points);
  host->free(host, one.hole);
  for (size_t k = 0; k < n && !code; k++) {
    opc_box b = boxes[k];
    opc_point corners[4] = {
        {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    code = take->polygon(take->data, corners, 4, error);
  }
  host->free(host, boxes);
  return code;
}

static int put_all(sorting *o, const polygon_taker *take, opc_error *error) {
  const opc_shapes *s = o->shapes;
  if (sort_holes(o, error)) return error->code;
  for (size_t i = 0; i < s->count; i++) {
    if (s->hole[i]) continue;
    uint32_t n_holes = o->first[i + 1] - o->first[i];
    int code = n_holes
                   ? put_boxes(o, i, n_holes, take, error)
                   : polygon_cut(o->host, s->points + s->start[i],
                                 s->start[i + 1] - s->start[i], take, error);
    if (code) return code;
  }
  return OPC_OK;
}

int polygons_without_holes(const opc_host *host, const opc_shapes *shapes,
                           const polygon_taker *take, opc_error *error) {
  size_t n = shapes->count;
  if (!shapes->hole) {
    for (size_t i = 0; i < n; i++)
      if (polygon_cut(host, shapes->points + shapes->start[i],
                      shapes->start[i + 1] - shapes->start[i], take, error))
        return error->code;
    return OPC_OK;
  }
  sorting o = {.host = host, .shapes = shapes};
  o.box = host->alloc(host, n, sizeof *o.box);
  o.owner = host->alloc(host, n, sizeof *o.owner);
  o.first = host->alloc(host, n + 1, sizeof *o.first);
  o.holes = host->alloc(host, n, sizeof *o.holes);
  int code = o.box && o.owner && o.first && o.holes
                 ? put_all(&o, take, error)
                 : host->fail(host, error, OPC_FAILED, NULL, "out of memory");
  host->free(host, o.box);
  host->free(host, o.owner);
  host->free(host, o.first);
  host->free(host, o.holes);
  return code;
}
