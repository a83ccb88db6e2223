/* SPDX-License-Identifier: BSD-3-Clause */
/* Merges equivalent transistors and nets of a cell by colour refinement
   (Weisfeiler and Leman 1968). Nets and transistors get colours, which are
   refined until they no longer change. Nets of one colour connect to equal
   numbers of transistors of each colour. Therefore equal voltages on these nets
   solve the circuit equations, and the nets can be joined. Transistors of one
   colour are merged into one with a multiplicity. The common divisor of all
   multiplicities is the number of identical circuits in parallel. */
#include <eda/random.h>
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

/* ---- colours ---- */

/* Kinds of connection of a transistor to a net. */
enum { AT_GATE = 1, AT_CHANNEL, AT_BULK };

static uint64_t hash_join(uint64_t a, uint64_t b) {
  return eda_random_mix(eda_random_mix(a) + EDA_RANDOM_STEP * (b + 1));
}

static uint64_t join_number(uint64_t a, double b) {
  uint64_t bits;
  memcpy(&bits, &b, sizeof bits);
  return hash_join(a, bits);
}

/* Return the colour of a part; drain and source are interchangeable. */
static uint64_t colour_of(const part *p, const uint64_t *net) {
  uint64_t c = join_number(join_number(p->type, p->length), p->width);
  c = hash_join(hash_join(c, net[p->gate]), net[p->bulk]);
  return hash_join(hash_join(c, eda_random_mix(net[p->drain]) +
                                    eda_random_mix(net[p->source])),
                   p->count);
}

static int by_value(const void *a, const void *b) {
  const uint64_t *x = a, *y = b;
  return *x < *y ? -1 : *x > *y;
}

static size_t count_distinct(const uint64_t *net, size_t n) {
  uint64_t *sorted = eda_alloc(n, sizeof *sorted);
  memcpy(sorted, net, n * sizeof *sorted);
  qsort(sorted, n, sizeof *sorted, by_value);
  size_t some = n > 0;
  for (size_t i = 1; i < n; i++) some += sorted[i] != sorted[i - 1];
  free(sorted);
  return some;
}

/* Set the initial colours. Supply, ground and pins have distinct colours. */
static void first_colours(const eda_timing_cell *c, uint64_t *net) {
  for (size_t i = 0; i < c->nets; i++)
    net[i] = c->rail[i] ? 1 + (c->rail[i] > 0) : 0;
  for (size_t i = 0; i < c->inputs + c->outputs; i++) net[c->port[i]] = 3 + i;
}

/* Refine the colours. Only the first of joined nets is evaluated. */
static void colours_refine(const eda_timing_cell *c, const part *p, size_t n,
                           const uint32_t *same, uint64_t *net) {
  const size_t nets = c->nets;
  uint64_t *sum = eda_alloc(nets, sizeof *sum);
  first_colours(c, net);
  for (size_t before = 0, now = count_distinct(net, nets); now > before;) {
    memset(sum, 0, nets * sizeof *sum);
    for (size_t i = 0; i < n; i++) {
      uint64_t colour = colour_of(&p[i], net);
      sum[p[i].gate] += p[i].count * hash_join(colour, AT_GATE);
      sum[p[i].drain] += p[i].count * hash_join(colour, AT_CHANNEL);
      sum[p[i].source] += p[i].count * hash_join(colour, AT_CHANNEL);
      sum[p[i].bulk] += p[i].count * hash_join(colour, AT_BULK);
    }
    for (size_t i = 0; i < nets; i++)
      net[i] = same[i] == i ? hash_join(net[i], sum[i]) : net[same[i]];
    before = now;
    now = count_distinct(net, nets);
  }
  free(sum);
}

/* ---- parts ---- */

static part part_of(const eda_timing_device *d, const uint32_t *same) {
  return (part){.type = d->type,
                .drain = same[d->drain],
                .gate = same[d->gate],
                .source = same[d->source],
                .bulk = same[d->bulk],
                .length = d->length,
                .width = d->width,
                .count = 1};
}

/* Join each net to the first net of the same colour. Supplies are one net,
   grounds another. */
static void join_nets(const eda_timing_cell *c, const uint64_t *net,
                      uint32_t *same) {
  for (uint32_t i = 0; i < c->nets; i++) {
    same[i] = 0;
    while (net[same[i]] != net[i]) same[i]++;
  }
}

static void join_devices(eda_timing_cell *c, const uint64_t *net,
                         const uint32_t *same, circuit *r) {
  for (size_t i = 0; i < c->devices; i++) {
    part p = part_of(&c->device[i], same);
    p.colour = colour_of(&p, net);
    size_t k = 0;
    while (k < r->parts && r->part[k].colour != p.colour) k++;
    if (k == r->parts)
      r->part[r->parts++] = p;
    else
      r->part[k].count++;
    c->device[i].bundle = (uint32_t)k;
  }
  for (size_t i = 0; i < c->devices; i++)
    c->device[i].share = 1.0 / r->part[c->device[i].bundle].count;
}

static uint32_t common_divisor(uint32_t a, uint32_t b) {
  return b ? common_divisor(b, a % b) : a;
}

static int by_colour(const void *a, const void *b) {
  return by_value(&((const part *)a)->colour, &((const part *)b)->colour);
}

/* Sort the parts into an order that is independent of the netlist. */
static void sort_parts(eda_timing_cell *c, circuit *r) {
  uint32_t *now = eda_alloc(r->parts, sizeof *now);
  for (uint32_t i = 0; i < r->parts; i++) r->part[i].place = i;
  qsort(r->part, r->parts, sizeof *r->part, by_colour);
  for (uint32_t i = 0; i < r->parts; i++) now[r->part[i].place] = i;
  for (size_t i = 0; i < c->devices; i++)
    c->device[i].bundle = now[c->device[i].bundle];
  free(now);
}

void cell_join(eda_pool *pool, eda_timing_cell *c, circuit *r) {
  uint64_t *net = eda_alloc(c->nets, sizeof *net);
  uint32_t *same = eda_alloc(c->nets, sizeof *same);
  part *alone = eda_alloc(c->devices, sizeof *alone);
  for (uint32_t i = 0; i < c->nets; i++) same[i] = i;
  for (size_t i = 0; i < c->devices; i++)
    alone[i] = part_of(&c->device[i], same);
  colours_refine(c, alone, c->devices, same, net);
  join_nets(c, net, same);
  r->part = eda_pool_alloc(pool, c->devices, sizeof *r->part);
  join_devices(c, net, same, r);
  uint32_t times = 0;
  for (size_t i = 0; i < r->parts; i++)
    times = common_divisor(times, r->part[i].count);
  for (size_t i = 0; times && i < r->parts; i++) r->part[i].count /= times;
  r->times = times;
  /* Compute the colours of the reduced circuit; the colours above also depend
     on the multiplicity. */
  colours_refine(c, r->part, r->parts, same, net);
  for (size_t i = 0; i < r->parts; i++)
    r->part[i].colour = colour_of(&r->part[i], net);
  sort_parts(c, r);
  c->bundles = r->parts;
  free(alone);
  free(same);
  free(net);
}
