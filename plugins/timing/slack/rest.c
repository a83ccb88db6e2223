/* SPDX-License-Identifier: BSD-3-Clause */
/* Which transistors leak while a circuit is at rest: those that are off between
   a net that is high and one that is low. Two that are off in series leak about
   a tenth of one (Narendra et al., ISLPED 2001): they do not count. */
#include <stdlib.h>
#include <string.h>

#include "budget.h"

/* Of more inputs than that, patterns are drawn at random: so many. A share is
   then off by 1.6 % of all patterns at most (two standard deviations). */
enum { MOST_INPUTS = 12, DRAWN = 1 << MOST_INPUTS };

/* splitmix64 (Steele, Lea, Flood 2014). */
static uint64_t draw(uint64_t *seed) {
  uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/* ---- a cell ---- */

enum { LOW, HIGH, FLOATS };

/* The levels of a cell's nets: those of pins and rails, then what channels that
   are on pass on. */
static void find_levels(const eda_timing_cell *c, uint32_t pattern,
                        uint8_t *level) {
  for (size_t i = 0; i < c->nets; i++)
    level[i] = c->rail[i] > 0 ? HIGH : c->rail[i] < 0 ? LOW : FLOATS;
  for (size_t i = 0; i < c->inputs; i++) level[c->port[i]] = pattern >> i & 1;
  for (int news = 1; news;) {
    news = 0;
    for (size_t i = 0; i < c->devices; i++) {
      const eda_timing_device *d = &c->device[i];
      if (level[d->gate] != (d->type == EDA_NMOS ? HIGH : LOW)) continue;
      if (level[d->drain] == level[d->source]) continue;
      if (level[d->source] == FLOATS)
        level[d->source] = level[d->drain], news = 1;
      else if (level[d->drain] == FLOATS)
        level[d->drain] = level[d->source], news = 1;
    }
  }
}

static int leaks(const eda_timing_device *d, const uint8_t *level) {
  int off = level[d->gate] == (d->type == EDA_NMOS ? LOW : HIGH);
  return off && level[d->drain] + level[d->source] == LOW + HIGH;
}

/* ---- the circuit ---- */

/* How often an instance has each pattern of its inputs. */
typedef struct tally {
  const node *node;
  uint32_t *times;
} tally;

static void count(const graph *g, uint8_t *level, const tally *tallies) {
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    uint32_t pattern = 0;
    for (size_t k = 0; k < n->cell->inputs; k++)
      pattern |= (uint32_t)level[n->in[k]] << k;
    level[n->net] = n->cell->level[n->output << n->cell->inputs | pattern];
    if (!n->output) tallies[n->instance].times[pattern]++;
  }
}

static void add_shares(const budget *b, const tally *t, size_t patterns,
                       double *share) {
  const eda_timing_cell *c = t->node->cell;
  uint8_t *level = eda_alloc(c->nets, 1);
  for (uint32_t k = 0; k < 1u << c->inputs; k++) {
    if (!t->times[k]) continue;
    find_levels(c, k, level);
    for (size_t d = 0; d < c->devices; d++)
      if (leaks(&c->device[d], level))
        share[b->first[t->node->instance] + c->device[d].bundle] +=
            c->device[d].share * t->times[k] / (double)patterns;
  }
  free(level);
}

double *rest_shares(const budget *b) {
  const graph *g = b->g;
  eda_pool pool = {0};
  tally *tallies = eda_pool_alloc(&pool, g->instances, sizeof *tallies);
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    if (n->output) continue;
    tallies[n->instance] = (tally){
        n,
        eda_pool_alloc(&pool, (size_t)1 << n->cell->inputs, sizeof(uint32_t))};
  }
  const int all = g->inputs <= MOST_INPUTS;
  const size_t patterns = all ? (size_t)1 << g->inputs : (size_t)DRAWN;
  uint8_t *level = eda_pool_alloc(&pool, g->nets, 1);
  uint64_t seed = 1;
  for (size_t i = 0; i < patterns; i++) {
    for (size_t k = 0; k < g->inputs; k++)
      level[g->input[k]] = all ? i >> k & 1 : draw(&seed) >> 63;
    count(g, level, tallies);
  }
  double *share = eda_alloc(b->count, sizeof *share);
  for (size_t i = 0; i < g->instances; i++)
    if (tallies[i].node) add_shares(b, &tallies[i], patterns, share);
  eda_pool_clear(&pool);
  return share;
}
