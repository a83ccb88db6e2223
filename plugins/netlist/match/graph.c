/* SPDX-License-Identifier: BSD-3-Clause */
/* The graph of a group: bundles, nets and their names. */
#include "graph.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

uint64_t graph_hash(const char *name) {
  uint64_t h = 14695981039346656037u;
  if (!name) return 0;
  for (; *name; name++)
    h = (h ^ (uint64_t)tolower((unsigned char)*name)) * 1099511628211u;
  return h | (uint64_t)1 << 63;
}

/* ---- bundles ---- */

/* A transistor of either side. */
typedef struct part {
  bundle as; /* a bundle of itself */
  uint32_t member;
} part;

static int by_nets(const void *a, const void *b) {
  const part *p = a, *q = b;
  if (p->as.type != q->as.type) return p->as.type < q->as.type ? -1 : 1;
  if (p->as.gate != q->as.gate) return p->as.gate < q->as.gate ? -1 : 1;
  if (p->as.a != q->as.a) return p->as.a < q->as.a ? -1 : 1;
  if (p->as.b != q->as.b) return p->as.b < q->as.b ? -1 : 1;
  return (p->member > q->member) - (p->member < q->member);
}

static int by_first_member(const void *a, const void *b, void *data) {
  const uint32_t *member = data;
  uint32_t p = member[((const bundle *)a)->first],
           q = member[((const bundle *)b)->first];
  return (p > q) - (p < q);
}

/* Bundles come in the order of their first members. */
static void make_bundles(job *j, part *parts, size_t n, side *s) {
  s->bundle = eda_pool_alloc(&j->pool, n, sizeof *s->bundle);
  s->member = eda_pool_alloc(&j->pool, n, sizeof *s->member);
  qsort(parts, n, sizeof *parts, by_nets);
  for (size_t i = 0; i < n; i++) {
    const bundle *as = &parts[i].as;
    s->member[i] = parts[i].member;
    bundle *b = i ? &s->bundle[s->bundles - 1] : NULL;
    if (!b || b->type != as->type || b->gate != as->gate || b->a != as->a ||
        b->b != as->b) {
      b = &s->bundle[s->bundles++];
      *b = *as;
      b->first = (uint32_t)i;
      b->count = 0;
      b->width = b->x = b->y = 0;
    }
    b->count++;
    b->width += as->width;
    b->x += as->x;
    b->y += as->y;
  }
  for (uint32_t i = 0; i < s->bundles; i++) {
    s->bundle[i].x /= s->bundle[i].count;
    s->bundle[i].y /= s->bundle[i].count;
  }
  qsort_r(s->bundle, s->bundles, sizeof *s->bundle, by_first_member, s->member);
}

static void order_nets(bundle *b) {
  if (b->a <= b->b) return;
  uint32_t a = b->a;
  b->a = b->b;
  b->b = a;
}

/* Number nets as they come; those without a transistor are not in the graph. */
static uint32_t net_of(uint32_t *known, uint32_t net, side *s) {
  if (known[net] == UINT32_MAX) known[net] = s->nets++;
  return known[net];
}

nm_point graph_place(const graph *g, const eda_transistor *d) {
  const eda_subcircuit *s = g->group->scope->of;
  double scale = g->j->netlist.scale;
  if (*g->group->path || d->from < s->element ||
      d->from >= s->element + s->elements)
    return (nm_point){NAN, NAN};
  return (nm_point){d->from->x * scale, d->from->y * scale};
}

static void netlist_side(graph *g, uint32_t *known) {
  job *j = g->j;
  const eda_flat_netlist *f = &g->flat;
  side *s = &g->side[NETLIST];
  part *parts = eda_pool_alloc(&j->pool, f->devices, sizeof *parts);
  for (size_t i = 0; i < f->devices; i++) {
    const eda_transistor *d = &f->device[i];
    nm_point at = graph_place(g, d);
    bundle b = {.gate = net_of(known, d->gate, s),
                .a = net_of(known, d->drain, s),
                .b = net_of(known, d->source, s),
                .type = d->from->type,
                .length = d->length,
                .width = d->width,
                .x = at.x,
                .y = at.y};
    order_nets(&b);
    parts[i] = (part){b, (uint32_t)i};
  }
  make_bundles(j, parts, f->devices, s);
}

static void layout_side(graph *g, uint32_t *known) {
  job *j = g->j;
  const uint32_t *gates = g->group->gate;
  size_t n = g->group->gates;
  const eda_gates *o = j->gates;
  side *s = &g->side[LAYOUT];
  part *parts = eda_pool_alloc(&j->pool, n, sizeof *parts);
  for (size_t i = 0; i < n; i++) {
    const terminals *t = &j->terminals[gates[i]];
    const eda_box *box = &o->box[gates[i]];
    bundle b = {.gate = net_of(known, t->gate, s),
                .a = net_of(known, t->low, s),
                .b = net_of(known, t->high, s),
                .type = o->type[gates[i]],
                .length = o->length[gates[i]],
                .width = o->width[gates[i]],
                .x = o->grid * ((double)box->x0 + box->x1) / 2,
                .y = o->grid * ((double)box->y0 + box->y1) / 2};
    order_nets(&b);
    parts[i] = (part){b, gates[i]};
  }
  make_bundles(j, parts, n, s);
}

/* ---- names ---- */

/* Labels come group by group. */
static size_t first_label(const job *j, uint32_t number) {
  size_t low = 0, high = j->labels;
  while (low < high) {
    size_t middle = low + (high - low) / 2;
    if (j->label[middle].group < number)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Ports that both sides have are each other's counterpart; other labels are a
   hint. `known`: the numbers of the nets of each side. */
static int name_nets(graph *g, uint32_t *const known[SIDES]) {
  job *j = g->j;
  eda_names net_of_name = {.pool = &j->pool};
  uint8_t *is_port = eda_pool_alloc(&j->pool, g->flat.nets, 1);
  for (size_t i = 0; i < g->flat.ports; i++) is_port[g->flat.port[i]] = 1;
  for (size_t i = 0; i < g->flat.nets; i++)
    *eda_names_add(&net_of_name, g->flat.net[i]) = (uint32_t)i;
  for (size_t i = first_label(j, g->number);
       i < j->labels && j->label[i].group == g->number; i++) {
    const label *l = &j->label[i];
    uint32_t *net = eda_names_find(&net_of_name, l->text, strlen(l->text));
    if (!net || l->net == UINT32_MAX || known[LAYOUT][l->net] == UINT32_MAX ||
        known[NETLIST][*net] == UINT32_MAX)
      continue;
    const char *name = g->flat.net[*net];
    uint32_t n = known[NETLIST][*net], m = known[LAYOUT][l->net];
    side *a = &g->side[NETLIST], *b = &g->side[LAYOUT];
    if (!is_port[*net]) {
      if (!b->name[m]) a->name[n] = b->name[m] = name;
      continue;
    }
    if (b->seed[m] && b->seed[m] != name)
      return opc_fail(j->error, OPC_INVALID, "file",
                           "ports '%.100s' and '%.100s' of '%.100s' are one "
                           "net in the layout",
                           b->seed[m], name, g->group->scope->of->name);
    a->seed[n] = b->seed[m] = name;
  }
  return OPC_OK;
}

/* ---- links ---- */

static void put_link(graph *g, uint32_t *at, uint32_t a, uint32_t b,
                     uint32_t role) {
  if (g->links) {
    g->links[at[a]] = (link){b, role};
    g->links[at[b]] = (link){a, role};
  }
  at[a]++;
  at[b]++;
}

static void put_links(graph *g, uint32_t *at) {
  for (int s = 0; s < SIDES; s++)
    for (uint32_t i = 0; i < g->side[s].bundles; i++) {
      const bundle *b = &g->side[s].bundle[i];
      uint32_t node = g->bundle0[s] + i, net0 = g->net0[s];
      put_link(g, at, node, net0 + b->gate, 1);
      put_link(g, at, node, net0 + b->a, 2);
      put_link(g, at, node, net0 + b->b, 2);
    }
}

static void make_links(graph *g) {
  eda_pool *m = &g->j->pool;
  const side *n = &g->side[NETLIST], *l = &g->side[LAYOUT];
  g->net0[LAYOUT] = n->nets;
  g->bundle0[NETLIST] = n->nets + l->nets;
  g->bundle0[LAYOUT] = g->bundle0[NETLIST] + n->bundles;
  g->nodes = g->bundle0[LAYOUT] + l->bundles;
  uint32_t *at = eda_pool_alloc(m, g->nodes + 1, sizeof *at);
  g->start = eda_pool_alloc(m, g->nodes + 1, sizeof *g->start);
  put_links(g, at);
  for (uint32_t i = 0; i < g->nodes; i++) {
    g->start[i + 1] = g->start[i] + at[i];
    at[i] = g->start[i];
  }
  g->links = eda_pool_alloc(m, g->start[g->nodes], sizeof *g->links);
  put_links(g, at);
}

int graph_make(job *j, uint32_t number, graph *g) {
  *g = (graph){.j = j, .group = &j->group[number], .number = number};
  g->flat.pool = &j->pool;
  if (eda_netlist_flatten(&j->netlist, g->group->scope, &g->flat))
    return j->error->code;
  /* Layout nets are numbered over all groups, gate by gate. */
  uint32_t *known[SIDES] = {match_unknown(j, g->flat.nets), j->known};
  netlist_side(g, known[NETLIST]);
  layout_side(g, known[LAYOUT]);
  for (int s = 0; s < SIDES; s++) {
    g->side[s].seed = eda_pool_alloc(&j->pool, g->side[s].nets, sizeof(char *));
    g->side[s].name = eda_pool_alloc(&j->pool, g->side[s].nets, sizeof(char *));
  }
  if (name_nets(g, known)) return j->error->code;
  make_links(g);
  return OPC_OK;
}
