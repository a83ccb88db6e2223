/* SPDX-License-Identifier: BSD-3-Clause */
/* Converts a subcircuit to a cell: pins, logic function and arcs. The logic
   function is derived from transistors as switches that are open, closed or
   unknown. */
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

/* ---- transistors ---- */

static char *own_text(study *s, const char *text) {
  return eda_pool_text(&s->timing->memory, text, strlen(text));
}

static void take_devices(study *s, const eda_flat_netlist *flat,
                         eda_timing_cell *c) {
  c->devices = flat->devices;
  c->device = eda_pool_alloc(&s->timing->memory, c->devices, sizeof *c->device);
  for (size_t i = 0; i < c->devices; i++) {
    const eda_transistor *t = &flat->device[i];
    eda_timing_device *d = &c->device[i];
    *d = (eda_timing_device){.name = own_text(s, t->name),
                             .type = t->from->type,
                             .drain = t->drain,
                             .gate = t->gate,
                             .source = t->source,
                             .bulk = t->bulk,
                             .length = t->length,
                             .width = t->width};
  }
}

/* ---- pins ---- */

static void take_rails(study *s, const eda_flat_netlist *flat,
                       eda_timing_cell *c) {
  c->nets = flat->nets;
  c->rail = eda_pool_alloc(&s->timing->memory, c->nets, 1);
  for (size_t i = 0; i < c->nets; i++)
    c->rail[i] = (int8_t)(eda_in_list(s->supplies, flat->net[i]) -
                          eda_in_list(s->grounds, flat->net[i]));
}

static int cell_touches(const eda_timing_cell *c, uint32_t net, int channel) {
  for (size_t i = 0; i < c->devices; i++) {
    const eda_timing_device *d = &c->device[i];
    if (channel ? d->drain == net || d->source == net : d->gate == net)
      return 1;
  }
  return 0;
}

static const char *take_pins(study *s, const eda_flat_netlist *flat,
                             eda_timing_cell *c) {
  eda_pool *pool = &s->timing->memory;
  int has[3] = {0}; /* ground, other, supply */
  c->pin = eda_pool_alloc(pool, flat->ports, sizeof *c->pin);
  c->port = eda_pool_alloc(pool, flat->ports, sizeof *c->port);
  for (int outputs = 0; outputs < 2; outputs++)
    for (size_t i = 0; i < flat->ports; i++) {
      uint32_t net = flat->port[i];
      has[c->rail[net] + 1] = 1;
      if (c->rail[net] || cell_touches(c, net, 1) != outputs) continue;
      if (!outputs && !cell_touches(c, net, 0)) continue;
      c->pin[c->inputs + c->outputs] = own_text(s, flat->net[net]);
      c->port[c->inputs + c->outputs] = net;
      if (outputs)
        c->outputs++;
      else
        c->inputs++;
    }
  if (!has[0] || !has[2]) return "the cell has no supply or no ground";
  if (!c->inputs || !c->outputs) return "the cell has no input or no output";
  if (c->inputs > EDA_TIMING_INPUTS) return "the cell has too many inputs";
  return NULL;
}

/* ---- logic ---- */

/* Flags of each net: by[level][0][net] is 1 if channels that certainly conduct
   connect the net to `level`; by[level][1][net] is 1 if channels that conduct
   or may conduct do. */
typedef struct reach {
  uint8_t *by[2][2];
} reach;

static int device_conducts(const eda_timing_device *d, const uint8_t *value) {
  int gate = value[d->gate];
  if (gate == UNKNOWN) return UNKNOWN;
  return d->type == EDA_NMOS ? gate : !gate;
}

/* Propagate the state of one end of a channel to the other, unless fixed.
   Returns 1 if anything changed. */
static int state_propagate(uint8_t *held, const uint8_t *fixed, uint32_t a,
                           uint32_t b) {
  int news = 0;
  if (held[a] && !held[b] && !fixed[b]) news = held[b] = 1;
  if (held[b] && !held[a] && !fixed[a]) news = held[a] = 1;
  return news;
}

static void state_settle(const eda_timing_cell *c, const uint8_t *fixed,
                         const uint8_t *value, reach *r) {
  for (int news = 1; news;) {
    news = 0;
    for (size_t i = 0; i < c->devices; i++) {
      const eda_timing_device *d = &c->device[i];
      int on = device_conducts(d, value);
      for (int level = 0; level < 2 && on; level++)
        for (int perhaps = on == UNKNOWN; perhaps < 2; perhaps++)
          news |= state_propagate(r->by[level][perhaps], fixed, d->drain,
                                  d->source);
    }
  }
}

/* Compute the levels of all nets from the `fixed` ones. */
static void cell_evaluate(const eda_timing_cell *c, const uint8_t *fixed,
                          uint8_t *value) {
  const size_t n = c->nets;
  uint8_t *all = eda_alloc(4 * n, 1);
  reach r = {{{all, all + n}, {all + 2 * n, all + 3 * n}}};
  for (int news = 1; news;) {
    news = 0;
    memset(all, 0, 4 * n);
    for (size_t i = 0; i < n; i++)
      if (fixed[i]) r.by[value[i]][0][i] = r.by[value[i]][1][i] = 1;
    state_settle(c, fixed, value, &r);
    for (size_t i = 0; i < n; i++) {
      if (fixed[i] || value[i] != UNKNOWN) continue;
      for (int level = 0; level < 2; level++)
        if (r.by[level][0][i] && !r.by[!level][1][i]) {
          value[i] = (uint8_t)level;
          news = 1;
        }
    }
  }
  free(all);
}

void cell_levels(const eda_timing_cell *c, size_t pattern, uint8_t *fixed,
                 uint8_t *value) {
  memset(fixed, 0, c->nets);
  memset(value, UNKNOWN, c->nets);
  for (size_t i = 0; i < c->nets; i++) {
    if (!c->rail[i]) continue;
    fixed[i] = 1;
    value[i] = c->rail[i] > 0 ? HIGH : LOW;
  }
  for (size_t i = 0; i < c->inputs; i++) {
    fixed[c->port[i]] = 1;
    value[c->port[i]] = pattern >> i & 1;
  }
  cell_evaluate(c, fixed, value);
}

static const char *find_levels(study *s, eda_timing_cell *c) {
  const size_t patterns = (size_t)1 << c->inputs;
  const char *trouble = NULL;
  uint8_t *fixed = eda_alloc(2 * c->nets, 1), *value = fixed + c->nets;
  c->level = eda_pool_alloc(&s->timing->memory, c->outputs * patterns, 1);
  for (size_t p = 0; p < patterns && !trouble; p++) {
    cell_levels(c, p, fixed, value);
    for (size_t o = 0; o < c->outputs; o++) {
      uint8_t v = value[c->port[c->inputs + o]];
      if (v == UNKNOWN) trouble = "the cell is sequential, or an output floats";
      c->level[o * patterns + p] = v;
    }
  }
  free(fixed);
  return trouble;
}

/* ---- arcs ---- */

static void list_arcs(study *s, eda_timing_cell *c) {
  eda_pool *pool = &s->timing->memory;
  const size_t patterns = (size_t)1 << c->inputs,
               most = c->outputs * c->inputs * patterns;
  c->arc = eda_pool_alloc(pool, most, sizeof *c->arc);
  c->arc_of = eda_pool_alloc(pool, most, sizeof *c->arc_of);
  for (size_t k = 0; k < most; k++) {
    size_t from = k % patterns, i = k / patterns % c->inputs,
           o = k / patterns / c->inputs;
    const uint8_t *level = c->level + o * patterns;
    uint8_t after = level[from ^ (size_t)1 << i];
    c->arc_of[k] = -1;
    if (level[from] == after) continue;
    c->arc_of[k] = (int32_t)c->arcs;
    c->arc[c->arcs++] = (eda_timing_arc){.input = (uint8_t)i,
                                         .output = (uint8_t)o,
                                         .rises = after,
                                         .from = (uint32_t)from};
  }
}

/* ---- sizes relevant for an arc ---- */

/* Mark the nets whose voltage may change during an arc: both ends of channels
   whose gate changes, and nets that a conducting channel connects to a changing
   net. Nets with a fixed level do not change. */
static void find_moves(const eda_timing_cell *c, const uint8_t *fixed,
                       const uint8_t *value, uint8_t *moves) {
  for (int news = 1; news;) {
    news = 0;
    for (size_t i = 0; i < c->devices; i++) {
      const eda_timing_device *d = &c->device[i];
      const uint32_t end[2] = {d->drain, d->source};
      int any = moves[d->gate] ||
                (device_conducts(d, value) && (moves[end[0]] || moves[end[1]]));
      for (int k = 0; k < 2 && any; k++)
        if (!fixed[end[k]] && !moves[end[k]]) news = moves[end[k]] = 1;
    }
  }
}

/* A transistor that is off during the whole arc acts as a capacitance on
   changing nets. The capacitance depends on the width, not on the length. */
void arc_sizes(const eda_timing_cell *c, const circuit *r,
               const eda_timing_arc *a, uint8_t *sizes) {
  uint8_t *fixed = eda_alloc(3 * c->nets, 1), *value = fixed + c->nets,
          *moves = value + c->nets;
  cell_levels(c, a->from, fixed, value);
  moves[c->port[a->input]] = 1;
  find_moves(c, fixed, value, moves);
  memset(sizes, NO_SIZE, r->parts);
  for (size_t i = 0; i < c->devices; i++) {
    const eda_timing_device *d = &c->device[i];
    int ends = moves[d->drain] || moves[d->source];
    sizes[d->bundle] = moves[d->gate] || (ends && device_conducts(d, value))
                           ? ALL_SIZES
                       : ends ? WIDTH_ONLY
                              : NO_SIZE;
  }
  free(fixed);
}

/* ---- the grid ---- */

/* Loads are given per um of channel width at the outputs, so that stronger
   cells have larger loads. */
static void make_grid(study *s, eda_timing_cell *c, const circuit *r) {
  eda_pool *pool = &s->timing->memory;
  double most = 0;
  for (size_t o = 0; o < c->outputs; o++) {
    uint32_t net = c->port[c->inputs + o];
    double width = 0;
    for (size_t i = 0; i < r->parts; i++)
      if (r->part[i].drain == net || r->part[i].source == net)
        width += r->part[i].count * r->part[i].width / 1000 * r->times;
    if (width > most) most = width;
  }
  c->slews = s->slews.count;
  c->loads = s->loads.count;
  c->at_slew = eda_pool_alloc(pool, c->slews, sizeof(double));
  c->at_load = eda_pool_alloc(pool, c->loads, sizeof(double));
  for (size_t i = 0; i < c->slews; i++) c->at_slew[i] = s->slews.values[i];
  for (size_t i = 0; i < c->loads; i++)
    c->at_load[i] = s->loads.values[i] * most;
  c->near_slew[0] = c->slews > 3;
  c->near_slew[1] = c->slews > 3 ? c->slews - 2 : c->slews - 1;
  c->near_load[0] = c->loads > 3;
  c->near_load[1] = c->loads > 3 ? c->loads - 2 : c->loads - 1;
}

/* ---- construction of a cell ---- */

int cell_build(study *s, eda_netlist *n, uint32_t number, eda_timing_cell *c,
               circuit *r, opc_error *error) {
  (void)error; /* n holds the error */
  eda_flat_netlist flat = {.pool = &s->timing->memory};
  const eda_subcircuit *of = &n->subcircuit[number];
  const eda_scope scope = {.of = of};
  c->name = own_text(s, of->name);
  int code = eda_netlist_prepare(n, number);
  if (!code) code = eda_netlist_flatten(n, &scope, &flat);
  if (code) return code;
  take_devices(s, &flat, c);
  take_rails(s, &flat, c);
  c->trouble = take_pins(s, &flat, c);
  if (!c->trouble) c->trouble = find_levels(s, c);
  if (c->trouble) return OPC_OK;
  cell_join(&s->timing->memory, c, r);
  list_arcs(s, c);
  pairs_list(s, c);
  make_grid(s, c, r);
  eda_timing_cell_figures(&s->timing->memory, c);
  return OPC_OK;
}
