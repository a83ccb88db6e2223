/* SPDX-License-Identifier: BSD-3-Clause */
/* Builds the graph of a group: bundles, nets and their names. */
#include "graph.h"

#include <glib.h>
#include <math.h>
#include <stdlib.h>

uint64_t graph_hash(const char *name) {
  return name ? eda_name_hash(name) | (uint64_t)1 << 63 : 0;
}

static int by_mark(const void *a, const void *b, void *data) {
  const uint64_t *mark = data;
  uint32_t p = *(const uint32_t *)a, q = *(const uint32_t *)b;
  if (mark[p] != mark[q]) return mark[p] < mark[q] ? -1 : 1;
  return (p > q) - (p < q);
}

void graph_sort(uint32_t *nodes, size_t n, const uint64_t *mark) {
  qsort_r(nodes, n, sizeof *nodes, by_mark, (void *)(uintptr_t)mark);
}

/* ---- places ---- */

nm_point graph_place(const graph *g, const eda_transistor *d) {
  const eda_subcircuit *s = g->group->scope->of;
  double scale = g->j->netlist.scale;
  if (*g->group->path || d->from < s->element ||
      d->from >= s->element + s->elements)
    return (nm_point){NAN, NAN};
  return (nm_point){d->from->x * scale, d->from->y * scale};
}

nm_point graph_middle(const match_task *j, uint32_t gate) {
  const eda_box *b = &j->gates->box[gate];
  return (nm_point){j->gates->grid * ((double)b->x0 + b->x1) / 2,
                    j->gates->grid * ((double)b->y0 + b->y1) / 2};
}

double graph_distance(nm_point a, nm_point b) {
  double far = hypot(a.x - b.x, a.y - b.y);
  return isnan(far) ? 0 : far;
}

/* ---- bundles ---- */

static guint hash_nets(const void *data) {
  const bundle *b = data;
  return (guint)graph_mix(graph_mix(b->gate, b->type), graph_mix(b->a, b->b));
}

static gboolean same_nets(const void *a, const void *b) {
  const bundle *p = a, *q = b;
  return p->type == q->type && p->gate == q->gate && p->a == q->a &&
         p->b == q->b;
}

/* Merge a side's transistors, each given as a bundle, into bundles in the order
   of their first members. */
static void make_bundles(match_task *j, const bundle *parts,
                         const uint32_t *member, size_t n, side *s) {
  g_autoptr(GHashTable) known = g_hash_table_new(hash_nets, same_nets);
  bundle **of = eda_pool_alloc(&j->pool, n, sizeof *of);
  s->bundle = eda_pool_alloc(&j->pool, n, sizeof *s->bundle);
  s->member = eda_pool_alloc(&j->pool, n, sizeof *s->member);
  for (size_t i = 0; i < n; i++) {
    bundle *b = of[i] = g_hash_table_lookup(known, &parts[i]);
    if (b) {
      b->width += parts[i].width;
      b->middle.x += parts[i].middle.x;
      b->middle.y += parts[i].middle.y;
    } else {
      b = of[i] = &s->bundle[s->bundles++];
      *b = parts[i];
      g_hash_table_add(known, b);
    }
    b->count++;
  }
  uint32_t end = 0;
  for (uint32_t i = 0; i < s->bundles; i++) {
    bundle *b = &s->bundle[i];
    b->first = end += b->count;
    b->middle.x /= b->count;
    b->middle.y /= b->count;
  }
  for (size_t i = n; i-- > 0;)
    s->member[--of[i]->first] = member ? member[i] : (uint32_t)i;
}

/* Return the number of a net, in the order of first use. Nets without a
   transistor are not in the graph. */
static uint32_t net_of(uint32_t *known, uint32_t net, side *s) {
  if (known[net] == UINT32_MAX) known[net] = s->nets++;
  return known[net];
}

static bundle part_at(uint32_t *known, side *s, uint32_t gate, uint32_t a,
                      uint32_t b) {
  gate = net_of(known, gate, s);
  a = net_of(known, a, s);
  b = net_of(known, b, s);
  return (bundle){.gate = gate, .a = MIN(a, b), .b = MAX(a, b)};
}

static void netlist_side(graph *g, uint32_t *known) {
  const eda_flat_netlist *f = &g->flat;
  side *s = &g->side[NETLIST];
  bundle *parts = eda_pool_alloc(&g->j->pool, f->devices, sizeof *parts);
  for (size_t i = 0; i < f->devices; i++) {
    const eda_transistor *d = &f->device[i];
    bundle *b = &parts[i];
    *b = part_at(known, s, d->gate, d->drain, d->source);
    b->type = d->from->type;
    b->length = d->length;
    b->width = d->width;
    b->middle = graph_place(g, d);
  }
  make_bundles(g->j, parts, NULL, f->devices, s);
}

static void layout_side(graph *g, uint32_t *known) {
  const eda_gates *o = g->j->gates;
  side *s = &g->side[LAYOUT];
  size_t n = g->group->gates;
  bundle *parts = eda_pool_alloc(&g->j->pool, n, sizeof *parts);
  for (size_t i = 0; i < n; i++) {
    uint32_t gate = g->group->gate[i];
    const terminals *t = &g->j->terminals[gate];
    bundle *b = &parts[i];
    *b = part_at(known, s, t->gate, t->low, t->high);
    b->type = o->type[gate];
    b->length = o->length[gate];
    b->width = o->width[gate];
    b->middle = graph_middle(g->j, gate);
  }
  make_bundles(g->j, parts, g->group->gate, n, s);
}

/* ---- names ---- */

/* Set the names of nets. Ports that both sides have are counterparts; other
   common labels are hints. `known` has the numbers of the nets of each side. */
static int name_nets(graph *g, uint32_t *const known[SIDES]) {
  match_task *j = g->j;
  eda_names net_of_name = {.pool = &j->pool};
  uint8_t *is_port = eda_pool_alloc(&j->pool, g->flat.nets, 1);
  for (size_t i = 0; i < g->flat.ports; i++) is_port[g->flat.port[i]] = 1;
  for (size_t i = 0; i < g->flat.nets; i++)
    *eda_names_add(&net_of_name, g->flat.net[i]) = (uint32_t)i;
  for (size_t i = 0; i < g->group->labels; i++) {
    const label *l = &g->group->label[i];
    uint32_t *net = eda_names_find(&net_of_name, l->text);
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
    g->links[at[a]] = (arc){b, role};
    g->links[at[b]] = (arc){a, role};
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

int graph_make(match_task *j, const region *group, graph *g) {
  *g = (graph){.j = j, .group = group};
  g->flat.pool = &j->pool;
  if (eda_netlist_flatten(&j->netlist, g->group->scope, &g->flat))
    return j->error->code;
  /* Layout nets are numbered over all groups, in the order of the gates. */
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
