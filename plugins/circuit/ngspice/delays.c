/* SPDX-License-Identifier: BSD-3-Clause */
/* Transients: how long outputs take to follow the inputs. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "bench.h"

enum {
  CHUNK = 4,     /* transitions of a process */
  POINTS = 1000, /* of a transient, at least */
  COARSE = 50,   /* of one that only looks for the end */
  LONGER = 4,    /* how much longer if that was too short */
  TRIES_DRAWN = 10,
  TRIES_PRINTED = 3
};

static const double first_window = 1e-9;
/* Of the time to the last slope's end. */
static const double room_after = 1.3;

/* A process: some transitions, one set of sizes. */
typedef struct job {
  const bench *b;
  const patterns *p;
  const delays *d;
  const char *netlist;
  int state, code;
  size_t from, to; /* flips */
  opc_error error;
} job;

double bench_start(const bench *b) { return b->slew; }

/* ---- decks ---- */

static char *make_deck(const job *j) {
  const bench *b = j->b;
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  if (!out) return NULL;
  bench_begin(b, out, 1e-4);
  bench_circuit(b, out, j->netlist);
  for (size_t i = 0; i < b->outputs; i++)
    fprintf(out, ".save v(n%u)\n", b->output[i]);
  fputs(".end\n", out);
  if (!fclose(out)) return text;
  free(text);
  return NULL;
}

/* Steps are at most a share of the window. */
static char *make_commands(const job *j, double window, int points) {
  const bench *b = j->b;
  double start = bench_start(b);
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  if (!out) return NULL;
  for (size_t k = j->from; k < j->to; k++) {
    transition t = j->p->transition[j->d->flip[k]];
    for (size_t i = 0; i < b->inputs; i++)
      fprintf(out, "alter @vi%zu[pwl] = [ 0 %.17g %.17g %.17g %.17g %.17g ]\n",
              i, b->supply * j->p->bit[t.from * b->inputs + i], start,
              b->supply * j->p->bit[t.from * b->inputs + i], start + b->slew,
              b->supply * j->p->bit[t.to * b->inputs + i]);
    fprintf(out, "tran %.17g %.17g 0 %.17g\n", window / points, window,
            window / points);
  }
  if (!fclose(out)) return text;
  free(text);
  return NULL;
}

/* ---- what is measured ---- */

/* Where the value passes a level between points i and i + 1. */
static double passes(const double *t, const double *v, size_t i, double level) {
  return t[i] + (level - v[i]) / (v[i + 1] - v[i]) * (t[i + 1] - t[i]);
}

/* Level, from 0 to 1 for a rising and a falling output alike. */
static double height(const bench *b, const arrival *a, double v) {
  return a->rises ? v / b->supply : 1 - v / b->supply;
}

/* The last point from which the height rises past a level, before a point;
   `none` if there is none. */
static size_t last_rise(const double *h, size_t before, double level,
                        size_t none) {
  for (size_t i = before; i-- > 0;)
    if (h[i] < level && h[i + 1] >= level) return i;
  return none;
}

/* Of an output that turns back on its way, the last time counts that it goes
   through the middle. Returns when it is over, NAN if it is not. */
static double measure(const bench *b, arrival *a, int state, const double *t,
                      const double *h, size_t n) {
  double middle = bench_start(b) + b->slew / 2;
  a->delay[state] = a->slope[state] = NAN;
  if (n < 2 || !(h[n - 1] >= b->high)) return NAN;
  size_t half = last_rise(h, n - 1, 0.5, n);
  size_t low = half < n ? last_rise(h, half + 1, b->low, n) : n;
  if (low == n) return NAN;
  size_t high = half;
  while (high + 2 < n && !(h[high + 1] >= b->high)) high++;
  double end = passes(t, h, high, b->high);
  a->delay[state] = passes(t, h, half, 0.5) - middle;
  a->slope[state] = end - passes(t, h, low, b->low);
  return end;
}

/* What became of all arrivals of a process. */
typedef struct outcome {
  size_t missing;
  double last; /* the end of the latest of the others */
} outcome;

static outcome measure_all(job *j, const opc_spice_result *r) {
  const bench *b = j->b;
  outcome all = {0, 0};
  for (size_t k = j->from; k < j->to; k++)
    for (uint32_t i = j->d->first[k]; i < j->d->first[k + 1]; i++) {
      arrival *a = &j->d->arrival[i];
      const opc_spice_plot *plot = &r->plot[k - j->from];
      node_name node;
      char name[32];
      snprintf(name, sizeof name, "v(%s)",
               bench_node(b, b->output[a->output], node));
      const opc_spice_vector *t = opc_spice_vector_find(plot, "time");
      const opc_spice_vector *v = opc_spice_vector_find(plot, name);
      size_t n = t && v && v->count == t->count ? t->count : 0;
      double *h = calloc(n + 1, sizeof *h);
      for (size_t m = 0; h && m < n; m++) h[m] = height(b, a, v->value[m]);
      double end = h ? measure(b, a, j->state, t ? t->value : NULL, h, n) : NAN;
      free(h);
      if (isnan(end)) all.missing++;
      if (end > all.last) all.last = end;
    }
  return all;
}

/* ---- one process ---- */

static outcome simulate(job *j, const char *deck, double window, int points) {
  opc_spice_result r = {0};
  outcome all = {SIZE_MAX, 0};
  char *commands = make_commands(j, window, points);
  if (!commands)
    j->code = no_memory(j->b->host, &j->error);
  else
    j->code =
        opc_spice_run(j->b->host, deck, commands, j->b->limit, &r, &j->error);
  if (!j->code && r.count == j->to - j->from) all = measure_all(j, &r);
  opc_spice_release(&r);
  free(commands);
  return all;
}

/* As drawn: how long all take, as far as they get there. */
static void find_window(job *j, const char *deck) {
  const bench *b = j->b;
  double wide = first_window + 4 * b->slew, start = bench_start(b);
  outcome best = {SIZE_MAX, 0};
  for (int i = 0; i < TRIES_DRAWN && best.missing && !j->code; i++) {
    outcome all = simulate(j, deck, wide, COARSE);
    if (all.missing < best.missing) best = all;
    wide *= LONGER;
  }
  double last = fmax(best.last, start + b->slew);
  for (size_t k = j->from; k < j->to; k++)
    j->d->window[k] = start + room_after * (last - start);
}

/* As printed, in the same time and so with the same steps, or longer if it
   takes longer. */
static void run_job(void *data, size_t index) {
  job *j = (job *)data + index;
  int drawn = j->state == NETLIST_DRAWN, points = POINTS;
  char *deck = make_deck(j);
  if (!deck) {
    j->code = no_memory(j->b->host, &j->error);
    return;
  }
  if (drawn) find_window(j, deck);
  double window = j->d->window[j->from];
  for (int i = 0; i < (drawn ? 1 : TRIES_PRINTED) && !j->code; i++) {
    if (!simulate(j, deck, window, points).missing) break;
    window *= LONGER;
    points *= LONGER;
  }
  free(deck);
}

static int find_state(bench *b, const patterns *p, const delays *d, int state,
                      opc_error *error) {
  const opc_host *host = b->host;
  size_t n = (d->flips + CHUNK - 1) / CHUNK;
  job *jobs = bench_alloc(b, n, sizeof *jobs, error);
  char *netlist =
      jobs ? bench_netlist(b, &b->plain, state, SIZE_TIMED, error) : NULL;
  if (!netlist) return error->code;
  for (size_t i = 0; i < n; i++)
    jobs[i] = (job){.b = b,
                    .p = p,
                    .d = d,
                    .netlist = netlist,
                    .state = state,
                    .from = i * CHUNK,
                    .to = i + 1 < n ? (i + 1) * CHUNK : d->flips};
  opc_spice_parallel(host, n, run_job, jobs);
  host->free(host, netlist);
  for (size_t i = 0; i < n; i++)
    if (jobs[i].code) {
      *error = jobs[i].error;
      return error->code;
    }
  return OPC_OK;
}

/* ---- which transitions ---- */

/* Whether output o follows transition t; `rises` is set where it does. */
static int follows(const bench *b, const patterns *p, const logic *l, size_t t,
                   size_t o, int *rises) {
  int from = l->level[p->transition[t].from * b->outputs + o];
  *rises = l->level[p->transition[t].to * b->outputs + o];
  return from >= 0 && *rises >= 0 && from != *rises;
}

/* Those that an output follows. */
static int list_arrivals(bench *b, const patterns *p, const logic *l, delays *d,
                         opc_error *error) {
  size_t all = 0;
  int rises;
  for (size_t t = 0; t < p->transitions; t++)
    for (size_t o = 0; o < b->outputs; o++)
      all += (size_t)follows(b, p, l, t, o, &rises);
  d->flip = bench_alloc(b, p->transitions, sizeof *d->flip, error);
  d->first = bench_alloc(b, p->transitions + 1, sizeof *d->first, error);
  d->arrival = bench_alloc(b, all, sizeof *d->arrival, error);
  d->window = bench_alloc(b, p->transitions, sizeof *d->window, error);
  if (!d->flip || !d->first || !d->arrival || !d->window) return error->code;
  for (uint32_t t = 0; t < p->transitions; t++) {
    size_t before = d->count;
    for (uint32_t o = 0; o < b->outputs; o++) {
      if (!follows(b, p, l, t, o, &rises)) continue;
      arrival *a = &d->arrival[d->count++];
      *a = (arrival){.flip = (uint32_t)d->flips, .output = o, .rises = rises};
      for (int s = 0; s < STATES; s++) a->delay[s] = a->slope[s] = NAN;
    }
    if (d->count == before) continue;
    d->flip[d->flips++] = t;
    d->first[d->flips] = (uint32_t)d->count;
  }
  return OPC_OK;
}

/* Of outputs that never change or are at no logic level. */
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
      b->host->log(b->host, OPC_LOG_WARNING, "output '%s' never changes", name);
  }
}

int delays_find(bench *b, const patterns *p, const logic *l, delays *out,
                opc_error *error) {
  *out = (delays){0};
  if (list_arrivals(b, p, l, out, error)) return error->code;
  warn_of_outputs(b, p, l, out);
  for (int state = 0; state < STATES; state++) {
    if (!b->has[state]) continue;
    int code = find_state(b, p, out, state, error);
    if (bench_forgive(b, state, code, error)) return code;
  }
  return OPC_OK;
}

/* ---- for the picture ---- */

static int keep_wave(bench *b, const arrival *a, const opc_spice_plot *plot,
                     wave *out, opc_error *error) {
  char name[32];
  snprintf(name, sizeof name, "v(n%u)", b->output[a->output]);
  const opc_spice_vector *t = opc_spice_vector_find(plot, "time");
  const opc_spice_vector *v = opc_spice_vector_find(plot, name);
  out->count = t && v && t->count == v->count ? t->count : 0;
  out->time = bench_alloc(b, out->count, sizeof(double), error);
  out->value = bench_alloc(b, out->count, sizeof(double), error);
  if (!out->time || !out->value) return error->code;
  for (size_t i = 0; i < out->count; i++) {
    out->time[i] = t->value[i];
    out->value[i] = v->value[i];
  }
  return OPC_OK;
}

int delays_wave(bench *b, const patterns *p, const delays *d, size_t index,
                int state, wave *out, opc_error *error) {
  const arrival *a = &d->arrival[index];
  *out = (wave){0};
  char *netlist = bench_netlist(b, &b->plain, state, SIZE_TIMED, error);
  if (!netlist) return error->code;
  job j = {.b = b,
           .p = p,
           .d = d,
           .netlist = netlist,
           .state = state,
           .from = a->flip,
           .to = a->flip + 1};
  opc_spice_result r = {0};
  char *deck = make_deck(&j);
  char *commands = make_commands(&j, d->window[a->flip], POINTS);
  int code = deck && commands
                 ? opc_spice_run(b->host, deck, commands, b->limit, &r, error)
                 : no_memory(b->host, error);
  if (!code && r.count) code = keep_wave(b, a, &r.plot[0], out, error);
  opc_spice_release(&r);
  free(deck);
  free(commands);
  b->host->free(b->host, netlist);
  return code;
}
