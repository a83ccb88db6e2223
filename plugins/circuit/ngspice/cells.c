/* SPDX-License-Identifier: BSD-3-Clause */
/* Finds memory cells in a netlist: pairs of cross-coupled inverters and the
   other transistors with a channel on their nodes. */
#include <stdlib.h>
#include <string.h>

#include "bench.h"

/* ---- halves of inverters ---- */

/* Transistor from a net to ground (n) or to the supply (p). */
typedef struct half {
  uint32_t gate, out;
  int type;
} half;

static int half_compare(const void *a, const void *b) {
  const half *p = a, *q = b;
  if (p->gate != q->gate) return p->gate < q->gate ? -1 : 1;
  if (p->out != q->out) return p->out < q->out ? -1 : 1;
  return p->type - q->type;
}

/* Return 1 if a net is the rail of transistors of a type: ground for n, supply
   for p. */
static int pulls_to(const eda_circuit *c, uint32_t net, int type) {
  return eda_circuit_role(c, net) ==
         (type == EDA_NMOS ? EDA_PIN_GROUND : EDA_PIN_SUPPLY);
}

static half *list_halves(bench *b, size_t *count) {
  const eda_circuit *c = b->circuit;
  half *list = eda_pool_alloc(&b->pool, c->count, sizeof *list);
  for (size_t i = 0; i < c->count; i++) {
    const eda_device *d = &c->device[i];
    int drain = pulls_to(c, d->drain, d->type);
    int source = pulls_to(c, d->source, d->type);
    if (drain == source) continue;
    list[(*count)++] = (half){d->gate, drain ? d->source : d->drain, d->type};
  }
  qsort(list, *count, sizeof *list, half_compare);
  return list;
}

static int halves_have_pair(const half *list, size_t n, uint32_t gate,
                            uint32_t out) {
  half n_half = {gate, out, EDA_NMOS}, p_half = {gate, out, EDA_PMOS};
  return bsearch(&n_half, list, n, sizeof *list, half_compare) &&
         bsearch(&p_half, list, n, sizeof *list, half_compare);
}

/* ---- cells ---- */

static int device_touches(const eda_device *d, uint32_t net) {
  return d->drain == net || d->source == net;
}

/* List the devices of a cell, access transistors last. */
static int list_devices(const bench *b, cell *m, opc_error *error) {
  const eda_circuit *c = b->circuit;
  m->on_ports = 1;
  for (int access = 0; access < 2; access++)
    for (size_t i = 0; i < c->count; i++) {
      const eda_device *d = &c->device[i];
      int at_q = device_touches(d, m->q), at_qb = device_touches(d, m->qb);
      if (!at_q && !at_qb) continue;
      uint32_t mine = at_q ? m->q : m->qb;
      uint32_t other = d->drain == mine ? d->source : d->drain;
      int role = eda_circuit_role(c, other);
      int is_access = d->gate != m->q && d->gate != m->qb && !is_rail(role) &&
                      !(at_q && at_qb);
      if (is_access != access) continue;
      if (m->devices == CELL_DEVICES)
        return opc_fail(error, OPC_FAILED, "circuit",
                        "the cell of '%s' and '%s' has more than %d "
                        "transistors",
                        c->net[m->q], c->net[m->qb], CELL_DEVICES);
      m->device[m->devices++] = (uint32_t)i;
      m->accesses += access;
      if (access && role < 0) m->on_ports = 0;
    }
  return OPC_OK;
}

int cells_find(bench *b, cell **out, size_t *count, opc_error *error) {
  size_t n = 0;
  half *list = list_halves(b, &n);
  *count = 0;
  *out = eda_pool_alloc(&b->pool, n, sizeof **out);
  for (size_t i = 0; i < n; i++) {
    const half *h = &list[i];
    if (h->gate >= h->out ||
        (i && h->gate == h[-1].gate && h->out == h[-1].out))
      continue;
    if (!halves_have_pair(list, n, h->gate, h->out) ||
        !halves_have_pair(list, n, h->out, h->gate))
      continue;
    cell *m = &(*out)[(*count)++];
    *m = (cell){.q = h->gate, .qb = h->out};
    if (list_devices(b, m, error)) return error->code;
  }
  return OPC_OK;
}

/* ---- loops ---- */

/* Return the representative of the part that contains a net. Nets connected by
   channels form one part. A part depends on the parts that drive the gates of
   its transistors. */
static uint32_t part_of(uint32_t *part, uint32_t net) {
  while (part[net] != net) net = part[net] = part[part[net]];
  return net;
}

static int is_driven(const bench *b, uint32_t net) {
  if (is_rail(eda_circuit_role(b->circuit, net))) return 1;
  for (size_t i = 0; i < b->inputs; i++)
    if (b->input[i] == net) return 1;
  return 0;
}

int64_t feedback_find(bench *b) {
  const eda_circuit *c = b->circuit;
  uint32_t *part = eda_pool_alloc(&b->pool, c->nets, sizeof *part);
  uint8_t *driven = eda_pool_alloc(&b->pool, c->nets, 1);
  uint8_t *done = eda_pool_alloc(&b->pool, c->nets, 1);
  uint8_t *waits = eda_pool_alloc(&b->pool, c->nets, 1);
  for (uint32_t i = 0; i < c->nets; i++) {
    part[i] = i;
    driven[i] = (uint8_t)is_driven(b, i);
  }
  for (size_t i = 0; i < c->count; i++) {
    const eda_device *d = &c->device[i];
    if (!driven[d->drain] && !driven[d->source])
      part[part_of(part, d->drain)] = part_of(part, d->source);
  }
  /* Repeatedly remove parts that depend only on removed parts. The remaining
     parts are on loops or depend on loops. */
  for (int more = 1; more;) {
    more = 0;
    memset(waits, 0, c->nets);
    for (size_t i = 0; i < c->count; i++) {
      const eda_device *d = &c->device[i];
      uint32_t end = driven[d->drain] ? d->source : d->drain;
      if (!driven[end] && !driven[d->gate] && !done[part_of(part, d->gate)])
        waits[part_of(part, end)] = 1;
    }
    for (uint32_t net = 0; net < c->nets; net++)
      if (part[net] == net && !done[net] && !waits[net]) done[net] = more = 1;
  }
  for (size_t i = 0; i < c->count; i++) {
    uint32_t net = c->device[i].gate;
    if (!driven[net] && !done[part_of(part, net)]) return net;
  }
  return -1;
}
