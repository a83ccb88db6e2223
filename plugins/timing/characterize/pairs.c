/* SPDX-License-Identifier: BSD-3-Clause */
/* Characterizes the effect of other inputs on a delay. Measures pin
   capacitances for each pattern of the other inputs, and pairs of inputs that
   change together. Each pair that switches an output is simulated at a few
   gaps, relative to one input alone. Source: Chandramouli and Sakallah,
   "Modeling the effects of temporal proximity of input transitions on gate
   propagation delay and transition time", DAC 1996. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "characterize.h"

enum {
  SLOWEST = 20, /* largest tabulated slew, relative to the delay */
  SOME = 48,
  MIDDLE = 2,
  POINTS = 5 * EDA_TIMING_GAPS
};

/* ---- list of pairs ---- */

/* Return 1 if two inputs that change from the pattern `from` are a pair for the
   output with the truth table `level`. Both together switch the output. Each of
   them alone also does (*parallel = 1), or none of them alone does (*parallel =
   0, in series). */
static int is_pair(const uint8_t *level, uint32_t from, size_t first,
                   size_t second, int *parallel) {
  uint32_t a = from ^ 1u << first, b = from ^ 1u << second,
           both = a ^ 1u << second;
  *parallel = level[a] != level[from];
  return level[a] == level[b] && level[both] != level[from];
}

/* Return the index of a listed pair that differs from `p` only in constant
   inputs, or -1 if there is none. */
static int32_t find_like(const eda_timing_cell *c, const eda_timing_pair *p) {
  uint32_t mask = 1u << p->first | 1u << p->second;
  for (size_t i = c->pairs; i-- > 0;) {
    const eda_timing_pair *q = &c->pair[i];
    if (q->first == p->first && q->second == p->second &&
        q->output == p->output && q->parallel == p->parallel &&
        !((q->from ^ p->from) & mask))
      return (int32_t)i;
  }
  return -1;
}

void pairs_list(study *s, eda_timing_cell *c) {
  const size_t n = c->inputs, patterns = (size_t)1 << n,
               most = c->outputs * n * n * patterns;
  size_t capacity = 0;
  eda_timing_pair *found = NULL;
  c->pair_of = eda_pool_alloc(&s->timing->memory, most, sizeof *c->pair_of);
  for (size_t k = 0; k < most; k++) {
    uint32_t from = (uint32_t)(k % patterns);
    size_t second = k / patterns % n, first = k / patterns / n % n,
           o = k / patterns / n / n;
    int parallel;
    c->pair_of[k] = -1;
    if (first == second ||
        !is_pair(c->level + o * patterns, from, first, second, &parallel))
      continue;
    eda_timing_pair p = {.first = (uint8_t)first,
                         .second = (uint8_t)second,
                         .output = (uint8_t)o,
                         .parallel = (uint8_t)parallel,
                         .from = from};
    c->pair = found;
    c->pair_of[k] = find_like(c, &p);
    if (c->pair_of[k] >= 0) continue;
    c->pair_of[k] = (int32_t)c->pairs;
    EDA_PUSH(found, c->pairs, capacity, p);
  }
  c->pair = eda_pool_alloc(&s->timing->memory, c->pairs, sizeof *c->pair);
  for (size_t i = 0; i < c->pairs; i++) c->pair[i] = found[i];
  free(found);
}

/* ---- arcs of single inputs ---- */

static const eda_timing_arc *arc_of(const eda_timing_cell *c, size_t output,
                                    size_t input, uint32_t from) {
  size_t at = (output * c->inputs + input) << c->inputs;
  return &c->arc[c->arc_of[at + from]];
}

/* Return the arc of the first or second input of a pair. The other input has
   the level at which this input alone switches the output. */
static const eda_timing_arc *pair_single_arc(const eda_timing_cell *c,
                                             const eda_timing_pair *p,
                                             int second) {
  size_t input = second ? p->second : p->first,
         other = second ? p->first : p->second;
  return arc_of(c, p->output, input,
                p->parallel ? p->from : p->from ^ 1u << other);
}

/* Return the index of a middle load. Normalized factors hardly depend on the
   load. */
static size_t load_of(const eda_timing_cell *c) { return c->loads / 2; }

/* Return the grid index of slew number `slew` (0 .. 2) of a pair: the two slews
   with sensitivities to sizes (near_slew), and a slew between them. */
static size_t slew_of(const eda_timing_cell *c, size_t slew) {
  return slew < MIDDLE ? c->near_slew[slew]
                       : (c->near_slew[0] + c->near_slew[1]) / 2;
}

static size_t grid_of(const eda_timing_cell *c, size_t slew) {
  return slew_of(c, slew) * c->loads + load_of(c);
}

/* ---- simulations ---- */

typedef struct work {
  study *s;
  eda_timing_cell *cell;
  size_t count, capacity; /* decks */
  deck *deck;
} work;

static deck *deck_for(work *w, double slew, int rises) {
  size_t k = 0;
  while (k < w->count &&
         (w->deck[k].slew != slew || w->deck[k].rises != rises ||
          w->deck[k].count == SOME))
    k++;
  if (k == w->count)
    EDA_PUSH(w->deck, w->count, w->capacity,
             (deck){.s = w->s, .slew = slew, .rises = rises, .care = GRID});
  return &w->deck[k];
}

/* A simulated point of a pair. slew: slew numbers of both inputs (see slew_of);
   place: number of the combination of slews, 0 to 4; gap: number of the gap;
   deck, copy: indices of the simulated copy of the cell. */
typedef struct point {
  const eda_timing_pair *pair;
  size_t slew[2], place, gap, deck, copy;
} point;

/* Add a point. The deck has the slew of the input that causes the output
   transition. */
static void plan_point(work *w, point *at) {
  const eda_timing_cell *c = w->cell;
  const eda_timing_pair *p = at->pair;
  int cause = !p->parallel;
  const eda_timing_arc *arc = pair_single_arc(c, p, cause);
  double delay = fmax(0, arc->delay[grid_of(c, at->slew[cause])]),
         slew = arc->slew[grid_of(c, at->slew[cause])],
         after = delay * eda_timing_gap[at->gap],
         own = c->at_slew[slew_of(c, at->slew[cause])],
         other = c->at_slew[slew_of(c, at->slew[!cause])];
  size_t input = cause ? p->second : p->first;
  deck *d = deck_for(w, own, !(p->from >> input & 1));
  copy one = {.cell = c,
              .from = p->from,
              .input = (uint8_t)input,
              .output = p->output,
              .load = c->at_load[load_of(c)],
              /* Two parallel inputs reduce the slew to as little as half; two
                 inputs in series increase the delay. */
              .delay = delay + 2 * slew,
              .slew = p->parallel ? slew / 2 : slew,
              .two = 1,
              .other = cause ? p->first : p->second,
              .other_slew = other,
              .other_after = cause ? -after : after};
  /* The ramp of the other input must begin after time 0. */
  double early = 2 * other - one.other_after;
  if (early > d->early) d->early = early;
  at->deck = (size_t)(d - w->deck);
  at->copy = d->count;
  EDA_PUSH(d->copy, d->count, d->capacity, one);
}

/* Return the ratio of a simulated value to eda_timing_blend. Return 1 if a
   delay of a single input is not positive, that is, the output switches before
   a slow input does. */
static double blend_factor(double found, double gap, double cause,
                           double other) {
  return cause > 0 && other > 0 ? found / eda_timing_blend(gap, cause, other)
                                : 1;
}

static void take_point(work *w, const point *at) {
  const eda_timing_cell *c = w->cell;
  const eda_timing_pair *p = at->pair;
  const copy *found = &w->deck[at->deck].copy[at->copy];
  int cause = !p->parallel;
  const eda_timing_arc *by = pair_single_arc(c, p, cause),
                       *other = pair_single_arc(c, p, !cause);
  size_t own = grid_of(c, at->slew[cause]),
         others = grid_of(c, at->slew[!cause]),
         to = at->place * EDA_TIMING_GAPS + at->gap;
  double gap = eda_timing_gap[at->gap];
  p->delay[to] =
      blend_factor(found->delay, gap, by->delay[own], other->delay[others]);
  p->slew[to] =
      blend_factor(found->slew, gap, by->slew[own], other->slew[others]);
  for (int k = 0; k < 2; k++) {
    double alone_by = pair_single_arc(c, p, k)->delay[grid_of(c, at->slew[k])],
           slew = c->at_slew[slew_of(c, at->slew[k])];
    p->at[k][at->slew[k]] = slew / fmax(alone_by, slew / SLOWEST);
  }
}

static void work_clear(work *w) {
  decks_clear(w->deck, &w->count);
  free(w->deck);
}

static int measure_pairs(study *s, eda_timing_cell *c, opc_error *error) {
  const size_t n = c->pairs * POINTS;
  work w = {.s = s, .cell = c};
  point *at = eda_alloc(n, sizeof *at);
  for (size_t i = 0; i < n; i++) {
    size_t k = i % POINTS / EDA_TIMING_GAPS;
    at[i] = (point){.pair = &c->pair[i / POINTS],
                    .slew = {k < 4 ? k / 2 : MIDDLE, k < 4 ? k % 2 : MIDDLE},
                    .place = k,
                    .gap = i % EDA_TIMING_GAPS};
    plan_point(&w, &at[i]);
  }
  int code = decks_run(s, w.deck, w.count, error);
  for (size_t i = 0; i < n && !code; i++) take_point(&w, &at[i]);
  work_clear(&w);
  free(at);
  return code;
}

/* ---- pin capacitances by pattern of the other inputs ---- */

/* Measure the capacitance of each input pin at the middle slew of the grid. At
   this slew, typical of circuits, the cell switches during the transition. */
static int measure_pins(study *s, eda_timing_cell *c, opc_error *error) {
  const double slew = c->at_slew[c->slews / 2];
  work w = {.s = s, .cell = c};
  for (uint32_t k = 0; k < c->inputs << c->inputs; k++) {
    uint32_t from = k & ((1u << c->inputs) - 1), input = k >> c->inputs;
    int rises = !(from >> input & 1);
    const copy one = {.cell = c,
                      .from = from,
                      .input = (uint8_t)input,
                      .of_pin = 1,
                      .load = c->at_load[load_of(c)],
                      .point = k};
    deck *d = deck_for(&w, slew, rises);
    EDA_PUSH(d->copy, d->count, d->capacity, one);
  }
  int code = decks_run(s, w.deck, w.count, error);
  for (size_t i = 0; i < w.count && !code; i++)
    for (size_t k = 0; k < w.deck[i].count; k++) {
      const copy *found = &w.deck[i].copy[k];
      for (size_t cap = 0; cap < EDA_CAPS; cap++)
        c->pin_capacitance[found->point * EDA_CAPS + cap] =
            found->capacitance[cap];
    }
  work_clear(&w);
  return code;
}

/* ---- public function ---- */

int pairs_find(study *s, eda_timing_cell *c, const char *key,
               opc_error *error) {
  char name[200];
  double *figure = c->figure + c->figures;
  snprintf(name, sizeof name, "%.180s-pairs", key);
  if (keep_load(s, name, figure, c->pair_figures)) return OPC_OK;
  int code = measure_pins(s, c, error);
  if (!code) code = measure_pairs(s, c, error);
  if (!code) keep_save(s, name, figure, c->pair_figures);
  return code;
}
