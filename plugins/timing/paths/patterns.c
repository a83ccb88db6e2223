/* SPDX-License-Identifier: BSD-3-Clause */
/* What is applied to the inputs: all transitions, or some drawn at random. */
#include <eda/random.h>
#include <string.h>

#include "paths.h"

/* Inputs of which all transitions can be counted in 64 bits; of so many nobody
   wants all. */
enum { COUNTED = 20 };

/* All there are, if so many are wanted: m 2^m of one input, 4^m - 2^m of
   several. */
void patterns_count(paths *p) {
  const size_t m = p->graph.inputs;
  size_t all = SIZE_MAX;
  if (m < COUNTED)
    all =
        p->changes == SINGLE ? m << m : ((size_t)1 << 2 * m) - ((size_t)1 << m);
  p->all = all <= (size_t)p->transitions;
  p->patterns = p->all ? all : (size_t)p->transitions;
}

static void listed(const paths *p, size_t index, uint8_t *before,
                   uint8_t *after) {
  const size_t m = p->graph.inputs;
  size_t from, to;
  if (p->changes == SINGLE) {
    from = index / m;
    to = from ^ (size_t)1 << index % m;
  } else {
    size_t others = ((size_t)1 << m) - 1;
    from = index / others;
    to = index % others;
    to += to >= from;
  }
  for (size_t i = 0; i < m; i++) {
    before[i] = from >> i & 1;
    after[i] = to >> i & 1;
  }
}

/* Each input stays or changes, from either level, all four alike; or one of
   them changes. */
void pattern_at(const paths *p, size_t index, uint8_t *before, uint8_t *after) {
  const size_t m = p->graph.inputs;
  if (!m) return;
  if (p->all) {
    listed(p, index, before, after);
    return;
  }
  uint64_t seed = (uint64_t)p->seed;
  seed = eda_random_draw(&seed) ^ (uint64_t)index * 0xd1342543de82ef95u;
  do {
    for (size_t i = 0; i < m; i++) {
      uint64_t bits = eda_random_draw(&seed) >> 62;
      before[i] = bits & 1;
      after[i] = p->changes == SINGLE ? before[i] : bits >> 1;
    }
    if (p->changes == SINGLE) after[eda_random_draw(&seed) % m] ^= 1;
  } while (!memcmp(before, after, m));
}
