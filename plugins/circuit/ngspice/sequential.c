/* SPDX-License-Identifier: BSD-3-Clause */
/* Measures delays of sequential circuits along traversals of their states. A
   traversal measures several transitions in sequence. */
#include <glib.h>
#include <stdio.h>
#include <string.h>

#include "bench.h"

enum { FLIPS = 8 }; /* number of transitions measured per traversal */

/* Relative tolerance, and option `trtol` (default 7) of the simulator.
   Tolerances of charges and currents alone limit the time steps. Compared with
   steps of 0.2 ps, delays of a flip-flop agree within 0.003 % and slopes within
   0.04 %. With 10 times the tolerance, they agree within 0.01 % and 0.4 %, in
   two thirds of the time. */
static const double share = 1e-5, steps = 1;

/* Data shared by all jobs. */
typedef struct study {
  const patterns *p;
  const delays *d;
} study;

/* ---- one traversal ---- */

/* A traversal, and the phase of each transition to be measured. */
typedef struct tour {
  traversal path;
  size_t step[FLIPS];
} tour;

static tour tour_plan(const bench_task *j) {
  const study *s = j->of;
  const machine *m = s->d->machine;
  tour t = {.path = traversal_new(m)};
  for (size_t k = j->from; k < j->to; k++) {
    transition flip = s->p->transition[s->d->flip[k]];
    uint32_t input = 0;
    traversal_to(j->b, m, &t.path, flip.from);
    while (m->next[flip.from * j->b->inputs + input] != flip.to) input++;
    traversal_step(j->b, m, &t.path, input);
    t.step[k - j->from] = t.path.input->len;
  }
  return t;
}

static void write_deck(bench_task *j, FILE *out, const void *how) {
  const machine *m = ((const study *)j->of)->d->machine;
  job_begin(j, out, share, SWITCHING_CURRENT);
  fprintf(out, ".options trtol=%g\n", steps);
  job_circuit(j, out, SIZE_TIMED);
  traversal_sources(j->b, m, how, out);
  states_save(j->b, m, out);
  fputs(".end\n", out);
}

static void write_commands(bench_task *j, FILE *out, const void *how) {
  traversal_command(((const study *)j->of)->d->machine, how, out);
}

/* Return 1 if all nets have the levels of a state. */
static int is_in(const bench_task *j, const eda_spice_plot *plot,
                 uint32_t state, double time) {
  const machine *m = ((const study *)j->of)->d->machine;
  g_autofree int8_t *level = g_new(int8_t, m->watched);
  states_levels(j->b, m, plot, time, level);
  return !memcmp(level, m->level + state * m->watched, m->watched);
}

static void tour_measure(const bench_task *j, const tour *t,
                         const eda_spice_plot *plot) {
  const study *s = j->of;
  const double phase = s->d->machine->phase;
  for (size_t k = j->from; k < j->to; k++) {
    transition flip = s->p->transition[s->d->flip[k]];
    double begin = phase * (double)t->step[k - j->from];
    if (!is_in(j, plot, flip.from, begin) ||
        !is_in(j, plot, flip.to, begin + phase))
      continue;
    for (uint32_t i = s->d->first[k]; i < s->d->first[k + 1]; i++)
      arrival_measure(j->b, &s->d->arrival[i], j->state, plot, begin,
                      begin + phase);
  }
}

static tour tour_simulate(bench_task *j, eda_spice_result *r) {
  tour t = tour_plan(j);
  g_autofree char *deck = job_text(j, write_deck, &t.path);
  g_autofree char *commands = job_text(j, write_commands, &t.path);
  job_simulate(j, deck, commands, r);
  if (!j->code && r->count != 1)
    j->code =
        opc_fail(&j->error, OPC_FAILED, NULL,
                 "'ngspice' returned %zu transients, expected 1", r->count);
  return t;
}

static void run_job(bench_task *j) {
  eda_spice_result r;
  tour t = tour_simulate(j, &r);
  if (!j->code) tour_measure(j, &t, &r.plot[0]);
  traversal_clear(&t.path);
  eda_spice_clear(&r);
}

int sequential_run(bench *b, const patterns *p, const delays *d,
                   opc_error *error) {
  const study s = {p, d};
  for (size_t k = 0; k < d->flips; k++)
    d->window[k] = bench_start(b) + d->machine->phase;
  return jobs_run(b, d->flips, FLIPS, run_job, &s, error);
}

int sequential_wave(bench *b, const patterns *p, const delays *d, size_t index,
                    int state, wave *out, opc_error *error) {
  const arrival *a = &d->arrival[index];
  const study s = {p, d};
  bench_task j = {
      .b = b, .of = &s, .state = state, .from = a->flip, .to = a->flip + 1};
  eda_spice_result r;
  tour t = tour_simulate(&j, &r);
  double begin = d->machine->phase * (double)t.step[0];
  if (!j.code)
    wave_keep(b, a, &r.plot[0], begin, begin + d->machine->phase, out);
  traversal_clear(&t.path);
  eda_spice_clear(&r);
  if (j.code) *error = j.error;
  return j.code;
}
