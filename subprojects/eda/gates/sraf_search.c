/* SPDX-License-Identifier: BSD-3-Clause */
/* Placement of scatter bars by a gain map. Among all candidate rectangles on a
   lattice, choose the rectangle with the largest gain. Repeat with the
   rectangles that keep their distance from the chosen ones. Cumulative sums
   yield the gain of a rectangle from four nodes. */
#include <eda/memory.h>
#include <eda/srafs.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Number of passes. In each pass each node has one candidate. A node whose
   candidate conflicts with a better candidate has a new candidate in the next
   pass. */
enum { PASSES = 4 };

/* Candidates with less than this fraction of the largest gain of a pass are
   deferred to the next pass. Half and twice this value change the result by
   less than 0.5 %. */
static const double part_of_best = 0.3;

typedef struct searcher {
  const eda_field *map;
  const eda_sraf_limits *rule;
  double grid, dx,
      dy; /* steps of the mask grid, and of the map (the lattice), nm */
  int nx, ny;
  double *gain;   /* cumulative gain to the left of and below each node, nm^2 */
  int32_t *taken; /* cumulative number of forbidden nodes, as `gain` */
  uint8_t *keep_out; /* 1: forbidden node */
} searcher;

/* A candidate scatter bar: the lattice cells x0 .. x1 - 1, y0 .. y1 - 1. */
typedef struct candidate {
  double gain;
  int x0, y0, x1, y1;
} candidate;

/* ---- cumulative sums ---- */

static size_t sample_index(const searcher *s, int x, int y) {
  return (size_t)y * (size_t)(s->nx + 1) + (size_t)x;
}

static void sum_up(searcher *s) {
  double cell = s->dx * s->dy;
  for (int y = 0; y < s->ny; y++) {
    double gain = 0;
    int32_t taken = 0;
    for (int x = 0; x < s->nx; x++) {
      size_t node = (size_t)y * (size_t)s->nx + (size_t)x;
      gain -= cell * (double)s->map->coefficients[node];
      taken += s->keep_out[node];
      s->gain[sample_index(s, x + 1, y + 1)] =
          s->gain[sample_index(s, x + 1, y)] + gain;
      s->taken[sample_index(s, x + 1, y + 1)] =
          s->taken[sample_index(s, x + 1, y)] + taken;
    }
  }
}

static int is_free(const searcher *s, const candidate *w) {
  const int32_t *t = s->taken;
  return t[sample_index(s, w->x1, w->y1)] - t[sample_index(s, w->x0, w->y1)] -
             t[sample_index(s, w->x1, w->y0)] +
             t[sample_index(s, w->x0, w->y0)] ==
         0;
}

static double gain_of(const searcher *s, const candidate *w) {
  const double *g = s->gain;
  return g[sample_index(s, w->x1, w->y1)] - g[sample_index(s, w->x0, w->y1)] -
         g[sample_index(s, w->x1, w->y0)] + g[sample_index(s, w->x0, w->y0)];
}

/* ---- forbidden nodes ---- */

/* Forbid all nodes within a box (grid steps) enlarged by `off` on each side. */
static void keep_out(searcher *s, eda_box b, int32_t off) {
  const eda_frame *f = &s->map->frame;
  int x0 = (int)floor(((b.x0 - off) * s->grid - f->x0) / s->dx + 0.5);
  int y0 = (int)floor(((b.y0 - off) * s->grid - f->y0) / s->dy + 0.5);
  int x1 = (int)ceil(((b.x1 + off) * s->grid - f->x0) / s->dx + 0.5);
  int y1 = (int)ceil(((b.y1 + off) * s->grid - f->y0) / s->dy + 0.5);
  x0 = x0 < 0 ? 0 : x0;
  y0 = y0 < 0 ? 0 : y0;
  x1 = x1 > s->nx ? s->nx : x1;
  y1 = y1 > s->ny ? s->ny : y1;
  for (int y = y0; y < y1 && x0 < x1; y++)
    memset(s->keep_out + (size_t)y * (size_t)s->nx + (size_t)x0, 1,
           (size_t)(x1 - x0));
}

/* ---- candidates ---- */

/* Find the size with the largest gain for a bar whose corner is cell (x, y).
   Widths increase by one cell, lengths by one cell plus an eighth of the
   length. */
static void try_sizes(const searcher *s, int x, int y, int upright,
                      candidate *best) {
  const eda_sraf_limits *r = s->rule;
  double across = (upright ? s->dx : s->dy) / s->grid;
  double along = (upright ? s->dy : s->dx) / s->grid;
  for (int w = (int)ceil(r->least_width / across - 1e-6);
       w * across <= r->most_width + 1e-6; w++)
    for (int l = (int)ceil(r->least_length / along - 1e-6);
         l * along <= r->most_length + 1e-6; l += 1 + l / 8) {
      candidate one = {0, x, y, x + (upright ? w : l), y + (upright ? l : w)};
      if (one.x1 > s->nx || one.y1 > s->ny || !is_free(s, &one)) break;
      one.gain = gain_of(s, &one);
      if (one.gain > best->gain) *best = one;
    }
}

static int by_gain(const void *a, const void *b) {
  const candidate *p = a, *q = b;
  if (p->gain != q->gain) return p->gain > q->gain ? -1 : 1;
  return p->y0 != q->y0 ? p->y0 - q->y0 : p->x0 - q->x0;
}

static size_t make_candidates(const searcher *s, candidate *candidates) {
  size_t n = 0;
  for (int y = 0; y < s->ny; y++)
    for (int x = 0; x < s->nx; x++) {
      candidate best = {.gain = s->rule->min_gain};
      if (s->keep_out[(size_t)y * (size_t)s->nx + (size_t)x]) continue;
      try_sizes(s, x, y, 0, &best);
      try_sizes(s, x, y, 1, &best);
      if (best.x1) candidates[n++] = best;
    }
  qsort(candidates, n, sizeof *candidates, by_gain);
  return n;
}

static eda_box box_of(const searcher *s, const candidate *w) {
  const eda_frame *f = &s->map->frame;
  /* A node is the centre of its cell. */
  return (eda_box){(int32_t)lround((f->x0 + (w->x0 - 0.5) * s->dx) / s->grid),
                   (int32_t)lround((f->y0 + (w->y0 - 0.5) * s->dy) / s->grid),
                   (int32_t)lround((f->x0 + (w->x1 - 0.5) * s->dx) / s->grid),
                   (int32_t)lround((f->y0 + (w->y1 - 0.5) * s->dy) / s->grid)};
}

/* Add candidates in order of decreasing gain. Skip candidates that conflict
   with added scatter bars. Return the number of added scatter bars. */
static size_t searcher_add(searcher *s, const candidate *candidates, size_t n,
                           size_t capacity, eda_box_list *srafs) {
  size_t added = 0;
  for (size_t i = 0; i < n && added < capacity; i++) {
    const candidate *w = &candidates[i];
    if (w->gain < part_of_best * candidates[0].gain) break;
    if (i && !is_free(s, w)) continue;
    eda_box b = box_of(s, w);
    eda_box_list_add(srafs, b);
    keep_out(s, b, s->rule->space);
    sum_up(s);
    added++;
  }
  return added;
}

int eda_srafs_search(const eda_field *map, const eda_sraf_limits *rule,
                     const eda_shapes *drawn, double grid, eda_box_list *srafs,
                     opc_error *error) {
  searcher s = {
      .map = map, .rule = rule, .grid = grid, .nx = map->nx, .ny = map->ny};
  eda_box *box = NULL;
  size_t n = 0, cells = (size_t)s.nx * (size_t)s.ny;
  size_t sums = (size_t)(s.nx + 1) * (size_t)(s.ny + 1);
  int code = eda_fracture(drawn, &box, &n, error);
  if (code) return code;
  s.dx = map->frame.width / s.nx;
  s.dy = map->frame.height / s.ny;
  s.gain = eda_alloc(sums, sizeof *s.gain);
  s.taken = eda_alloc(sums, sizeof *s.taken);
  s.keep_out = eda_alloc(cells, 1);
  for (size_t i = 0; i < n; i++) keep_out(&s, box[i], rule->distance);
  for (size_t i = 0; i < srafs->count; i++)
    keep_out(&s, srafs->box[i], rule->space);
  /* Forbid the first row and column: half of each cell is outside the frame. */
  memset(s.keep_out, 1, (size_t)s.nx);
  for (int y = 0; y < s.ny; y++) s.keep_out[(size_t)y * (size_t)s.nx] = 1;
  sum_up(&s);
  candidate *candidates = eda_alloc(cells, sizeof *candidates);
  for (int pass = 0; pass < PASSES && srafs->count < rule->most; pass++)
    if (!searcher_add(&s, candidates, make_candidates(&s, candidates),
                      rule->most - srafs->count, srafs))
      break;
  free(candidates);
  free(box);
  free(s.gain);
  free(s.taken);
  free(s.keep_out);
  return OPC_OK;
}

double eda_srafs_gain(const eda_field *map, eda_box b, double grid) {
  const eda_frame *f = &map->frame;
  double dx = f->width / map->nx, dy = f->height / map->ny, sum = 0;
  for (int y = (int)ceil((b.y0 * grid - f->y0) / dy);
       f->y0 + y * dy < b.y1 * grid; y++)
    for (int x = (int)ceil((b.x0 * grid - f->x0) / dx);
         f->x0 + x * dx < b.x1 * grid; x++)
      sum -=
          (double)
              map->coefficients[(size_t)eda_wrap(y, map->ny) * (size_t)map->nx +
                                (size_t)eda_wrap(x, map->nx)];
  return sum * dx * dy;
}
