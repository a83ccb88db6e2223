/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists input patterns: all transitions, or random transitions. */
#include <eda/random.h>
#include <string.h>

#include "paths.h"

/* Circuits with at least this number of inputs have random transitions, because
   the number of all transitions might not fit into 64 bits. */
enum { COUNTED = 20 };

/* The number of all transitions is m 2^m with one changing input and 4^m - 2^m
   with several. If this number is at most 'transitions', all transitions are
   used. */
void patterns_count(paths *p) {
  const size_t m = p->graph.inputs;
  size_t all = SIZE_MAX;
  if (m < COUNTED)
    all =
        p->changes == SINGLE ? m << m : ((size_t)1 << 2 * m) - ((size_t)1 << m);
  p->all = all <= (size_t)p->transitions;
  p->patterns = p->all ? all : (size_t)p->transitions;
}

static void pattern_listed(const paths *p, size_t index, uint8_t *before,
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

/* Random patterns: each input takes one of the four combinations of levels with
   equal probability, or a single input changes. */
void pattern_at(const paths *p, size_t index, uint8_t *before, uint8_t *after) {
  const size_t m = p->graph.inputs;
  if (!m) return;
  if (p->all) {
    pattern_listed(p, index, before, after);
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
