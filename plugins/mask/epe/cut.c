/* SPDX-License-Identifier: BSD-3-Clause */
/* Cut the edges of a layer into fragments: shorter ones beside corners and
   opposite to corners of others, even ones between (thesis 3.3.1). */
#include "epe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct cutter {
  epe_layer *layer;
  const opc_shapes *drawn;
  epe_bins corners;        /* of all polygons */
  size_t room;             /* for pieces */
  int32_t *marks;          /* where one edge is cut */
  size_t n_marks, marks_room;
  uint8_t *convex;         /* each point of `drawn` */
} cutter;

/* An edge as drawn: from a corner along a direction. */
typedef struct drawn_edge {
  opc_point a, b;
  int32_t length;
  uint8_t axis;            /* of its normal */
  int8_t sign;
  uint8_t convex[2];
} drawn_edge;

static drawn_edge edge_of(const cutter *c, uint32_t i, uint32_t next) {
  drawn_edge e = {.a = c->drawn->points[i], .b = c->drawn->points[next]};
  int rises = e.a.x == e.b.x ? e.b.y > e.a.y : e.b.x > e.a.x;
  e.axis = e.a.x == e.b.x ? OPC_X : OPC_Y;
  /* The inside is on the left. */
  e.sign = (e.axis == OPC_X) == rises ? 1 : -1;
  e.length = e.axis == OPC_X ? abs(e.b.y - e.a.y) : abs(e.b.x - e.a.x);
  e.convex[0] = c->convex[i];
  e.convex[1] = c->convex[next];
  return e;
}

static opc_point point_at(const drawn_edge *e, int32_t t) {
  opc_point p = e->a;
  if (e->axis == OPC_X) p.y += e->b.y > e->a.y ? t : -t;
  else p.x += e->b.x > e->a.x ? t : -t;
  return p;
}

/* ---- where to cut ---- */

static int mark(cutter *c, int32_t t) {
  if (c->n_marks == c->marks_room) {
    size_t room = c->marks_room ? 2 * c->marks_room : 64;
    int32_t *grown = realloc(c->marks, room * sizeof *grown);
    if (!grown) return 0;
    c->marks = grown;
    c->marks_room = room;
  }
  c->marks[c->n_marks++] = t;
  return 1;
}

static int ascending(const void *a, const void *b) {
  int32_t p = *(const int32_t *)a, q = *(const int32_t *)b;
  return (p > q) - (p < q);
}

/* Mark a corner of another edge that this one has in sight, if it does, and
   one ripple to both sides of it. */
static int mark_corner(cutter *c, const drawn_edge *e, opc_point p) {
  const epe_rules *r = c->layer->rules;
  int32_t off = e->axis == OPC_X ? p.x - e->a.x : p.y - e->a.y;
  int32_t along = e->axis == OPC_X ? p.y - e->a.y : p.x - e->a.x;
  int rises = e->axis == OPC_X ? e->b.y > e->a.y : e->b.x > e->a.x;
  if (!rises) along = -along;
  off *= e->sign;
  if (off <= 0 || off > r->ripple_reach || along <= 0 || along >= e->length)
    return 1;
  return mark(c, along) && mark(c, along - r->ripple) &&
         mark(c, along + r->ripple);
}

static int mark_ripples(cutter *c, const drawn_edge *e) {
  const epe_rules *r = c->layer->rules;
  if (r->ripple_reach <= 0) return 1;
  int32_t out = e->sign * r->ripple_reach;
  opc_point p = e->a, q = e->b;
  if (e->axis == OPC_X) q.x += out;
  else q.y += out;
  const epe_bins *b = &c->corners;
  int32_t r0 = epe_row(b, p.y < q.y ? p.y : q.y);
  int32_t r1 = epe_row(b, p.y < q.y ? q.y : p.y);
  int32_t c0 = epe_column(b, p.x < q.x ? p.x : q.x);
  int32_t c1 = epe_column(b, p.x < q.x ? q.x : p.x);
  for (int32_t row = r0; row <= r1; row++)
    for (int32_t column = c0; column <= c1; column++) {
      size_t at = (size_t)row * (size_t)b->columns + (size_t)column;
      for (uint32_t k = b->start[at]; k < b->start[at + 1]; k++)
        if (!mark_corner(c, e, c->drawn->points[b->items[k]])) return 0;
    }
  return 1;
}

/* Keep the marks that leave no fragment shorter than the least, between
   `first` and `last`. */
static void thin_out(cutter *c, int32_t first, int32_t last) {
  int32_t least = c->layer->rules->min_edge, at = first;
  size_t n = 0;
  if (!c->n_marks) return;
  qsort(c->marks, c->n_marks, sizeof *c->marks, ascending);
  for (size_t k = 0; k < c->n_marks; k++) {
    int32_t t = c->marks[k];
    if (t - at < least || last - t < least) continue;
    c->marks[n++] = at = t;
  }
  c->n_marks = n;
}

/* Even fragments from `from` to `to`, which both are marks or ends. */
static int fill(cutter *c, int32_t from, int32_t to) {
  const epe_rules *r = c->layer->rules;
  int32_t parts = (to - from + r->fragment / 2) / r->fragment;
  while (parts > 1 && (to - from) / parts < r->min_edge) parts--;
  for (int32_t i = 1; i < parts; i++)
    if (!mark(c, from + (int32_t)((int64_t)(to - from) * i / parts))) return 0;
  return 1;
}

/* The marks of an edge, none at its ends. */
static int mark_edge(cutter *c, const drawn_edge *e) {
  const epe_rules *r = c->layer->rules;
  c->n_marks = 0;
  if (e->length < 2 * r->min_edge) return 1;
  if (e->convex[0] && e->convex[1] && e->length <= r->line_end) return 1;
  int32_t first = e->convex[0] ? r->corner_edge : r->concave_corner;
  int32_t last = e->length - (e->convex[1] ? r->corner_edge : r->concave_corner);
  if (first + r->min_edge > last) return mark(c, e->length / 2);
  if (!mark_ripples(c, e)) return 0;
  thin_out(c, first, last);
  size_t n = c->n_marks;
  int32_t at = first;
  for (size_t k = 0; k < n; k++) {
    int32_t next = c->marks[k];
    if (!fill(c, at, next)) return 0;
    at = next;
  }
  if (!fill(c, at, last) || !mark(c, first) || !mark(c, last)) return 0;
  qsort(c->marks, c->n_marks, sizeof *c->marks, ascending);
  return 1;
}

/* ---- fragments ---- */

static epe_piece *add_piece(cutter *c) {
  epe_layer *l = c->layer;
  if (l->count == c->room) {
    size_t room = c->room ? 2 * c->room : 256;
    epe_piece *grown = realloc(l->pieces, room * sizeof *grown);
    if (!grown) return NULL;
    l->pieces = grown;
    c->room = room;
  }
  epe_piece *p = &l->pieces[l->count++];
  *p = (epe_piece){.gate = -1};
  return p;
}

static int add_edge(cutter *c, const drawn_edge *e, uint32_t polygon) {
  epe_layer *l = c->layer;
  if (!mark_edge(c, e)) return 0;
  l->edge[l->edges] = (uint32_t)l->count;
  for (size_t k = 0; k <= c->n_marks; k++) {
    epe_piece *p = add_piece(c);
    if (!p) return 0;
    p->from = point_at(e, k ? c->marks[k - 1] : 0);
    p->to = point_at(e, k < c->n_marks ? c->marks[k] : e->length);
    p->polygon = polygon;
    p->hole = c->drawn->hole && c->drawn->hole[polygon];
    p->edge = (uint32_t)l->edges;
    p->axis = e->axis;
    p->sign = e->sign;
    p->corner = (uint8_t)((k ? 0 : EPE_FROM) | (k < c->n_marks ? 0 : EPE_TO));
    p->still = e->length < l->rules->min_edge;
  }
  l->edges++;
  return 1;
}

static void close_polygon(epe_layer *l, uint32_t first) {
  uint32_t end = (uint32_t)l->count;
  for (uint32_t i = first; i < end; i++) {
    l->pieces[i].previous = i > first ? i - 1 : end - 1;
    l->pieces[i].next = i + 1 < end ? i + 1 : first;
  }
}

static int cut_polygons(cutter *c) {
  epe_layer *l = c->layer;
  const opc_shapes *s = c->drawn;
  for (size_t p = 0; p < s->count; p++) {
    uint32_t first = (uint32_t)l->count;
    l->start[p] = first;
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t next = i + 1 < s->start[p + 1] ? i + 1 : s->start[p];
      drawn_edge e = edge_of(c, i, next);
      if (!add_edge(c, &e, (uint32_t)p)) return 0;
    }
    close_polygon(l, first);
  }
  l->start[s->count] = l->edge[l->edges] = (uint32_t)l->count;
  return 1;
}

/* ---- sites ---- */

/* The middle of a fragment, but off the corners, where the print is round, as
   far as the edge allows. */
static void set_site(epe_layer *l, uint32_t i, double grid) {
  const epe_piece *p = &l->pieces[i];
  uint32_t first = l->edge[p->edge], last = l->edge[p->edge + 1] - 1;
  double a = epe_along(p, l->pieces[first].from);
  double b = epe_along(p, l->pieces[last].to);
  double low = epe_min(a, b) + l->rules->tangency;
  double high = epe_max(a, b) - l->rules->tangency;
  double t = (epe_along(p, p->from) + (double)epe_along(p, p->to)) / 2;
  t = low > high ? (a + b) / 2 : epe_within(t, low, high);
  double at = epe_line(l->pieces, NULL, i);
  l->site[2 * i] = grid * (p->axis == OPC_X ? at : t);
  l->site[2 * i + 1] = grid * (p->axis == OPC_X ? t : at);
}

/* ---- owners ---- */

static int64_t distance(opc_point a, opc_point b) {
  return llabs((int64_t)b.x - a.x) + llabs((int64_t)b.y - a.y);
}

/* The transistor that owns the middle of each fragment, from the fragments that
   the gates came with: both go around the same polygons. */
static void set_owners(epe_layer *l, const opc_edges *e) {
  if (e->polygons != l->polygons) return;
  for (size_t p = 0; p < l->polygons; p++) {
    uint32_t k = e->start[p], last = e->start[p + 1];
    uint32_t i = l->start[p], end = l->start[p + 1];
    if (k == last || distance(e->fragments[k].from, l->from[i])) continue;
    int64_t begins = 0, at = 0;
    for (; i < end; i++) {
      int64_t length = distance(l->pieces[i].from, l->pieces[i].to);
      while (k + 1 < last) {
        int64_t next = begins + distance(e->fragments[k].from,
                                         e->fragments[k + 1].from);
        if (2 * next > 2 * at + length) break;
        begins = next;
        k++;
      }
      if (e->fragments[k].role != OPC_FIXED)
        l->pieces[i].gate = e->fragments[k].gate;
      at += length;
    }
  }
}

/* ---- all of it ---- */

static int find_corners(cutter *c, size_t n) {
  const opc_shapes *s = c->drawn;
  opc_box *boxes = calloc(n ? n : 1, sizeof *boxes);
  if (!boxes) return 0;
  for (size_t p = 0; p < s->count; p++)
    for (uint32_t i = s->start[p]; i < s->start[p + 1]; i++) {
      uint32_t last = s->start[p + 1] - 1;
      opc_point a = s->points[i > s->start[p] ? i - 1 : last];
      opc_point b = s->points[i];
      opc_point d = s->points[i < last ? i + 1 : s->start[p]];
      boxes[i] = (opc_box){b.x, b.y, b.x, b.y};
      /* A turn to the left; only signs, products may not fit. */
      int in_x = (b.x > a.x) - (b.x < a.x), in_y = (b.y > a.y) - (b.y < a.y);
      int out_x = (d.x > b.x) - (d.x < b.x), out_y = (d.y > b.y) - (d.y < b.y);
      c->convex[i] = in_x * out_y - in_y * out_x > 0;
    }
  int32_t reach = c->layer->rules->ripple_reach;
  int ok = epe_bins_make(&c->corners, boxes, n, reach > 1 ? reach : 1);
  free(boxes);
  return ok;
}

/* Everything that has the length of the fragments. */
static int make_arrays(epe_layer *l) {
  size_t n = l->count ? l->count : 1;
  l->from = calloc(n, sizeof *l->from);
  l->site = calloc(n, 2 * sizeof *l->site);
  l->wanted = calloc(n, sizeof *l->wanted);
  l->gain = calloc(n, sizeof *l->gain);
  int worked = 1;
  for (int k = 0; k < 5; k++)
    worked &= (l->work[k] = calloc(n, sizeof *l->work[k])) != NULL;
  l->step = calloc(n, sizeof *l->step);
  l->side = calloc(n, sizeof *l->side);
  l->error = calloc(n, sizeof *l->error);
  l->before = calloc(n, sizeof *l->before);
  l->cost = calloc(n, sizeof *l->cost);
  l->shift = calloc(n, sizeof *l->shift);
  l->last = calloc(n, sizeof *l->last);
  l->best = calloc(n, sizeof *l->best);
  l->low = calloc(n, sizeof *l->low);
  l->high = calloc(n, sizeof *l->high);
  l->most = calloc(n, sizeof *l->most);
  l->state = calloc(l->edges ? l->edges : 1, sizeof *l->state);
  l->runs = calloc(n, sizeof *l->runs);
  l->settled = calloc(n, sizeof *l->settled);
  return worked && l->from && l->site && l->wanted && l->gain && l->step &&
         l->side && l->error && l->cost && l->before && l->shift && l->last && l->best &&
         l->low && l->high && l->most && l->state && l->runs && l->settled;
}

int epe_cut(epe_layer *l, const opc_gates *gates, int which) {
  cutter c = {.layer = l, .drawn = &gates->drawn[which]};
  size_t n = c.drawn->count ? c.drawn->start[c.drawn->count] : 0;
  l->polygons = c.drawn->count;
  l->start = calloc(l->polygons + 1, sizeof *l->start);
  l->edge = calloc(n + 1, sizeof *l->edge);
  c.convex = calloc(n ? n : 1, 1);
  int ok = l->start && l->edge && c.convex && find_corners(&c, n) &&
           cut_polygons(&c) && make_arrays(l);
  if (ok) {
    for (uint32_t i = 0; i < l->count; i++) {
      l->from[i] = l->pieces[i].from;
      l->gain[i] = 1;
      l->step[i] = INFINITY;
      l->most[i] = l->pieces[i].still ? 0 : l->rules->max_shift;
      set_site(l, i, gates->grid);
    }
    set_owners(l, &gates->edges[which]);
  }
  epe_bins_clear(&c.corners);
  free(c.convex);
  free(c.marks);
  return ok;
}

void epe_clear(epe_layer *l) {
  free(l->pieces);
  free(l->start);
  free(l->from);
  free(l->site);
  free(l->edge);
  free(l->state);
  free(l->pairs);
  free(l->wanted);
  free(l->gain);
  free(l->step);
  epe_coupling *couplings[] = {&l->coupling, &l->transposed};
  for (int k = 0; k < 2; k++) {
    free(couplings[k]->start);
    free(couplings[k]->index);
    free(couplings[k]->weight);
  }
  for (int k = 0; k < 5; k++) free(l->work[k]);
  free(l->side);
  free(l->error);
  free(l->before);
  free(l->cost);
  free(l->shift);
  free(l->last);
  free(l->best);
  free(l->low);
  free(l->high);
  free(l->most);
  free(l->bars);
  free(l->runs);
  free(l->settled);
  free(l->broken);
  *l = (epe_layer){0};
}
