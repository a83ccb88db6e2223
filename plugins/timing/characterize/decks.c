/* SPDX-License-Identifier: BSD-3-Clause */
/* Simulates many copies of cells in one run with a common input transition.
   Copies share time steps, so that differences between copies contain no
   discretization noise. */
#include <eda/wave.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "characterize.h"

/* Largest number of runs of a deck. Each run is twice as long as the previous
   run; the last takes 64 times the expected time. */
enum { TRIES = 7 };

static const double start = 2e-12; /* start of the input ramps, s */

/* Fraction of its voltage swing that an output must have reached at the end of
   a run; otherwise a longer run follows. */
static const double arrived = 0.97;

/* A run whose delays are unknown lasts pilot_ramps times the duration of the
   input ramp, plus pilot_rest (s), plus pilot_load (s/F) times the load. A
   channel 1 um wide needs some ps for each fF. pilot_steps is the least number
   of time steps of this run and of runs that measure pins. */
static const double pilot_ramps = 2.8, pilot_rest = 30e-12, pilot_load = 8e3,
                    pilot_steps = 50;

/* End of a run that measures a pin, relative to the time at which the input
   reaches the upper slew level. */
static const double pin_rest = 1.05;

/* Step reduction for a retry after the simulator finds no valid time step. */
static const double shorter = 0.7;

/* Least number of time steps within the slew of the fastest output. The errors
   were measured against a run of 1,400 steps, for AOI21 with an input slew of
   22 ps and 18 size changes. With 4 steps, the largest errors are 0.05 % of a
   delay, 0.13 % of a slew, and 0.004 % of the delay for the change of a delay
   by 1 %. With 2 steps the errors are 0.11, 0.23 and 0.005 %, with 8 steps
   0.01, 0.04 and 0.001 %. */
static const double steps[] = {
    [PILOT] = 0, [GRID] = 5, [CHANGES] = 4, [JUDGE] = 25};

/* Time from the middle of the output transition to the end of a run, in slews
   of the output. With 5, an output 1.5 times as slow as estimated has settled.
   In CHANGES the slews are known, and the run ends two steps after them. */
static const double settled[] = {
    [PILOT] = 0, [GRID] = 5, [CHANGES] = 1.5, [JUDGE] = 5};

/* ---- the input ---- */

/* Return the time at which the inputs cross the middle, s. */
static double middle_of(const deck *d) {
  return start + d->early +
         eda_timing_ramp_time(d->s->timing, d->slew, d->rises) *
             eda_timing_ramp(d->rises, 0.5);
}

static void put_source(const deck *d, FILE *out, const char *name, int rises,
                       double slew, double middle) {
  fprintf(out, "v%s i%s 0 ", name, name);
  eda_timing_ramp_write(out, d->s->timing, !rises, rises, slew, middle);
}

/* ---- the cards ---- */

/* Distinct values of DLC, as offsets from the value of the model card. */
typedef struct offsets {
  size_t count, capacity;
  double *value;
  uint8_t *type;
  size_t types_capacity;
} offsets;

static size_t offset_of(offsets *o, int type, double value) {
  size_t i = 0;
  while (i < o->count && (o->type[i] != type || o->value[i] != value)) i++;
  if (i < o->count) return i;
  eda_grow(&o->type, &o->types_capacity, o->count + 1, 1);
  o->type[o->count] = (uint8_t)type;
  EDA_PUSH(o->value, o->count, o->capacity, value);
  return i;
}

static double change_of(const copy *c, size_t bundle, size_t size) {
  return c->change ? c->change[bundle * EDA_SIZES + size] : 0;
}

/* ---- the copies ---- */

static void put_node(FILE *out, const copy *c, size_t k, uint32_t net) {
  const eda_timing_cell *cell = c->cell;
  if (cell->rail[net]) {
    fputs(cell->rail[net] > 0 ? " vdd" : " 0", out);
    return;
  }
  for (size_t i = 0; i < cell->inputs; i++)
    if (cell->port[i] == net) {
      int high = c->from >> i & 1;
      if (c->two && i == c->other)
        fprintf(out, " i%zu", k);
      else if (i != c->input)
        fputs(high ? " vdd" : " 0", out);
      else if (c->of_pin)
        fprintf(out, " i%zu", k);
      else
        fputs(" in", out);
      return;
    }
  fprintf(out, " n%zu_%u", k, net);
}

static void put_part(const deck *d, FILE *out, size_t k, size_t i,
                     const part *p, offsets *o) {
  const copy *c = &d->copy[k];
  double l = p->length * exp(change_of(c, i, EDA_SIZE_L)),
         w = p->width * exp(change_of(c, i, EDA_SIZE_W)),
         mean = p->length * exp(change_of(c, i, EDA_SIZE_C));
  double dlc = d->s->dlc ? (l - mean) / 2 : 0;
  fprintf(out, "m%zu_%zu", k, i);
  put_node(out, c, k, p->drain);
  put_node(out, c, k, p->gate);
  put_node(out, c, k, p->source);
  put_node(out, c, k, p->bulk);
  fprintf(out, " %s", d->s->model[p->type]);
  if (dlc != 0) fprintf(out, "_%zu", offset_of(o, p->type, dlc));
  fprintf(out, " w=%.12ge-9 l=%.12ge-9", w, l);
  fprintf(out, p->count > 1 ? " m=%u\n" : "\n", p->count);
}

static void put_other(const deck *d, FILE *out, size_t k) {
  const copy *c = &d->copy[k];
  char name[32];
  snprintf(name, sizeof name, "%zu", k);
  put_source(d, out, name, !(c->from >> c->other & 1), c->other_slew,
             middle_of(d) + c->other_after);
}

/* Write the levels before the change as first guesses of the operating point.
   Without guesses, the simulator accepts points at which a net between two
   transistors is 0.4 V beyond the supplies; copies with such a point have
   other delays than the rest of the deck. */
static void put_levels(const deck *d, FILE *out, size_t k) {
  const eda_timing_cell *cell = d->copy[k].cell;
  const circuit *r = circuit_of(d->s, cell);
  const double guess[] = {[LOW] = 0, [HIGH] = 1, [UNKNOWN] = 0.5};
  uint8_t *fixed = eda_alloc(2 * cell->nets, 1), *value = fixed + cell->nets;
  cell_levels(cell, d->copy[k].from, fixed, value);
  for (size_t i = 0; i < 2 * r->parts; i++) {
    const part *p = &r->part[i / 2];
    uint32_t net = i % 2 ? p->source : p->drain;
    if (fixed[net]) continue;
    fixed[net] = 1;
    fprintf(out, ".nodeset v(n%zu_%u)=%.17g\n", k, net,
            guess[value[net]] * d->s->supply);
  }
  free(fixed);
}

static void put_copy(const deck *d, FILE *out, size_t k, offsets *o) {
  const copy *c = &d->copy[k];
  const eda_timing_cell *cell = c->cell;
  const circuit *r = circuit_of(d->s, cell);
  for (size_t i = 0; i < r->parts; i++) put_part(d, out, k, i, &r->part[i], o);
  for (size_t i = 0; i < cell->outputs; i++)
    fprintf(out, "c%zu_%zu n%zu_%u 0 %.17g\n", k, i, k,
            cell->port[cell->inputs + i], c->load / r->times);
  put_levels(d, out, k);
  if (c->of_pin) {
    char name[32];
    snprintf(name, sizeof name, "%zu", k);
    put_source(d, out, name, d->rises, d->slew, middle_of(d));
    fprintf(out, ".save i(v%zu) v(i%zu)\n", k, k);
  } else {
    fprintf(out, ".save v(n%zu_%u)\n", k, cell->port[cell->inputs + c->output]);
  }
  if (c->two) put_other(d, out, k);
}

/* Return the deck (caller frees). Charges are of the order of fF times mV; the
   default charge tolerance of the simulator, 1e-14 C, would ignore them. */
static char *deck_text(const deck *d) {
  const study *s = d->s;
  char *text = NULL;
  size_t size;
  FILE *out = open_memstream(&text, &size);
  offsets o = {0};
  fputs("timing.characterize\n", out);
  for (int i = 0; i < 2; i++)
    if (s->cards[i]) fprintf(out, ".include \"%s\"\n", s->cards[i]);
  fprintf(out,
          ".options temp=%.17g gmin=1e-15 reltol=%g abstol=1e-12 "
          "chgtol=1e-17 itl4=40\nvs vdd 0 %.17g\n",
          s->temperature, d->care == JUDGE ? 1e-4 : 1e-3, s->supply);
  put_source(d, out, "n", d->rises, d->slew, middle_of(d));
  for (size_t k = 0; k < d->count; k++) put_copy(d, out, k, &o);
  for (size_t i = 0; i < o.count; i++) {
    char name[200];
    snprintf(name, sizeof name, "%.150s_%zu", s->model[o.type[i]], i);
    eda_card_write(out, &s->card[o.type[i]], name,
                   s->card[o.type[i]].dlc + o.value[i]);
  }
  fputs(".end\n", out);
  fclose(out);
  free(o.value);
  free(o.type);
  return text;
}

/* ---- measurement ---- */

static const double *vector_of(const eda_spice_plot *plot, const char *format,
                               size_t k, uint32_t net, size_t n) {
  char name[48];
  snprintf(name, sizeof name, format, k, net);
  const eda_spice_vector *v = eda_spice_vector_find(plot, name);
  return v && v->count == n ? v->value : NULL;
}

/* Measure the last edge of an output. Return 0 if the output should change but
   has no complete edge. */
static int measure_output(const deck *d, copy *c, const double *t,
                          const double *v, size_t n) {
  const eda_timing *of = d->s->timing;
  size_t before = c->from,
         after = before ^ (size_t)1 << c->input ^ (size_t) !!c->two << c->other,
         at = (size_t)c->output << c->cell->inputs;
  int rises = c->cell->level[at + after];
  if (rises == c->cell->level[at + before]) return 1;
  double *h = eda_alloc(n, sizeof *h);
  eda_wave_heights(v, n, d->s->supply, rises, h);
  eda_wave_edge e;
  int there = eda_wave_find(h, n, of->low, of->high, &e) &&
              (d->care == CHANGES || h[n - 1] > arrived);
  if (there) {
    c->delay = eda_wave_smooth_time(t, h, n, e.half, 0.5) - middle_of(d);
    c->slew = eda_wave_smooth_time(t, h, n, e.high, of->high) -
              eda_wave_smooth_time(t, h, n, e.low, of->low);
  }
  free(h);
  return there;
}

/* Return the capacitance of an input, F. The input voltage changes between the
   fractions `from` and `to` of the swing; the charge that flows into the input
   is divided by the voltage difference. */
static double charge(const deck *d, const double *t, const double *i, size_t n,
                     double from, double to) {
  double whole = eda_timing_ramp_time(d->s->timing, d->slew, d->rises), sum = 0,
         a = start + whole * eda_timing_ramp(d->rises, from),
         b = start + whole * eda_timing_ramp(d->rises, to);
  for (size_t k = 0; k + 1 < n; k++) {
    double x = fmax(t[k], a), y = fmin(t[k + 1], b), h = t[k + 1] - t[k];
    if (!(y > x)) continue;
    double at_x = i[k] + (i[k + 1] - i[k]) * (x - t[k]) / h,
           at_y = i[k] + (i[k + 1] - i[k]) * (y - t[k]) / h;
    sum += (y - x) * (at_x + at_y) / 2;
  }
  return (d->rises ? -sum : sum) / ((to - from) * d->s->supply);
}

static int measure_copy(const deck *d, copy *c, size_t k,
                        const eda_spice_plot *plot) {
  const eda_timing *of = d->s->timing;
  const eda_spice_vector *t = eda_spice_vector_find(plot, "time");
  if (!t || t->count < 4) return 0;
  if (!c->of_pin) {
    const double *v =
        vector_of(plot, "v(n%zu_%u)", k,
                  c->cell->port[c->cell->inputs + c->output], t->count);
    return v && measure_output(d, c, t->value, v, t->count);
  }
  const double *i = vector_of(plot, "i(v%zu)", k, 0, t->count);
  if (!i) return 0;
  c->capacitance[EDA_CAP_DELAY] = charge(d, t->value, i, t->count, 0, 0.5);
  c->capacitance[EDA_CAP_SLEW] =
      charge(d, t->value, i, t->count, of->low, of->high);
  return 1;
}

/* ---- a run ---- */

/* Duration of a run and its largest step, s. */
typedef struct span {
  double window, step;
} span;

/* Return the span for unknown outputs. */
static span pilot_span(const deck *d) {
  double load = 0;
  for (size_t k = 0; k < d->count; k++)
    load =
        fmax(load, d->copy[k].load / circuit_of(d->s, d->copy[k].cell)->times);
  double window = start +
                  pilot_ramps * eda_timing_ramp_time(d->s->timing, d->slew, 1) +
                  pilot_rest + pilot_load * load;
  return (span){window, window / pilot_steps};
}

/* Return the span for pins, whose charges are measured while the input
   changes. */
static span pin_span(const deck *d) {
  double window =
      start + eda_timing_ramp_time(d->s->timing, d->slew, d->rises) *
                  eda_timing_ramp(d->rises, d->s->timing->high);
  return (span){window * pin_rest, window / pilot_steps};
}

static span span_of(const deck *d) {
  if (d->copy[0].of_pin) return pin_span(d);
  if (d->care == PILOT) return pilot_span(d);
  span best = {0, INFINITY};
  for (size_t k = 0; k < d->count; k++) {
    const copy *c = &d->copy[k];
    best.window = fmax(best.window, c->delay + settled[d->care] * c->slew);
    best.step = fmin(best.step, c->slew / steps[d->care]);
  }
  best.window += middle_of(d);
  return best;
}

/* Simulate once. Return the number of copies whose outputs do not settle. */
static size_t run_once(deck *d, const char *text, span of) {
  char command[120];
  eda_spice_result r = {0};
  size_t missing = 0;
  snprintf(command, sizeof command, "tran %.17g %.17g 0 %.17g\n", of.step,
           of.window, of.step);
  d->code = eda_spice_run(d->s->host->context, text, command, d->s->limit, &r,
                          &d->error);
  for (size_t k = 0; !d->code && k < d->count; k++)
    missing += !r.count || !measure_copy(d, &d->copy[k], k, &r.plot[0]);
  eda_spice_clear(&r);
  return missing;
}

static void deck_run(void *decks, size_t which) {
  deck *d = (deck *)decks + which;
  char *text = deck_text(d);
  span of = span_of(d);
  size_t missing = run_once(d, text, of);
  /* Occasionally the simulator finds no valid step ("timestep too small"); a
     retry with other steps succeeds. */
  if (d->code == OPC_FAILED) {
    of.step *= shorter;
    missing = run_once(d, text, of);
  }
  for (int i = 1; i < TRIES && missing && !d->code; i++) {
    of.window *= 2;
    missing = run_once(d, text, of);
  }
  free(text);
  if (missing && !d->code)
    d->code = opc_fail(
        &d->error, OPC_FAILED, NULL,
        "cell '%.100s': an output does not follow the input within %.3g ns",
        d->copy[0].cell->name, of.window * 1e9);
}

int decks_run(study *s, deck *decks, size_t count, opc_error *error) {
  opc_parallel(s->host->context, count, deck_run, decks);
  for (size_t i = 0; i < count; i++) {
    s->simulated += decks[i].count;
    if (!decks[i].code) continue;
    *error = decks[i].error;
    return error->code;
  }
  return OPC_OK;
}

void decks_clear(deck *decks, size_t *count) {
  for (size_t i = 0; i < *count; i++) free(decks[i].copy);
  *count = 0;
}
