/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes the output events of a node from input events with slews. The delay
   is that of the arc from the input that causes the output transition, at the
   load of the net at the time of the transition. Other inputs that change
   nearly simultaneously modify the delay. Pulses shorter than the delay are
   suppressed (inertial delay). Times in ps. */
#include <math.h>

#include "paths.h"

/* ---- a node ---- */

/* Delay and output slew of a node. */
typedef struct both {
  double delay, slew;
} both;

/* Sums of the relative effects of other inputs on the delay and slew that the
   cause (the input that switches the output) produces alone. The effects of
   inputs in series with the cause add like resistances; the effects of inputs
   in parallel add like conductances (with_others). */
typedef struct sums {
  both series, parallel;
} sums;

typedef struct gate {
  waves *w;
  const node *n;
  const state *s;
  const uint8_t *level;
  merge m;
  uint32_t seen;                 /* inputs that have changed */
  event last[EDA_TIMING_INPUTS]; /* last change of each input */
  /* Pending transition of the output: number of the causing input (-1 if no
     transition is pending) and the event of this input; input levels before the
     event; load (see load_at in graph.h); delay and slew without the effect of
     other inputs; effect of other inputs. */
  int cause;
  event by;
  uint32_t from;
  double load[EDA_CAPS];
  both alone;
  sums with;
} gate;

static int level_of(const gate *g, uint32_t inputs) { return g->level[inputs]; }

static both arc_alone(const gate *g, size_t input, uint32_t from, double slew) {
  const eda_timing_cell *c = g->n->cell;
  size_t at = ((size_t)g->n->output * c->inputs + input) << c->inputs;
  both b;
  arc_loaded(g->n, g->s, (size_t)c->arc_of[at + from], slew, g->load, &b.delay,
             &b.slew);
  return b;
}

/* ---- the load ---- */

/* Return the level of a net at a time; before its first event, the initial
   level. */
static uint32_t level_at(const waves *w, uint32_t net, double time) {
  uint32_t changes = 0;
  for (uint32_t k = w->first[net]; k < w->last[net]; k++)
    changes += w->event[k].time < time;
  return (w->level[net] + changes) & 1;
}

/* Compute the load from the input levels of the connected instances at a time.
   The net itself has the level before its change. */
static void find_load(gate *g, int rises, double time) {
  const graph *all = &g->w->p->graph;
  uint32_t net = g->n->net, first = all->first_pin[net];
  for (size_t k = first; k < all->first_pin[net + 1]; k++) {
    const node *n = &all->node[all->pin[k].node];
    uint32_t from = 0;
    for (uint32_t i = 0; i < n->cell->inputs; i++)
      from |=
          (n->in[i] == net ? (uint32_t)!rises : level_at(g->w, n->in[i], time))
          << i;
    g->w->pins[k - first] = from;
  }
  load_at(all, g->s, net, rises, g->w->pins, g->load);
}

/* ---- two inputs ---- */

/* Return the factors by which another input multiplies the delay and slew of
   the cause. Delay and slew that each produces alone: `alone` (the cause) and
   `other`. Time between both inputs, in delays: `gap`. Slews of the inputs of
   the pair, each divided by the delay of that input: `first`, `second`. If p is
   NULL, the other input only changes the path of the current. */
static both blend_factors(both alone, both other, const eda_timing_pair *p,
                          double gap, double first, double second) {
  both f = {1, 1};
  if (p) eda_timing_pair_at(p, gap, first, second, &f.delay, &f.slew);
  f.delay *= eda_timing_blend(gap, alone.delay, other.delay) / alone.delay;
  f.slew *= eda_timing_blend(gap, alone.slew, other.slew) / alone.slew;
  return f;
}

static const eda_timing_pair *find_pair(const gate *g, size_t first,
                                        size_t second, uint32_t from) {
  const eda_timing_cell *c = g->n->cell;
  size_t at = ((size_t)g->n->output * c->inputs + first) * c->inputs + second;
  int32_t k = c->pair_of[at << c->inputs | from];
  return k < 0 ? NULL : &c->pair[k];
}

/* An input that changes before the cause and forms no pair with it has an
   effect if the gap is less than 1 / fades of the delay. The value was fitted
   to simulations. */
static const double fades = 3;

/* Add the effect of an input that changed before the cause. */
static void add_earlier(gate *g, size_t k) {
  const event *e = &g->last[k];
  uint32_t from = g->from ^ 1u << k, cause = 1u << g->cause;
  double gap = (g->by.time - e->time) / g->alone.delay;
  if (level_of(g, from) != level_of(g, g->from))
    return; /* input k is not in series with the cause: alone, it would switch
               the output */
  if (!(g->alone.delay > 0)) return;
  const eda_timing_pair *p = find_pair(g, k, (size_t)g->cause, from);
  both other, f;
  if (!p && fades * gap >= 1) return;
  if (p) {
    other = arc_alone(g, k, from ^ cause, e->slew);
    if (!(other.delay > 0)) return;
    f = blend_factors(g->alone, other, p, gap, e->slew / other.delay,
                      g->by.slew / g->alone.delay);
  } else {
    if (level_of(g, from) == level_of(g, from ^ cause)) return;
    other = arc_alone(g, (size_t)g->cause, from, g->by.slew);
    f = blend_factors(g->alone, other, NULL, fades * gap, 0, 0);
  }
  g->with.series.delay += f.delay - 1;
  g->with.series.slew += f.slew - 1;
}

/* Add the effect of an input that changes after the cause and does not change
   the level to which the output switches. */
static void add_later(gate *g, size_t k, const event *e) {
  uint32_t cause = 1u << g->cause;
  double gap = (e->time - g->by.time) / g->alone.delay;
  if (!(g->alone.delay > 0) || gap > eda_timing_gap[EDA_TIMING_GAPS - 1])
    return;
  const eda_timing_pair *p = find_pair(g, (size_t)g->cause, k, g->from);
  both other, f;
  if (p) {
    other = arc_alone(g, k, g->from, e->slew);
    if (!(other.delay > 0)) return;
    f = blend_factors(g->alone, other, p, gap, g->by.slew / g->alone.delay,
                      e->slew / other.delay);
  } else {
    uint32_t from = g->from ^ 1u << k;
    if (gap >= 1 || level_of(g, from) == level_of(g, from ^ cause)) return;
    other = arc_alone(g, (size_t)g->cause, from, g->by.slew);
    f = blend_factors(g->alone, other, NULL, gap, 0, 0);
  }
  g->with.parallel.delay += 1 / f.delay - 1;
  g->with.parallel.slew += 1 / f.slew - 1;
}

static both with_others(const gate *g) {
  const sums *with = &g->with;
  return (both){
      g->alone.delay * (1 + with->series.delay) / (1 + with->parallel.delay),
      g->alone.slew * (1 + with->series.slew) / (1 + with->parallel.slew)};
}

/* ---- events of a node ---- */

/* Start a transition of the output caused by an input; later inputs may modify
   the returned event. */
static event event_start(gate *g, int cause, const event *e, uint32_t from) {
  int rises = !level_of(g, from);
  g->cause = cause;
  g->by = *e;
  g->from = from;
  g->with = (sums){0};
  const double *mean = mean_load(g->s, g->n->net, rises);
  for (int cap = 0; cap < EDA_CAPS; cap++) g->load[cap] = mean[cap];
  g->alone = arc_alone(g, (size_t)cause, from, e->slew);
  find_load(g, rises, e->time + g->alone.delay);
  g->alone = arc_alone(g, (size_t)cause, from, e->slew);
  for (size_t k = 0; k < EDA_TIMING_INPUTS; k++)
    if ((int)k != cause && g->seen >> k & 1) add_earlier(g, k);
  both b = with_others(g);
  return (event){e->time + b.delay, b.slew, path_on(e->path, g->n->net)};
}

/* Modify the pending transition for a further change of an input. */
static void event_modify(gate *g, size_t first, size_t k, const event *e) {
  waves *w = g->w;
  if (g->cause < 0 || w->count == first || g->cause == (int)k) return;
  add_later(g, k, e);
  both b = with_others(g);
  event *out = &w->event[w->count - 1];
  double earliest = w->count - 1 > first ? out[-1].time : -INFINITY;
  out->time = fmax(g->by.time + b.delay, earliest);
  out->slew = b.slew;
}

void waves_by_slews(waves *w, const node *n, const state *s) {
  gate g = {.w = w, .n = n, .s = s, .cause = -1};
  size_t first = w->count;
  double time;
  g.level = n->cell->level + ((size_t)n->output << n->cell->inputs);
  if (!merge_init(&g.m, w, n)) return;
  for (int i; (i = merge_next(&g.m, &time)) >= 0;) {
    const event e = w->event[g.m.next[i]];
    uint32_t from = g.m.now;
    g.m.next[i]++;
    g.m.now ^= (uint32_t)1 << i;
    if (g.level[from] == g.level[g.m.now]) {
      event_modify(&g, first, (size_t)i, &e);
    } else if (w->count > first && w->event[w->count - 1].time > time) {
      w->count--;
      g.cause = -1;
    } else {
      event out = event_start(&g, i, &e, from);
      if (w->count > first && out.time <= w->event[w->count - 1].time) {
        w->count--;
        g.cause = -1;
      } else {
        waves_push(w, out.time, out.slew, out.path);
      }
    }
    g.seen |= (uint32_t)1 << i;
    g.last[i] = e;
  }
}
