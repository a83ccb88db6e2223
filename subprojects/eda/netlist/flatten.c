/* SPDX-License-Identifier: BSD-3-Clause */
/* Expansion of a subcircuit hierarchy to a flat list of transistors. */
#include "netlist/lines.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MAX_DEVICES ((uint64_t)1 << 24)
enum { MAX_DEPTH = 64 };

const char *eda_netlist_where(const eda_netlist *n, const eda_element *e,
                              char *buffer, size_t capacity) {
  snprintf(buffer, capacity, "%.200s:%u", n->lines->file[e->at.file],
           e->at.line);
  return buffer;
}

int64_t eda_netlist_find(eda_netlist *n, const char *name) {
  uint32_t *at = eda_names_find(&n->subcircuit_of, name);
  if (at) return *at;
  char list[500] = "";
  size_t used = 0, i = 0;
  for (; i < n->subcircuits && used + 120 < sizeof list; i++)
    used += (size_t)snprintf(list + used, sizeof list - used, "%s'%.100s'",
                             i ? ", " : "", n->subcircuit[i].name);
  opc_fail(n->error, OPC_INVALID, "top",
           "'%.200s' has no subcircuit '%.100s'%s%s%s", n->lines->file[0], name,
           n->subcircuits ? "; it has " : "", list,
           i < n->subcircuits ? " and more" : "");
  return -1;
}

/* ---- nodes ---- */

/* Return the number of the node `name` in a subcircuit; add the node if new. */
static uint32_t node_of(eda_netlist *n, eda_subcircuit *s, eda_names *known,
                        const char *name) {
  uint32_t *at = eda_names_add(known, name);
  if (*at != UINT32_MAX) return *at;
  eda_pool_grow(&n->pool, &s->node, &s->capacity_nodes, s->nodes + 1,
                sizeof *s->node);
  s->node[s->nodes] = name;
  return *at = (uint32_t)s->nodes++;
}

static int number_nodes(eda_netlist *n, eda_subcircuit *s) {
  eda_names known = {.pool = &n->pool};
  for (size_t i = 0; i < s->ports; i++)
    if (node_of(n, s, &known, s->port[i]) != i)
      return lines_refuse(n->lines, s->at,
                          "port '%.100s' of '%.100s' is declared twice",
                          s->port[i], s->name);
  for (size_t i = 0; i < s->elements; i++) {
    eda_element *e = &s->element[i];
    e->local = eda_pool_alloc(&n->pool, e->nodes, sizeof *e->local);
    for (size_t k = 0; k < e->nodes; k++)
      e->local[k] = node_of(n, s, &known, e->node[k]);
  }
  return OPC_OK;
}

/* ---- subcircuit instances ---- */

static int has_setting(const eda_element *e, const char *name) {
  for (size_t i = 0; i < e->settings; i++)
    if (eda_same_name(e->setting[i].name, name)) return 1;
  return 0;
}

/* Return whether an X element without a subcircuit in the file is a transistor
   of a foundry kit: X d g s b MODEL w= l=. */
static int is_wrapped(const eda_element *e) {
  return e->nodes == 4 && has_setting(e, "w") && has_setting(e, "l");
}

static int prepare_call(eda_netlist *n, eda_element *e, int depth);

static int subcircuit_prepare(eda_netlist *n, uint32_t number, int depth) {
  eda_subcircuit *s = &n->subcircuit[number];
  if (s->state == 2) return OPC_OK;
  s->state = 1;
  if (number_nodes(n, s)) return n->error->code;
  eda_names seen = {.pool = &n->pool};
  for (size_t i = 0; i < s->elements; i++) {
    eda_element *e = &s->element[i];
    uint32_t *before = eda_names_add(&seen, e->name);
    if (*before != UINT32_MAX)
      return lines_refuse(n->lines, e->at,
                          "'%.100s' is already defined in line %u", e->name,
                          s->element[*before].at.line);
    *before = (uint32_t)i;
    if (!e->is_transistor && prepare_call(n, e, depth)) return n->error->code;
    s->devices += e->is_transistor ? 1 : n->subcircuit[e->child].devices;
    if (s->devices > MAX_DEVICES)
      return lines_refuse(n->lines, e->at, "more than 2^24 transistors");
  }
  s->state = 2;
  return OPC_OK;
}

static int prepare_call(eda_netlist *n, eda_element *e, int depth) {
  uint32_t *child = eda_names_find(&n->subcircuit_of, e->model);
  if (!child && is_wrapped(e)) {
    int type = netlist_type(n, e->model);
    e->is_transistor = type >= 0;
    e->type = (uint8_t)type;
    if (type >= 0) return OPC_OK;
  }
  if (!child)
    return lines_refuse(n->lines, e->model_at, "no subcircuit '%.100s'",
                        e->model);
  e->child = *child;
  eda_subcircuit *s = &n->subcircuit[*child];
  if (s->state == 1 || depth == MAX_DEPTH)
    return lines_refuse(n->lines, e->model_at,
                        s->state == 1
                            ? "subcircuit '%.100s' contains itself"
                            : "subcircuits are nested too deep at '%.100s'",
                        e->model);
  if (s->ports != e->nodes)
    return lines_refuse(n->lines, e->at,
                        "'%.100s' has %zu nodes, but '%.100s' has %zu ports",
                        e->name, e->nodes, s->name, s->ports);
  return subcircuit_prepare(n, *child, depth + 1);
}

int eda_netlist_prepare(eda_netlist *n, uint32_t top) {
  return subcircuit_prepare(n, top, 0);
}

/* ---- devices ---- */

typedef struct flattener {
  eda_netlist *n;
  eda_flat_netlist *out;
  uint32_t *global; /* net of each .global node; UINT32_MAX: not yet created */
  uint32_t ground;  /* net of node "0"; UINT32_MAX: not yet created */
} flattener;

/* Read the value of a size or multiplier, which must be above 0. If the element
   does not set `name`, *value is unchanged. */
static int look_up(eda_netlist *n, const eda_scope *in, const eda_element *e,
                   const char *name, double *value) {
  for (size_t i = 0; i < e->settings; i++) {
    if (!eda_same_name(e->setting[i].name, name)) continue;
    if (netlist_value(n, in, &e->setting[i], value)) return n->error->code;
    if (!(*value > 0))
      return lines_refuse(n->lines, e->setting[i].at,
                          "%s of '%.100s' is not above 0: '%.100s'", name,
                          e->name, e->setting[i].value);
  }
  return OPC_OK;
}

/* Read a whole number of fingers or multiples, 1 by default. Set *given if the
   element sets `name`. */
static int look_up_count(eda_netlist *n, const eda_scope *in,
                         const eda_element *e, const char *name, double *value,
                         int *given) {
  double found = NAN;
  if (look_up(n, in, e, name, &found)) return n->error->code;
  *given |= !isnan(found);
  *value = isnan(found) ? 1 : found;
  if (*value != floor(*value) || *value > 1e6)
    return lines_refuse(n->lines, e->at,
                        "%s of '%.100s' is not a whole number: %g", name,
                        e->name, *value);
  return OPC_OK;
}

static int size_device(eda_netlist *n, const eda_scope *in,
                       const eda_element *e, double multiple,
                       eda_transistor *d) {
  double w = NAN, l = NAN, m = 1, nf = 1;
  int given = multiple > 1;
  if (look_up(n, in, e, "w", &w) || look_up(n, in, e, "l", &l) ||
      look_up_count(n, in, e, "m", &m, &given) ||
      look_up_count(n, in, e, "nf", &nf, &given))
    return n->error->code;
  if (isnan(w) || isnan(l))
    return lines_refuse(n->lines, e->at, "'%.100s' has no %s", e->name,
                        isnan(w) ? "w" : "l");
  double nm = 1e9 * n->unit * n->scale;
  d->length = l * nm;
  d->width = w * nm * m * multiple;
  if (given) d->fingers = (uint32_t)fmin(m * nf * multiple, 1e6);
  return OPC_OK;
}

static uint32_t new_net(flattener *w, const char *path, const char *name) {
  eda_flat_netlist *f = w->out;
  eda_pool_grow(f->pool, &f->net, &f->capacity_nets, f->nets + 1,
                sizeof *f->net);
  f->net[f->nets] = eda_pool_path(f->pool, path, name);
  return (uint32_t)f->nets++;
}

/* Return the net of node k, which is not a port, in a subcircuit. */
static uint32_t inner_net(flattener *w, const eda_subcircuit *s, size_t k,
                          const char *path) {
  const char *name = s->node[k];
  uint32_t *shared = NULL;
  uint32_t *number = eda_names_find(&w->n->global_of, name);
  if (number) {
    shared = &w->global[*number];
    name = w->n->global[*number];
  }
  if (!strcmp(name, "0")) shared = &w->ground;
  if (!shared) return new_net(w, path, name);
  if (*shared == UINT32_MAX) *shared = new_net(w, "", name);
  return *shared;
}

static int add_device(flattener *w, const eda_scope *in, const eda_element *e,
                      const char *path, double multiple, const uint32_t *net) {
  eda_flat_netlist *f = w->out;
  eda_pool_grow(f->pool, &f->device, &f->capacity_devices, f->devices + 1,
                sizeof *f->device);
  eda_transistor *d = &f->device[f->devices++];
  *d = (eda_transistor){.from = e,
                        .name = eda_pool_path(f->pool, path, e->name),
                        .drain = net[e->local[0]],
                        .gate = net[e->local[1]],
                        .source = net[e->local[2]],
                        .bulk = net[e->local[3]]};
  return size_device(w->n, in, e, multiple, d);
}

/* Expand the elements of a subcircuit; `port` lists the nets of its ports
   (NULL: top). Skip subcircuits without transistors: only the number of
   transistors is limited, so empty subcircuits could take unlimited time. */
static int go_down(flattener *w, const eda_scope *in, const char *path,
                   double multiple, const uint32_t *port) {
  const eda_subcircuit *s = in->of;
  eda_pool *pool = w->out->pool;
  uint32_t *net = eda_pool_alloc(pool, s->nodes, sizeof *net);
  for (size_t k = 0; k < s->nodes; k++)
    net[k] = k < s->ports && port ? port[k] : inner_net(w, s, k, path);
  for (size_t i = 0; i < s->elements; i++) {
    const eda_element *e = &s->element[i];
    if (e->is_transistor) {
      if (add_device(w, in, e, path, multiple, net)) return w->n->error->code;
      continue;
    }
    double m = 1;
    int given = 0;
    if (!w->n->subcircuit[e->child].devices) continue;
    if (look_up_count(w->n, in, e, "m", &m, &given)) return w->n->error->code;
    const char *below = eda_pool_path(pool, path, e->name);
    uint32_t *outer = eda_pool_alloc(pool, e->nodes, sizeof *outer);
    for (size_t k = 0; k < e->nodes; k++) outer[k] = net[e->local[k]];
    eda_scope child = {in, &w->n->subcircuit[e->child], e};
    if (go_down(w, &child, below, multiple * m, outer))
      return w->n->error->code;
  }
  return OPC_OK;
}

/* List the ports of the top cell, then the used .global nets that are not
   ports. Fail if two nets have the same name. */
static int list_ports(flattener *w, const eda_subcircuit *s) {
  const eda_netlist *n = w->n;
  eda_flat_netlist *out = w->out;
  eda_names first = {.pool = out->pool};
  out->port =
      eda_pool_alloc(out->pool, s->ports + n->globals, sizeof *out->port);
  for (size_t i = 0; i < out->nets; i++) {
    uint32_t *at = eda_names_add(&first, out->net[i]);
    if (*at != UINT32_MAX)
      return lines_refuse(n->lines, s->at,
                          "two nets of '%.100s' have the name '%.100s'",
                          s->name, out->net[i]);
    *at = (uint32_t)i;
  }
  for (size_t i = 0; i < s->ports; i++)
    out->port[out->ports++] = *eda_names_find(&first, s->port[i]);
  for (size_t i = 0; i < n->globals; i++) {
    int is_port = 0;
    for (size_t k = 0; k < s->ports; k++)
      is_port |= eda_same_name(s->port[k], n->global[i]);
    if (w->global[i] != UINT32_MAX && !is_port)
      out->port[out->ports++] = w->global[i];
  }
  return OPC_OK;
}

int eda_netlist_flatten(eda_netlist *n, const eda_scope *top,
                        eda_flat_netlist *out) {
  flattener w = {.n = n, .out = out, .ground = UINT32_MAX};
  w.global = eda_pool_alloc(out->pool, n->globals, sizeof *w.global);
  for (size_t i = 0; i < n->globals; i++) w.global[i] = UINT32_MAX;
  int code = go_down(&w, top, "", 1, NULL);
  return code ? code : list_ports(&w, top->of);
}
