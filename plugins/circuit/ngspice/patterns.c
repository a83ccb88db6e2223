/* SPDX-License-Identifier: BSD-3-Clause */
/* Lists input patterns and the transitions between them. */
#include <eda/random.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "bench.h"

/* Return a random number from 0 to n - 1; n is far below 2^64. */
static uint64_t draw_below(uint64_t *state, uint64_t n) {
  return n ? eda_random_draw(state) % n : 0;
}

/* ---- all transitions ---- */

/* Set the input levels from a number; the first input is the most significant
   bit. */
static void set_bits(uint8_t *bit, size_t inputs, uint64_t pattern) {
  for (size_t i = 0; i < inputs; i++) bit[i] = pattern >> (inputs - 1 - i) & 1;
}

/* List the transitions. If there are more than `most`, selection sampling keeps
   `most` of them with equal probability (Knuth 3.4.2, algorithm S). */
static void list_pairs(const bench *b, patterns *p) {
  uint64_t seed = (uint64_t)b->seed;
  size_t others = b->several ? p->count - 1 : b->inputs;
  uint64_t left = (uint64_t)p->count * others;
  for (size_t from = 0; from < p->count; from++)
    for (size_t k = 0; k < others; k++, left--) {
      size_t to = b->several ? k + (k >= from)
                             : from ^ ((size_t)1 << (b->inputs - 1 - k));
      size_t need = (size_t)b->most - p->transitions;
      if (left > need && draw_below(&seed, left) >= need) continue;
      p->transition[p->transitions++] =
          (transition){(uint32_t)from, (uint32_t)to};
    }
}

/* ---- random transitions ---- */

static void draw_pairs(const bench *b, patterns *p) {
  uint64_t seed = (uint64_t)b->seed;
  size_t inputs = b->inputs;
  p->transitions = (size_t)b->most;
  for (size_t k = 0; k < p->transitions; k++) {
    uint8_t *from = p->bit + 2 * k * inputs, *to = from + inputs;
    for (size_t i = 0; i < inputs; i++) from[i] = eda_random_draw(&seed) >> 63;
    memcpy(to, from, inputs);
    while (b->several && !memcmp(from, to, inputs))
      for (size_t i = 0; i < inputs; i++) to[i] = eda_random_draw(&seed) >> 63;
    if (!b->several) to[draw_below(&seed, inputs)] ^= 1;
    p->transition[k] = (transition){(uint32_t)(2 * k), (uint32_t)(2 * k + 1)};
  }
}

int patterns_make(bench *b, patterns *p, opc_error *error) {
  const size_t inputs = b->inputs, most = (size_t)b->most;
  *p = (patterns){0};
  if (bench_drives(b, error)) return error->code;
  int listed = inputs < 32 && (size_t)1 << inputs <= most;
  p->count = listed ? (size_t)1 << inputs : 2 * most;
  p->bit = eda_pool_alloc(&b->pool, p->count * inputs, 1);
  p->transition = eda_pool_alloc(&b->pool, most, sizeof *p->transition);
  p->sampled = 1;
  if (!listed) {
    draw_pairs(b, p);
    return OPC_OK;
  }
  for (size_t k = 0; k < p->count; k++)
    set_bits(p->bit + k * inputs, inputs, k);
  list_pairs(b, p);
  p->sampled = p->transitions < p->count * (b->several ? p->count - 1 : inputs);
  return OPC_OK;
}

const char *patterns_say(bench *b, const patterns *p, transition t) {
  const uint8_t *from = p->bit + t.from * b->inputs;
  const uint8_t *to = p->bit + t.to * b->inputs;
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  for (size_t i = 0; i < b->inputs; i++) {
    fprintf(out, "%s%s %d", i ? ", " : "", b->circuit->net[b->input[i]],
            from[i]);
    if (to[i] != from[i]) fprintf(out, ">%d", to[i]);
  }
  fclose(out);
  const char *own = eda_pool_text(&b->pool, text, size);
  free(text);
  return own;
}
