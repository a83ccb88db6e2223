/* SPDX-License-Identifier: BSD-3-Clause */
/* Fragmentation of the edges of poly and active (thesis figures 2.4 and 3.2). A
   gate owns a span of the poly edge on each side, and of the active edge at
   each end. Spans on one edge are separated before fragments are made. */
#include <math.h>
#include <stdlib.h>

#include "segment/segment.h"

/* A span of an edge: the part that the gate covers, later extended to the part
   that the gate owns. */
typedef struct span {
  uint32_t point; /* first point of the edge */
  uint32_t gate;
  int32_t low, high;
  uint8_t role;
} span;

typedef struct cutter {
  segment *s;
  int layer;
  const edge **edges; /* edge that starts at each point */
  span *spans;        /* sorted by edge, then low */
  size_t count;
} cutter;

EDA_COMPARE_RISING(by_edge, span, point, low);

/* ---- owners of spans ---- */

/* Return the edge of `layer` that contains a side of gate i; recognise.c has
   verified that such an edge exists. */
static const edge *side_of(const segment *s, int layer, size_t i, int d,
                           int side) {
  const eda_box *b = &s->gates->box[i];
  return segment_edge(&s->index[layer], d, side, box_side(b, d, side),
                      box_side(b, !d, LOW), box_side(b, !d, HIGH));
}

static void add_sides(cutter *c) {
  const eda_gates *g = c->s->gates;
  for (size_t i = 0; i < g->count; i++) {
    int d = c->layer == EDA_POLY ? g->axis[i] : !g->axis[i];
    int role = c->layer == EDA_POLY ? EDA_L_LOW : EDA_W_LOW;
    for (int side = 0; side < 2; side++)
      c->spans[c->count++] =
          (span){side_of(c->s, c->layer, i, d, side)->point, (uint32_t)i,
                 box_side(&g->box[i], !d, LOW), box_side(&g->box[i], !d, HIGH),
                 (uint8_t)(role + side)};
  }
  qsort(c->spans, c->count, sizeof *c->spans, by_edge);
}

/* Return the first span of the edge that starts at `point` with a low end of at
   least `low`, or of a later edge. */
static size_t find_span(const span *spans, size_t count, uint32_t point,
                        int32_t low) {
  const span key = {.point = point, .low = low};
  size_t from = 0, to = count;
  while (from < to) {
    size_t middle = from + (to - from) / 2;
    if (by_edge(&spans[middle], &key) < 0)
      from = middle + 1;
    else
      to = middle;
  }
  return from;
}

static uint32_t next_point(const eda_shapes *shapes, const edge *e) {
  uint32_t next = e->point + 1;
  return next < shapes->start[e->polygon + 1] ? next
                                              : shapes->start[e->polygon];
}

/* Return whether edge e is where the window cuts the poly. */
static int is_cut(const segment *s, const edge *e) {
  return s->window && e->at == box_side(s->window, e->across, e->side);
}

/* Return the edge that closes the poly of gate i on a side along W, where both
   long sides end; NULL if the poly turns or continues. */
static const edge *closing_edge(const cutter *c, size_t i, int side) {
  const eda_gates *g = c->s->gates;
  int d = g->axis[i];
  const edge *low = side_of(c->s, EDA_POLY, i, d, LOW);
  const edge *high = side_of(c->s, EDA_POLY, i, d, HIGH);
  /* In counter-clockwise order, the left side of a vertical line precedes the
     lower end; the lower side of a horizontal line follows the left end. */
  int forward = (d == EDA_X) == (side == LOW);
  const edge *from = forward ? low : high, *to = forward ? high : low;
  const eda_shapes *drawn = &g->drawn[EDA_POLY];
  const edge *end = c->edges[next_point(drawn, from)];
  if (is_cut(c->s, end)) return NULL;
  return next_point(drawn, end) == to->point ? end : NULL;
}

/* Return whether another gate owns the poly beyond gate i on a side along W. */
static int shares_end(const cutter *c, size_t sides, size_t i, int side) {
  const edge *e = side_of(c->s, EDA_POLY, i, c->s->gates->axis[i], LOW);
  size_t k = find_span(c->spans, sides, e->point,
                       box_side(&c->s->gates->box[i], !e->across, LOW));
  if (side == LOW) return k > 0 && c->spans[k - 1].point == e->point;
  return k + 1 < sides && c->spans[k + 1].point == e->point;
}

/* Return a default length in grid units: `nm` for 65 nm gates, scaled by the
   length of gate i and rounded to whole nm. The result is at most half of the
   reach. */
static int32_t in_lengths(const segment *s, size_t i, double nm) {
  double all = round(s->gates->length[i] * nm / 65) / s->grid;
  int32_t most = s->reach / 2;
  return (int32_t)fmin(round(all), most);
}

static int32_t segment_overhang(const segment *s, size_t i) {
  return s->overhang != NOT_GIVEN ? s->overhang : in_lengths(s, i, 84);
}

static int32_t segment_line_end(const segment *s, size_t i) {
  return s->line_end != NOT_GIVEN ? s->line_end : in_lengths(s, i, 200);
}

/* Add the line ends, and set the extension of poly beyond each gate. The end of
   a poly line belongs only to the gate that is nearest to the end. */
static void add_ends(cutter *c) {
  const segment *s = c->s;
  size_t sides = c->count;
  for (size_t i = 0; i < s->gates->count; i++)
    for (int side = 0; side < 2; side++) {
      s->gates->extension[2 * i + side] = INFINITY;
      const edge *e = closing_edge(c, i, side);
      if (!e || shares_end(c, sides, i, side)) continue;
      int64_t from = box_side(&s->gates->box[i], !s->gates->axis[i], side);
      int64_t reach = side ? e->at - from : from - e->at;
      if (reach > segment_line_end(s, i)) continue;
      s->gates->extension[2 * i + side] = s->grid * (double)reach;
      c->spans[c->count++] = (span){e->point, (uint32_t)i, e->low, e->high,
                                    (uint8_t)(EDA_END_LOW + side)};
    }
  qsort(c->spans, c->count, sizeof *c->spans, by_edge);
}

/* ---- extension of spans along an edge ---- */

static int32_t reach_of(const cutter *c, const span *a) {
  return c->layer == EDA_ACTIVE ? c->s->reach : segment_overhang(c->s, a->gate);
}

/* Return the length by which a span is extended past its gate towards an end of
   the edge; `distance` is the distance from the gate to this end. On poly, the
   span extends to the end if the distance is at most that of a line end. */
static int32_t span_extension(const cutter *c, const span *a,
                              int64_t distance) {
  int32_t reach = reach_of(c, a);
  if (distance <= reach ||
      (c->layer == EDA_POLY && distance <= segment_line_end(c->s, a->gate)))
    return (int32_t)distance;
  return reach;
}

/* Extend two adjacent spans of an edge towards each other by their reaches. If
   the gap between the spans is smaller than both reaches together, divide the
   gap in proportion to the reaches. */
static void spans_divide(const cutter *c, span *a, span *b) {
  int64_t gap = (int64_t)b->low - a->high, of_a = reach_of(c, a),
          of_b = reach_of(c, b);
  if (gap < of_a + of_b) {
    a->high += (int32_t)(gap * of_a / (of_a + of_b));
    b->low = a->high;
  } else {
    a->high += (int32_t)of_a;
    b->low -= (int32_t)of_b;
  }
}

static void part_edge(const cutter *c, const edge *e, span *spans, size_t n) {
  if (spans->role >= EDA_END_LOW) return;
  spans[0].low -= span_extension(c, &spans[0], (int64_t)spans[0].low - e->low);
  for (size_t k = 0; k + 1 < n; k++) spans_divide(c, &spans[k], &spans[k + 1]);
  spans[n - 1].high +=
      span_extension(c, &spans[n - 1], (int64_t)e->high - spans[n - 1].high);
}

/* ---- fragments ---- */

static void fragment_put(eda_edges *out, uint32_t *n, const edge *e, int32_t at,
                         const span *owner) {
  eda_fragment *f = &out->fragments[(*n)++];
  f->from =
      e->across == EDA_X ? (eda_point){e->at, at} : (eda_point){at, e->at};
  f->gate = owner ? (int32_t)owner->gate : -1;
  f->role = owner ? owner->role : EDA_FIXED;
}

/* Add the fragments of one edge in the direction of the edge. */
static void put_edge(eda_edges *out, uint32_t *n, const edge *e,
                     const span *spans, size_t count) {
  /* Edges run downwards on the low side of x and upwards on its high side; the
     directions are reversed for the sides of y. */
  int rising = (e->across == EDA_X) == (e->side == HIGH);
  int32_t at = rising ? e->low : e->high;
  for (size_t k = 0; k < count; k++) {
    const span *o = &spans[rising ? k : count - 1 - k];
    int32_t from = rising ? o->low : o->high;
    if (from != at) fragment_put(out, n, e, at, NULL);
    fragment_put(out, n, e, from, o);
    at = rising ? o->high : o->low;
  }
  if (at != (rising ? e->high : e->low)) fragment_put(out, n, e, at, NULL);
}

static void put_all(const cutter *c) {
  const eda_shapes *drawn = &c->s->gates->drawn[c->layer];
  eda_edges *out = &c->s->gates->edges[c->layer];
  size_t points = c->s->index[c->layer].count;
  out->start = eda_alloc(drawn->count + 1, sizeof *out->start);
  out->fragments = eda_alloc(points + 2 * c->count, sizeof *out->fragments);
  out->polygons = drawn->count;
  uint32_t n = 0;
  size_t k = 0;
  for (size_t p = 0; p < drawn->count; p++) {
    for (uint32_t i = drawn->start[p]; i < drawn->start[p + 1]; i++) {
      size_t first = k;
      while (k < c->count && c->spans[k].point == i) k++;
      if (k > first) part_edge(c, c->edges[i], &c->spans[first], k - first);
      put_edge(out, &n, c->edges[i], &c->spans[first], k - first);
    }
    out->start[p + 1] = n;
  }
}

static void cut_layer(segment *s, int layer) {
  const edge_index *x = &s->index[layer];
  cutter c = {.s = s,
              .layer = layer,
              .edges = eda_alloc(x->count, sizeof(const edge *)),
              .spans = eda_alloc(s->gates->count, 4 * sizeof *c.spans)};
  for (size_t i = 0; i < x->count; i++)
    c.edges[x->edges[i].point] = &x->edges[i];
  add_sides(&c);
  if (layer == EDA_POLY) add_ends(&c);
  put_all(&c);
  free(c.edges);
  free(c.spans);
}

void segment_cut(segment *s) {
  cut_layer(s, EDA_POLY);
  cut_layer(s, EDA_ACTIVE);
}
