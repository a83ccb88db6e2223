/* SPDX-License-Identifier: BSD-3-Clause */
/* Searches paths through the states of a circuit: the shortest path to a state,
   the recurrent states, and a synchronizing sequence. */
#include <stdio.h>
#include <string.h>

#include "bench.h"

/* ---- traversals ---- */

traversal traversal_new(const machine *m) {
  traversal w = {g_array_new(FALSE, FALSE, sizeof(uint32_t)), m->first};
  g_array_append_vals(w.input, m->lead, (guint)m->leads);
  return w;
}

void traversal_clear(traversal *w) { g_array_free(w->input, TRUE); }

void traversal_step(const bench *b, const machine *m, traversal *w,
                    uint32_t input) {
  g_array_append_val(w->input, input);
  if (w->at < STATE_LOST) w->at = m->next[w->at * b->inputs + input];
}

/* Use breadth-first search. */
int traversal_to(const bench *b, const machine *m, traversal *w,
                 uint32_t state) {
  g_autofree uint32_t *from = g_new(uint32_t, m->states);
  g_autofree uint32_t *by = g_new(uint32_t, m->states);
  g_autofree uint32_t *queue = g_new(uint32_t, m->states);
  size_t head = 0, tail = 0;
  for (size_t i = 0; i < m->states; i++) from[i] = STATE_UNKNOWN;
  from[w->at] = w->at;
  queue[tail++] = w->at;
  while (head < tail && from[state] == STATE_UNKNOWN) {
    uint32_t s = queue[head++];
    for (uint32_t i = 0; i < b->inputs; i++) {
      uint32_t t = m->next[s * b->inputs + i];
      if (t >= STATE_LOST || from[t] != STATE_UNKNOWN) continue;
      from[t] = s;
      by[t] = i;
      queue[tail++] = t;
    }
  }
  if (from[state] == STATE_UNKNOWN) return 0;
  size_t steps = 0;
  for (uint32_t s = state; s != w->at; s = from[s]) queue[steps++] = by[s];
  while (steps--) traversal_step(b, m, w, queue[steps]);
  return 1;
}

static double end_of(const machine *m, const traversal *w) {
  return m->phase * (w->input->len + 1);
}

/* The supplies start at 0 V, at which the operating point is unique. Each
   change is written on its own line, because traversals may be long. */
void traversal_sources(const bench *b, const machine *m, const traversal *w,
                       FILE *out) {
  const eda_circuit *c = b->circuit;
  for (size_t i = 0; i < c->ports; i++)
    if (c->role[i] == EDA_PIN_SUPPLY)
      fprintf(out, "vs%zu n%u 0 pwl(0 0 %.17g %.17g)\n", i, c->port[i],
              m->phase / 4, b->supply);
  for (uint32_t i = 0; i < b->inputs; i++) {
    int bit = 0;
    fprintf(out, "vi%u n%u 0 pwl(0 0\n", i, b->input[i]);
    for (size_t k = 0; k < w->input->len; k++) {
      double at = m->phase * (double)(k + 1);
      if (g_array_index(w->input, uint32_t, k) != i) continue;
      fprintf(out, "+ %.17g %.17g %.17g %.17g\n", at, bit ? b->supply : 0,
              at + b->slew, bit ? 0 : b->supply);
      bit = !bit;
    }
    fprintf(out, "+ %.17g %.17g)\n", end_of(m, w), bit ? b->supply : 0);
  }
}

void traversal_command(const machine *m, const traversal *w, FILE *out) {
  const double step = m->phase / 20;
  fprintf(out, "tran %.17g %.17g 0 %.17g\n", step, end_of(m, w), step);
}

/* ---- recurrent states ---- */

/* Mark all states that are reached from marked states (`reached` 1) or that
   lead to marked states (`reached` 0). */
static void mark_all(const machine *m, size_t inputs, int reached,
                     uint8_t *mark) {
  for (int more = 1; more;) {
    more = 0;
    for (size_t s = 0; s < m->states; s++)
      for (size_t i = 0; i < inputs; i++) {
        uint32_t t = m->next[s * inputs + i];
        if (t >= STATE_LOST || mark[s] == mark[t]) continue;
        if (mark[reached ? s : t]) mark[reached ? t : s] = more = 1;
      }
  }
}

/* Return 1 if no transition from the state is known. */
static int is_end(const machine *m, size_t inputs, size_t s) {
  for (size_t i = 0; i < inputs; i++)
    if (m->next[s * inputs + i] < STATE_LOST) return 0;
  return 1;
}

/* Start with the state after power-up. Move to a state outside of the strongly
   connected set of the present state, as long as such a state is reachable. */
void states_leading_to(const bench *b, const machine *m, uint8_t *kept) {
  const size_t inputs = b->inputs;
  g_autofree uint8_t *before = g_new(uint8_t, m->states);
  size_t c = 0;
  while (c < m->states) {
    memset(kept, 0, m->states);
    memset(before, 0, m->states);
    kept[c] = before[c] = 1;
    mark_all(m, inputs, 1, kept);
    mark_all(m, inputs, 0, before);
    for (c = 0; c < m->states; c++)
      if (kept[c] && !before[c] && !is_end(m, inputs, c)) break;
  }
  for (size_t s = 0; s < m->states; s++) kept[s] &= before[s];
}

/* ---- synchronizing sequence ---- */

typedef struct pair {
  uint32_t s, t, from, input; /* two states, preceding pair, changed input */
} pair;

/* Find changes that lead two states to the same state, by breadth-first search.
   Return 0 if no such changes are known. */
static int states_merge(const machine *m, size_t inputs, uint32_t s, uint32_t t,
                        GArray *sequence) {
  g_autoptr(GArray) queue = g_array_new(FALSE, FALSE, sizeof(pair));
  g_autoptr(GHashTable) seen = g_hash_table_new(NULL, NULL);
  const pair first = {s, t, 0, 0};
  g_array_append_val(queue, first);
  for (uint32_t head = 0; head < queue->len; head++) {
    const pair p = g_array_index(queue, pair, head);
    if (p.s == p.t) {
      for (uint32_t k = head; k; k = g_array_index(queue, pair, k).from)
        g_array_prepend_val(sequence, g_array_index(queue, pair, k).input);
      return 1;
    }
    for (uint32_t i = 0; i < inputs; i++) {
      const pair next = {m->next[p.s * inputs + i], m->next[p.t * inputs + i],
                         head, i};
      if (next.s >= STATE_LOST || next.t >= STATE_LOST) continue;
      size_t key = next.s * m->states + next.t + 1;
      if (g_hash_table_add(seen, GSIZE_TO_POINTER(key)))
        g_array_append_val(queue, next);
    }
  }
  return 0;
}

/* Apply a sequence of changes to each state of a set. Return 0 if a transition
   is unknown. */
static int go_on(const machine *m, size_t inputs, const GArray *sequence,
                 GArray *set) {
  for (size_t k = 0; k < set->len; k++) {
    uint32_t *s = &g_array_index(set, uint32_t, k);
    for (size_t i = 0; i < sequence->len; i++) {
      *s = m->next[*s * inputs + g_array_index(sequence, uint32_t, i)];
      if (*s >= STATE_LOST) return 0;
    }
  }
  return 1;
}

/* Lead pairs of states to one state, pair by pair (D. Eppstein, SIAM J. Comput.
   19, 1990). */
int traversal_synchronise(const bench *b, const machine *m, traversal *w) {
  const size_t inputs = b->inputs;
  g_autoptr(GArray) set = g_array_new(FALSE, FALSE, sizeof(uint32_t));
  for (uint32_t s = 0; s < m->states; s++) {
    size_t i = 0;
    while (i < inputs && !m->bit[s * inputs + i]) i++;
    if (i == inputs) g_array_append_val(set, s);
  }
  for (guint k = 1; k < set->len; k++) {
    g_autoptr(GArray) sequence = g_array_new(FALSE, FALSE, sizeof(uint32_t));
    if (!states_merge(m, inputs, g_array_index(set, uint32_t, 0),
                      g_array_index(set, uint32_t, k), sequence) ||
        !go_on(m, inputs, sequence, set))
      return 0;
    g_array_append_vals(w->input, sequence->data, sequence->len);
  }
  w->at = g_array_index(set, uint32_t, 0);
  return 1;
}
