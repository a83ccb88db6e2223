/* SPDX-License-Identifier: BSD-3-Clause */
/* Plans the simulations of a cell: arcs over the grid, changes of each relevant
   transistor size at three grid points, and pin capacitances. */
#include <eda/random.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

enum {
  SOME = 48,  /* approximate number of copies per run; more copies share time
                 steps, but take longer */
  FEW = 12,   /* a run with fewer copies also includes copies of the next load;
                 starting a run takes 20 ms */
  POINTS = 3, /* grid points at which sizes are changed */
  SIDES = 4   /* largest number of patterns of the other inputs at which size
                 changes of a pin are simulated */
};

/* Relative size change of the difference quotients. Derivatives from changes of
   1 % have errors of about 1 %; the discretization noise is far smaller. */
static const double nudge = 0.01;

static const size_t none = SIZE_MAX;

/* ---- decks ---- */

typedef struct plan {
  study *s;
  eda_timing_cell *cell;
  const circuit *circuit;
  size_t count, capacity;
  deck *deck;
  double *unit; /* n x n matrix; row k is a copy.change with only size k
                   changed, by `nudge` */
} plan;

static copy *last_copy(const plan *p) {
  const deck *d = &p->deck[p->count - 1];
  return &d->copy[d->count - 1];
}

/* Return the last deck if it has the given slew and accuracy and the direction
   of `c`, and takes `need` more copies; otherwise a new deck. */
static deck *deck_for(plan *p, double slew, care with, const copy *c,
                      size_t need) {
  int rises = !(c->from >> c->input & 1);
  deck *d = p->count ? &p->deck[p->count - 1] : NULL;
  if (d && d->slew == slew && d->rises == rises && d->care == with &&
      d->copy[0].of_pin == c->of_pin && d->count + need <= SOME &&
      (c->load == last_copy(p)->load || d->count < FEW))
    return d;
  EDA_PUSH(p->deck, p->count, p->capacity,
           (deck){.s = p->s, .slew = slew, .rises = rises, .care = with});
  return &p->deck[p->count - 1];
}

static void deck_add(deck *d, const copy *c) {
  EDA_PUSH(d->copy, d->count, d->capacity, *c);
}

static size_t changes_of(const plan *p) {
  return p->cell->bundles * (size_t)EDA_SIZES;
}

static const double *unit_of(const plan *p, size_t k) {
  return p->unit + k * changes_of(p);
}

/* Return 1 if size k has an effect. The length for the capacitance has none
   without DLC. */
static int is_size(const plan *p, size_t k) {
  return p->s->dlc || k % EDA_SIZES != EDA_SIZE_C;
}

static copy copy_of(const eda_timing_cell *c, eda_timing_arc *a, size_t slew,
                    size_t load) {
  const size_t at = slew * c->loads + load;
  return (copy){.cell = c,
                .from = a->from,
                .input = a->input,
                .output = a->output,
                .load = c->at_load[load],
                .delay = a->delay[at],
                .slew = a->slew[at],
                .arc = a,
                .point = at,
                .size = none};
}

static int input_rises(const eda_timing_arc *a) {
  return !(a->from >> a->input & 1);
}

/* Add all arcs of one direction of the input at a point of the grid. */
static void plan_point(plan *p, care with, int rises, size_t slew,
                       size_t load) {
  const eda_timing_cell *cell = p->cell;
  for (size_t k = 0; k < cell->arcs; k++) {
    if (input_rises(&cell->arc[k]) != rises) continue;
    copy c = copy_of(cell, &cell->arc[k], slew, load);
    deck_add(deck_for(p, cell->at_slew[slew], with, &c, 1), &c);
  }
}

/* ---- as drawn ---- */

/* Add runs at the smallest input slew with the smallest and the largest load.
   The results determine the durations of later runs. */
static void plan_pilot(plan *p) {
  for (int rises = 0; rises < 2; rises++) {
    plan_point(p, PILOT, rises, 0, 0);
    plan_point(p, PILOT, rises, 0, p->cell->loads - 1);
  }
}

/* Estimate delays and slews over the grid. Interpolate linearly between the
   smallest and the largest load. Per second of input slew, delays grow by
   `later` (the largest value for inverters of PTM 65 nm) and slews by `slower`
   (the smallest value). Decks have a margin, and continue if an output has not
   settled. */
static void cell_estimate(const eda_timing_cell *c) {
  const double later = 0.4, slower = 0.1;
  const size_t end = c->loads - 1;
  for (size_t k = 0; k < c->arcs; k++) {
    const eda_timing_arc *a = &c->arc[k];
    const double d0 = a->delay[0], d1 = a->delay[end], s0 = a->slew[0],
                 s1 = a->slew[end];
    for (size_t i = 0; i < c->slews; i++)
      for (size_t j = 0; j < c->loads; j++) {
        double more = c->at_slew[i] - c->at_slew[0],
               share = (c->at_load[j] - c->at_load[0]) /
                       (c->at_load[end] - c->at_load[0]);
        a->delay[i * c->loads + j] = d0 + share * (d1 - d0) + later * more;
        a->slew[i * c->loads + j] = s0 + share * (s1 - s0) + slower * more;
      }
  }
}

static void plan_grid(plan *p) {
  for (size_t i = 0; i < p->cell->slews; i++)
    for (int rises = 0; rises < 2; rises++)
      for (size_t j = 0; j < p->cell->loads; j++)
        plan_point(p, GRID, rises, i, j);
}

static void take_grid(const copy *c) {
  c->arc->delay[c->point] = c->delay;
  c->arc->slew[c->point] = c->slew;
}

/* ---- changes of single sizes ---- */

/* Add an arc as drawn and with each relevant size changed, in one deck. */
static void plan_arc(plan *p, eda_timing_arc *a, const uint8_t *sizes,
                     size_t point) {
  const eda_timing_cell *cell = p->cell;
  const size_t n = changes_of(p), slew = cell->near_slew[point == 2],
               load = cell->near_load[point == 1];
  copy c = copy_of(cell, a, slew, load);
  c.point = point;
  deck *d = deck_for(p, cell->at_slew[slew], CHANGES, &c, 1 + n);
  deck_add(d, &c);
  for (size_t k = 0; k < n; k++) {
    int of = sizes[k / EDA_SIZES];
    if (!is_size(p, k) || of == NO_SIZE ||
        (of == WIDTH_ONLY && k % EDA_SIZES != EDA_SIZE_W))
      continue;
    c.change = unit_of(p, k);
    c.size = k;
    deck_add(d, &c);
  }
}

static void plan_changes(plan *p) {
  const eda_timing_cell *cell = p->cell;
  uint8_t *sizes = eda_alloc(cell->bundles, 1);
  for (size_t point = 0; point < POINTS; point++)
    for (int rises = 0; rises < 2; rises++)
      for (size_t k = 0; k < cell->arcs; k++) {
        if (input_rises(&cell->arc[k]) != rises) continue;
        arc_sizes(cell, p->circuit, &cell->arc[k], sizes);
        plan_arc(p, &cell->arc[k], sizes, point);
      }
  free(sizes);
}

static void take_change(const plan *p, const copy *base, const copy *c) {
  if (c == base) return;
  const size_t at = c->point * changes_of(p) + c->size;
  c->arc->delay_by[at] = (c->delay - base->delay) / nudge;
  c->arc->slew_by[at] = (c->slew - base->slew) / nudge;
}

/* ---- pins ---- */

static int is_on(const plan *p, size_t bundle, size_t input) {
  return p->circuit->part[bundle].gate == p->cell->port[input];
}

/* Return the number of patterns of the other inputs of a pin. */
static size_t patterns_of(const eda_timing_cell *c) {
  return (size_t)1 << (c->inputs - 1);
}

/* Return the number of these patterns at which sizes are changed. */
static size_t sides_of(const eda_timing_cell *c) {
  return patterns_of(c) > SIDES ? SIDES : patterns_of(c);
}

/* Plan the measurement of an input pin in one direction, for all patterns of
   the other inputs. */
static void plan_pin(plan *p, size_t i, int rises) {
  const eda_timing_cell *cell = p->cell;
  const size_t n = changes_of(p), every = patterns_of(cell) / sides_of(cell);
  const double slew = cell->at_slew[cell->slews > 2 ? 1 : 0];
  size_t number = 0;
  for (uint32_t from = 0; from >> cell->inputs == 0; from++) {
    if ((from >> i & 1) == (uint32_t)rises) continue;
    copy c = {.cell = cell,
              .from = from,
              .input = (uint8_t)i,
              .of_pin = 1,
              .load = cell->at_load[cell->loads > 2],
              .size = none};
    deck_add(deck_for(p, slew, GRID, &c, 1), &c);
    if (number++ % every) continue;
    for (size_t k = 0; k < n; k++) {
      if (!is_on(p, k / EDA_SIZES, i) || !is_size(p, k)) continue;
      c.change = unit_of(p, k);
      c.size = k;
      deck_add(deck_for(p, slew, GRID, &c, 1), &c);
    }
  }
}

static void plan_pins(plan *p) {
  for (int rises = 0; rises < 2; rises++)
    for (size_t i = 0; i < p->cell->inputs; i++) plan_pin(p, i, rises);
}

static void take_pin(const plan *p, const copy *base, const copy *c) {
  const eda_timing_cell *cell = p->cell;
  const size_t n = changes_of(p);
  size_t at = (c->input * 2u + !(c->from >> c->input & 1)) * EDA_CAPS;
  for (size_t cap = 0; cap < EDA_CAPS; cap++, at++)
    if (c == base)
      cell->capacitance[at] += c->capacitance[cap] / (double)patterns_of(cell);
    else
      cell->capacitance_by[at * n + c->size] +=
          (c->capacitance[cap] - base->capacitance[cap]) / nudge /
          (double)sides_of(cell);
}

/* ---- a cell ---- */

static void take_all(const plan *p) {
  const copy *base = NULL;
  for (size_t i = 0; i < p->count; i++)
    for (size_t k = 0; k < p->deck[i].count; k++) {
      const copy *c = &p->deck[i].copy[k];
      if (c->size == none) base = c;
      if (c->of_pin)
        take_pin(p, base, c);
      else if (p->deck[i].care == CHANGES)
        take_change(p, base, c);
      else
        take_grid(c);
    }
}

/* Run the planned decks and store their results. */
static int plan_settle(plan *p, opc_error *error) {
  int code = decks_run(p->s, p->deck, p->count, error);
  if (!code) take_all(p);
  decks_clear(p->deck, &p->count);
  return code;
}

int cell_measure(study *s, eda_timing_cell *c, opc_error *error) {
  plan p = {.s = s, .cell = c, .circuit = circuit_of(s, c)};
  const size_t n = changes_of(&p);
  p.unit = eda_alloc(n * n, sizeof(double));
  for (size_t k = 0; k < n; k++) p.unit[k * n + k] = nudge;
  plan_pilot(&p);
  int code = plan_settle(&p, error);
  if (!code) {
    cell_estimate(c);
    plan_grid(&p);
    plan_pins(&p);
    code = plan_settle(&p, error);
  }
  if (!code) {
    plan_changes(&p);
    code = plan_settle(&p, error);
  }
  free(p.deck);
  free(p.unit);
  return code;
}

/* ---- the linear model against the simulator ---- */

/* Largest random size change, slightly more than the size deviations after a
   correction by the methods of the thesis. */
static const double spread = 0.03;

static size_t random_below(uint64_t *state, size_t n) {
  return (size_t)(eda_random_unit(state) * (double)n);
}

/* Return a random value with uniform logarithm between the second and the last
   but one grid value. The outermost grid steps serve rare cases. */
static double draw_between(uint64_t *state, const double *at, size_t n) {
  double low = at[n > 3], high = at[n > 3 ? n - 2 : n - 1];
  return low * pow(high / low, eda_random_unit(state));
}

static void at_point(const deck *d, const copy *k, double *delay,
                     double *slew) {
  const eda_timing_cell *c = k->cell;
  double ds[EDA_TIMING_GRID], ss[EDA_TIMING_GRID],
      cubic[EDA_TIMING_POWERS * EDA_TIMING_GRID];
  size_t at = ((size_t)k->output * c->inputs + k->input) << c->inputs;
  const eda_timing_arc *a = &c->arc[c->arc_of[at + k->from]];
  eda_timing_at(c, a, k->load, k->load, k->change, ds, ss);
  eda_timing_cubic(c->at_slew, ds, c->slews, cubic);
  *delay = eda_timing_cubic_at(c->at_slew, cubic, c->slews, d->slew);
  eda_timing_cubic(c->at_slew, ss, c->slews, cubic);
  *slew = eda_timing_cubic_at(c->at_slew, cubic, c->slews, d->slew);
}

/* Make a deck with two copies of a random arc at a random slew and load, one as
   drawn and one with all sizes changed. */
static void plan_check(study *s, uint64_t *seed, deck *d) {
  const eda_timing *t = s->timing;
  const eda_timing_cell *c;
  do c = &t->cell[random_below(seed, t->count)];
  while (c->trouble);
  const eda_timing_arc *a = &c->arc[random_below(seed, c->arcs)];
  size_t n = c->bundles * (size_t)EDA_SIZES;
  double *change = eda_pool_alloc(&s->pool, n, sizeof *change);
  for (size_t k = 0; k < n; k++)
    if (s->dlc || k % EDA_SIZES != EDA_SIZE_C)
      change[k] = spread * (2 * eda_random_unit(seed) - 1);
  double slew = draw_between(seed, c->at_slew, c->slews),
         load = draw_between(seed, c->at_load, c->loads);
  copy k = {.cell = c,
            .from = a->from,
            .input = a->input,
            .output = a->output,
            .load = load};
  *d = (deck){.s = s, .slew = slew, .rises = input_rises(a), .care = JUDGE};
  for (int changed = 0; changed < 2; changed++) {
    k.change = changed ? change : NULL;
    at_point(d, &k, &k.delay, &k.slew);
    deck_add(d, &k);
  }
}

static void deck_judge(const deck *d, verdict *v) {
  double delay[2], slew[2];
  for (int i = 0; i < 2; i++) at_point(d, &d->copy[i], &delay[i], &slew[i]);
  const copy *drawn = &d->copy[0], *other = &d->copy[1];
  double by_delay = 100 * fabs(delay[1] / other->delay - 1),
         by_slew = 100 * fabs(slew[1] / other->slew - 1),
         /* Error of the delay change, in percentage points of the delay. */
      change = 100 * ((delay[1] - delay[0]) - (other->delay - drawn->delay)) /
               drawn->delay;
  v->delay_rms += by_delay * by_delay;
  v->slew_rms += by_slew * by_slew;
  v->change_rms += change * change;
  v->delay_max = fmax(v->delay_max, by_delay);
  v->slew_max = fmax(v->slew_max, by_slew);
  v->points++;
}

int cells_check(study *s, verdict *out, opc_error *error) {
  const size_t n = (size_t)s->checks;
  uint64_t seed = (uint64_t)s->seed;
  plan p = {.s = s, .count = n, .deck = eda_alloc(n, sizeof(deck))};
  for (size_t i = 0; i < n; i++) plan_check(s, &seed, &p.deck[i]);
  int code = decks_run(s, p.deck, p.count, error);
  *out = (verdict){0};
  for (size_t i = 0; i < n && !code; i++) deck_judge(&p.deck[i], out);
  decks_clear(p.deck, &p.count);
  free(p.deck);
  if (!out->points) return code;
  out->delay_rms = sqrt(out->delay_rms / (double)n);
  out->slew_rms = sqrt(out->slew_rms / (double)n);
  out->change_rms = sqrt(out->change_rms / (double)n);
  return code;
}
