/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements the greedy search for gate lengths, with static timing analysis of
   the whole circuit after each step. */
#include "budget.h"

#include <math.h>
#include <stdlib.h>

static const double ps = 1e12;

/* ---- lists ---- */

static void list_pins(budget *b) {
  const graph *g = b->g;
  b->driver = eda_pool_alloc(&b->pool, g->nets, sizeof *b->driver);
  b->pins_of = eda_pool_alloc(&b->pool, g->nets + 2, sizeof *b->pins_of);
  for (size_t i = 0; i < g->nets; i++) b->driver[i] = -1;
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    b->driver[n->net] = (int64_t)i;
    for (size_t k = 0; k < n->cell->inputs && !n->output; k++)
      b->pins_of[n->in[k] + 2]++;
  }
  for (size_t i = 2; i < g->nets + 2; i++) b->pins_of[i] += b->pins_of[i - 1];
  b->pin = eda_pool_alloc(&b->pool, b->pins_of[g->nets + 1], sizeof *b->pin);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    for (size_t k = 0; k < n->cell->inputs && !n->output; k++)
      b->pin[b->pins_of[n->in[k] + 1]++] = (pin){(uint32_t)i, (uint32_t)k};
  }
}

static void list_nodes(budget *b) {
  const graph *g = b->g;
  b->node_of = eda_pool_alloc(&b->pool, g->instances + 2, sizeof *b->node_of);
  b->node = eda_pool_alloc(&b->pool, g->nodes, sizeof *b->node);
  for (size_t i = 0; i < g->nodes; i++) b->node_of[g->node[i].instance + 2]++;
  for (size_t i = 2; i < g->instances + 2; i++)
    b->node_of[i] += b->node_of[i - 1];
  for (size_t i = 0; i < g->nodes; i++)
    b->node[b->node_of[g->node[i].instance + 1]++] = (uint32_t)i;
}

/* ---- sizes ---- */

static void put_level(budget *b, const choice *c) {
  double *to = b->sizes.change[c->instance] + c->bundle * EDA_SIZES;
  to[EDA_SIZE_L] = to[EDA_SIZE_C] = c->length[c->level];
}

void budget_init(budget *b) {
  const graph *g = b->g;
  list_pins(b);
  list_nodes(b);
  b->sizes = (state){.name = "slack"};
  b->sizes.change =
      eda_pool_alloc(&b->pool, g->instances, sizeof *b->sizes.change);
  for (size_t i = 0; i < g->nodes; i++) {
    double **to = &b->sizes.change[g->node[i].instance];
    if (!*to)
      *to = eda_pool_alloc(&b->pool, g->node[i].cell->bundles * EDA_SIZES,
                           sizeof **to);
  }
  for (size_t i = 0; i < b->count; i++) put_level(b, &b->choice[i]);
  state_tables(g, b->at, &b->sizes);
}

void budget_clear(budget *b) {
  state_clear(&b->sizes);
  eda_pool_clear(&b->pool);
}

/* Set the level of a choice and recompute the tables of its instance and of the
   nodes that drive the instance. */
static void set_level(budget *b, choice *c, uint32_t level) {
  const graph *g = b->g;
  c->level = level;
  put_level(b, c);
  uint32_t from = b->node_of[c->instance];
  for (uint32_t i = from; i < b->node_of[c->instance + 1]; i++)
    node_tables(&g->node[b->node[i]], &b->sizes);
  const node *n = &g->node[b->node[from]];
  for (size_t k = 0; k < n->cell->inputs; k++) {
    int64_t d = b->driver[n->in[k]];
    if (d < 0) continue;
    net_loads(b->g, b->at, &b->sizes, n->in[k]);
    node_tables(&g->node[d], &b->sizes);
  }
}

double budget_leak(const budget *b) {
  double sum = 0;
  for (size_t i = 0; i < b->count; i++)
    sum += b->choice[i].leak[b->choice[i].level];
  return sum;
}

/* ---- arrivals ---- */

/* Return the end of the latest path, net * 2 + rises. */
static uint32_t latest_end(const budget *b, const arrivals *a) {
  const graph *g = b->g;
  uint32_t at = g->output[0] * 2;
  for (size_t o = 0; o < 2 * g->outputs; o++) {
    uint32_t k = g->output[o / 2] * 2 + (uint32_t)(o % 2);
    if (a->time[k] > a->time[at]) at = k;
  }
  return at;
}

double budget_worst(const budget *b) {
  eda_pool pool = {0};
  arrivals a = static_arrivals(b->g, &b->sizes, b->at.slew, &pool);
  double worst = a.time[latest_end(b, &a)];
  eda_pool_clear(&pool);
  return worst;
}

static uint32_t comes_from(const node *n, const eda_timing_arc *arc) {
  return n->in[arc->input] * 2 + !(arc->from >> arc->input & 1);
}

double *budget_slack(const budget *b) {
  const graph *g = b->g;
  eda_pool pool = {0};
  arrivals a = static_arrivals(g, &b->sizes, b->at.slew, &pool);
  double *slack = eda_alloc(2 * g->nets, sizeof *slack), delay, out;
  for (size_t i = 0; i < 2 * g->nets; i++) slack[i] = INFINITY;
  for (size_t o = 0; o < 2 * g->outputs; o++) {
    uint32_t k = g->output[o / 2] * 2 + (uint32_t)(o % 2);
    slack[k] = b->limit - a.time[k];
  }
  for (size_t i = g->nodes; i-- > 0;) {
    const node *n = &g->node[i];
    for (size_t k = 0; k < n->cell->arcs; k++) {
      const eda_timing_arc *arc = &n->cell->arc[k];
      uint32_t from = comes_from(n, arc), to = n->net * 2 + arc->rises;
      if (arc->output != n->output || isinf(a.time[from])) continue;
      arc_at(n, &b->sizes, k, a.slew[from], &delay, &out);
      double spare = a.time[to] - a.time[from] - delay;
      slack[from] = fmin(slack[from], slack[to] + spare);
    }
  }
  eda_pool_clear(&pool);
  return slack;
}

/* ---- gains on a path ---- */

/* Return the difference a - b of two delays at the input slew `slew`, ps. a and
   b are the delays at the slews of the grid, s. */
static double delay_difference(const eda_timing_cell *c, const double *a,
                               const double *b, double slew) {
  double row[EDA_TIMING_GRID], coefficient[EDA_TIMING_POWERS * EDA_TIMING_GRID];
  for (size_t i = 0; i < c->slews; i++) row[i] = a[i] - b[i];
  eda_timing_cubic(c->at_slew, row, c->slews, coefficient);
  return ps * eda_timing_cubic_at(c->at_slew, coefficient, c->slews, slew / ps);
}

static void unit_change(double *change, size_t bundle, double by) {
  change[bundle * EDA_SIZES + EDA_SIZE_L] = by;
  change[bundle * EDA_SIZES + EDA_SIZE_C] = by;
}

/* Add the derivatives of a stage's delay with respect to the lengths of the
   stage's transistors. Delays are linear in size changes (eda_timing_at). */
static void gain_of_cell(const budget *b, const node *n, size_t arc,
                         double slew, double *gain) {
  const eda_timing_cell *c = n->cell;
  const double *load =
      b->sizes.load + (n->net * 2 + c->arc[arc].rises) * EDA_CAPS;
  double drawn[EDA_TIMING_GRID], moved[EDA_TIMING_GRID], out[EDA_TIMING_GRID];
  double *change = eda_alloc(c->bundles * EDA_SIZES, sizeof *change);
  eda_timing_at(c, &c->arc[arc], load[EDA_CAP_DELAY], load[EDA_CAP_SLEW], NULL,
                drawn, out);
  for (size_t k = 0; k < c->bundles; k++) {
    unit_change(change, k, 1);
    eda_timing_at(c, &c->arc[arc], load[EDA_CAP_DELAY], load[EDA_CAP_SLEW],
                  change, moved, out);
    unit_change(change, k, 0);
    gain[b->first[n->instance] + k] += delay_difference(c, moved, drawn, slew);
  }
  free(change);
}

/* Relative load change of the finite difference, equal to the size change of
   timing.characterize. */
static const double nudge = 0.01;

/* Add the derivatives of a stage's delay with respect to the lengths of the
   transistors that load the output of the stage. */
static void gain_of_load(const budget *b, const node *n, size_t arc,
                         double slew, double *gain) {
  const eda_timing_cell *c = n->cell;
  const int rises = c->arc[arc].rises;
  const double *load =
                   b->sizes.load + (n->net * 2 + (uint32_t)rises) * EDA_CAPS,
               *change = b->sizes.change[n->instance];
  const double step = nudge * load[EDA_CAP_DELAY];
  double low[EDA_TIMING_GRID], high[EDA_TIMING_GRID], out[EDA_TIMING_GRID];
  if (!(step > 0)) return;
  eda_timing_at(c, &c->arc[arc], load[EDA_CAP_DELAY], load[EDA_CAP_SLEW],
                change, low, out);
  eda_timing_at(c, &c->arc[arc], load[EDA_CAP_DELAY] + step, load[EDA_CAP_SLEW],
                change, high, out);
  double by_load = delay_difference(c, high, low, slew) / step;
  for (uint32_t i = b->pins_of[n->net]; i < b->pins_of[n->net + 1]; i++) {
    const node *m = &b->g->node[b->pin[i].node];
    const eda_timing_cell *d = m->cell;
    double *one = eda_alloc(d->bundles * EDA_SIZES, sizeof *one);
    double drawn =
        eda_timing_capacitance(d, b->pin[i].input, rises, EDA_CAP_DELAY, NULL);
    for (size_t k = 0; k < d->bundles; k++) {
      unit_change(one, k, 1);
      double moved =
          eda_timing_capacitance(d, b->pin[i].input, rises, EDA_CAP_DELAY, one);
      unit_change(one, k, 0);
      gain[b->first[m->instance] + k] += by_load * (moved - drawn);
    }
    free(one);
  }
}

/* Return the arc with the largest delay from `from` to `to`. */
static size_t latest_arc(const budget *b, const arrivals *a, const node *n,
                         uint32_t from, uint32_t to) {
  size_t found = 0;
  double most = -INFINITY, delay, out;
  for (size_t k = 0; k < n->cell->arcs; k++) {
    const eda_timing_arc *arc = &n->cell->arc[k];
    if (arc->output != n->output || n->net * 2 + arc->rises != to ||
        comes_from(n, arc) != from)
      continue;
    arc_at(n, &b->sizes, k, a->slew[from], &delay, &out);
    if (delay > most) found = k, most = delay;
  }
  return found;
}

/* Compute the derivative of the latest path's delay with respect to the length
   of each choice, ps. The effect of slews on later stages is neglected: this
   effect is similar for all choices, and static analysis checks each step. */
static void find_gain(const budget *b, const arrivals *a, double *gain) {
  for (size_t i = 0; i < b->count; i++) gain[i] = 0;
  for (uint32_t at = latest_end(b, a); a->from[at] != UINT32_MAX;
       at = a->from[at]) {
    const node *n = &b->g->node[b->driver[at / 2]];
    uint32_t from = a->from[at];
    size_t arc = latest_arc(b, a, n, from, at);
    gain_of_cell(b, n, arc, a->slew[from], gain);
    gain_of_load(b, n, arc, a->slew[from], gain);
  }
}

/* ---- the search ---- */

/* Return the delay reduction if a choice is lowered by one level, ps. `gain` is
   the derivative of the delay with respect to ln(length). */
static double step_down(const choice *c, double gain) {
  return gain * (c->length[c->level] - c->length[c->level - 1]);
}

/* Return the choice with the largest delay reduction per added leakage if it is
   lowered by one level, or NULL if no lower level reduces the delay. speed_up
   sets the gain of a lowered choice to 0 until the gains are computed again. */
static choice *best_down(const budget *b, const double *gain) {
  choice *best = NULL;
  double most = 0;
  for (size_t i = 0; i < b->count; i++) {
    choice *c = &b->choice[i];
    if (!c->level || !(gain[i] > 0)) continue;
    double gain_per_step =
        step_down(c, gain[i]) /
        fmax(c->leak[c->level - 1] - c->leak[c->level], 1e-30);
    if (gain_per_step > most) most = gain_per_step, best = c;
  }
  return best;
}

/* Lower choices on the latest path until the estimated reduction of its delay
   is half of the excess over the limit. The caller then evaluates all paths
   again, because another path may be the latest. Return 0 if no choice can be
   lowered. */
static int speed_up(budget *b, double *gain) {
  eda_pool pool = {0};
  arrivals a = static_arrivals(b->g, &b->sizes, b->at.slew, &pool);
  double late = a.time[latest_end(b, &a)] - b->limit, won = 0;
  int any = !(late > 0);
  if (!any) find_gain(b, &a, gain);
  eda_pool_clear(&pool);
  while (late > 0 && won < late / 2) {
    choice *c = best_down(b, gain);
    if (!c) break;
    size_t i = (size_t)(c - b->choice);
    won += step_down(c, gain[i]);
    gain[i] = 0;
    set_level(b, c, c->level - 1);
    any = 1;
  }
  return any;
}

/* Lower all choices by one level. This is necessary if no choice on the latest
   path has a gain: the delay then depends on the slew of an input that is not
   on the path. Return 0 if all choices have the drawn length. */
static int all_down(budget *b) {
  int any = 0;
  for (size_t i = 0; i < b->count; i++) {
    if (!b->choice[i].level) continue;
    set_level(b, &b->choice[i], b->choice[i].level - 1);
    any = 1;
  }
  return any;
}

/* A choice to raise, and the leakage that raising by one level saves. */
typedef struct turn {
  double saves;
  size_t of;
} turn;

EDA_COMPARE_FALLING(by_saving, turn, saves, of);

/* Return 1 if the slack of a net that the instance drives is positive. */
static int has_slack(const budget *b, const choice *c, const double *slack) {
  for (uint32_t i = b->node_of[c->instance]; i < b->node_of[c->instance + 1];
       i++) {
    const uint32_t net = b->g->node[b->node[i]].net;
    if (slack[2 * net] > 0 || slack[2 * net + 1] > 0) return 1;
  }
  return 0;
}

/* Raise each choice by one level if the limit allows, in order of decreasing
   saving. Returns the number of raised choices. */
static size_t give_back(budget *b, turn *turns) {
  double *slack = budget_slack(b);
  size_t n = 0, gone = 0;
  for (size_t i = 0; i < b->count; i++) {
    const choice *c = &b->choice[i];
    if (c->level == c->most || !has_slack(b, c, slack)) continue;
    turns[n++] = (turn){c->leak[c->level] - c->leak[c->level + 1], i};
  }
  free(slack);
  if (n) qsort(turns, n, sizeof *turns, by_saving);
  for (size_t i = 0; i < n; i++) {
    choice *c = &b->choice[turns[i].of];
    set_level(b, c, c->level + 1);
    if (budget_worst(b) <= b->limit)
      gone++;
    else
      set_level(b, c, c->level - 1);
  }
  return gone;
}

int budget_spend(budget *b) {
  double *gain = eda_alloc(b->count, sizeof *gain);
  turn *turns = eda_alloc(b->count, sizeof *turns);
  for (size_t i = 0; i < b->count; i++) {
    b->choice[i].level = b->choice[i].most;
    put_level(b, &b->choice[i]);
  }
  state_clear(&b->sizes);
  state_tables(b->g, b->at, &b->sizes);
  int kept = 1;
  while (kept && budget_worst(b) > b->limit)
    kept = speed_up(b, gain) || all_down(b);
  while (kept && give_back(b, turns)) continue;
  free(gain);
  free(turns);
  return kept;
}
