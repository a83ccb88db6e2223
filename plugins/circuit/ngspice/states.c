/* SPDX-License-Identifier: BSD-3-Clause */
/* The states of a circuit that keeps one, and what each change of an input
   makes of them. Nothing is known of clocks: from the state in which it wakes
   up, the inputs change one at a time in walks through transients, the shortest
   that lead to what has not been tried, until all has (C. E. Shannon's mouse).
   A state is the inputs and the levels of all nets that gates and outputs are
   on. */
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench.h"

enum {
  WALKS = 64,   /* of a round, between which what they saw is put together */
  LONGER = 4,   /* how much longer phases are if they were too short */
  LONGEST = 10, /* times that */
};

static const double first_phase = 1e-9;

/* ---- walks ---- */

walk walk_new(const machine *m) {
  walk w = {g_array_new(FALSE, FALSE, sizeof(uint32_t)), m->first};
  g_array_append_vals(w.input, m->lead, (guint)m->leads);
  return w;
}

void walk_clear(walk *w) { g_array_free(w->input, TRUE); }

void walk_step(const bench *b, const machine *m, walk *w, uint32_t input) {
  g_array_append_val(w->input, input);
  if (w->at < STATE_LOST) w->at = m->next[w->at * b->inputs + input];
}

/* Breadth first, backwards along the marks that the search leaves. */
int walk_to(const bench *b, const machine *m, walk *w, uint32_t state) {
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
  while (steps--) walk_step(b, m, w, queue[steps]);
  return 1;
}

double walk_end(const machine *m, const walk *w) {
  return m->phase * (w->input->len + 1);
}

void walk_write(const bench *b, const machine *m, const walk *w, FILE *out) {
  const double step = m->phase / 20;
  for (uint32_t i = 0; i < b->inputs; i++) {
    int bit = 0;
    fprintf(out, "alter @vi%u[pwl] = [ 0 0", i);
    for (size_t k = 0; k < w->input->len; k++) {
      double at = m->phase * (double)(k + 1);
      if (g_array_index(w->input, uint32_t, k) != i) continue;
      fprintf(out, " %.17g %.17g %.17g %.17g", at, bit ? b->supply : 0,
              at + b->slew, bit ? 0 : b->supply);
      bit = !bit;
    }
    fprintf(out, " %.17g %.17g ]\n", walk_end(m, w), bit ? b->supply : 0);
  }
  fprintf(out, "tran %.17g %.17g 0 %.17g\n", step, walk_end(m, w), step);
}

/* ---- what is looked at ---- */

static void list_watched(bench *b, machine *m) {
  const eda_circuit *c = b->circuit;
  g_autofree uint8_t *seen = g_new0(uint8_t, c->nets);
  m->net = eda_pool_alloc(&b->pool, c->nets, sizeof *m->net);
  for (size_t i = 0; i < c->count; i++) seen[c->device[i].gate] = 1;
  for (size_t i = 0; i < b->outputs; i++) seen[b->output[i]] = 1;
  for (size_t i = 0; i < b->inputs; i++) seen[b->input[i]] = 0;
  for (uint32_t i = 0; i < c->nets; i++)
    if (seen[i] && !is_rail(eda_circuit_role(c, i))) m->net[m->watched++] = i;
}

static const char *probe(const bench *b, uint32_t net, char name[32]) {
  int port = eda_circuit_role(b->circuit, net) >= 0;
  snprintf(name, 32, "v(%sn%u)", port ? "" : "x1.", net);
  return name;
}

void states_save(const bench *b, const machine *m, FILE *out) {
  char name[32];
  for (size_t k = 0; k < m->watched; k++)
    fprintf(out, ".save %s\n", probe(b, m->net[k], name));
}

/* The value of a vector at a time. */
static double value_at(const eda_spice_vector *t, const eda_spice_vector *v,
                       double time) {
  if (!t || !v || t->count != v->count || t->count < 2) return NAN;
  size_t low = 0, high = t->count - 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    *(t->value[middle] <= time ? &low : &high) = middle;
  }
  double share = (time - t->value[low]) / (t->value[high] - t->value[low]);
  return v->value[low] + fmin(share, 1) * (v->value[high] - v->value[low]);
}

void states_levels(const bench *b, const machine *m, const eda_spice_plot *plot,
                   double time, int8_t *level) {
  const eda_spice_vector *t = eda_spice_vector_find(plot, "time");
  char name[32];
  for (size_t k = 0; k < m->watched; k++) {
    const eda_spice_vector *v =
        eda_spice_vector_find(plot, probe(b, m->net[k], name));
    double x = value_at(t, v, time) / b->supply;
    level[k] = (int8_t)(x >= b->high ? 1 : x <= b->low ? 0 : -1);
  }
}

/* ---- a round of walks ---- */

/* What a walk saw, and whether all was at rest in the second half of its
   phases. */
typedef struct trip {
  walk way;
  uint32_t target, input; /* the first that it tries, and where */
  int8_t *level;          /* at the end of each phase */
  int rests;
} trip;

typedef struct round_of {
  const machine *m;
  trip *trip;
} round_of;

static void write_deck(job *j, FILE *out, const void *how) {
  const round_of *r = how;
  job_begin(j, out, 1e-3);
  job_circuit(j, out, SIZE_TIMED);
  states_save(j->b, r->m, out);
  fputs(".end\n", out);
}

static void write_walk(job *j, FILE *out, const void *how) {
  const round_of *r = j->of;
  walk_write(j->b, r->m, how, out);
}

static void look(const job *j, trip *t, const eda_spice_plot *plot) {
  const machine *m = ((const round_of *)j->of)->m;
  g_autofree int8_t *middle = g_new(int8_t, m->watched);
  for (size_t k = 0; k <= t->way.input->len; k++) {
    int8_t *end = t->level + k * m->watched;
    states_levels(j->b, m, plot, m->phase * ((double)k + 0.5), middle);
    states_levels(j->b, m, plot, m->phase * ((double)k + 1), end);
    /* The first may well wake up slowly. */
    if (k && memcmp(middle, end, m->watched)) t->rests = 0;
  }
}

static void run_job(job *j) {
  const round_of *r = j->of;
  trip *t = &r->trip[j->from];
  eda_spice_result result;
  g_autofree char *deck = job_text(j, write_deck, r);
  g_autofree char *commands = job_text(j, write_walk, &t->way);
  t->rests = 1;
  t->level = g_new(int8_t, (t->way.input->len + 1) * r->m->watched);
  job_simulate(j, deck, commands, &result);
  if (!j->code && result.count != 1)
    j->code = opc_fail(&j->error, OPC_FAILED, NULL,
                       "'ngspice' gave %zu transients, not 1", result.count);
  if (!j->code) look(j, t, &result.plot[0]);
  eda_spice_clear(&result);
}

/* ---- the map ---- */

/* While it is made: arrays that grow. */
typedef struct map {
  bench *b;
  machine *m;
  GArray *bit, *level, *next;
} map;

static void show(map *a) {
  a->m->bit = (uint8_t *)a->bit->data;
  a->m->level = (int8_t *)a->level->data;
  a->m->next = (uint32_t *)a->next->data;
}

/* The state of these inputs and levels, perhaps a new one. */
static uint32_t state_of(map *a, const uint8_t *bit, const int8_t *level) {
  const size_t inputs = a->b->inputs;
  machine *m = a->m;
  const uint32_t unknown = STATE_UNKNOWN;
  for (size_t s = 0; s < m->states; s++)
    if (!memcmp(m->bit + s * inputs, bit, inputs) &&
        !memcmp(m->level + s * m->watched, level, m->watched))
      return (uint32_t)s;
  g_array_append_vals(a->bit, bit, (guint)inputs);
  g_array_append_vals(a->level, level, (guint)m->watched);
  for (size_t i = 0; i < inputs; i++) g_array_append_val(a->next, unknown);
  show(a);
  return (uint32_t)m->states++;
}

/* Put down what a walk saw. Where the same change has led elsewhere before, the
   levels do not say all of the state, and nothing is known. */
static void put_down(map *a, const trip *seen) {
  const size_t inputs = a->b->inputs;
  machine *m = a->m;
  g_autofree uint8_t *bit = g_new0(uint8_t, inputs);
  uint32_t s = state_of(a, bit, seen->level);
  for (size_t k = 0; k < seen->way.input->len; k++) {
    uint32_t input = g_array_index(seen->way.input, uint32_t, k);
    bit[input] ^= 1;
    uint32_t t = state_of(a, bit, seen->level + (k + 1) * m->watched);
    uint32_t *next = &m->next[s * inputs + input];
    *next = *next == STATE_UNKNOWN || *next == t ? t : STATE_LOST;
    s = t;
  }
  if (seen->target == STATE_UNKNOWN) return;
  uint32_t *next = &m->next[seen->target * inputs + seen->input];
  /* The way there does not lead there any more. */
  if (*next == STATE_UNKNOWN) *next = STATE_LOST;
}

/* Ways to states in which some inputs have not changed: each of them changes,
   and back. `tried` counts them, up to `most`. */
static size_t plan(const map *a, trip *trips, size_t *tried) {
  const bench *b = a->b;
  const machine *m = a->m;
  size_t n = 0;
  for (uint32_t s = 0; s < m->states && n < WALKS; s++) {
    const uint32_t *next = m->next + s * b->inputs;
    uint32_t i = 0;
    while (i < b->inputs && next[i] != STATE_UNKNOWN) i++;
    if (i == b->inputs || *tried >= (size_t)b->most) continue;
    trip *t = &trips[n];
    *t = (trip){.way = walk_new(m), .target = s, .input = i};
    if (!walk_to(b, m, &t->way, s)) {
      walk_clear(&t->way);
      continue;
    }
    for (n++; i < b->inputs && *tried < (size_t)b->most; i++) {
      if (next[i] != STATE_UNKNOWN) continue;
      walk_step(b, m, &t->way, i);
      walk_step(b, m, &t->way, i);
      ++*tried;
    }
  }
  return n;
}

/* One round; 1 if all was at rest, -1 on failure. */
static int go(map *a, trip *trips, size_t n, opc_error *error) {
  const round_of r = {a->m, trips};
  int rests = 1;
  int code = jobs_run_at(a->b, EDA_DRAWN, n, 1, run_job, &r, error);
  for (size_t i = 0; i < n; i++) rests &= trips[i].rests;
  for (size_t i = 0; i < n; i++) {
    if (!code && rests) put_down(a, &trips[i]);
    walk_clear(&trips[i].way);
    g_free(trips[i].level);
  }
  return code ? -1 : rests;
}

/* All rounds, with phases of one length. */
static int explore(map *a, opc_error *error) {
  trip trips[WALKS];
  size_t tried = 0, n = 1;
  g_array_set_size(a->bit, 0);
  g_array_set_size(a->level, 0);
  g_array_set_size(a->next, 0);
  a->m->states = 0;
  trips[0] = (trip){.way = walk_new(a->m), .target = STATE_UNKNOWN};
  while (n) {
    int rests = go(a, trips, n, error);
    if (rests <= 0) return rests;
    n = plan(a, trips, &tried);
  }
  for (size_t i = 0; i < a->m->states * a->b->inputs; i++)
    n += a->m->next[i] == STATE_UNKNOWN;
  if (n)
    a->b->host->log(a->b->host, OPC_LOG_INFO,
                    "%zu changes of inputs tried, nearest to where the circuit "
                    "wakes up: there are more",
                    tried);
  return 1;
}

/* ---- the states that there is always a way back to ---- */

/* Mark what leads to the marked. */
static void mark_before(const machine *m, size_t inputs, uint8_t *mark) {
  for (int more = 1; more;) {
    more = 0;
    for (size_t s = 0; s < m->states; s++)
      for (size_t i = 0; i < inputs && !mark[s]; i++) {
        uint32_t t = m->next[s * inputs + i];
        if (t < STATE_LOST && mark[t]) mark[s] = more = 1;
      }
  }
}

/* Mark what the marked lead to. */
static void mark_after(const machine *m, size_t inputs, uint8_t *mark) {
  for (int more = 1; more;) {
    more = 0;
    for (size_t s = 0; s < m->states; s++)
      for (size_t i = 0; i < inputs && mark[s]; i++) {
        uint32_t t = m->next[s * inputs + i];
        if (t < STATE_LOST && !mark[t]) mark[t] = more = 1;
      }
  }
}

/* Has any change been seen there? Without, it is only not known any further. */
static int is_end(const machine *m, size_t inputs, size_t s) {
  for (size_t i = 0; i < inputs; i++)
    if (m->next[s * inputs + i] < STATE_LOST) return 0;
  return 1;
}

/* Mark the states that lead to each other and to no others, the first that
   there is a way to from the one in which the circuit wakes up. */
static void mark_kept(const machine *m, size_t inputs, uint8_t *kept) {
  g_autofree uint8_t *before = g_new(uint8_t, m->states);
  size_t c = 0;
  while (c < m->states) {
    memset(kept, 0, m->states);
    memset(before, 0, m->states);
    kept[c] = before[c] = 1;
    mark_after(m, inputs, kept);
    mark_before(m, inputs, before);
    for (c = 0; c < m->states; c++)
      if (kept[c] && !before[c] && !is_end(m, inputs, c)) break;
  }
  for (size_t s = 0; s < m->states; s++) kept[s] &= before[s];
}

/* Leave out all others: what leads to the first that stays goes ahead of each
   walk. */
static void leave_out(bench *b, machine *m, const uint8_t *kept) {
  g_autofree uint32_t *number = g_new(uint32_t, m->states);
  walk w = walk_new(m);
  uint32_t first = 0, n = 0;
  while (!kept[first]) first++;
  walk_to(b, m, &w, first);
  m->leads = w.input->len;
  m->lead = eda_pool_alloc(&b->pool, m->leads, sizeof *m->lead);
  memcpy(m->lead, w.input->data, m->leads * sizeof *m->lead);
  walk_clear(&w);
  for (size_t s = 0; s < m->states; s++) number[s] = kept[s] ? n++ : STATE_LOST;
  for (size_t s = first; s < m->states; s++) {
    if (!kept[s]) continue;
    const uint32_t *from = m->next + s * b->inputs;
    uint32_t *to = m->next + number[s] * b->inputs;
    for (size_t i = 0; i < b->inputs; i++)
      to[i] = from[i] < STATE_LOST ? number[from[i]] : from[i];
    memmove(m->bit + number[s] * b->inputs, m->bit + s * b->inputs, b->inputs);
    memmove(m->level + number[s] * m->watched, m->level + s * m->watched,
            m->watched);
  }
  m->states = n;
  m->first = 0;
}

/* ---- what is known in the end ---- */

static const void *keep(bench *b, const GArray *a, size_t count, size_t size) {
  void *own = eda_pool_alloc(&b->pool, count, size);
  memcpy(own, a->data, count * size);
  return own;
}

/* As patterns, with the transitions between them, and outputs' levels: none
   where a gate is at no level. */
static void list_patterns(bench *b, const machine *m, patterns *p, logic *l) {
  *p = (patterns){.count = m->states, .bit = m->bit};
  *l = (logic){0};
  p->transition =
      eda_pool_alloc(&b->pool, m->states * b->inputs, sizeof *p->transition);
  l->level = eda_pool_alloc(&b->pool, m->states * b->outputs, sizeof *l->level);
  for (uint32_t s = 0; s < m->states; s++) {
    const int8_t *level = m->level + s * m->watched;
    int known = !memchr(level, -1, m->watched);
    for (size_t i = 0; i < b->inputs; i++) {
      uint32_t t = m->next[s * b->inputs + i];
      if (t < STATE_LOST) p->transition[p->transitions++] = (transition){s, t};
    }
    for (size_t k = 0; k < m->watched; k++)
      for (size_t o = 0; o < b->outputs; o++)
        if (m->net[k] == b->output[o])
          l->level[s * b->outputs + o] = known ? level[k] : -1;
  }
}

static void warn(const bench *b, const machine *m) {
  const opc_host *host = b->host;
  size_t lost = 0;
  for (size_t i = 0; i < m->states * b->inputs; i++)
    lost += m->next[i] == STATE_LOST;
  if (lost)
    host->log(host, OPC_LOG_WARNING,
              "%zu changes of an input do not always lead to the same state "
              "and are left out",
              lost);
  for (size_t k = 0; k < m->watched; k++) {
    size_t n = 0;
    for (size_t s = 0; s < m->states; s++)
      n += m->level[s * m->watched + k] < 0;
    if (n)
      host->log(host, OPC_LOG_WARNING,
                "net '%s' is at no logic level in %zu of %zu states, which "
                "are left out",
                b->circuit->net[m->net[k]], n, m->states);
  }
}

int states_find(bench *b, machine *m, patterns *p, logic *l, opc_error *error) {
  *m = (machine){.phase = first_phase + 4 * b->slew};
  map a = {b, m, g_array_new(FALSE, FALSE, 1), g_array_new(FALSE, FALSE, 1),
           g_array_new(FALSE, FALSE, sizeof(uint32_t))};
  int rests = 0;
  list_watched(b, m);
  for (int i = 0; i < LONGEST && !rests; i++) {
    if (i) m->phase *= LONGER;
    rests = explore(&a, error);
  }
  if (!rests)
    opc_fail(error, OPC_FAILED, "circuit", "'%s' is not at rest after %g ns",
             b->circuit->name, 1e9 * m->phase);
  if (rests > 0) {
    size_t all = m->states;
    g_autofree uint8_t *kept = g_new(uint8_t, all);
    mark_kept(m, b->inputs, kept);
    leave_out(b, m, kept);
    m->bit = (uint8_t *)keep(b, a.bit, m->states * b->inputs, 1);
    m->level = (int8_t *)keep(b, a.level, m->states * m->watched, 1);
    m->next =
        (uint32_t *)keep(b, a.next, m->states * b->inputs, sizeof *m->next);
    b->host->log(b->host, OPC_LOG_INFO,
                 "'%s' keeps a state: %zu with those of its inputs, of %zu "
                 "seen; changes are %g ns apart",
                 b->circuit->name, m->states, all, 1e9 * m->phase);
    warn(b, m);
    list_patterns(b, m, p, l);
  }
  g_array_free(a.bit, TRUE);
  g_array_free(a.level, TRUE);
  g_array_free(a.next, TRUE);
  return rests > 0 ? OPC_OK : error->code;
}
