/* SPDX-License-Identifier: BSD-3-Clause */
/* Determines which transistors leak in a static circuit: transistors that are
   off between a high and a low net. Two transistors in series that are both off
   leak about a tenth of one transistor (Narendra et al., ISLPED 2001); this
   leakage is neglected. */
#include <eda/random.h>
#include <stdlib.h>
#include <string.h>

#include "budget.h"

/* For circuits of at most MOST_INPUTS inputs, all patterns are evaluated; for
   other circuits, DRAWN random patterns, so that the standard error of a share
   of the patterns is at most 0.8 percentage points. */
enum { MOST_INPUTS = 12, DRAWN = 1 << MOST_INPUTS };

/* ---- a cell ---- */

enum { LOW, HIGH, FLOATS };

/* Leakage of a transistor at a degraded level, relative to a full level. A high
   level behind an n-transistor and a low level behind a p-transistor are
   degraded by the threshold voltage. ngspice yields 0.38 for a NAND2 with
   data/devices/opcflow65.pm. Half or twice the value changes the leakage of c17
   by -4 % and +7 %, and the saving by less than 1.5 percentage points. */
static const double weakly = 0.4;

/* Level of each net of a cell; weak[net] is 1 if the level is degraded by a
   threshold voltage. */
typedef struct levels {
  uint8_t *of, *weak;
} levels;

static int is_on(const eda_timing_device *d, const uint8_t *level) {
  return level[d->gate] == (d->type == EDA_NMOS ? HIGH : LOW);
}

/* Propagate the level of the net `from` through a conducting channel to the net
   `to`, if `to` floats. Degraded levels are propagated only if weakly_too.
   Return 1 if `to` has got a level. */
static int level_propagate(const eda_timing_device *d, uint32_t from,
                           uint32_t to, int weakly_too, levels *v) {
  int weak = v->weak[from] || v->of[from] == (d->type == EDA_NMOS ? HIGH : LOW);
  if (v->of[from] == FLOATS || v->of[to] != FLOATS || (weak && !weakly_too))
    return 0;
  v->of[to] = v->of[from];
  v->weak[to] = (uint8_t)weak;
  return 1;
}

/* Compute the levels of all nets: pins and rails first, then nets reached by
   full levels, then nets reached by degraded levels. */
static void find_levels(const eda_timing_cell *c, uint32_t pattern, levels *v) {
  for (size_t i = 0; i < c->nets; i++) {
    v->of[i] = c->rail[i] > 0 ? HIGH : c->rail[i] < 0 ? LOW : FLOATS;
    v->weak[i] = 0;
  }
  for (size_t i = 0; i < c->inputs; i++) v->of[c->port[i]] = pattern >> i & 1;
  for (int too = 0; too < 2; too++)
    for (int news = 1; news;) {
      news = 0;
      for (size_t i = 0; i < c->devices; i++) {
        const eda_timing_device *d = &c->device[i];
        if (!is_on(d, v->of)) continue;
        news |= level_propagate(d, d->drain, d->source, too, v);
        news |= level_propagate(d, d->source, d->drain, too, v);
      }
    }
}

/* Return the leakage of a transistor as a fraction of its Ioff. */
static double device_leakage(const eda_timing_device *d, const levels *v) {
  uint8_t gate = v->of[d->gate];
  if (gate == FLOATS || is_on(d, v->of)) return 0;
  if (v->of[d->drain] + v->of[d->source] != LOW + HIGH) return 0;
  return v->weak[d->drain] || v->weak[d->source] ? weakly : 1;
}

/* ---- the circuit ---- */

/* First node of an instance, and the number of occurrences of each input
   pattern of this instance. */
typedef struct tally {
  const node *node;
  uint32_t *times;
} tally;

/* Evaluate the circuit for the levels of its inputs in `level`, and count the
   input pattern of each instance. */
static void pattern_count(const graph *g, uint8_t *level,
                          const tally *tallies) {
  for (size_t i = 0; i < g->nodes; i++) {
    const node *n = &g->node[i];
    uint32_t pattern = 0;
    for (size_t k = 0; k < n->cell->inputs; k++)
      pattern |= (uint32_t)level[n->in[k]] << k;
    level[n->net] = n->cell->level[n->output << n->cell->inputs | pattern];
    if (!n->output) tallies[n->instance].times[pattern]++;
  }
}

/* Add the relative leakage of an instance's transistors to their choices. */
static void add_shares(const budget *b, const tally *t, size_t patterns,
                       double *share) {
  const eda_timing_cell *c = t->node->cell;
  levels v = {eda_alloc(c->nets, 1), eda_alloc(c->nets, 1)};
  for (uint32_t k = 0; k < 1u << c->inputs; k++) {
    if (!t->times[k]) continue;
    find_levels(c, k, &v);
    for (size_t d = 0; d < c->devices; d++)
      share[b->first[t->node->instance] + c->device[d].bundle] +=
          device_leakage(&c->device[d], &v) * c->device[d].share * t->times[k] /
          (double)patterns;
  }
  free(v.of);
  free(v.weak);
}

double *static_leakage_shares(const budget *b) {
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
      level[g->input[k]] = all ? i >> k & 1 : eda_random_draw(&seed) >> 63;
    pattern_count(g, level, tallies);
  }
  double *share = eda_alloc(b->count, sizeof *share);
  for (size_t i = 0; i < g->instances; i++)
    if (tallies[i].node) add_shares(b, &tallies[i], patterns, share);
  eda_pool_clear(&pool);
  return share;
}
