/* SPDX-License-Identifier: BSD-3-Clause */
/* Implements delay tables at the loads and sizes of a state: for each arc of
   each node, cubics of the input slew. Implements static timing analysis with
   these tables. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "graph.h"

static const double ps = 1e12, fs_of_ps = 1000;

/* Tuned constants. */
static const struct {
  double slew, load;
} tuned = {
    /* Ratios of slew and load to the largest values of a table, beyond which
       delays are inaccurate. Measured for the NAND2 of flows/timing.yaml.
       Delays by tables up to 70 ps are smaller than by tables up to 280 ps: by
       6 % at 100 ps, 11 % at 140 ps. Delays by tables up to 16 and 64 fF/um
       differ by 0.2 % at 3 times the largest load of the smaller table, 0.1
       to 0.8 % at 6 times. */
    .slew = 1.1,
    .load = 10,
};

size_t arc_doubles(const eda_timing_cell *cell) {
  return ARC_PARTS * EDA_TIMING_POWERS * (cell->slews - 1);
}

/* ---- loads ---- */

static size_t place_of(uint32_t net, int rises) {
  return ((size_t)net * 2 + (size_t)rises) * EDA_CAPS;
}

/* Return the ratios of printed to drawn capacitance of pin k of the graph,
   [EDA_CAPS]. */
static double *factor_of(const state *s, size_t k, int rises) {
  return s->pins + (k * 2 + (size_t)rises) * EDA_CAPS;
}

static double pin_at(const graph *g, size_t k, uint32_t from, int cap) {
  const eda_timing_cell *c = g->node[g->pin[k].node].cell;
  size_t at = (size_t)g->pin[k].input << c->inputs | from;
  return c->pin_capacitance[at * EDA_CAPS + (size_t)cap];
}

/* Add the capacitance of pin k to the least, largest and mean load of its
   net. */
static void add_pin(const graph *g, state *s, uint32_t net, size_t k,
                    int rises) {
  const node *n = &g->node[g->pin[k].node];
  const double *change = s->change ? s->change[n->instance] : NULL;
  size_t input = g->pin[k].input, to = place_of(net, rises);
  for (int cap = 0; cap < EDA_CAPS; cap++, to++) {
    double drawn = eda_timing_capacitance(n->cell, input, rises, cap, NULL),
           mean = eda_timing_capacitance(n->cell, input, rises, cap, change),
           factor = drawn > 0 ? mean / drawn : 1, least = INFINITY,
           largest = -INFINITY;
    for (uint32_t from = 0; from >> n->cell->inputs == 0; from++) {
      if ((int)(from >> input & 1) == rises) continue;
      least = fmin(least, factor * pin_at(g, k, from, cap));
      largest = fmax(largest, factor * pin_at(g, k, from, cap));
    }
    factor_of(s, k, rises)[cap] = factor;
    s->least[to] += least;
    s->largest[to] += largest;
    s->load[to] += mean;
  }
}

void net_loads(const graph *g, conditions at, state *s, uint32_t net) {
  size_t first = place_of(net, 0), end = place_of(net + 1, 0);
  double fixed = at.wire * g->fanout[net];
  for (size_t o = 0; o < g->outputs; o++)
    if (g->output[o] == net) fixed += at.load;
  for (size_t k = first; k < end; k++)
    s->least[k] = s->largest[k] = s->load[k] = s->fixed[k] = fixed;
  for (size_t k = g->first_pin[net]; k < g->first_pin[net + 1]; k++)
    for (int rises = 0; rises < 2; rises++) add_pin(g, s, net, k, rises);
  for (size_t k = first; k < end; k++) {
    double range = s->largest[k] - s->least[k];
    s->mean[k] = range > 0 ? (s->load[k] - s->least[k]) / range : 0;
  }
}

static void find_loads(const graph *g, conditions at, state *s) {
  const size_t n = g->nets * 2 * EDA_CAPS;
  s->load = eda_alloc(5 * n, sizeof *s->load);
  s->fixed = s->load + n;
  s->least = s->fixed + n;
  s->largest = s->least + n;
  s->mean = s->largest + n;
  s->pins = eda_alloc(g->first_pin[g->nets] * 2 * EDA_CAPS, sizeof *s->pins);
  for (uint32_t net = 0; net < g->nets; net++) net_loads(g, at, s, net);
}

const double *mean_load(const state *s, uint32_t net, int rises) {
  return s->mean + place_of(net, rises);
}

void load_at(const graph *g, const state *s, uint32_t net, int rises,
             const uint32_t *from, double load[EDA_CAPS]) {
  size_t at = place_of(net, rises);
  for (int cap = 0; cap < EDA_CAPS; cap++, at++) {
    double sum = s->fixed[at], range = s->largest[at] - s->least[at];
    for (size_t k = g->first_pin[net]; k < g->first_pin[net + 1]; k++)
      sum += factor_of(s, k, rises)[cap] *
             pin_at(g, k, from[k - g->first_pin[net]], cap);
    load[cap] = range > 0 ? (sum - s->least[at]) / range : 0;
  }
}

/* ---- cubics ---- */

static void put_arc(const node *n, const state *s, size_t arc) {
  const eda_timing_cell *c = n->cell;
  const eda_timing_arc *a = &c->arc[arc];
  size_t at = place_of(n->net, a->rises);
  double part[ARC_PARTS][EDA_TIMING_GRID];
  for (int k = 0; k < 2; k++) {
    const double *load = (k ? s->largest : s->least) + at;
    eda_timing_at(c, a, load[EDA_CAP_DELAY], load[EDA_CAP_SLEW],
                  s->change ? s->change[n->instance] : NULL, part[2 * k],
                  part[2 * k + 1]);
  }
  double *to = s->table + n->table + arc * arc_doubles(c);
  for (int k = 0; k < ARC_PARTS; k++) {
    double cubic[EDA_TIMING_POWERS * EDA_TIMING_GRID];
    eda_timing_cubic(c->at_slew, part[k], c->slews, cubic);
    for (size_t i = 0; i + 1 < c->slews; i++) {
      double unit = ps;
      for (size_t power = 0; power < 4; power++, unit /= ps)
        to[(4 * i + power) * ARC_PARTS + (size_t)k] =
            cubic[4 * i + power] * unit;
    }
  }
}

void arc_loaded(const node *n, const state *s, size_t arc, double slew,
                const double load[EDA_CAPS], double *delay, double *out) {
  const eda_timing_cell *c = n->cell;
  const double *a = s->table + n->table + arc * arc_doubles(c);
  double part[ARC_PARTS];
  size_t i = 0;
  while (i + 2 < c->slews && slew > c->at_slew[i + 1] * ps) i++;
  a += EDA_TIMING_POWERS * i * ARC_PARTS;
  double t = slew - c->at_slew[i] * ps,
         h = (c->at_slew[i + 1] - c->at_slew[i]) * ps;
  /* Extrapolate linearly beyond the ends of the grid. */
  double e = t < 0 ? 0 : t > h ? h : t, over = t - e;
  for (int k = 0; k < ARC_PARTS; k++, a++) {
    const double *b = a + ARC_PARTS, *q = b + ARC_PARTS, *r = q + ARC_PARTS;
    part[k] = *a + e * (*b + e * (*q + e * *r)) +
              over * (*b + e * (2 * *q + 3 * e * *r));
  }
  *delay = part[0] + load[EDA_CAP_DELAY] * (part[2] - part[0]);
  *out = part[1] + load[EDA_CAP_SLEW] * (part[3] - part[1]);
}

void arc_at(const node *n, const state *s, size_t arc, double slew,
            double *delay, double *out) {
  arc_loaded(n, s, arc, slew, mean_load(s, n->net, n->cell->arc[arc].rises),
             delay, out);
}

/* ---- static analysis ---- */

/* The arrival of a transition is the latest of all arcs to it. The slew is the
   largest of all arcs, also of arcs that are not the latest. */
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

/* Return the largest ratio of a slew at the inputs of a node to the largest
   slew of the cell's tables. */
static double node_slew(const node *n, const arrivals *a) {
  double most = 0;
  for (size_t k = 0; k < 2 * n->cell->inputs; k++) {
    size_t at = n->in[k / 2] * 2 + k % 2;
    if (isfinite(a->time[at])) most = fmax(most, a->slew[at]);
  }
  return most / (n->cell->at_slew[n->cell->slews - 1] * ps);
}

/* Return the largest ratio of the load of a node to the largest load of the
   cell's tables. */
static double node_load(const node *n, const state *s) {
  double most = 0;
  for (size_t k = place_of(n->net, 0); k < place_of(n->net + 1, 0); k++)
    most = fmax(most, s->load[k]);
  return most / n->cell->at_load[n->cell->loads - 1];
}

void log_extrapolated(const opc_host *host, const graph *g, const state *s,
                      double slew) {
  eda_pool pool = {0};
  arrivals a = static_arrivals(g, s, slew, &pool);
  size_t beyond = 0;
  double slews = 0, loads = 0;
  for (size_t i = 0; i < g->nodes; i++) {
    double by_slew = node_slew(&g->node[i], &a),
           by_load = node_load(&g->node[i], s);
    beyond += by_slew > tuned.slew || by_load > tuned.load;
    slews = fmax(slews, by_slew);
    loads = fmax(loads, by_load);
  }
  if (beyond)
    host->log(host, OPC_LOG_FINDING,
              "delays of %zu of %zu gates are extrapolated beyond the timing "
              "tables: slews are up to %.3g times, loads up to %.3g times the "
              "largest of the tables; set larger 'slews' and 'loads' of "
              "timing.characterize",
              beyond, g->nodes, slews, loads);
  eda_pool_clear(&pool);
}

/* ---- one delay an arc ---- */

const double *one_delay(const node *n, const state *s, size_t input,
                        int rises) {
  return s->one + ((((size_t)(n - s->nodes) * EDA_TIMING_INPUTS) + input) * 2 +
                   (size_t)rises) *
                      KINDS;
}

/* Compute one delay per arc, rounded to whole fs as in SDF and Icarus Verilog,
   at least 1 fs. */
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
    all += g->node[i].cell->arcs * arc_doubles(g->node[i].cell);
  s->table = eda_alloc(all, sizeof *s->table);
  find_loads(g, at, s);
  for (size_t i = 0; i < g->nodes; i++) node_tables(&g->node[i], s);
  find_one(g, at.slew, s);
}

void state_clear(state *s) {
  free(s->table);
  free(s->one);
  free(s->load);
  free(s->pins);
  s->table = s->one = s->load = s->pins = NULL;
}
