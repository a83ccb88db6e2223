/* SPDX-License-Identifier: BSD-3-Clause */
/* Reference model: simulates some of the transitions with the whole circuit in
   ngspice, at the sizes used by the event simulation. */
#include <eda/simulator.h>
#include <eda/wave.h>
#include <math.h>
#include <opcflow/table.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "paths.h"

enum {
  SIZES = 2, /* drawn sizes, sizes printed by the mask */
  TRIES = 3  /* largest number of runs of a transition */
};

static const double step = 0.5e-12; /* largest time step, s; delays are then
                                       accurate to 0.1 % */

typedef struct line {
  int64_t pattern;
  const char *output, *edge;
  double drawn, drawn_spice, printed, printed_spice; /* ps */
  double error, by, by_spice;                        /* % */
  int there[SIZES];
} line;

typedef struct reference {
  paths *p;
  char *netlist[SIZES], *cards;
  uint32_t *port; /* net of the circuit for each input and output of the
                     graph */
  size_t sizes;
  line *line; /* [pattern * outputs + output] */
  int code;
  opc_error error;
} reference;

/* Largest distance of a settled output from its level, relative to the
   supply. */
static const double settled = 0.025;

/* start: time of the earliest start of the input ramps, s. A run lasts until
   `late` times the latest arrival of the event simulation (which has an error
   of some percent) plus the settling time `rest` of a slow output, s. A run in
   which an output does not settle is repeated with twice the duration. */
static const double start = 2e-12, late = 1.2, rest = 60e-12;

/* Duration of the input ramps with their exponential ends, relative to the
   duration of a linear ramp (eda_timing_ramp_time). */
static const double ramps = 3;

/* Return the time at which inputs cross the middle, s. The ramp begins at most
   two slews earlier. */
static double middle_of(const paths *p) { return start + 2 * p->at.slew; }

/* ---- decks ---- */

static int find_port(const eda_circuit *c, const char *name, uint32_t *out) {
  for (size_t i = 0; i < c->ports; i++)
    if (eda_same_name(c->net[c->port[i]], name)) {
      *out = c->port[i];
      return 1;
    }
  return 0;
}

static int find_ports(reference *r, opc_error *error) {
  const graph *g = &r->p->graph;
  r->port =
      eda_pool_alloc(&r->p->pool, g->inputs + g->outputs, sizeof *r->port);
  for (size_t i = 0; i < g->inputs + g->outputs; i++) {
    const char *name =
        g->net[i < g->inputs ? g->input[i] : g->output[i - g->inputs]];
    if (!find_port(r->p->circuit, name, &r->port[i]))
      return opc_fail(error, OPC_INVALID, "circuit",
                      "'%.100s' has no port '%s'", r->p->circuit->name, name);
  }
  return OPC_OK;
}

/* Return a copy of the circuit with names that the simulator accepts. */
static eda_circuit plain_circuit(paths *p) {
  eda_circuit c = *p->circuit;
  c.net = eda_pool_alloc(&p->pool, c.nets, sizeof *c.net);
  for (size_t i = 0; i < c.nets; i++) {
    char name[24];
    int n = snprintf(name, sizeof name, "n%zu", i);
    c.net[i] = eda_pool_text(&p->pool, name, (size_t)n);
  }
  return c;
}

static int make_netlists(reference *r, opc_error *error) {
  paths *p = r->p;
  eda_circuit plain = plain_circuit(p);
  eda_card card[2];
  size_t size;
  FILE *out = open_memstream(&r->cards, &size);
  for (int i = 0; i < 2; i++) {
    char *path = p->models[i] ? realpath(p->models[i], NULL) : NULL;
    if (path) fprintf(out, ".include \"%s\"\n", path);
    free(path);
  }
  fclose(out);
  for (int type = 0; type < 2; type++)
    if (eda_card_read(&p->pool, p->models[type && p->models[1]], p->model[type],
                      type, &card[type], error))
      return error->code;
  for (size_t s = 0; s < r->sizes; s++) {
    const eda_annotation a = {.circuit = &plain,
                              .mask = p->mask,
                              .state = s ? EDA_AFTER : EDA_DRAWN,
                              .model = {p->model[0], p->model[1]},
                              .card = {&card[0], &card[1]}};
    r->netlist[s] = eda_annotate(&a, NULL, error);
    if (!r->netlist[s]) return error->code;
  }
  return OPC_OK;
}

static char *deck_text(const reference *r, size_t sizes, const uint8_t *before,
                       const uint8_t *after) {
  const paths *p = r->p;
  const graph *g = &p->graph;
  const eda_circuit *c = p->circuit;
  double supply = p->timing->supply;
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  fprintf(out,
          "timing.paths\n%s.options temp=%.17g gmin=1e-15 reltol=3e-4 "
          "abstol=1e-14 chgtol=1e-18\n%sx1",
          r->cards, p->timing->temperature, r->netlist[sizes]);
  for (size_t i = 0; i < c->ports; i++)
    if (c->role[i] == EDA_PIN_GROUND)
      fputs("\n+ 0", out);
    else
      fprintf(out, "\n+ n%u", c->port[i]);
  fprintf(out, "\n+ %s\n", c->name);
  for (size_t i = 0; i < c->ports; i++)
    if (c->role[i] == EDA_PIN_SUPPLY)
      fprintf(out, "vs%zu n%u 0 %.17g\n", i, c->port[i], supply);
  for (size_t i = 0; i < g->inputs; i++) {
    fprintf(out, "vi%zu n%u 0 ", i, r->port[i]);
    eda_timing_ramp_write(out, p->timing, before[i], after[i], p->at.slew,
                          middle_of(p));
  }
  for (size_t i = 0; i < g->outputs; i++)
    fprintf(out, "cl%zu n%u 0 %.17g\n.save v(n%u)\n", i, r->port[g->inputs + i],
            p->at.load, r->port[g->inputs + i]);
  fputs(".end\n", out);
  fclose(out);
  return text;
}

/* ---- one transition at one set of sizes ---- */

/* Return the last time at which an output crosses the middle, ps after the
   inputs; NAN if the output does not reach its final level. */
static double arrival_of(const paths *p, const double *t, const double *v,
                         size_t n, int rises) {
  double *h = eda_alloc(n, sizeof *h), time = NAN;
  eda_wave_heights(v, n, p->timing->supply, rises, h);
  size_t half = eda_wave_last_rise(h, n - 1, 0.5, n);
  if (half < n && fabs(h[n - 1] - 1) <= settled)
    time = 1e12 * (eda_wave_time(t, h, half, 0.5) - middle_of(p));
  free(h);
  return time;
}

static int reference_read_plot(reference *r, size_t sizes, size_t pattern,
                               const waves *w, const eda_spice_plot *plot) {
  const paths *p = r->p;
  const graph *g = &p->graph;
  const eda_spice_vector *t = eda_spice_vector_find(plot, "time");
  int missing = !t;
  for (size_t o = 0; o < g->outputs && t; o++) {
    line *l = &r->line[pattern * g->outputs + o];
    char name[32];
    double ours = waves_arrival(w, o).time;
    if (isnan(ours)) continue;
    snprintf(name, sizeof name, "v(n%u)", r->port[g->inputs + o]);
    const eda_spice_vector *v = eda_spice_vector_find(plot, name);
    int rises = !w->level[g->output[o]];
    double theirs = v && v->count == t->count
                        ? arrival_of(p, t->value, v->value, t->count, rises)
                        : (double)NAN;
    missing |= isnan(theirs);
    *(sizes ? &l->printed : &l->drawn) = ours;
    *(sizes ? &l->printed_spice : &l->drawn_spice) = theirs;
    l->there[sizes] = !isnan(theirs);
    l->output = g->net[g->output[o]];
    l->edge = rises ? "rises" : "falls";
    l->pattern = (int64_t)pattern;
  }
  return missing;
}

static void run_one(void *data, size_t index) {
  reference *r = data;
  const paths *p = r->p;
  size_t pattern = index / r->sizes, sizes = index % r->sizes;
  opc_error error = {0};
  double longest = 0;
  waves w;
  waves_init(&w, p);
  pattern_at(p, pattern, w.before, w.after);
  waves_run(&w, &p->state[sizes]);
  for (size_t o = 0; o < p->graph.outputs; o++)
    longest = fmax(longest, waves_arrival(&w, o).time);
  char *text = deck_text(r, sizes, w.before, w.after);
  double window = middle_of(p) +
                  ramps * eda_timing_ramp_time(p->timing, p->at.slew, 1) +
                  late * longest * 1e-12 + rest;
  int missing = longest > 0, code = OPC_OK;
  for (int i = 0; i < TRIES && missing && !code; i++, window *= 2) {
    eda_spice_result result = {0};
    char command[100];
    snprintf(command, sizeof command, "tran %.17g %.17g 0 %.17g\n", step,
             window, step);
    code = eda_spice_run(p->host->context, text, command, p->limit, &result,
                         &error);
    if (!code)
      missing = reference_read_plot(r, sizes, pattern, &w, &result.plot[0]);
    eda_spice_clear(&result);
  }
  if (code) {
    r->code = code; /* the last of several errors is kept */
    r->error = error;
  }
  free(text);
  waves_clear(&w);
}

/* ---- all ---- */

typedef struct sums {
  double error, error_max, by, by_max;
  size_t lines;
} sums;

static sums reference_compare(reference *r, size_t n, line *kept) {
  sums s = {0};
  for (size_t i = 0; i < n; i++) {
    line *l = &r->line[i];
    if (!l->there[0] || !l->there[r->sizes - 1]) continue;
    l->error = 100 * (l->drawn / l->drawn_spice - 1);
    l->by = 100 * (l->printed / l->drawn - 1);
    l->by_spice = 100 * (l->printed_spice / l->drawn_spice - 1);
    s.error += l->error * l->error;
    s.error_max = fmax(s.error_max, fabs(l->error));
    if (r->sizes > 1) {
      s.by += fabs(l->by - l->by_spice);
      s.by_max = fmax(s.by_max, fabs(l->by - l->by_spice));
    }
    kept[s.lines++] = *l;
  }
  if (!s.lines) return s;
  s.error = sqrt(s.error / (double)s.lines);
  s.by /= (double)s.lines;
  return s;
}

static int reference_report(reference *r, size_t n, opc_error *error) {
  line *l = eda_pool_alloc(&r->p->pool, n + 1, sizeof *l);
  sums s = reference_compare(r, n, l);
#define PRINTED(name) (r->sizes > 1 ? (name) : NULL)
  const opc_metric_value values[] = {
      {"spice_delays", (double)s.lines},
      {"spice_error", s.error},
      {"spice_error_max", s.error_max},
      {PRINTED("spice_deviation"), s.by},
      {PRINTED("spice_deviation_max"), s.by_max}};
#undef PRINTED
  const opc_column columns[] = {
      {"transition", NULL, OPC_INT, 0, &l->pattern},
      {"output", NULL, OPC_TEXT, 0, &l->output},
      {"edge", NULL, OPC_TEXT, 0, &l->edge},
      {"drawn", "ps", OPC_REAL, 3, &l->drawn},
      {"drawn_spice", "ps", OPC_REAL, 3, &l->drawn_spice},
      {"error", "%", OPC_REAL, 2, &l->error},
      {"printed", "ps", OPC_REAL, 3, &l->printed},
      {"printed_spice", "ps", OPC_REAL, 3, &l->printed_spice},
      {"deviation", "%", OPC_REAL, 3, &l->by},
      {"deviation_spice", "%", OPC_REAL, 3, &l->by_spice}};
  int code = opc_put_metrics(r->p->host, OPC_ARRAY(values), error);
  return code ? code
              : opc_put_rows(r->p->host, "spice", 0, s.lines, sizeof *l,
                             columns, r->sizes > 1 ? 10 : 6, error);
}

int compare_with_spice(paths *p, opc_error *error) {
  size_t n = (size_t)p->spice < p->patterns ? (size_t)p->spice : p->patterns;
  reference r = {.p = p, .sizes = p->mask ? 2 : 1};
  r.line = eda_alloc(n * p->graph.outputs, sizeof *r.line);
  int code = find_ports(&r, error);
  if (!code) code = make_netlists(&r, error);
  if (!code) {
    opc_parallel(p->host->context, n * r.sizes, run_one, &r);
    code = r.code;
    if (code) *error = r.error;
  }
  if (!code) code = reference_report(&r, n * p->graph.outputs, error);
  for (size_t s = 0; s < r.sizes; s++) free(r.netlist[s]);
  free(r.cards);
  free(r.line);
  return code;
}
