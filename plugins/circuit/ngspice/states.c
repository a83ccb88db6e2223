/* SPDX-License-Identifier: BSD-3-Clause */
/* Explores the states of a sequential circuit and the transitions caused by
   changes of single inputs. A state consists of the levels of the inputs and of
   all nets connected to gates or outputs. No clock is assumed. A traversal is a
   transient that starts at power-up and changes one input at a time, along the
   shortest known path to an untried change. Traversals are run until all
   changes are known. */
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "bench.h"

enum {
  WALKS = 64,   /* traversals per round; results are merged after each round */
  LONGER = 4,   /* factor on the phase if the circuit did not settle */
  LONGEST = 10, /* largest number of extensions */
  RINGS = 32,   /* changes of a net in one phase that count as oscillation */
};

static const double first_phase = 1e-9;

/* ---- observed nets ---- */

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

static const char *net_probe(const bench *b, uint32_t net, char name[32]) {
  int port = eda_circuit_role(b->circuit, net) >= 0;
  snprintf(name, 32, "v(%sn%u)", port ? "" : "x1.", net);
  return name;
}

void states_save(const bench *b, const machine *m, FILE *out) {
  char name[32];
  for (size_t k = 0; k < m->watched; k++)
    fprintf(out, ".save %s\n", net_probe(b, m->net[k], name));
}

/* Return the value of a vector at a time. */
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
        eda_spice_vector_find(plot, net_probe(b, m->net[k], name));
    double x = value_at(t, v, time) / b->supply;
    level[k] = (int8_t)(x >= b->high ? 1 : x <= b->low ? 0 : -1);
  }
}

/* ---- one round ---- */

/* A traversal and its result: the levels, and whether all nets were constant in
   the second half of each phase. */
typedef struct trip {
  traversal path;
  uint32_t target, input; /* state and input of the first change that the
                             traversal tries */
  int8_t *level;          /* levels at the end of each phase */
  int rests;
} trip;

typedef struct round_of {
  const machine *m;
  trip *trip;
} round_of;

static void write_deck(bench_task *j, FILE *out, const void *how) {
  const round_of *r = j->of;
  job_begin(j, out, 1e-3, SWITCHING_CURRENT);
  job_circuit(j, out, SIZE_TIMED);
  traversal_sources(j->b, r->m, how, out);
  states_save(j->b, r->m, out);
  fputs(".end\n", out);
}

static void write_traversal(bench_task *j, FILE *out, const void *how) {
  traversal_command(((const round_of *)j->of)->m, how, out);
}

/* Return the number of level changes of a net between two times. */
static int count_changes(const bench *b, const eda_spice_plot *plot,
                         uint32_t net, double from, double to) {
  char name[32];
  const eda_spice_vector *t = eda_spice_vector_find(plot, "time");
  const eda_spice_vector *v =
      eda_spice_vector_find(plot, net_probe(b, net, name));
  int n = 0, was = -1;
  for (size_t i = 0; t && v && i < t->count && t->value[i] <= to; i++) {
    double x = v->value[i] / b->supply;
    int is = x >= b->high ? 1 : x <= b->low ? 0 : was;
    n += t->value[i] >= from && was >= 0 && is != was;
    was = is;
  }
  return n;
}

static void check_ringing(bench_task *j, const eda_spice_plot *plot,
                          double from, double to) {
  const bench *b = j->b;
  const machine *m = ((const round_of *)j->of)->m;
  for (size_t i = 0; i < m->watched && !j->code; i++)
    if (count_changes(b, plot, m->net[i], from, to) >= RINGS)
      j->code = opc_fail(
          &j->error, OPC_INVALID, "circuit",
          "'%s' does not settle: net '%s' changes at least %d times in %g ns",
          b->circuit->name, b->circuit->net[m->net[i]], RINGS,
          1e9 * (to - from));
}

/* Return 1 if any net changes between two times. Comparing the levels at the
   ends does not suffice: an oscillating net may return to its level. */
static int any_changes(const bench_task *j, const eda_spice_plot *plot,
                       double from, double to) {
  const machine *m = ((const round_of *)j->of)->m;
  for (size_t i = 0; i < m->watched; i++)
    if (count_changes(j->b, plot, m->net[i], from, to)) return 1;
  return 0;
}

static void trip_read_levels(bench_task *j, trip *t,
                             const eda_spice_plot *plot) {
  const machine *m = ((const round_of *)j->of)->m;
  g_autofree int8_t *middle = g_new(int8_t, m->watched);
  for (size_t k = 0; k <= t->path.input->len; k++) {
    int8_t *end = t->level + k * m->watched;
    double from = m->phase * (double)k, half = m->phase * ((double)k + 0.5),
           to = m->phase * ((double)k + 1);
    states_levels(j->b, m, plot, half, middle);
    states_levels(j->b, m, plot, to, end);
    /* Power-up may be slow, so nets need not settle in the first phase. */
    if (!k ||
        (!memcmp(middle, end, m->watched) && !any_changes(j, plot, half, to)))
      continue;
    t->rests = 0;
    check_ringing(j, plot, from, to);
  }
}

static void run_job(bench_task *j) {
  const round_of *r = j->of;
  trip *t = &r->trip[j->from];
  eda_spice_result result;
  g_autofree char *deck = job_text(j, write_deck, &t->path);
  g_autofree char *commands = job_text(j, write_traversal, &t->path);
  t->rests = 1;
  t->level = g_new(int8_t, (t->path.input->len + 1) * r->m->watched);
  job_simulate(j, deck, commands, &result);
  if (!j->code && result.count != 1)
    j->code =
        opc_fail(&j->error, OPC_FAILED, NULL,
                 "'ngspice' returned %zu transients, expected 1", result.count);
  if (!j->code) trip_read_levels(j, t, &result.plot[0]);
  eda_spice_clear(&result);
}

/* ---- the map ---- */

/* A finite-state machine under construction, with growing arrays. */
typedef struct map {
  bench *b;
  machine *m;
  GArray *bit, *level, *next;
} map;

static void map_publish(map *a) {
  a->m->bit = (uint8_t *)a->bit->data;
  a->m->level = (int8_t *)a->level->data;
  a->m->next = (uint32_t *)a->next->data;
}

/* Return the index of the state with these inputs and levels; add the state if
   it is new. */
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
  map_publish(a);
  return (uint32_t)m->states++;
}

/* Record the result of a traversal. If the same change has led to another state
   before, the levels do not determine the state, and the transition is marked
   STATE_LOST. */
static void put_down(map *a, const trip *seen) {
  const size_t inputs = a->b->inputs;
  machine *m = a->m;
  g_autofree uint8_t *bit = g_new0(uint8_t, inputs);
  uint32_t s = state_of(a, bit, seen->level);
  for (size_t k = 0; k < seen->path.input->len; k++) {
    uint32_t input = g_array_index(seen->path.input, uint32_t, k);
    bit[input] ^= 1;
    uint32_t t = state_of(a, bit, seen->level + (k + 1) * m->watched);
    uint32_t *next = &m->next[s * inputs + input];
    *next = *next == STATE_UNKNOWN || *next == t ? t : STATE_LOST;
    s = t;
  }
  if (seen->target == STATE_UNKNOWN) return;
  uint32_t *next = &m->next[seen->target * inputs + seen->input];
  /* The recorded path no longer leads to the target state, so this transition
     is not unique. */
  if (*next == STATE_UNKNOWN) *next = STATE_LOST;
}

/* Plan traversals to states with untried input changes. Each traversal makes
   all untried changes of its state, and reverses each change. `tried` counts
   the changes, up to b->most. */
static size_t trips_plan(const map *a, trip *trips, size_t *tried) {
  const bench *b = a->b;
  const machine *m = a->m;
  size_t n = 0;
  for (uint32_t s = 0; s < m->states && n < WALKS; s++) {
    const uint32_t *next = m->next + s * b->inputs;
    uint32_t i = 0;
    while (i < b->inputs && next[i] != STATE_UNKNOWN) i++;
    if (i == b->inputs || *tried >= (size_t)b->most) continue;
    trip *t = &trips[n];
    *t = (trip){.path = traversal_new(m), .target = s, .input = i};
    if (!traversal_to(b, m, &t->path, s)) {
      traversal_clear(&t->path);
      continue;
    }
    for (n++; i < b->inputs && *tried < (size_t)b->most; i++) {
      if (next[i] != STATE_UNKNOWN) continue;
      traversal_step(b, m, &t->path, i);
      traversal_step(b, m, &t->path, i);
      ++*tried;
    }
  }
  return n;
}

/* Run one round. Returns 1 if all nets settled, -1 on failure. */
static int trips_run(map *a, trip *trips, size_t n, opc_error *error) {
  const round_of r = {a->m, trips};
  int rests = 1;
  int code = jobs_run_at(a->b, EDA_DRAWN, n, 1, run_job, &r, error);
  for (size_t i = 0; i < n; i++) rests &= trips[i].rests;
  for (size_t i = 0; i < n; i++) {
    if (!code && rests) put_down(a, &trips[i]);
    traversal_clear(&trips[i].path);
    g_free(trips[i].level);
  }
  return code ? -1 : rests;
}

/* Run rounds with a given phase until no change is untried. Returns 1 if all
   nets settled, 0 if a net did not settle, -1 on failure. */
static int map_explore(map *a, opc_error *error) {
  trip trips[WALKS];
  size_t tried = 0, n = 1;
  g_array_set_size(a->bit, 0);
  g_array_set_size(a->level, 0);
  g_array_set_size(a->next, 0);
  a->m->states = 0;
  trips[0] = (trip){.path = traversal_new(a->m), .target = STATE_UNKNOWN};
  while (n) {
    int rests = trips_run(a, trips, n, error);
    if (rests <= 0) return rests;
    n = trips_plan(a, trips, &tried);
  }
  for (size_t i = 0; i < a->m->states * a->b->inputs; i++)
    n += a->m->next[i] == STATE_UNKNOWN;
  if (n)
    a->b->host->log(
        a->b->host, OPC_LOG_INFO,
        "%zu input changes tried, nearest to the initial state; more exist",
        tried);
  return 1;
}

/* ---- resulting machine ---- */

/* Remove all states but `kept`. The changes that lead from power-up to a kept
   state become m->lead. */
static void leave_out(bench *b, machine *m, const uint8_t *kept) {
  g_autofree uint32_t *number = g_new(uint32_t, m->states);
  traversal w = traversal_new(m);
  uint32_t first = 0, n = 0;
  while (!kept[first]) first++;
  if (!traversal_synchronise(b, m, &w) || !kept[w.at]) {
    b->host->log(b->host, OPC_LOG_WARNING,
                 "no sequence of input changes is known that leads from all "
                 "states to one: the simulator chooses the initial state");
    traversal_clear(&w);
    w = traversal_new(m);
    traversal_to(b, m, &w, first);
  }
  m->leads = w.input->len;
  m->lead = eda_pool_alloc(&b->pool, m->leads, sizeof *m->lead);
  for (size_t i = 0; i < m->leads; i++)
    m->lead[i] = g_array_index(w.input, uint32_t, i);
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
  m->first = number[w.at];
  traversal_clear(&w);
}

static const void *array_keep(bench *b, const GArray *a, size_t count,
                              size_t size) {
  void *own = eda_pool_alloc(&b->pool, count, size);
  memcpy(own, a->data, count * size);
  return own;
}

/* List states as patterns, with the transitions between them and the levels of
   the outputs. Outputs have no level in a state with a net at an
   undefined level. */
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
      p->sampled |= t == STATE_UNKNOWN;
    }
    for (size_t k = 0; k < m->watched; k++)
      for (size_t o = 0; o < b->outputs; o++)
        if (m->net[k] == b->output[o])
          l->level[s * b->outputs + o] = known ? level[k] : -1;
  }
}

static void machine_warn(const bench *b, const machine *m) {
  const opc_host *host = b->host;
  size_t lost = 0;
  for (size_t i = 0; i < m->states * b->inputs; i++)
    lost += m->next[i] == STATE_LOST;
  if (lost)
    host->log(host, OPC_LOG_WARNING,
              "%zu changes of an input do not always lead to the same state "
              "and are omitted",
              lost);
  for (size_t k = 0; k < m->watched; k++) {
    size_t n = 0;
    for (size_t s = 0; s < m->states; s++)
      n += m->level[s * m->watched + k] < 0;
    if (n)
      host->log(host, OPC_LOG_WARNING,
                "net '%s' is at no logic level in %zu of %zu states, which are "
                "omitted",
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
    rests = map_explore(&a, error);
  }
  if (!rests)
    opc_fail(error, OPC_FAILED, "circuit", "'%s' has not settled after %g ns",
             b->circuit->name, 1e9 * m->phase);
  if (rests > 0) {
    size_t all = m->states;
    g_autofree uint8_t *kept = g_new(uint8_t, all);
    states_leading_to(b, m, kept);
    leave_out(b, m, kept);
    m->bit = (uint8_t *)array_keep(b, a.bit, m->states * b->inputs, 1);
    m->level = (int8_t *)array_keep(b, a.level, m->states * m->watched, 1);
    m->next = (uint32_t *)array_keep(b, a.next, m->states * b->inputs,
                                     sizeof *m->next);
    b->host->log(b->host, OPC_LOG_INFO,
                 "'%s' is sequential: %zu of %zu states of inputs and nets are "
                 "used; inputs change every %g ns",
                 b->circuit->name, m->states, all, 1e9 * m->phase);
    machine_warn(b, m);
    list_patterns(b, m, p, l);
  }
  g_array_free(a.bit, TRUE);
  g_array_free(a.level, TRUE);
  g_array_free(a.next, TRUE);
  return rests > 0 ? OPC_OK : error->code;
}
