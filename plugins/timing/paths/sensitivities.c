/* SPDX-License-Identifier: BSD-3-Clause */
/* Makes the output `delays`: paths that can be the longest, and all arcs of the
   circuit, with their derivatives by the sizes of each gate of the layout. */
#include <glib.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdlib.h>
#include <string.h>

#include "gradients.h"

typedef struct sensing {
  const paths *p;
  gradients *z;
  eda_delays *out;
  critical_path *path;
  size_t *at;       /* position of each gate in a vector of changes, or
                       SIZE_MAX */
  double *weight;   /* change of the bundle for a change of the gate */
  size_t *arc_node; /* node of each arc of the output */
} sensing;

/* ---- gates ---- */

/* Find the place and weight of each gate: a bundle changes by `share` times the
   change of its device. The change of a device is the mean over its fingers,
   weighted by printed width (sizes.c). */
static int gates_place(sensing *s, opc_error *error) {
  const eda_circuit *c = s->p->circuit;
  size_t n = c->gates->count;
  place *places = graph_places(&s->p->graph, c, error);
  if (!places) return error->code;
  s->at = eda_alloc(n, sizeof *s->at);
  s->weight = eda_alloc(n, sizeof *s->weight);
  for (size_t i = 0; i < n; i++) s->at[i] = SIZE_MAX;
  for (size_t i = 0; i < c->count; i++) {
    const eda_device *d = &c->device[i];
    const eda_timing_device *t = places[i].device;
    double width = 0;
    for (uint32_t k = 0; k < d->fingers; k++)
      width += s->out->size[EDA_SIZE_W][d->finger[k]];
    for (uint32_t k = 0; k < d->fingers; k++) {
      uint32_t f = d->finger[k];
      s->at[f] = s->z->base[places[i].instance] + t->bundle * EDA_SIZES;
      s->weight[f] = t->share * s->out->size[EDA_SIZE_W][f] / width;
    }
  }
  free(places);
  return OPC_OK;
}

/* Set the reference sizes: printed if there is a mask, else drawn. */
static void sizes_refer(sensing *s) {
  const eda_gates *g = s->p->circuit->gates;
  const eda_performance *after = s->p->mask ? &s->p->mask->after : NULL;
  for (size_t i = 0; i < g->count; i++) {
    double l = after ? after->leq_ion[i] : g->length[i];
    double w = after ? after->weq[i] : g->width[i];
    s->out->size[EDA_SIZE_L][i] = l;
    s->out->size[EDA_SIZE_W][i] = w;
    s->out->size[EDA_SIZE_C][i] = after ? after->area[i] : l * w;
  }
}

/* ---- delays ---- */

static void delay_fill(sensing *s, eda_delay *d, const double *vector,
                       eda_delay_term *term) {
  for (size_t i = 0; i < s->p->circuit->gates->count; i++) {
    if (s->at[i] == SIZE_MAX) continue;
    eda_delay_term one = {.gate = (uint32_t)i};
    int some = 0;
    for (int k = 0; k < EDA_SIZES; k++) {
      one.by[k] = (float)(s->weight[i] * vector[s->at[i] + (size_t)k]);
      some |= one.by[k] != 0;
    }
    if (some) term[d->terms++] = one;
  }
}

/* Return the arcs from an input of node i to a rising or falling output, with
   the weight of a mean. */
static size_t arcs_between(const gradients *z, size_t i, size_t input,
                           int rises, weighted_arc *out) {
  const node *n = &z->graph->node[i];
  size_t count = 0;
  for (size_t k = 0; k < n->cell->arcs; k++) {
    const eda_timing_arc *a = &n->cell->arc[k];
    if (a->output == n->output && a->input == input && a->rises == rises &&
        z->node[i].arc[k].delay != 0)
      out[count++] = (weighted_arc){(uint32_t)i, (uint32_t)k, 1};
  }
  for (size_t k = 0; k < count; k++) out[k].weight = 1 / (double)count;
  return count;
}

/* Fill delay number `index`: the paths, then the arcs. */
static void delay_sense(void *data, size_t index) {
  sensing *s = data;
  const eda_delays *out = s->out;
  const gradients *z = s->z;
  double *vector = eda_alloc(z->length, sizeof *vector);
  eda_delay_term *term = eda_alloc(s->p->circuit->gates->count, sizeof *term);
  eda_delay *d;
  if (index < out->paths) {
    d = &out->path[index].delay;
    gradients_of(z, s->path[index].arc, s->path[index].arcs, vector);
  } else {
    eda_delay_arc *a = &out->arc[index - out->paths];
    size_t i = s->arc_node[index - out->paths], input = 0;
    const node *n = &z->graph->node[i];
    weighted_arc *arc = eda_alloc(n->cell->arcs, sizeof *arc);
    while (n->cell->pin[input] != a->input) input++;
    size_t count = arcs_between(z, i, input, a->rises, arc);
    d = &a->delay;
    gradients_of(z, arc, count, vector);
    free(arc);
  }
  delay_fill(s, d, vector, term);
  d->term =
      eda_alloc(d->terms, sizeof *term); /* moves to the pool at the end */
  if (d->terms) memcpy(d->term, term, d->terms * sizeof *term);
  free(term);
  free(vector);
}

static void list_paths(sensing *s) {
  eda_delays *out = s->out;
  const graph *g = s->z->graph;
  out->path = eda_pool_alloc(&out->memory, out->paths, sizeof *out->path);
  for (size_t i = 0; i < out->paths; i++) {
    const critical_path *c = &s->path[i];
    const weighted_arc *last = &c->arc[c->arcs - 1];
    const char *from = g->net[arc_from(&g->node[last->node], last->arc) / 2];
    const char *to = g->net[c->to / 2];
    out->path[i] = (eda_delay_path){
        .delay = {.time = c->time},
        .from = eda_pool_text(&out->memory, from, strlen(from)),
        .to = eda_pool_text(&out->memory, to, strlen(to)),
        .rises = c->to % 2};
  }
}

static void list_arcs(sensing *s) {
  eda_delays *out = s->out;
  const graph *g = s->z->graph;
  size_t most = 0, arcs = 0;
  for (size_t i = 0; i < g->nodes; i++) {
    most += g->node[i].cell->inputs * 2;
    arcs = MAX(arcs, g->node[i].cell->arcs);
  }
  weighted_arc *arc = eda_alloc(arcs, sizeof *arc);
  out->arc = eda_pool_alloc(&out->memory, most, sizeof *out->arc);
  s->arc_node = eda_alloc(most, sizeof *s->arc_node);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    const char *name = sdf_instance(g, n);
    for (size_t k = 0; k < 2 * n->cell->inputs; k++) {
      size_t count = arcs_between(s->z, i, k / 2, k % 2, arc);
      if (!count) continue;
      double time = 0;
      for (size_t j = 0; j < count; j++)
        time += arc[j].weight * s->z->node[i].arc[arc[j].arc].delay;
      s->arc_node[out->arcs] = i;
      out->arc[out->arcs++] = (eda_delay_arc){
          .delay = {.time = time},
          .cell = n->cell->name,
          .instance = eda_pool_text(&out->memory, name, strlen(name)),
          .input = n->cell->pin[k / 2],
          .output = n->cell->pin[n->cell->inputs + n->output],
          .rises = k % 2};
    }
  }
  free(arc);
}

static void terms_own(eda_delays *out, eda_delay *d) {
  eda_delay_term *own = eda_pool_alloc(&out->memory, d->terms, sizeof *own);
  if (d->terms) memcpy(own, d->term, d->terms * sizeof *own);
  free(d->term);
  d->term = own;
}

int delays_differentiate(paths *p, eda_delays **out, opc_error *error) {
  gradients z;
  if (!p->circuit) {
    *out = eda_delays_new(NULL);
    return OPC_OK;
  }
  sensing s = {.p = p, .z = &z, .out = eda_delays_new(p->circuit->gates)};
  double coverage;
  gradients_init(&z, p, &p->state[p->mask ? 1 : 0]);
  sizes_refer(&s);
  int code = gates_place(&s, error);
  if (!code) {
    eda_delays *d = s.out;
    d->name = eda_pool_text(&d->memory, p->graph.name, strlen(p->graph.name));
    d->supply = p->timing->supply;
    d->temperature = p->timing->temperature;
    d->drawn = worst_path(p, &p->state[0]);
    s.path = critical_find(&z, (uint64_t)p->seed, &d->paths, &coverage);
    list_paths(&s);
    list_arcs(&s);
    opc_parallel(p->host->context, d->paths + d->arcs, delay_sense, &s);
    for (size_t i = 0; i < d->paths; i++) terms_own(d, &d->path[i].delay);
    for (size_t i = 0; i < d->arcs; i++) terms_own(d, &d->arc[i].delay);
    const opc_metric_value values[] = {{"critical_paths", (double)d->paths},
                                       {"critical_coverage", 100 * coverage}};
    code = opc_put_metrics(p->host, OPC_ARRAY(values), error);
  }
  free(s.at);
  free(s.weight);
  free(s.arc_node);
  gradients_clear(&z);
  if (code)
    eda_delays_free(s.out);
  else
    *out = s.out;
  return code;
}
