/* SPDX-License-Identifier: BSD-3-Clause */
/* Removal of holes, because layout formats have only polygons without holes.
   Each hole is assigned to the enclosing outline. Outlines with holes are
   fractured into rectangles. */
#include <eda/formats.h>
#include <eda/memory.h>
#include <stdlib.h>
#include <string.h>

/* Linked lists of holes. A link is the number of the hole plus 1; 0 ends a
   list. */
typedef struct sorting {
  const eda_shapes *shapes;
  eda_box *box;    /* bounding box of each polygon */
  uint32_t *first; /* first hole of each outline; 0: none */
  uint32_t *next;  /* next hole of the same outline; 0: none */
} sorting;

/* Return the lowest, then leftmost point of a polygon or hole. The unit square
   to the upper right of this point is inside the polygon or hole. */
static eda_point lowest_point(const eda_shapes *s, size_t i) {
  eda_point low = s->points[s->start[i]];
  for (uint32_t k = s->start[i] + 1; k < s->start[i + 1]; k++) {
    eda_point p = s->points[k];
    if (p.y < low.y || (p.y == low.y && p.x < low.x)) low = p;
  }
  return low;
}

/* Return whether the unit square to the upper right of p is inside outline i.
   Counts the vertical edges to the left of the square. */
static int outline_contains(const eda_shapes *s, size_t i, eda_point p) {
  int in = 0;
  uint32_t start = s->start[i], end = s->start[i + 1];
  eda_point a = s->points[end - 1];
  for (uint32_t k = start; k < end; k++) {
    eda_point b = s->points[k];
    if ((a.y <= p.y) != (b.y <= p.y) && a.x <= p.x) in = !in;
    a = b;
  }
  return in;
}

static double area(eda_box b) {
  return ((double)b.x1 - b.x0) * ((double)b.y1 - b.y0);
}

/* Return the outline with the smallest bounding box that contains hole h; -1 if
   none. */
static int64_t outline_of(const sorting *o, size_t h) {
  const eda_shapes *s = o->shapes;
  eda_point p = lowest_point(s, h);
  int64_t best = -1;
  for (size_t i = 0; i < s->count; i++) {
    eda_box b = o->box[i], c = o->box[h];
    if (s->hole[i] || b.x0 > c.x0 || b.y0 > c.y0 || b.x1 < c.x1 ||
        b.y1 < c.y1 || (best >= 0 && area(b) >= area(o->box[best])))
      continue;
    if (outline_contains(s, i, p)) best = (int64_t)i;
  }
  return best;
}

static int sort_holes(sorting *o, opc_error *error) {
  const eda_shapes *s = o->shapes;
  for (size_t i = 0; i < s->count; i++) o->box[i] = eda_shape_box(s, i);
  for (size_t h = s->count; h-- > 0;) {
    if (!s->hole[h]) continue;
    int64_t owner = outline_of(o, h);
    if (owner < 0)
      return opc_fail(error, OPC_FAILED, NULL,
                      "a hole at (%d, %d) is not inside of a polygon",
                      o->box[h].x0, o->box[h].y0);
    o->next[h] = o->first[owner];
    o->first[owner] = (uint32_t)h + 1;
  }
  return OPC_OK;
}

/* Append polygon `from` of `s`, an outline or a hole. */
static void outline_add(eda_shapes *out, const eda_shapes *s, size_t from) {
  uint32_t n = s->start[from + 1] - s->start[from];
  uint32_t begin = out->start[out->count];
  memcpy(out->points + begin, s->points + s->start[from],
         n * sizeof *out->points);
  out->hole[out->count] = s->hole[from];
  out->start[++out->count] = begin + n;
}

/* Return a copy of outline i with its holes. */
static eda_shapes outline_gather(const sorting *o, size_t i) {
  const eda_shapes *s = o->shapes;
  size_t points = s->start[i + 1] - s->start[i], n = 1;
  for (uint32_t h = o->first[i]; h; h = o->next[h - 1], n++)
    points += s->start[h] - s->start[h - 1];
  eda_shapes out = {.start = eda_alloc(n + 1, sizeof *out.start),
                    .points = eda_alloc(points, sizeof *out.points),
                    .hole = eda_alloc(n, 1)};
  outline_add(&out, s, i);
  for (uint32_t h = o->first[i]; h; h = o->next[h - 1])
    outline_add(&out, s, h - 1);
  return out;
}

static int put_boxes(const sorting *o, size_t i, const eda_polygon_taker *take,
                     opc_error *error) {
  eda_shapes one = outline_gather(o, i);
  eda_box *boxes = NULL;
  size_t n = 0;
  int code = eda_fracture(&one, &boxes, &n, error);
  eda_shapes_clear(&one);
  for (size_t k = 0; k < n && !code; k++) {
    eda_box b = boxes[k];
    eda_point corners[4] = {
        {b.x0, b.y0}, {b.x1, b.y0}, {b.x1, b.y1}, {b.x0, b.y1}};
    code = take->polygon(take->data, corners, 4, error);
  }
  free(boxes);
  return code;
}

static int put_outline(const eda_shapes *s, size_t i,
                       const eda_polygon_taker *take, opc_error *error) {
  return eda_polygon_cut(s->points + s->start[i], s->start[i + 1] - s->start[i],
                         take, error);
}

static int put_all(sorting *o, const eda_polygon_taker *take,
                   opc_error *error) {
  const eda_shapes *s = o->shapes;
  if (sort_holes(o, error)) return error->code;
  for (size_t i = 0; i < s->count; i++) {
    if (s->hole[i]) continue;
    int code = o->first[i] ? put_boxes(o, i, take, error)
                           : put_outline(s, i, take, error);
    if (code) return code;
  }
  return OPC_OK;
}

int eda_polygons_without_holes(const eda_shapes *shapes,
                               const eda_polygon_taker *take,
                               opc_error *error) {
  size_t n = shapes->count;
  for (size_t i = 0; i < n && !shapes->hole; i++)
    if (put_outline(shapes, i, take, error)) return error->code;
  if (!shapes->hole) return OPC_OK;
  sorting o = {.shapes = shapes,
               .box = eda_alloc(n, sizeof *o.box),
               .first = eda_alloc(n, sizeof *o.first),
               .next = eda_alloc(n, sizeof *o.next)};
  int code = put_all(&o, take, error);
  free(o.box);
  free(o.first);
  free(o.next);
  return code;
}
