/* SPDX-License-Identifier: BSD-3-Clause */
/* What is left of the cells' tables once loads and sizes are known: of each arc
   of each node, cubics of the input's slew; and static analysis by them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "graph.h"

static const double ps = 1e12, fs_of_ps = 1000;

size_t arc_room(const eda_timing_cell *cell) {
  return ARC_PARTS * 4 * (cell->slews - 1);
}

/* ---- loads ---- */

static void find_loads(const graph *g, conditions at, state *s) {
  s->load = eda_alloc(g->nets * 2 * EDA_CAPS, sizeof *s->load);
  for (size_t k = 0; k < g->nets * 2 * EDA_CAPS; k++)
    s->load[k] = at.wire * g->fanout[k / (2 * EDA_CAPS)];
  for (size_t o = 0; o < g->outputs; o++)
    for (size_t k = 0; k < 2 * EDA_CAPS; k++)
      s->load[g->output[o] * 2 * EDA_CAPS + k] += at.load;
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    const double *change = s->change ? s->change[n->instance] : NULL;
    for (size_t in = 0; in < n->cell->inputs && !n->output; in++)
      for (int rises = 0; rises < 2; rises++)
        for (int cap = 0; cap < EDA_CAPS; cap++)
          s->load[(n->in[in] * 2 + (uint32_t)rises) * EDA_CAPS +
                  (uint32_t)cap] +=
              eda_timing_capacitance(n->cell, in, rises, cap, change);
  }
}

/* ---- cubics ---- */

static void put_arc(const node *n, const state *s, size_t arc) {
  const eda_timing_cell *c = n->cell;
  const eda_timing_arc *a = &c->arc[arc];
  const double *load = s->load + (n->net * 2 + a->rises) * EDA_CAPS;
  double part[ARC_PARTS][64];
  eda_timing_at(c, a, load[EDA_CAP_DELAY], load[EDA_CAP_SLEW],
                s->change ? s->change[n->instance] : NULL, part[0], part[1]);
  double *to = s->table + n->table + arc * arc_room(c);
  for (int k = 0; k < ARC_PARTS; k++, to += 4 * (c->slews - 1)) {
    eda_timing_cubic(c->at_slew, part[k], c->slews, to);
    for (size_t i = 0; i + 1 < c->slews; i++) {
      double unit = ps;
      for (int power = 0; power < 4; power++, unit /= ps)
        to[4 * i + (size_t)power] *= unit;
    }
  }
}

void arc_at(const node *n, const state *s, size_t arc, double slew,
            double *delay, double *out) {
  const eda_timing_cell *c = n->cell;
  const size_t room = 4 * (c->slews - 1);
  const double *table = s->table + n->table + arc * arc_room(c);
  size_t i = 0;
  while (i + 2 < c->slews && slew > c->at_slew[i + 1] * ps) i++;
  double t = slew - c->at_slew[i] * ps,
         h = (c->at_slew[i + 1] - c->at_slew[i]) * ps;
  const double *a = table + 4 * i, *b = a + room;
  if (t >= 0 && t <= h) {
    *delay = a[0] + t * (a[1] + t * (a[2] + t * a[3]));
    *out = b[0] + t * (b[1] + t * (b[2] + t * b[3]));
    return;
  }
  /* Straight on beyond the ends. */
  double e = t < 0 ? 0 : h, over = t - e;
  *delay = a[0] + e * (a[1] + e * (a[2] + e * a[3])) +
           over * (a[1] + e * (2 * a[2] + 3 * e * a[3]));
  *out = b[0] + e * (b[1] + e * (b[2] + e * b[3])) +
         over * (b[1] + e * (2 * b[2] + 3 * e * b[3]));
}

/* ---- static analysis ---- */

/* The latest of all arcs, each with the latest slew that an input has. */
arrivals static_arrivals(const graph *g, const state *s, double slew,
                         eda_pool *pool) {
  arrivals a = {eda_pool_alloc(pool, 2 * g->nets, sizeof(double)),
                eda_pool_alloc(pool, 2 * g->nets, sizeof(double)),
                eda_pool_alloc(pool, 2 * g->nets, sizeof(uint32_t))};
  for (size_t i = 0; i < 2 * g->nets; i++) {
    a.time[i] = -INFINITY;
    a.from[i] = UINT32_MAX;
  }
  for (size_t i = 0; i < 2 * g->inputs; i++) {
    uint32_t at = g->input[i / 2] * 2 + i % 2;
    a.time[at] = 0;
    a.slew[at] = slew * ps;
  }
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    for (size_t k = 0; k < n->cell->arcs; k++) {
      const eda_timing_arc *arc = &n->cell->arc[k];
      if (arc->output != n->output) continue;
      uint32_t from = n->in[arc->input] * 2 + !(arc->from >> arc->input & 1),
               to = n->net * 2 + arc->rises;
      double delay, out;
      if (isinf(a.time[from])) continue;
      arc_at(n, s, k, a.slew[from], &delay, &out);
      a.slew[to] = fmax(a.slew[to], out);
      if (!(a.time[from] + delay > a.time[to])) continue;
      a.time[to] = a.time[from] + delay;
      a.from[to] = from;
    }
  }
  return a;
}

/* ---- one delay an arc ---- */

const double *one_delay(const node *n, const state *s, size_t input,
                        int rises) {
  return s->one + ((((size_t)(n - s->nodes) * EDA_TIMING_INPUTS) + input) * 2 +
                   (size_t)rises) *
                      KINDS;
}

/* In whole fs, as SDF and Icarus Verilog have them, and no less than 1. */
static void find_one(const graph *g, double slew, state *s) {
  eda_pool pool = {0};
  arrivals a = static_arrivals(g, s, slew, &pool);
  s->nodes = g->node;
  s->one = eda_alloc(g->nodes * EDA_TIMING_INPUTS * 2 * KINDS, sizeof *s->one);
  size_t *count = eda_alloc(EDA_TIMING_INPUTS * 2, sizeof *count);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    memset(count, 0, EDA_TIMING_INPUTS * 2 * sizeof *count);
    for (size_t k = 0; k < n->cell->arcs; k++) {
      const eda_timing_arc *arc = &n->cell->arc[k];
      if (arc->output != n->output) continue;
      uint32_t from = n->in[arc->input] * 2 + !(arc->from >> arc->input & 1);
      double *one = (double *)one_delay(n, s, arc->input, arc->rises), delay,
             out;
      arc_at(n, s, k, a.slew[from], &delay, &out);
      delay = fmax(1, delay * fs_of_ps);
      size_t *c = &count[arc->input * 2 + arc->rises];
      one[LEAST] = *c ? fmin(one[LEAST], delay) : delay;
      one[LARGEST] = *c ? fmax(one[LARGEST], delay) : delay;
      one[MEAN] += (delay - one[MEAN]) / (double)++*c;
    }
    for (size_t k = 0; k < n->cell->inputs * 2; k++) {
      double *one = (double *)one_delay(n, s, k / 2, (int)(k % 2));
      for (int kind = 0; kind < KINDS; kind++)
        one[kind] = count[k] ? round(one[kind]) : (double)NAN;
    }
  }
  free(count);
  eda_pool_clear(&pool);
}

void node_tables(const node *n, const state *s) {
  for (size_t k = 0; k < n->cell->arcs; k++)
    if (n->cell->arc[k].output == n->output) put_arc(n, s, k);
}

void state_tables(const graph *g, conditions at, state *s) {
  size_t all = 0;
  for (size_t i = 0; i < g->nodes; i++)
    all += g->node[i].cell->arcs * arc_room(g->node[i].cell);
  s->table = eda_alloc(all, sizeof *s->table);
  find_loads(g, at, s);
  for (size_t i = 0; i < g->nodes; i++) node_tables(&g->node[i], s);
  find_one(g, at.slew, s);
}

void state_clear(state *s) {
  free(s->table);
  free(s->one);
  free(s->load);
  s->table = s->one = s->load = NULL;
}
