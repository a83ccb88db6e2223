/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the rounding of the shifts that the feedback requests to shifts on
   the grid that satisfy the mask rules for jogs, edge length, width and space.
 */
#include "epe.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "tuning.h"

static int32_t run_clamp(double value, int32_t low, int32_t high) {
  return (int32_t)lround(epe_within(value, low, high));
}

/* ---- the runs of an edge ---- */

static void run_set_shift(epe_run *r) {
  r->shift = run_clamp(r->weighted / r->length, r->low, r->high);
}

/* Make one run of each fragment of an edge, a list that begins at runs[0]. The
   rounding error of the grid is summed along the edge until the sum justifies a
   jog, because the optics average shifts along the edge. */
static void runs_begin(const epe_layer *l, size_t e, epe_run *runs) {
  int32_t n = (int32_t)(l->edge[e + 1] - l->edge[e]);
  double missing = 0, tolerance = l->rules->blur / tuned.jog_part;
  for (int32_t k = 0; k < n; k++) {
    uint32_t i = l->edge[e] + (uint32_t)k;
    double length = epe_length(&l->fragments[i]);
    runs[k] = (epe_run){i,      i + 1,     l->wanted[i] * length,
                        length, l->low[i], l->high[i],
                        0,      k - 1,     k + 1 < n ? k + 1 : -1};
    epe_run *r = &runs[k];
    run_set_shift(r);
    if (k) {
      int32_t same = runs[k - 1].shift;
      double left = missing + (l->wanted[i] - same) * length;
      if (fabs(left) <= tolerance && same >= r->low && same <= r->high)
        r->shift = same;
      else
        r->shift = run_clamp(l->wanted[i] + missing / length, r->low, r->high);
    }
    missing += (l->wanted[i] - r->shift) * length;
    missing = epe_within(missing, -length, length);
  }
}

/* Merge run k with the next run. The bounds of both runs include 0, so their
   intersection is not empty. */
static void run_merge(epe_run *runs, int32_t k) {
  epe_run *a = &runs[k];
  const epe_run *b = &runs[a->after];
  a->end = b->end;
  a->weighted += b->weighted;
  a->length += b->length;
  if (b->low > a->low) a->low = b->low;
  if (b->high < a->high) a->high = b->high;
  a->after = b->after;
  if (a->after >= 0) runs[a->after].before = k;
  if (a->shift != b->shift) run_set_shift(a);
}

static int run_differs(const epe_run *runs, int32_t k, int32_t n) {
  return abs(runs[k].shift - runs[n].shift);
}

/* Merge run k with all neighbours whose shifts differ by at most `jog`. Return
   the index of the merged run. */
static int32_t run_absorb(epe_run *runs, int32_t k, int32_t jog) {
  for (;;) {
    int32_t before = runs[k].before, after = runs[k].after;
    if (after >= 0 && run_differs(runs, k, after) <= jog)
      run_merge(runs, k);
    else if (before >= 0 && run_differs(runs, k, before) <= jog)
      run_merge(runs, k = before);
    else
      return k;
  }
}

/* ---- smallest lengths ---- */

static int run_is_convex(const epe_fragment *p, const epe_fragment *next) {
  return (p->sign * next->sign > 0) == (p->axis == EDA_X);
}

/* Return 1 if the inside of the mask is beside the run at its end `side` (0:
   begin, 1: end): the run is shifted further outwards than the adjacent run, or
   the corner is convex. If both ends are such ends, the run bounds a mask
   width; if neither is, the run bounds a space. */
static int run_is_bounded_inside(const epe_layer *l, const epe_run *runs,
                                 const epe_run *r, int side) {
  const epe_fragment *p = l->fragments;
  int32_t other = side ? r->after : r->before;
  if (other >= 0) return r->shift > runs[other].shift;
  uint32_t i = side ? r->end - 1 : r->first;
  return side ? run_is_convex(&p[i], &p[p[i].next])
              : run_is_convex(&p[p[i].previous], &p[i]);
}

static int run_too_short(const epe_layer *l, const epe_run *runs, int32_t k,
                         const int32_t *shift) {
  const epe_fragment *p = l->fragments;
  const epe_run *r = &runs[k];
  if (r->before < 0 && r->after < 0) return 0;
  int before = run_is_bounded_inside(l, runs, r, 0),
      after = run_is_bounded_inside(l, runs, r, 1);
  int32_t least = before && after     ? l->rules->min_width
                  : !before && !after ? l->rules->min_space
                                      : 0;
  if (least < l->rules->min_edge) least = l->rules->min_edge;
  int32_t length =
      epe_end(p, shift, r->end - 1) - epe_begin(p, shift, r->first);
  int rises = (p[r->first].axis == EDA_X) == (p[r->first].sign > 0);
  return (rises ? length : -length) < least;
}

/* Merge run k with the adjacent run whose shift is closer. Return the index of
   the merged run. */
static int32_t run_join(epe_run *runs, int32_t k) {
  int32_t before = runs[k].before, after = runs[k].after;
  if (after < 0 || (before >= 0 && run_differs(runs, k, before) <=
                                       run_differs(runs, k, after)))
    k = before;
  run_merge(runs, k);
  return k;
}

/* Compute the shifts of an edge into l->settled. `shift`: present shifts, which
   determine the positions of the corners. */
static void edge_settle(epe_layer *l, size_t e, const int32_t *shift) {
  int32_t jog = l->rules->min_jog > 1 ? l->rules->min_jog - 1 : 0;
  epe_run *runs = l->runs + l->edge[e];
  runs_begin(l, e, runs);
  if (l->state[e] & EPE_WHOLE) run_absorb(runs, 0, INT32_MAX);
  for (int32_t j = 0; j <= jog; j++)
    for (int32_t k = 0; k >= 0; k = runs[k].after) k = run_absorb(runs, k, j);
  for (int32_t k = 0; k >= 0;) {
    if (!run_too_short(l, runs, k, shift)) {
      k = runs[k].after;
      continue;
    }
    k = run_absorb(runs, run_join(runs, k), jog);
    /* The preceding run may now be too short. */
    if (runs[k].before >= 0) k = runs[k].before;
  }
  for (int32_t k = 0; k >= 0; k = runs[k].after)
    for (uint32_t i = runs[k].first; i < runs[k].end; i++)
      l->settled[i] = runs[k].shift;
}

/* Find the runs of an edge in the mask of `shift`. */
static void runs_find(const epe_layer *l, size_t e, const int32_t *shift,
                      epe_run *runs) {
  int32_t n = 0;
  for (uint32_t i = l->edge[e]; i < l->edge[e + 1]; i++) {
    if (n && runs[n - 1].shift == shift[i]) {
      runs[n - 1].end = i + 1;
      continue;
    }
    if (n) runs[n - 1].after = n;
    runs[n] = (epe_run){.first = i,
                        .end = i + 1,
                        .shift = shift[i],
                        .before = n - 1,
                        .after = -1};
    n++;
  }
}

/* Return 1 if a run of an edge is too short. Corners may have moved since the
   edge was settled. */
static int edge_has_short(epe_layer *l, size_t e, const int32_t *shift) {
  epe_run *runs = l->runs + l->edge[e];
  runs_find(l, e, shift, runs);
  for (int32_t k = 0; k >= 0; k = runs[k].after)
    if (run_too_short(l, runs, k, shift)) return 1;
  return 0;
}

/* ---- all edges ---- */

typedef struct round_state {
  epe_layer *layer;
  int32_t *shift;
} round_state;

static void edge_settle_if_needed(void *data, size_t e) {
  const round_state *r = data;
  epe_layer *l = r->layer;
  uint32_t first = l->edge[e], n = l->edge[e + 1] - first;
  if (l->state[e] & (EPE_NARROWED | EPE_SHORT))
    edge_settle(l, e, r->shift);
  else
    memcpy(l->settled + first, r->shift + first, n * sizeof *r->shift);
}

static void edge_check(void *data, size_t e) {
  const round_state *r = data;
  uint8_t *state = &r->layer->state[e];
  *state &= EPE_WHOLE;
  if (edge_has_short(r->layer, e, r->shift)) *state |= EPE_SHORT;
}

/* Settle the marked edges. `whole`: 1: an edge with a run that is too short has
   one shift from now on. Return the number of edges with such a run. */
static size_t edges_settle(epe_layer *l, int32_t *shift, int whole) {
  round_state r = {l, shift};
  size_t found = 0;
  opc_parallel(l->context, l->edges, edge_settle_if_needed, &r);
  memcpy(shift, l->settled, l->count * sizeof *shift);
  opc_parallel(l->context, l->edges, edge_check, &r);
  for (size_t e = 0; e < l->edges; e++) {
    if (!(l->state[e] & EPE_SHORT)) continue;
    found++;
    if (whole) l->state[e] |= EPE_WHOLE;
  }
  return found;
}

void epe_settle(epe_layer *l, int32_t *shift) {
  memset(l->state, EPE_NARROWED, l->edges);
  for (size_t i = 0; i < l->count; i++) {
    l->high[i] = l->most[i];
    l->low[i] = l->fragments[i].still ? 0 : -l->rules->max_shift;
    shift[i] = run_clamp(l->wanted[i], l->low[i], l->high[i]);
  }
  size_t bad = 1;
  for (int round = 0; bad; round++) {
    bad = edges_settle(l, shift, round >= tuned.whole_after);
    bad += epe_separate(l, shift, round >= tuned.drawn_after);
  }
}
