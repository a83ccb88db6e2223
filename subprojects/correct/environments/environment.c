/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements checksums of environments. Each edge within the radius becomes a
   64-bit number in the transistor's coordinates. The mirror image along L and W
   with the smallest of the four hash sums is selected; equal sums indicate a
   symmetry. The sums do not depend on the order of edges, because sorting would
   double the time of the scan. */
#include "environment.h"

#include <eda/check.h>
#include <eda/index.h>
#include <eda/memory.h>
#include <glib.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

/* CELL: cell size of the spatial index, nm, about a tenth of a search window.
   AT_ONCE: number of transistors per task. */
enum { CELL = 500, AT_ONCE = 256 };

/* Bits of an edge's number: three coordinates of BITS bits each, and the layer,
   axis and side of the edge. */
enum {
  BITS = 19,
  FURTHEST = (1 << (BITS - 1)) - 1,
  WIDEST = FURTHEST / 4, /* largest radius */
  MOST_LAYERS = 32
};

enum { FLIPS = 4 };

/* Edge of merged shapes: position `at` along the axis `across`, extent along
   the other axis. */
typedef struct edge {
  int32_t at, low, high;
  uint8_t layer, across, high_side;
} edge;

typedef struct seen {
  const opc_context *context;
  const eda_gates *gates;
  eda_box core;
  int32_t radius;
  int orientations;
  edge *edges;
  size_t count;
  eda_index *index;
  environment *out;
} seen;

/* ---- edges ---- */

static edge edge_of(size_t layer, eda_point a, eda_point b) {
  edge e = {.layer = (uint8_t)layer};
  if (a.x == b.x) { /* an edge runs down on the left side of the interior, and
                       up on the right side */
    e.across = EDA_X;
    e.high_side = a.y < b.y;
    e.at = a.x;
    e.low = MIN(a.y, b.y);
    e.high = MAX(a.y, b.y);
  } else {
    e.across = EDA_Y;
    e.high_side = a.x > b.x;
    e.at = a.y;
    e.low = MIN(a.x, b.x);
    e.high = MAX(a.x, b.x);
  }
  return e;
}

static eda_box box_of(const edge *e) {
  return e->across == EDA_X ? (eda_box){e->at, e->low, e->at, e->high}
                            : (eda_box){e->low, e->at, e->high, e->at};
}

static void find_edges(seen *s) {
  const eda_gates *g = s->gates;
  size_t all = 0, n = 0;
  for (size_t k = 0; k < g->layers; k++)
    if (g->drawn[k].count) all += g->drawn[k].start[g->drawn[k].count];
  s->edges = eda_alloc(all, sizeof *s->edges);
  eda_box *box = eda_alloc(all, sizeof *box);
  for (size_t k = 0; k < g->layers; k++) {
    const eda_shapes *d = &g->drawn[k];
    for (size_t p = 0; p < d->count; p++)
      for (uint32_t i = d->start[p]; i < d->start[p + 1]; i++, n++) {
        uint32_t next = i + 1 < d->start[p + 1] ? i + 1 : d->start[p];
        s->edges[n] = edge_of(k, d->points[i], d->points[next]);
        box[n] = box_of(&s->edges[n]);
      }
  }
  s->count = n;
  s->index = eda_index_new(box, n, (int32_t)ceil(CELL / g->grid));
  free(box);
}

/* ---- one transistor ---- */

/* Coordinate system of a transistor, with the origin at the LOW corner of its
   box; along a mirrored axis, the origin is at the HIGH end. */
typedef struct frame {
  eda_box box;
  uint8_t axis;
} frame;

static int32_t low_of(const frame *f, int d) {
  return d == EDA_X ? f->box.x0 : f->box.y0;
}

static int32_t size_of(const frame *f, int d) {
  return d == EDA_X ? f->box.x1 - f->box.x0 : f->box.y1 - f->box.y0;
}

/* Return the number of an edge in the coordinates of a transistor. back[axis]:
   1: the axis is mirrored. */
static uint64_t number_of(const frame *f, const edge *e, const int *back) {
  static const uint64_t mask = ((uint64_t)1 << BITS) - 1;
  int d = e->across, other = !d;
  int32_t at = e->at - low_of(f, d), low = e->low - low_of(f, other),
          high = e->high - low_of(f, other);
  int side = e->high_side;
  if (back[d]) {
    at = size_of(f, d) - at;
    side = !side;
  }
  if (back[other]) {
    int32_t was = low;
    low = size_of(f, other) - high;
    high = size_of(f, other) - was;
  }
  uint64_t head =
      (uint64_t)e->layer << 2 | (uint64_t)(d ^ f->axis) << 1 | (uint64_t)side;
  return head << (3 * BITS) | ((uint64_t)at & mask) << (2 * BITS) |
         ((uint64_t)low & mask) << BITS | ((uint64_t)high & mask);
}

/* Return the splitmix64 hash of a number, for one of two seeds. */
static uint64_t hash_mix(uint64_t x, uint64_t start) {
  x += start;
  x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
  x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
  return x ^ (x >> 31);
}

void environment_add(uint64_t sum[2], uint64_t number) {
  sum[0] += hash_mix(number, 0x9E3779B97F4A7C15u);
  sum[1] += hash_mix(~number, 0xD1B54A32D192ED03u);
}

/* Hash sums and number of the edges around a transistor in one of the four
   mirror images. */
typedef struct heap {
  uint64_t sum[2], count;
} heap;

static void heap_add(heap *h, const frame *f, const edge *e) {
  for (int k = 0; k < FLIPS; k++) {
    int l = k & EDA_FLIP_L, w = (k & EDA_FLIP_W) / EDA_FLIP_W;
    const int back[2] = {f->axis == EDA_X ? l : w, f->axis == EDA_X ? w : l};
    environment_add(h[k].sum, number_of(f, e, back));
    h[k].count++;
  }
}

static int too_large(const seen *s, size_t i, opc_error *error) {
  eda_box b = s->gates->box[i];
  return opc_fail(
      error, OPC_INVALID, NULL,
      "transistor from (%.10g, %.10g) to (%.10g, %.10g) nm: expected "
      "sides of at most %.10g nm minus twice 'radius'",
      b.x0 * s->gates->grid, b.y0 * s->gates->grid, b.x1 * s->gates->grid,
      b.y1 * s->gates->grid, FURTHEST * s->gates->grid);
}

/* Collect the edges of all layers, clipped at the radius around transistor
   i. */
static void heap_collect(const seen *s, size_t i, heap *h) {
  frame f = {s->gates->box[i], s->gates->axis[i]};
  eda_box w = eda_box_grown(f.box, s->radius);
  eda_finder finder = eda_index_find(s->index, w);
  for (uint32_t k; eda_index_next(&finder, &k);) {
    edge e = s->edges[k];
    e.low = MAX(e.low, e.across == EDA_X ? w.y0 : w.x0);
    e.high = MIN(e.high, e.across == EDA_X ? w.y1 : w.x1);
    if (e.low < e.high) heap_add(h, &f, &e);
  }
}

static void environment_digest(const seen *s, size_t i, const heap *h,
                               uint8_t *out) {
  const eda_gates *g = s->gates;
  frame f = {g->box[i], g->axis[i]};
  eda_goal goal = eda_gates_goal(g, i);
  /* L and W in steps of 1e-3 nm, to absorb rounding. */
  const int64_t head[] = {g->type[i],
                          s->orientations == 8 ? EDA_X : f.axis,
                          size_of(&f, f.axis),
                          size_of(&f, !f.axis),
                          llround(g->length[i] * 1000),
                          llround(g->width[i] * 1000),
                          goal.given};
  uint8_t all[32];
  gsize size = sizeof all;
  g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
  g_checksum_update(sum, (const guchar *)head, sizeof head);
  g_checksum_update(sum, (const guchar *)h, sizeof *h);
  if (goal.given)
    g_checksum_update(sum, (const guchar *)&goal, offsetof(eda_goal, given));
  g_checksum_update(sum, (const guchar *)eda_gates_flavour(g, i), -1);
  g_checksum_get_digest(sum, all, &size);
  memcpy(out, all, SUM_SIZE);
}

static int find_one(const seen *s, size_t i, opc_error *error) {
  heap h[FLIPS] = {{{0}, 0}};
  eda_box b = s->gates->box[i];
  int32_t most = FURTHEST - 2 * s->radius;
  if (b.x1 - b.x0 > most || b.y1 - b.y0 > most) return too_large(s, i, error);
  heap_collect(s, i, h);
  int least = 0;
  for (int k = 1; k < FLIPS && s->orientations > 1; k++)
    if (h[k].sum[0] < h[least].sum[0]) least = k;
  s->out[i].flip = (uint8_t)least;
  environment_digest(s, i, &h[least], s->out[i].sum);
  return OPC_OK;
}

/* ---- run ---- */

static int find_some(void *data, size_t part, opc_error *error) {
  const seen *s = data;
  size_t end = MIN((part + 1) * AT_ONCE, s->gates->count);
  int code = OPC_OK;
  for (size_t i = part * AT_ONCE; i < end && !code; i++)
    if (environment_starts(s->core, s->gates->box[i]))
      code = find_one(s, i, error);
  return code;
}

int environment_starts(eda_box core, eda_box b) {
  return b.x0 >= core.x0 && b.x0 < core.x1 && b.y0 >= core.y0 && b.y0 < core.y1;
}

int environments_find(const opc_context *context, const eda_gates *window,
                      eda_box core, int32_t radius, int orientations,
                      environment *out, opc_error *error) {
  seen s = {.context = context,
            .gates = window,
            .core = core,
            .radius = radius,
            .orientations = orientations,
            .out = out};
  if (window->layers > MOST_LAYERS)
    return opc_fail(error, OPC_INVALID, NULL, "%zu layers, expected at most %d",
                    window->layers, MOST_LAYERS);
  if (radius < 0 || radius > WIDEST)
    return opc_fail(
        error, OPC_INVALID, "radius",
        "'radius' is %.10g nm, expected 0 to %.10g nm for this mask grid",
        radius * window->grid, WIDEST * window->grid);
  find_edges(&s);
  int code = eda_try_all(context, (window->count + AT_ONCE - 1) / AT_ONCE,
                         find_some, &s, error);
  eda_index_free(s.index);
  free(s.edges);
  return code;
}
