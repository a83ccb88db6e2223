/* SPDX-License-Identifier: BSD-3-Clause */
/* Derivatives of delays with respect to sizes. The derivatives of single arcs
   are differences of the tables. One pass from the outputs to the inputs
   (adjoint method) returns the gradient of a sum of delays. The gradient
   includes the effect of each size on the slews of all later gates. */
#include "gradients.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Steps of the differences: of ln of a size, and relative, of a slew. The
   tables are cubics in load and slew, so the error of a derivative is about as
   large as the step. */
static const double size_step = 1e-4, slew_step = 1e-4;

uint32_t arc_from(const node *n, size_t arc) {
  const eda_timing_arc *a = &n->cell->arc[arc];
  return n->in[a->input] * 2 + !(a->from >> a->input & 1);
}

/* ---- arcs ---- */

static int arc_occurs(const gradients *z, const node *n, size_t arc) {
  return n->cell->arc[arc].output == n->output &&
         !isinf(z->arrivals.time[arc_from(n, arc)]);
}

static void node_arcs(const gradients *z, const node *n, arc_slope *out) {
  for (size_t k = 0; k < n->cell->arcs; k++) {
    if (!arc_occurs(z, n, k)) continue;
    double slew = z->arrivals.slew[arc_from(n, k)], delay, last;
    arc_at(n, &z->state, k, slew * (1 + slew_step), &delay, &last);
    arc_at(n, &z->state, k, slew, &out[k].delay, &out[k].out);
    out[k].delay_by = (delay - out[k].delay) / (slew * slew_step);
    out[k].out_by = (last - out[k].out) / (slew * slew_step);
  }
}

/* Compute the derivatives of the arcs of node i by the sizes of one instance,
   the columns from `at` on. Return the next column. */
static size_t node_vary(gradients *z, const paths *p, size_t i,
                        const node *varied, size_t at) {
  const graph *g = z->graph;
  const node *n = &g->node[i];
  node_slopes *s = &z->node[i];
  double *change = z->state.change[varied->instance];
  int is_load = varied->instance != n->instance;
  for (size_t b = 0; b < varied->cell->bundles * EDA_SIZES; b++, at++) {
    double was = change[b];
    change[b] += size_step;
    if (is_load) net_loads(g, p->at, &z->state, n->net);
    node_tables(n, &z->state);
    s->column[at] = (uint32_t)(z->base[varied->instance] + b);
    for (size_t k = 0; k < n->cell->arcs; k++) {
      double delay, out, *by = s->by + (k * s->columns + at) * 2;
      if (!arc_occurs(z, n, k)) continue;
      arc_at(n, &z->state, k, z->arrivals.slew[arc_from(n, k)], &delay, &out);
      by[0] = (delay - s->arc[k].delay) / size_step;
      by[1] = (out - s->arc[k].out) / size_step;
    }
    change[b] = was;
  }
  if (is_load) net_loads(g, p->at, &z->state, n->net);
  node_tables(n, &z->state);
  return at;
}

/* Compute the slopes of node i. An instance with several pins on the net is
   varied once. */
static void node_slope(gradients *z, const paths *p, size_t i) {
  const graph *g = z->graph;
  const node *n = &g->node[i];
  node_slopes *s = &z->node[i];
  const plug *pin = g->pin + g->first_pin[n->net];
  size_t pins = g->first_pin[n->net + 1] - g->first_pin[n->net], at;
  s->columns = n->cell->bundles * EDA_SIZES;
  for (size_t k = 0; k < pins; k++)
    if (!k || pin[k].node != pin[k - 1].node)
      s->columns += g->node[pin[k].node].cell->bundles * EDA_SIZES;
  s->arc = eda_pool_alloc(&z->memory, n->cell->arcs, sizeof *s->arc);
  s->column = eda_pool_alloc(&z->memory, s->columns, sizeof *s->column);
  s->by =
      eda_pool_alloc(&z->memory, n->cell->arcs * s->columns * 2, sizeof *s->by);
  node_arcs(z, n, s->arc);
  at = node_vary(z, p, i, n, 0);
  for (size_t k = 0; k < pins; k++)
    if (!k || pin[k].node != pin[k - 1].node)
      at = node_vary(z, p, i, &g->node[pin[k].node], at);
  for (size_t k = 0; k < n->cell->arcs; k++) {
    uint32_t *slowest = &z->slowest[n->net * 2 + n->cell->arc[k].rises];
    if (!arc_occurs(z, n, k)) continue;
    if (*slowest == UINT32_MAX || s->arc[k].out > s->arc[*slowest].out)
      *slowest = (uint32_t)k;
  }
}

void gradients_init(gradients *z, const paths *p, const state *reference) {
  const graph *g = &p->graph;
  *z = (gradients){.graph = g};
  z->base = eda_pool_alloc(&z->memory, g->instances, sizeof *z->base);
  z->state.change =
      eda_pool_alloc(&z->memory, g->instances, sizeof *z->state.change);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    size_t own = n->cell->bundles * EDA_SIZES;
    double **change = &z->state.change[n->instance];
    if (*change) continue;
    z->base[n->instance] = z->length;
    z->length += own;
    *change = eda_pool_alloc(&z->memory, own, sizeof **change);
    if (reference->change)
      memcpy(*change, reference->change[n->instance], own * sizeof **change);
  }
  z->slowest = eda_pool_alloc(&z->memory, 2 * g->nets, sizeof *z->slowest);
  memset(z->slowest, 0xff, 2 * g->nets * sizeof *z->slowest);
  z->node = eda_pool_alloc(&z->memory, g->nodes, sizeof *z->node);
  state_tables(g, p->at, &z->state);
  z->arrivals = static_arrivals(g, &z->state, p->at.slew, &z->memory);
  for (size_t i = 0; i < g->nodes; i++) node_slope(z, p, i);
}

void gradients_clear(gradients *z) {
  state_clear(&z->state);
  eda_pool_clear(&z->memory);
}

/* ---- sums of delays ---- */

/* Add the derivatives of an arc's delay and output slew with these weights, and
   pass the derivative by the input slew on. */
static void arc_pull(const gradients *z, size_t i, size_t arc, double delay,
                     double out, double *slews, double *vector) {
  const node_slopes *s = &z->node[i];
  const double *by = s->by + arc * s->columns * 2;
  for (size_t c = 0; c < s->columns; c++)
    vector[s->column[c]] += delay * by[2 * c] + out * by[2 * c + 1];
  slews[arc_from(&z->graph->node[i], arc)] +=
      delay * s->arc[arc].delay_by + out * s->arc[arc].out_by;
}

void gradients_of(const gradients *z, const weighted_arc *arc, size_t n,
                  double *vector) {
  const graph *g = z->graph;
  double *slews = eda_alloc(2 * g->nets, sizeof *slews);
  size_t k = 0;
  for (size_t i = n ? arc->node + (size_t)1 : 0; i-- > 0;) {
    for (; k < n && arc[k].node == i; k++)
      arc_pull(z, i, arc[k].arc, arc[k].weight, 0, slews, vector);
    for (uint32_t rises = 0; rises < 2; rises++) {
      uint32_t to = g->node[i].net * 2 + rises;
      if (slews[to] != 0)
        arc_pull(z, i, z->slowest[to], 0, slews[to], slews, vector);
    }
  }
  free(slews);
}
