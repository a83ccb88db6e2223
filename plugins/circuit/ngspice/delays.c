/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures delays from inputs to outputs in transient analyses. */
#include <eda/wave.h>
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench.h"

enum {
  CHUNK = 4,     /* number of transitions per process */
  POINTS = 1000, /* least number of points of a transient */
  COARSE = 50,   /* points of a transient that only determines the duration */
  LONGER = 4,    /* factor on the duration of a retry */
  TRIES_DRAWN = 10,
  TRIES_PRINTED = 3
};

static const double first_window = 1e-9;
/* Duration of a transient relative to the end of the last output slope. */
static const double capacity_after = 1.3;

/* Data shared by all jobs. An item is a flip (delays.flip). */
typedef struct study {
  const patterns *p;
  const delays *d;
} study;

/* Settings of a transient. */
typedef struct transient {
  double window;
  int points; /* least number of points; the largest step is window / points */
} transient;

/* ---- decks ---- */

static void write_deck(bench_task *j, FILE *out, const void *how) {
  const bench *b = j->b;
  (void)how;
  job_begin(j, out, 1e-4, SWITCHING_CURRENT);
  job_circuit(j, out, SIZE_TIMED);
  job_sources(j, out);
  for (size_t i = 0; i < b->outputs; i++)
    fprintf(out, ".save v(n%u)\n", b->output[i]);
  fputs(".end\n", out);
}

static void write_commands(bench_task *j, FILE *out, const void *how) {
  const bench *b = j->b;
  const study *s = j->of;
  const transient *w = how;
  double start = bench_start(b), step = w->window / w->points;
  for (size_t k = j->from; k < j->to; k++) {
    transition t = s->p->transition[s->d->flip[k]];
    for (size_t i = 0; i < b->inputs; i++)
      fprintf(out, "alter @vi%zu[pwl] = [ 0 %.17g %.17g %.17g %.17g %.17g ]\n",
              i, b->supply * s->p->bit[t.from * b->inputs + i], start,
              b->supply * s->p->bit[t.from * b->inputs + i], start + b->slew,
              b->supply * s->p->bit[t.to * b->inputs + i]);
    fprintf(out, "tran %.17g %.17g 0 %.17g\n", step, w->window, step);
  }
}

/* ---- measurement ---- */

/* Measure the last edge of an output. Return the end of the edge; NAN if the
   edge is incomplete or the output changes again. */
static double last_edge_measure(const bench *b, arrival *a, int state,
                                double middle, const double *t, const double *h,
                                size_t n) {
  eda_wave_edge e;
  a->delay[state] = a->slope[state] = NAN;
  if (!eda_wave_find(h, n, b->low, b->high, &e) || !(h[n - 1] >= b->high))
    return NAN;
  double end = eda_wave_time(t, h, e.high, b->high);
  a->delay[state] = eda_wave_time(t, h, e.half, 0.5) - middle;
  a->slope[state] = end - eda_wave_time(t, h, e.low, b->low);
  return end;
}

/* Return the part of an output's vector from one slew before `begin` to
   `end`. */
static size_t part_of(const bench *b, const arrival *a,
                      const eda_spice_plot *plot, double begin, double end,
                      const double **time, const double **value) {
  char name[32];
  snprintf(name, sizeof name, "v(n%u)", b->output[a->output]);
  const eda_spice_vector *t = eda_spice_vector_find(plot, "time");
  const eda_spice_vector *v = eda_spice_vector_find(plot, name);
  size_t from = 0, to = t && v && v->count == t->count ? t->count : 0;
  while (from < to && t->value[from] < begin - b->slew) from++;
  while (to > from && t->value[to - 1] > end) to--;
  *time = to > from ? t->value + from : NULL;
  *value = to > from ? v->value + from : NULL;
  return to - from;
}

double arrival_measure(const bench *b, arrival *a, int state,
                       const eda_spice_plot *plot, double begin, double end) {
  const double *t, *v;
  size_t n = part_of(b, a, plot, begin, end, &t, &v);
  g_autofree double *h = g_new(double, n);
  eda_wave_heights(v, n, b->supply, a->rises, h);
  return last_edge_measure(b, a, state, begin + b->slew / 2, t, h, n);
}

/* Result of all arrivals of a process. */
typedef struct outcome {
  size_t missing;
  double last; /* end of the latest complete arrival, s */
} outcome;

static outcome measure_all(const bench_task *j, const eda_spice_result *r) {
  const bench *b = j->b;
  const delays *d = ((const study *)j->of)->d;
  outcome all = {0, 0};
  for (size_t k = j->from; k < j->to; k++)
    for (uint32_t i = d->first[k]; i < d->first[k + 1]; i++) {
      double end =
          arrival_measure(b, &d->arrival[i], j->state, &r->plot[k - j->from],
                          bench_start(b), INFINITY);
      if (isnan(end)) all.missing++;
      if (end > all.last) all.last = end;
    }
  return all;
}

/* ---- one process ---- */

static outcome delays_simulate(bench_task *j, const char *deck, transient how) {
  eda_spice_result r;
  outcome all = {SIZE_MAX, 0};
  g_autofree char *commands = job_text(j, write_commands, &how);
  job_simulate(j, deck, commands, &r);
  if (!j->code && r.count == j->to - j->from) all = measure_all(j, &r);
  eda_spice_clear(&r);
  return all;
}

/* Find the duration after which all outputs that settle at drawn sizes have
   settled. */
static void find_window(bench_task *j, const char *deck) {
  const bench *b = j->b;
  const delays *d = ((const study *)j->of)->d;
  transient how = {first_window + 4 * b->slew, COARSE};
  outcome best = {SIZE_MAX, 0};
  for (int i = 0; i < TRIES_DRAWN && best.missing && !j->code; i++) {
    outcome all = delays_simulate(j, deck, how);
    if (all.missing < best.missing) best = all;
    how.window *= LONGER;
  }
  double start = bench_start(b), last = fmax(best.last, start + b->slew);
  for (size_t k = j->from; k < j->to; k++)
    d->window[k] = start + capacity_after * (last - start);
}

/* Simulate drawn sizes with the duration that find_window determines. Simulate
   printed sizes with the same duration and time steps; extend the duration if
   an output has not settled. */
static void run_job(bench_task *j) {
  const delays *d = ((const study *)j->of)->d;
  int drawn = j->state == EDA_DRAWN;
  g_autofree char *deck = job_text(j, write_deck, NULL);
  if (drawn && deck) find_window(j, deck);
  transient how = {d->window[j->from], POINTS};
  for (int i = 0; i < (drawn ? 1 : TRIES_PRINTED) && !j->code; i++) {
    if (!delays_simulate(j, deck, how).missing) break;
    how.window *= LONGER;
    how.points *= LONGER;
  }
}

/* ---- transitions to measure ---- */

/* Return 1 if output o changes after transition t, and set `rises`. */
static int output_follows(const bench *b, const patterns *p, const logic *l,
                          size_t t, size_t o, int *rises) {
  int from = l->level[p->transition[t].from * b->outputs + o];
  *rises = l->level[p->transition[t].to * b->outputs + o];
  return from >= 0 && *rises >= 0 && from != *rises;
}

/* List the transitions after which an output changes. */
static void list_arrivals(bench *b, const patterns *p, const logic *l,
                          delays *d) {
  size_t all = 0;
  int rises;
  for (size_t t = 0; t < p->transitions; t++)
    for (size_t o = 0; o < b->outputs; o++)
      all += (size_t)output_follows(b, p, l, t, o, &rises);
  d->flip = eda_pool_alloc(&b->pool, p->transitions, sizeof *d->flip);
  d->first = eda_pool_alloc(&b->pool, p->transitions + 1, sizeof *d->first);
  d->arrival = eda_pool_alloc(&b->pool, all, sizeof *d->arrival);
  d->window = eda_pool_alloc(&b->pool, p->transitions, sizeof *d->window);
  for (uint32_t t = 0; t < p->transitions; t++) {
    size_t before = d->count;
    for (uint32_t o = 0; o < b->outputs; o++) {
      if (!output_follows(b, p, l, t, o, &rises)) continue;
      arrival *a = &d->arrival[d->count++];
      *a = (arrival){.flip = (uint32_t)d->flips, .output = o, .rises = rises};
      for (int s = 0; s < EDA_STATES; s++) a->delay[s] = a->slope[s] = NAN;
    }
    if (d->count == before) continue;
    d->flip[d->flips++] = t;
    d->first[d->flips] = (uint32_t)d->count;
  }
}

/* Warn about outputs that never change or have no logic level. */
static void warn_of_outputs(const bench *b, const patterns *p, const logic *l,
                            const delays *d) {
  for (size_t o = 0; o < b->outputs; o++) {
    size_t unknown = 0, i = 0;
    const char *name = b->circuit->net[b->output[o]];
    for (size_t k = 0; k < p->count; k++)
      unknown += l->level[k * b->outputs + o] < 0;
    while (i < d->count && d->arrival[i].output != o) i++;
    if (unknown)
      b->host->log(b->host, OPC_LOG_WARNING,
                   "output '%s' is at no logic level in %zu of %zu patterns",
                   name, unknown, p->count);
    if (i == d->count)
      b->host->log(b->host, OPC_LOG_WARNING, "output '%s' does not change%s",
                   name, p->sampled ? " for the tried inputs" : "");
  }
}

int delays_find(bench *b, const machine *m, const patterns *p, const logic *l,
                delays *out, opc_error *error) {
  const study s = {p, out};
  *out = (delays){.machine = m};
  list_arrivals(b, p, l, out);
  warn_of_outputs(b, p, l, out);
  if (m) return sequential_run(b, p, out, error);
  return jobs_run(b, out->flips, CHUNK, run_job, &s, error);
}

/* ---- waveforms for the picture ---- */

void wave_keep(bench *b, const arrival *a, const eda_spice_plot *plot,
               double begin, double end, wave *out) {
  const double *t, *v;
  out->count = part_of(b, a, plot, begin, end, &t, &v);
  out->time = eda_pool_alloc(&b->pool, out->count, sizeof(double));
  out->value = eda_pool_alloc(&b->pool, out->count, sizeof(double));
  for (size_t i = 0; i < out->count; i++) {
    out->time[i] = t[i] - begin + bench_start(b);
    out->value[i] = v[i];
  }
}

int delays_wave(bench *b, const patterns *p, const delays *d, size_t index,
                int state, wave *out, opc_error *error) {
  const arrival *a = &d->arrival[index];
  const study s = {p, d};
  const transient how = {d->window[a->flip], POINTS};
  bench_task j = {
      .b = b, .of = &s, .state = state, .from = a->flip, .to = a->flip + 1};
  eda_spice_result r;
  *out = (wave){0};
  if (d->machine) return sequential_wave(b, p, d, index, state, out, error);
  g_autofree char *deck = job_text(&j, write_deck, NULL);
  g_autofree char *commands = job_text(&j, write_commands, &how);
  job_simulate(&j, deck, commands, &r);
  if (!j.code && r.count)
    wave_keep(b, a, &r.plot[0], bench_start(b), INFINITY, out);
  eda_spice_clear(&r);
  if (j.code) *error = j.error;
  return j.code;
}
