/* SPDX-License-Identifier: BSD-3-Clause */
/* Computes logic levels and leakage from operating points of input patterns. */
#include <glib.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench.h"

enum { CHUNK = 64 }; /* number of patterns per process */

/* Test current in A per um of channel width at an output, directed to half the
   supply. The current is far above leakage (0.2 uA) and far below drive
   currents (0.2 mA). A driven output keeps its level, a floating output does
   not. */
static const double test_current = 5e-6;

/* Smallest voltage of a high output under the test current, relative to the
   supply. A low output has at most 1 - least_height. */
static const double least_height = 0.75;

/* Data shared by all jobs. */
typedef struct study {
  const patterns *p;
  const logic *out;
} study;

/* ---- one process ---- */

/* Return the number of operating points per pattern. Drawn sizes have two,
   without and with the test current; printed sizes have one. */
static size_t points_of(const bench_task *j) {
  return j->state == EDA_DRAWN ? 2 : 1;
}

static double test_resistance(const bench *b, uint32_t net) {
  const eda_circuit *c = b->circuit;
  double width = 0;
  for (size_t i = 0; i < c->count; i++)
    if (c->device[i].drain == net || c->device[i].source == net)
      width += c->device[i].width / 1000;
  return b->supply / 2 / (test_current * fmax(width, 1e-3));
}

static void write_deck(bench_task *j, FILE *out, const void *how) {
  const bench *b = j->b;
  const eda_circuit *c = b->circuit;
  (void)how;
  job_begin(j, out, 1e-5, 1e-15);
  job_circuit(j, out, SIZE_OFF);
  job_sources(j, out);
  for (size_t i = 0; i < c->ports; i++)
    if (c->role[i] == EDA_PIN_SUPPLY) fprintf(out, ".save i(vs%zu)\n", i);
  for (size_t i = 0; i < b->inputs; i++) fprintf(out, ".save i(vi%zu)\n", i);
  for (size_t i = 0; i < b->outputs; i++)
    fprintf(out, "rt%zu n%u middle 1e18\n.save v(n%u)\n", i, b->output[i],
            b->output[i]);
  fprintf(out, "vmiddle middle 0 %.17g\n.end\n", b->supply / 2);
}

static void write_commands(bench_task *j, FILE *out, const void *how) {
  const bench *b = j->b;
  const study *s = j->of;
  (void)how;
  for (size_t k = j->from; k < j->to; k++) {
    const uint8_t *bit = s->p->bit + k * b->inputs;
    for (size_t i = 0; i < b->inputs; i++)
      if (k == j->from || bit[i] != (bit - b->inputs)[i])
        fprintf(out, "alter @vi%zu[dc] = %.17g\n", i, bit[i] ? b->supply : 0);
    fputs("op\n", out);
    if (points_of(j) == 1) continue;
    for (size_t i = 0; i < b->outputs; i++)
      fprintf(out, "alter rt%zu = %.17g\n", i,
              test_resistance(b, b->output[i]));
    fputs("op\n", out);
    for (size_t i = 0; i < b->outputs; i++)
      fprintf(out, "alter rt%zu = 1e18\n", i);
  }
}

static double value_of(const eda_spice_plot *plot, const char *format,
                       size_t n) {
  char name[40];
  snprintf(name, sizeof name, format, n);
  const eda_spice_vector *v = eda_spice_vector_find(plot, name);
  return v && v->count ? v->value[0] : (double)NAN;
}

static void keep_point(const bench_task *j, const eda_spice_plot *rest,
                       size_t k) {
  const bench *b = j->b;
  const eda_circuit *c = b->circuit;
  const study *s = j->of;
  const uint8_t *bit = s->p->bit + k * b->inputs;
  double from_supply = 0, from_inputs = 0;
  for (size_t i = 0; i < c->ports; i++)
    if (c->role[i] == EDA_PIN_SUPPLY)
      from_supply -= value_of(rest, "i(vs%zu)", i);
  for (size_t i = 0; i < b->inputs; i++)
    if (bit[i]) from_inputs -= value_of(rest, "i(vi%zu)", i);
  s->out->current[j->state][k] = from_supply;
  s->out->power[j->state][k] = b->supply * (from_supply + from_inputs);
}

static int level_of(const bench *b, double rest, double test) {
  if (rest >= b->high && test >= least_height) return 1;
  return rest <= b->low && test <= 1 - least_height ? 0 : -1;
}

static void keep_levels(const bench_task *j, const eda_spice_plot *plot,
                        size_t k) {
  const bench *b = j->b;
  const study *s = j->of;
  for (size_t i = 0; i < b->outputs; i++) {
    double v[2];
    for (int point = 0; point < 2; point++)
      v[point] = value_of(&plot[point], "v(n%zu)", b->output[i]) / b->supply;
    s->out->level[k * b->outputs + i] = level_of(b, v[0], v[1]);
  }
}

static void run_job(bench_task *j) {
  eda_spice_result r;
  g_autofree char *deck = job_text(j, write_deck, NULL);
  g_autofree char *commands = job_text(j, write_commands, NULL);
  job_simulate(j, deck, commands, &r);
  size_t points = points_of(j), all = points * (j->to - j->from);
  if (!j->code && r.count != all)
    j->code = opc_fail(&j->error, OPC_FAILED, NULL,
                       "'ngspice' returned %zu operating points, expected %zu",
                       r.count, all);
  for (size_t k = j->from; !j->code && k < j->to; k++) {
    const eda_spice_plot *plot = &r.plot[points * (k - j->from)];
    keep_point(j, plot, k);
    if (points == 2) keep_levels(j, plot, k);
  }
  eda_spice_clear(&r);
}

int logic_find(bench *b, const patterns *p, logic *out, opc_error *error) {
  const study s = {p, out};
  *out = (logic){0};
  out->level =
      eda_pool_alloc(&b->pool, p->count * b->outputs, sizeof *out->level);
  for (int state = 0; state < EDA_STATES; state++) {
    out->current[state] = eda_pool_alloc(&b->pool, p->count, sizeof(double));
    out->power[state] = eda_pool_alloc(&b->pool, p->count, sizeof(double));
  }
  return jobs_run(b, p->count, CHUNK, run_job, &s, error);
}
