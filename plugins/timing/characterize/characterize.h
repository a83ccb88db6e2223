/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of timing.characterize. Times s, voltages V, capacitances F. */
#pragma once

#include <eda/netlist.h>
#include <eda/simulator.h>
#include <eda/timing.h>
#include <opcflow/step.h>

/* Transistors of a cell that behave alike, as one; nets by the first of those
   that are joined. Its number is that of the cell's bundle. */
typedef struct part {
  uint8_t type;
  uint32_t drain, gate, source, bulk;
  double length, width; /* nm, of one */
  uint32_t count;
  uint32_t place; /* while they are sorted */
  uint64_t
      colour; /* where it is in the circuit, whatever the netlist's order */
} part;

/* What is simulated of a cell, which is `times` of it side by side. */
typedef struct circuit {
  size_t parts;
  part *part;
  double times;
} circuit;

typedef struct study {
  const opc_host *host;

  /* Parameters. */
  const char *file, *top, *cells;
  double scale;
  const char *models[2], *model[2]; /* files ([1] NULL: the same), names */
  const char *n_models, *p_models; /* of the netlist, whose type is not shown */
  const char *supplies, *grounds;
  int dlc;
  double supply, temperature;
  opc_reals slews, loads, edges;
  int64_t checks, seed;
  const char *liberty;
  double limit;

  /* Of a run. */
  eda_timing *timing;
  circuit *circuit; /* of each cell */
  eda_pool pool;
  const char *cards[2]; /* whole paths; [1] NULL: the same */
  eda_card card[2];
  size_t simulated; /* transitions */
} study;

/* ---- cells.c: what a cell is ---- */

/* The pins, logic and arcs of a subcircuit; cells that cannot be characterised
   get a `trouble`. */
int cell_build(study *s, eda_netlist *n, uint32_t number, eda_timing_cell *c,
               circuit *r, opc_error *error);

static inline const circuit *circuit_of(const study *s,
                                        const eda_timing_cell *c) {
  return &s->circuit[c - s->timing->cell];
}

/* Which sizes of each part matter to an arc. */
enum { NO_SIZE, WIDTH_ONLY, ALL_SIZES };
void arc_sizes(const eda_timing_cell *c, const circuit *r,
               const eda_timing_arc *a, uint8_t *sizes);

/* ---- symmetry.c: what of a cell behaves alike ---- */

/* Find the circuit of a cell and the bundles of its transistors. */
void cell_join(eda_pool *pool, eda_timing_cell *c, circuit *r);

/* ---- decks.c: many copies of a cell in one run of the simulator ---- */

typedef struct copy {
  const eda_timing_cell *cell;
  uint32_t from; /* the inputs before the change */
  uint8_t input, output;
  int of_pin; /* its pin's capacitance is measured, not a delay */
  double load;
  const double *change; /* of sizes [bundle * EDA_SIZES + size]; NULL */
  double delay, slew;   /* what is expected, then what was found; 0: unknown */
  double capacitance[EDA_CAPS];
  /* If `two`, a second input changes: its slew, and how long after the first.
   */
  int two;
  uint8_t other;
  double other_slew, other_after;
  /* For whoever planned it: */
  eda_timing_arc *arc;
  size_t point, size;
} copy;

/* How a deck's steps are chosen: nothing is known of its outputs; delays and
   slews are about as expected; they are known; or best, to judge by. */
typedef enum care { PILOT, GRID, CHANGES, JUDGE } care;

/* Copies that share a slew, a direction of the input and a run. */
typedef struct deck {
  study *s;
  double slew;
  int rises;
  care care;
  double early; /* s; how long before the input others change */
  size_t count, room;
  copy *copy;
  int code;
  opc_error error;
} deck;

/* The time of the whole ramp for a slew between the edges. */

/* Simulate until every output is there. [any] */
void deck_run(deck *d);

/* ---- measure.c ---- */

int cell_measure(study *s, eda_timing_cell *c, opc_error *error);

/* How far linear changes are off at random points: of delay and slew, in % of
   the value. */
typedef struct verdict {
  size_t points;
  double delay_rms, delay_max, slew_rms, slew_max, change_rms;
} verdict;
int cells_check(study *s, verdict *out, opc_error *error);

/* ---- pairs.c: inputs that change together ---- */

/* The pairs of a cell whose arcs are known. */
void pairs_list(study *s, eda_timing_cell *c);
/* Simulate them, once the arcs are there, and pins by what other inputs are; or
   take what was kept beside `key`. */
int pairs_find(study *s, eda_timing_cell *c, const char *key, opc_error *error);

/* ---- key.c: cells that were simulated before ---- */

/* Return the key of a cell: a hash of all that its figures depend on (free). */
char *keep_key(const study *s, const eda_timing_cell *c, opc_error *error);
/* Return 1 if the figures were in the store. */
int keep_load(const study *s, const char *key, double *figure, size_t figures);
void keep_save(const study *s, const char *key, const double *figure,
               size_t figures);

/* ---- liberty.c ---- */

int liberty_write(const study *s, const char *path, opc_error *error);
