/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes the events of all nets after an input pattern, in topological order:
   the events of a net are complete before the nodes that the net drives. Times
   in ps; with one delay per arc, whole fs. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "paths.h"

void waves_init(waves *w, const paths *p) {
  const graph *g = &p->graph;
  *w = (waves){.p = p};
  size_t most = 0;
  for (size_t i = 0; i < g->nets; i++)
    if (g->fanout[i] > most) most = g->fanout[i];
  w->pins = eda_alloc(most, sizeof *w->pins);
  w->first = eda_alloc(2 * g->nets, sizeof *w->first);
  w->last = w->first + g->nets;
  w->level = eda_alloc(g->nets + 2 * g->inputs, 1);
  w->before = w->level + g->nets;
  w->after = w->before + g->inputs;
}

void waves_clear(waves *w) {
  free(w->pins);
  free(w->first);
  free(w->level);
  free(w->event);
  free(w->change);
}

uint64_t path_on(uint64_t path, uint32_t net) {
  return (path ^ (net + 1)) * 0x100000001b3u;
}

void waves_push(waves *w, double time, double slew, uint64_t path) {
  EDA_PUSH(w->event, w->count, w->capacity, (event){time, slew, path});
}

/* ---- the inputs of a node, in the order of time ---- */

int merge_init(merge *m, const waves *w, const node *n) {
  int some = 0;
  m->w = w;
  m->n = n;
  m->now = 0;
  for (size_t i = 0; i < n->cell->inputs; i++) {
    uint32_t net = n->in[i];
    m->now |= (uint32_t)w->level[net] << i;
    m->next[i] = w->first[net];
    m->end[i] = w->last[net];
    some |= m->next[i] < m->end[i];
  }
  return some;
}

int merge_next(const merge *m, double *time) {
  int found = -1;
  *time = INFINITY;
  for (size_t i = 0; i < m->n->cell->inputs; i++)
    if (m->next[i] < m->end[i] && m->w->event[m->next[i]].time < *time) {
      *time = m->w->event[m->next[i]].time;
      found = (int)i;
    }
  return found;
}

/* ---- one delay per arc ---- */

/* Compute the events with the rules of module paths in vvp, the simulator of
   Icarus Verilog (delay.cc, vvp_fun_modpath). Simultaneous input changes have
   the smallest of their delays. Each change of the logic function schedules an
   output event. At this event, the output takes the value that the logic
   function had just before the event. */
static void by_arcs(waves *w, const node *n, const state *s) {
  const eda_timing_cell *c = n->cell;
  const uint8_t *level = c->level + ((size_t)n->output << c->inputs);
  size_t changes = 0;
  double time, now;
  merge m;
  int some = merge_init(&m, w, n);
  uint8_t value = level[m.now];
  if (!some) return;
  for (int i; (i = merge_next(&m, &time)) >= 0;) {
    uint32_t from = m.now, inputs = 0;
    for (; i >= 0 && (i = merge_next(&m, &now)) >= 0 && now == time;) {
      m.next[i]++;
      m.now ^= (uint32_t)1 << i;
      inputs |= (uint32_t)1 << i;
    }
    if (level[from] == level[m.now]) continue;
    double least = INFINITY;
    for (size_t k = 0; k < c->inputs; k++) {
      double d = one_delay(n, s, k, level[m.now])[MEAN];
      if (inputs >> k & 1 && d < least) least = d;
    }
    EDA_PUSH(w->change, changes, w->capacity_changes,
             (flip){time, time + least, level[m.now]});
  }
  flip *change = w->change;
  for (size_t left = changes; left;) {
    size_t next = changes;
    for (size_t k = 0; k < changes; k++)
      if (!isinf(change[k].fires) &&
          (next == changes || change[k].fires < change[next].fires))
        next = k;
    time = change[next].fires;
    change[next].fires = INFINITY;
    left--;
    size_t last = 0;
    for (size_t k = 0; k < changes; k++)
      if (change[k].at < time) last = k;
    if (change[last].value == value) continue;
    value = change[last].value;
    waves_push(w, time, 0, 0);
  }
}

/* ---- a pattern ---- */

/* Compute the levels of all nets before the change. */
static void find_levels(waves *w) {
  const graph *g = &w->p->graph;
  for (size_t i = 0; i < g->inputs; i++) w->level[g->input[i]] = w->before[i];
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    uint32_t now = 0;
    for (size_t k = 0; k < n->cell->inputs; k++)
      now |= (uint32_t)w->level[n->in[k]] << k;
    w->level[n->net] =
        n->cell->level[((size_t)n->output << n->cell->inputs) + now];
  }
}

void waves_run(waves *w, const state *s) {
  const paths *p = w->p;
  const graph *g = &p->graph;
  double slew = p->at.slew * 1e12;
  w->count = 0;
  memset(w->first, 0, 2 * g->nets * sizeof *w->first);
  find_levels(w);
  for (size_t i = 0; i < g->inputs; i++) {
    uint32_t net = g->input[i];
    w->first[net] = (uint32_t)w->count;
    if (w->before[i] != w->after[i]) waves_push(w, 0, slew, path_on(0, net));
    w->last[net] = (uint32_t)w->count;
  }
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    w->first[n->net] = (uint32_t)w->count;
    if (p->delays == ONE_AN_ARC)
      by_arcs(w, n, s);
    else
      waves_by_slews(w, n, s);
    w->last[n->net] = (uint32_t)w->count;
  }
}

arrival waves_arrival(const waves *w, size_t output) {
  uint32_t net = w->p->graph.output[output];
  uint32_t n = w->last[net] - w->first[net];
  if (n % 2 == 0) return (arrival){.time = (double)NAN};
  const event *e = &w->event[w->last[net] - 1];
  return (arrival){e->time, e->path};
}
