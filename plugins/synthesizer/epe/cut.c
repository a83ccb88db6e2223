/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the fragmentation of the edges of a layer (thesis 3.3.1): short
   fragments beside corners and opposite corners of other edges, and fragments
   of equal length elsewhere. */
#include "epe.h"

#include <eda/memory.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct cutter {
  epe_layer *layer;
  const eda_shapes *drawn;
  eda_index *corners; /* corners of all polygons */
  size_t capacity;    /* capacity of layer->fragments */
  int32_t *marks;     /* distances of the cuts from the start of an edge */
  size_t n_marks, marks_capacity;
  uint8_t *convex; /* [points], 1: convex corner */
} cutter;

/* A drawn edge from a to b. */
typedef struct drawn_edge {
  eda_point a, b;
  int32_t length;
  uint8_t axis;      /* axis of the normal */
  int8_t sign;       /* direction of the outside along the axis */
  uint8_t convex[2]; /* 1: the corner a or b is convex */
} drawn_edge;

static drawn_edge edge_of(const cutter *c, uint32_t i, uint32_t next) {
  drawn_edge e = {.a = c->drawn->points[i], .b = c->drawn->points[next]};
  int rises = e.a.x == e.b.x ? e.b.y > e.a.y : e.b.x > e.a.x;
  e.axis = e.a.x == e.b.x ? EDA_X : EDA_Y;
  /* The inside is on the left. */
  e.sign = (e.axis == EDA_X) == rises ? 1 : -1;
  e.length = e.axis == EDA_X ? abs(e.b.y - e.a.y) : abs(e.b.x - e.a.x);
  e.convex[0] = c->convex[i];
  e.convex[1] = c->convex[next];
  return e;
}

static eda_point point_at(const drawn_edge *e, int32_t t) {
  eda_point p = e->a;
  if (e->axis == EDA_X)
    p.y += e->b.y > e->a.y ? t : -t;
  else
    p.x += e->b.x > e->a.x ? t : -t;
  return p;
}

/* ---- marks ---- */

static void cut_at(cutter *c, int32_t t) {
  eda_grow(&c->marks, &c->marks_capacity, c->n_marks + 1, sizeof t);
  c->marks[c->n_marks++] = t;
}

/* Mark the projection of a corner of another edge onto the edge, and positions
   one ripple length before and after the projection. Only corners on the outer
   side of the edge count. */
static void cut_at_corner(cutter *c, const drawn_edge *e, eda_point p) {
  const epe_rules *r = c->layer->rules;
  int32_t off = e->axis == EDA_X ? p.x - e->a.x : p.y - e->a.y;
  int32_t along = e->axis == EDA_X ? p.y - e->a.y : p.x - e->a.x;
  int rises = e->axis == EDA_X ? e->b.y > e->a.y : e->b.x > e->a.x;
  if (!rises) along = -along;
  off *= e->sign;
  if (off <= 0 || off > r->ripple_reach || along <= 0 || along >= e->length)
    return;
  cut_at(c, along);
  cut_at(c, along - r->ripple);
  cut_at(c, along + r->ripple);
}

static void cut_ripples(cutter *c, const drawn_edge *e) {
  const epe_rules *r = c->layer->rules;
  if (r->ripple_reach <= 0) return;
  int32_t out = e->sign * r->ripple_reach;
  eda_point sight[] = {e->a, e->b}; /* corners of the searched region in front
                                       of the edge */
  *(e->axis == EDA_X ? &sight[1].x : &sight[1].y) += out;
  eda_finder f = eda_index_find(c->corners, eda_bounds(sight, 2));
  for (uint32_t k; eda_index_next(&f, &k);)
    cut_at_corner(c, e, c->drawn->points[k]);
}

/* Remove marks so that all fragments between `first` and `last` have at least
   the length min_edge. */
static void cut_thin_out(cutter *c, int32_t first, int32_t last) {
  int32_t least = c->layer->rules->min_edge, at = first;
  size_t n = 0;
  if (!c->n_marks) return;
  qsort(c->marks, c->n_marks, sizeof *c->marks, eda_int32s_rise);
  for (size_t k = 0; k < c->n_marks; k++) {
    int32_t t = c->marks[k];
    if (t - at < least || last - t < least) continue;
    c->marks[n++] = at = t;
  }
  c->n_marks = n;
}

/* Mark fragments of equal length between the positions `from` and `to`. */
static void cut_evenly(cutter *c, int32_t from, int32_t to) {
  const epe_rules *r = c->layer->rules;
  int32_t parts = (to - from + r->fragment / 2) / r->fragment;
  while (parts > 1 && (to - from) / parts < r->min_edge) parts--;
  for (int32_t i = 1; i < parts; i++)
    cut_at(c, from + (int32_t)((int64_t)(to - from) * i / parts));
}

/* Mark the cuts of an edge, except the two ends of the edge. */
static void cut_edge(cutter *c, const drawn_edge *e) {
  const epe_rules *r = c->layer->rules;
  c->n_marks = 0;
  if (e->length < 2 * r->min_edge) return;
  if (e->convex[0] && e->convex[1] && e->length <= r->line_end) return;
  int32_t first = e->convex[0] ? r->corner_edge : r->concave_corner;
  int32_t last =
      e->length - (e->convex[1] ? r->corner_edge : r->concave_corner);
  if (first + r->min_edge > last) {
    cut_at(c, e->length / 2);
    return;
  }
  cut_ripples(c, e);
  cut_thin_out(c, first, last);
  size_t n = c->n_marks;
  int32_t at = first;
  for (size_t k = 0; k < n; k++) {
    int32_t next = c->marks[k];
    cut_evenly(c, at, next);
    at = next;
  }
  cut_evenly(c, at, last);
  cut_at(c, first);
  cut_at(c, last);
  qsort(c->marks, c->n_marks, sizeof *c->marks, eda_int32s_rise);
}

/* ---- fragments ---- */

static void layer_add_edge(cutter *c, const drawn_edge *e, uint32_t polygon) {
  epe_layer *l = c->layer;
  cut_edge(c, e);
  l->edge[l->edges] = (uint32_t)l->count;
  for (size_t k = 0; k <= c->n_marks; k++) {
    int first = k == 0, last = k == c->n_marks;
    eda_grow(&l->fragments, &c->capacity, l->count + 1, sizeof *l->fragments);
    l->fragments[l->count++] = (epe_fragment){
        .from = point_at(e, first ? 0 : c->marks[k - 1]),
        .to = point_at(e, last ? e->length : c->marks[k]),
        .polygon = polygon,
        .edge = (uint32_t)l->edges,
        .gate = -1,
        .axis = e->axis,
        .sign = e->sign,
        .corner = (uint8_t)((first ? EPE_FROM : 0) | (last ? EPE_TO : 0)),
        .still = e->length < l->rules->min_edge,
        .hole = c->drawn->hole && c->drawn->hole[polygon]};
  }
  l->edges++;
}

static void layer_close_polygon(epe_layer *l, uint32_t first) {
  uint32_t end = (uint32_t)l->count;
  for (uint32_t i = first; i < end; i++) {
    l->fragments[i].previous = i > first ? i - 1 : end - 1;
    l->fragments[i].next = i + 1 < end ? i + 1 : first;
  }
}

static void cut_polygons(cutter *c) {
  epe_layer *l = c->layer;
  const eda_shapes *s = c->drawn;
  for (size_t p = 0; p < s->count; p++) {
    uint32_t first = (uint32_t)l->count;
    l->start[p] = first;
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t next = i + 1 < s->start[p + 1] ? i + 1 : s->start[p];
      drawn_edge e = edge_of(c, i, next);
      layer_add_edge(c, &e, (uint32_t)p);
    }
    layer_close_polygon(l, first);
  }
  l->start[s->count] = l->edge[l->edges] = (uint32_t)l->count;
}

/* ---- sites ---- */

/* Set the site to the centre of the fragment. If the edge is long enough, keep
   the site at least `tangency` away from the corners, where the printed image
   is round. */
static void fragment_set_site(epe_layer *l, uint32_t i, double grid) {
  const epe_fragment *p = &l->fragments[i];
  uint32_t first = l->edge[p->edge], last = l->edge[p->edge + 1] - 1;
  double a = epe_along(p, l->fragments[first].from);
  double b = epe_along(p, l->fragments[last].to);
  double low = epe_min(a, b) + l->rules->tangency;
  double high = epe_max(a, b) - l->rules->tangency;
  double t = (epe_along(p, p->from) + (double)epe_along(p, p->to)) / 2;
  t = low > high ? (a + b) / 2 : epe_within(t, low, high);
  double at = epe_line(l->fragments, NULL, i);
  l->site[2 * i] = grid * (p->axis == EDA_X ? at : t);
  l->site[2 * i + 1] = grid * (p->axis == EDA_X ? t : at);
}

/* ---- owners ---- */

static int64_t point_distance(eda_point a, eda_point b) {
  return llabs((int64_t)b.x - a.x) + llabs((int64_t)b.y - a.y);
}

/* Set the owner of each fragment: the transistor whose fragment in `e` contains
   the centre of the fragment. `e` contains the segmentation's fragments of the
   same polygons. */
static void layer_set_owners(epe_layer *l, const eda_edges *e) {
  if (e->polygons != l->polygons) return;
  for (size_t p = 0; p < l->polygons; p++) {
    uint32_t k = e->start[p], last = e->start[p + 1];
    uint32_t i = l->start[p], end = l->start[p + 1];
    if (k == last || point_distance(e->fragments[k].from, l->from[i])) continue;
    int64_t begins = 0, at = 0;
    for (; i < end; i++) {
      int64_t length = point_distance(l->fragments[i].from, l->fragments[i].to);
      while (k + 1 < last) {
        int64_t next = begins + point_distance(e->fragments[k].from,
                                               e->fragments[k + 1].from);
        if (2 * next > 2 * at + length) break;
        begins = next;
        k++;
      }
      if (e->fragments[k].role != EDA_FIXED)
        l->fragments[i].gate = e->fragments[k].gate;
      at += length;
    }
  }
}

/* ---- layers ---- */

static void find_corners(cutter *c, size_t n) {
  const eda_shapes *s = c->drawn;
  eda_box *boxes = eda_alloc(n, sizeof *boxes);
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t last = s->start[p + 1] - 1;
      eda_point a = s->points[i > s->start[p] ? i - 1 : last];
      eda_point b = s->points[i];
      eda_point d = s->points[i < last ? i + 1 : s->start[p]];
      boxes[i] = (eda_box){b.x, b.y, b.x, b.y};
      /* Convex: a turn to the left. Compare signs only, because products may
         overflow. */
      int in_x = (b.x > a.x) - (b.x < a.x), in_y = (b.y > a.y) - (b.y < a.y);
      int out_x = (d.x > b.x) - (d.x < b.x), out_y = (d.y > b.y) - (d.y < b.y);
      c->convex[i] = in_x * out_y - in_y * out_x > 0;
    }
  int32_t reach = c->layer->rules->ripple_reach;
  c->corners = eda_index_new(boxes, n, reach > 1 ? reach : 1);
  free(boxes);
}

/* Allocate all arrays with one element per fragment. */
static void layer_make_arrays(epe_layer *l) {
  double **reals[] = {&l->wanted,  &l->gain,    &l->step,    &l->side,
                      &l->error,   &l->before,  &l->cost,    &l->work[0],
                      &l->work[1], &l->work[2], &l->work[3], &l->work[4]};
  int32_t **integers[] = {&l->shift, &l->last, &l->best,   &l->low,
                          &l->high,  &l->most, &l->settled};
  size_t n = l->count;
  l->reals = eda_alloc(sizeof reals / sizeof *reals * n, sizeof *l->reals);
  l->integers =
      eda_alloc(sizeof integers / sizeof *integers * n, sizeof *l->integers);
  for (size_t k = 0; k < sizeof reals / sizeof *reals; k++)
    *reals[k] = l->reals + k * n;
  for (size_t k = 0; k < sizeof integers / sizeof *integers; k++)
    *integers[k] = l->integers + k * n;
  l->from = eda_alloc(n, sizeof *l->from);
  l->site = eda_alloc(n, 2 * sizeof *l->site);
  l->runs = eda_alloc(n, sizeof *l->runs);
  l->state = eda_alloc(l->edges, sizeof *l->state);
}

void epe_cut(epe_layer *l, const eda_gates *gates, int which) {
  cutter c = {.layer = l, .drawn = &gates->drawn[which]};
  size_t n = c.drawn->count ? c.drawn->start[c.drawn->count] : 0;
  l->polygons = c.drawn->count;
  l->start = eda_alloc(l->polygons + 1, sizeof *l->start);
  l->edge = eda_alloc(n + 1, sizeof *l->edge);
  c.convex = eda_alloc(n, 1);
  find_corners(&c, n);
  cut_polygons(&c);
  layer_make_arrays(l);
  for (uint32_t i = 0; i < l->count; i++) {
    l->from[i] = l->fragments[i].from;
    l->gain[i] = 1;
    l->step[i] = INFINITY;
    l->most[i] = l->fragments[i].still ? 0 : l->rules->max_shift;
    fragment_set_site(l, i, gates->grid);
  }
  layer_set_owners(l, &gates->edges[which]);
  eda_index_free(c.corners);
  free(c.convex);
  free(c.marks);
}

void epe_clear(epe_layer *l) {
  epe_coupling *couplings[] = {&l->coupling, &l->transposed};
  for (int k = 0; k < 2; k++) {
    free(couplings[k]->start);
    free(couplings[k]->index);
    free(couplings[k]->weight);
  }
  free(l->fragments);
  free(l->start);
  free(l->from);
  free(l->site);
  free(l->edge);
  free(l->state);
  free(l->pairs);
  free(l->broken);
  free(l->reals);
  free(l->integers);
  free(l->runs);
  free(l->srafs.box);
  *l = (epe_layer){0};
}
