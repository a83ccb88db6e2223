/* SPDX-License-Identifier: BSD-3-Clause */
/* What is simulated of a cell: its arcs over the grid, again with each size of
   each transistor changed at four points of it, and its pins. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

enum {
  SOME = 64,  /* copies of a run, about: more share its steps, but wait */
  POINTS = 3, /* at which sizes are changed */
  SIDES = 4   /* patterns of the other inputs for which pins' changes are */
};

/* By how much a size is changed: a derivative of a secant of 1 % is off by 1 %
   of itself or so; the steps' noise is below that by far. */
static const double nudge = 0.01;

/* ---- decks ---- */

typedef struct plan {
  study *s;
  eda_timing_cell *cell;
  size_t count, room;
  deck *deck;
  double *unit; /* changes of one size each: [k * n + k] is the nudge */
} plan;

static deck *deck_for(plan *p, double slew, int rough, size_t need) {
  deck *last = p->count ? &p->deck[p->count - 1] : NULL;
  if (last && last->slew == slew && last->rough == rough &&
      (!last->count || last->count + need <= SOME))
    return last;
  EDA_PUSH(p->deck, p->count, p->room,
           (deck){.s = p->s, .slew = slew, .rough = rough});
  return &p->deck[p->count - 1];
}

static void add(deck *d, const copy *c) {
  EDA_PUSH(d->copy, d->count, d->room, *c);
}

static size_t changes_of(const plan *p) {
  return p->cell->bundles * (size_t)EDA_SIZES;
}

static const double *unit_of(const plan *p, size_t k) {
  return p->unit + k * changes_of(p);
}

/* Whether a change means anything: without DLC the third size has none. */
static int is_size(const plan *p, size_t k) {
  return p->s->dlc || k % EDA_SIZES != EDA_SIZE_C;
}

static copy copy_of(const eda_timing_cell *c, const eda_timing_arc *a,
                    size_t load) {
  return (copy){.cell = c,
                .from = a->from,
                .input = a->input,
                .output = a->output,
                .load = c->at_load[load]};
}

/* As drawn, in all loads at a slew. */
static void plan_grid(plan *p, size_t slew) {
  const eda_timing_cell *cell = p->cell;
  for (size_t j = 0; j < cell->loads; j++)
    for (size_t k = 0; k < cell->arcs; k++) {
      copy c = copy_of(cell, &cell->arc[k], j);
      add(deck_for(p, cell->at_slew[slew], 0, 1), &c);
    }
}

/* As drawn and with each size changed, side by side. */
static void plan_changes(plan *p, const eda_timing_arc *a, int point) {
  const eda_timing_cell *cell = p->cell;
  copy c = copy_of(cell, a, cell->near_load[point == 1]);
  size_t n = changes_of(p);
  deck *d = deck_for(p, cell->at_slew[cell->near_slew[point == 2]], 1, 1 + n);
  add(d, &c);
  for (size_t k = 0; k < n; k++) {
    if (!is_size(p, k)) continue;
    c.change = unit_of(p, k);
    add(d, &c);
  }
}

/* Where the copies are taken from again, in the same order. */
typedef struct reader {
  plan plan;
  size_t deck, at;
  const copy *base;
} reader;

static const copy *next(reader *r) {
  while (r->at == r->plan.deck[r->deck].count) {
    r->deck++;
    r->at = 0;
  }
  return &r->plan.deck[r->deck].copy[r->at++];
}

static void take_grid(reader *r, size_t slew) {
  eda_timing_cell *cell = r->plan.cell;
  for (size_t j = 0; j < cell->loads; j++)
    for (size_t k = 0; k < cell->arcs; k++) {
      const copy *c = next(r);
      cell->arc[k].delay[slew * cell->loads + j] = c->delay;
      cell->arc[k].slew[slew * cell->loads + j] = c->slew;
    }
}

static void take_changes(reader *r, eda_timing_arc *a, int point) {
  const plan *p = &r->plan;
  const size_t n = changes_of(p), at = (size_t)point * n;
  const copy *base = next(r);
  for (size_t k = 0; k < n; k++) {
    if (!is_size(p, k)) continue;
    const copy *c = next(r);
    a->delay_by[at + k] = (c->delay - base->delay) / nudge;
    a->slew_by[at + k] = (c->slew - base->slew) / nudge;
  }
}

/* ---- pins ---- */

static int is_on(const eda_timing_cell *c, size_t bundle, size_t input) {
  for (size_t i = 0; i < c->devices; i++)
    if (c->device[i].bundle == bundle)
      return c->device[i].gate == c->port[input];
  return 0;
}

/* Those patterns of the other inputs that changes of a pin are found for. */
static int is_side(const eda_timing_cell *c, size_t number) {
  size_t all = (size_t)1 << (c->inputs - 1),
         every = all > SIDES ? all / SIDES : 1;
  return number % every == 0;
}

/* Call for each change of a pin that is simulated, in order. */
static void each_pin(plan *p,
                     void (*call)(plan *p, const copy *c, size_t change)) {
  const eda_timing_cell *cell = p->cell;
  const size_t n = changes_of(p), none = SIZE_MAX;
  for (size_t i = 0; i < cell->inputs; i++)
    for (uint32_t from = 0, number[2] = {0}; from >> cell->inputs == 0;
         from++) {
      int high = from >> i & 1;
      copy c = {.cell = cell,
                .from = from,
                .input = (uint8_t)i,
                .of_pin = 1,
                .load = cell->at_load[cell->loads > 2]};
      call(p, &c, none);
      if (is_side(cell, number[high]++))
        for (size_t k = 0; k < n; k++) {
          if (!is_on(cell, k / EDA_SIZES, i) || !is_size(p, k)) continue;
          c.change = unit_of(p, k);
          call(p, &c, k);
        }
    }
}

static double pin_slew(const eda_timing_cell *c) {
  return c->at_slew[c->slews > 2 ? 1 : 0];
}

static void plan_pin(plan *p, const copy *c, size_t change) {
  (void)change;
  add(deck_for(p, pin_slew(p->cell), 0, 1), c);
}

static void take_pin(plan *p, const copy *c, size_t change) {
  reader *r = (reader *)p;
  eda_timing_cell *cell = p->cell;
  const size_t n = changes_of(p), all = (size_t)1 << (cell->inputs - 1),
               sides = all > SIDES ? SIDES : all;
  size_t at = (c->input * 2u + !(c->from >> c->input & 1)) * EDA_CAPS;
  const copy *found = next(r);
  if (change == SIZE_MAX) r->base = found;
  double *pin = cell->pin_capacitance +
                ((size_t)c->input << cell->inputs | c->from) * EDA_CAPS;
  for (size_t cap = 0; cap < EDA_CAPS; cap++, at++)
    if (change == SIZE_MAX) {
      pin[cap] = found->capacitance[cap];
      cell->capacitance[at] += pin[cap] / (double)all;
    } else
      cell->capacitance_by[at * n + change] +=
          (found->capacitance[cap] - r->base->capacitance[cap]) / nudge /
          (double)sides;
}

/* ---- a cell ---- */

static void run_deck(void *data, size_t i) {
  plan *p = data;
  deck_run(&p->deck[i]);
}

static int run_all(plan *p, opc_error *error) {
  opc_parallel(p->s->host->context, p->count, run_deck, p);
  for (size_t i = 0; i < p->count; i++) {
    p->s->simulated += p->deck[i].count;
    if (!p->deck[i].code) continue;
    *error = p->deck[i].error;
    return error->code;
  }
  return OPC_OK;
}

static void plan_clear(plan *p) {
  for (size_t i = 0; i < p->count; i++) free(p->deck[i].copy);
  free(p->deck);
  free(p->unit);
}

static void plan_all(plan *p) {
  eda_timing_cell *c = p->cell;
  for (size_t i = 0; i < c->slews; i++) plan_grid(p, i);
  for (int point = 0; point < POINTS; point++)
    for (size_t k = 0; k < c->arcs; k++) plan_changes(p, &c->arc[k], point);
  each_pin(p, plan_pin);
}

static void take_all(plan *p) {
  eda_timing_cell *c = p->cell;
  reader r = {.plan = *p};
  for (size_t i = 0; i < c->slews; i++) take_grid(&r, i);
  for (int point = 0; point < POINTS; point++)
    for (size_t k = 0; k < c->arcs; k++) take_changes(&r, &c->arc[k], point);
  each_pin(&r.plan, take_pin);
}

int cell_measure(study *s, eda_timing_cell *c, opc_error *error) {
  plan p = {.s = s, .cell = c};
  const size_t n = changes_of(&p);
  p.unit = eda_alloc(n * n, sizeof(double));
  for (size_t k = 0; k < n; k++) p.unit[k * n + k] = nudge;
  plan_all(&p);
  int code = run_all(&p, error);
  if (!code) take_all(&p);
  plan_clear(&p);
  return code ? code : pairs_measure(s, c, error);
}

/* ---- the linear model against the simulator ---- */

/* splitmix64 (Steele, Lea, Flood 2014), from 0 to 1. */
static double draw(uint64_t *state) {
  uint64_t z = (*state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Sizes within this of the drawn ones: a little more than the masks of the
   thesis's methods print. */
static const double spread = 0.03;

static size_t below(uint64_t *state, size_t n) {
  return (size_t)(draw(state) * (double)n);
}

/* Within the grid but for its first and last steps, which are for the odd case;
   all decades alike. */
static double draw_between(uint64_t *state, const double *at, size_t n) {
  double low = at[n > 3], high = at[n > 3 ? n - 2 : n - 1];
  return low * pow(high / low, draw(state));
}

/* A point between those of the grid, as drawn and with all sizes changed. */
static void plan_check(study *s, uint64_t *seed, deck *d) {
  const eda_timing *t = s->timing;
  const eda_timing_cell *c;
  do c = &t->cell[below(seed, t->count)];
  while (c->trouble);
  const eda_timing_arc *a = &c->arc[below(seed, c->arcs)];
  size_t n = c->bundles * (size_t)EDA_SIZES;
  double *change = eda_pool_alloc(&s->pool, n, sizeof *change);
  for (size_t k = 0; k < n; k++)
    if (s->dlc || k % EDA_SIZES != EDA_SIZE_C)
      change[k] = spread * (2 * draw(seed) - 1);
  double slew = draw_between(seed, c->at_slew, c->slews),
         load = draw_between(seed, c->at_load, c->loads);
  *d = (deck){.s = s, .slew = slew};
  copy k = {.cell = c,
            .from = a->from,
            .input = a->input,
            .output = a->output,
            .load = load};
  add(d, &k);
  k.change = change;
  add(d, &k);
}

static void at_point(const deck *d, const copy *k, double *delay,
                     double *slew) {
  const eda_timing_cell *c = k->cell;
  double ds[64], ss[64], cubic[4 * 64];
  size_t at = ((size_t)k->output * c->inputs + k->input) << c->inputs;
  const eda_timing_arc *a = &c->arc[c->arc_of[at + k->from]];
  eda_timing_at(c, a, k->load, k->load, k->change, ds, ss);
  eda_timing_cubic(c->at_slew, ds, c->slews, cubic);
  *delay = eda_timing_cubic_at(c->at_slew, cubic, c->slews, d->slew);
  eda_timing_cubic(c->at_slew, ss, c->slews, cubic);
  *slew = eda_timing_cubic_at(c->at_slew, cubic, c->slews, d->slew);
}

static void judge(const deck *d, verdict *v) {
  double delay[2], slew[2];
  for (int i = 0; i < 2; i++) at_point(d, &d->copy[i], &delay[i], &slew[i]);
  const copy *drawn = &d->copy[0], *other = &d->copy[1];
  double by_delay = 100 * fabs(delay[1] / other->delay - 1),
         by_slew = 100 * fabs(slew[1] / other->slew - 1),
         /* Of what the step is for: how much the delay moves, in points. */
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
  int code = run_all(&p, error);
  *out = (verdict){0};
  for (size_t i = 0; i < n && !code; i++) judge(&p.deck[i], out);
  plan_clear(&p);
  if (!out->points) return code;
  out->delay_rms = sqrt(out->delay_rms / (double)n);
  out->slew_rms = sqrt(out->slew_rms / (double)n);
  out->change_rms = sqrt(out->change_rms / (double)n);
  return code;
}
