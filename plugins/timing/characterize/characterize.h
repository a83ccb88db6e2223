/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of timing.characterize. Times in s, voltages in V,
   capacitances in F. */
#pragma once

#include <eda/netlist.h>
#include <eda/simulator.h>
#include <eda/timing.h>
#include <opcflow/step.h>

/* Merged equivalent transistors of a cell. A merged net has the number of the
   first of its nets. Part i corresponds to bundle i of the cell. */
typedef struct part {
  uint8_t type;
  uint32_t drain, gate, source, bulk;
  double length, width; /* size of one of the merged transistors, nm */
  uint32_t count;
  uint32_t place;  /* temporary, for sorting */
  uint64_t colour; /* hash of the position in the circuit, independent of the
                      netlist's order */
} part;

/* Simulated circuit; the cell equals `times` such circuits in parallel. */
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
  const char *models[2], *model[2]; /* files ([1] NULL: as [0]), names */
  const char *n_models, *p_models;  /* model names in the netlist that do not
                                       show the type */
  const char *supplies, *grounds;
  int dlc;
  double supply, temperature;
  opc_reals slews, loads, edges;
  int64_t checks, seed;
  const char *liberty;
  double limit;

  /* State of a run. */
  eda_timing *timing;
  circuit *circuit; /* of each cell */
  eda_pool pool;
  const char *cards[2]; /* absolute paths; [1] NULL: as [0] */
  eda_card card[2];
  size_t simulated; /* number of simulated transitions */
} study;

/* ---- cells.c: pins, logic and arcs ---- */

/* Find the pins, logic and arcs of a subcircuit. Sets `trouble` for cells that
   cannot be characterized. */
int cell_build(study *s, eda_netlist *n, uint32_t number, eda_timing_cell *c,
               circuit *r, opc_error *error);

static inline const circuit *circuit_of(const study *s,
                                        const eda_timing_cell *c) {
  return &s->circuit[c - s->timing->cell];
}

/* Return, for each part, the set of sizes that affect an arc. */
enum { NO_SIZE, WIDTH_ONLY, ALL_SIZES };
void arc_sizes(const eda_timing_cell *c, const circuit *r,
               const eda_timing_arc *a, uint8_t *sizes);

/* ---- symmetry.c: equivalent transistors and nets ---- */

/* Build the reduced circuit of a cell and the bundles of its transistors. */
void cell_join(eda_pool *pool, eda_timing_cell *c, circuit *r);

/* ---- decks.c: many copies of a cell in one run of the simulator ---- */

typedef struct copy {
  const eda_timing_cell *cell;
  uint32_t from; /* input levels before the change */
  uint8_t input, output;
  int of_pin; /* 1: measure the capacitance of the pin, not a delay */
  double load;
  const double *change; /* ln of size ratio, [bundle * EDA_SIZES + size]; NULL:
                           drawn sizes */
  double delay, slew;   /* delay and slew: expected before the run, measured
                           after the run; 0: unknown */
  double capacitance[EDA_CAPS];
  /* If `two`, a second input changes; its number, its slew, s, and the time by
     which it follows the first input, s. */
  int two;
  uint8_t other;
  double other_slew, other_after;
  /* Destination of the results. */
  eda_timing_arc *arc;
  size_t point, size;
} copy;

/* Accuracy of time steps. PILOT: delays unknown; GRID: delays estimated;
   CHANGES: delays known; JUDGE: most accurate, for verification. */
typedef enum care { PILOT, GRID, CHANGES, JUDGE } care;

/* Copies that share a slew, a direction of the input and a simulation. */
typedef struct deck {
  study *s;
  double slew;
  int rises;
  care care;
  double early; /* time by which other inputs change earlier, s */
  size_t count, capacity;
  copy *copy;
  int code;
  opc_error error;
} deck;

/* Simulate `count` decks in parallel, each until every output has settled, and
   count the copies in s->simulated. Return the first error. */
int decks_run(study *s, deck *decks, size_t count, opc_error *error);
/* Free the copies of the decks and set *count to 0. */
void decks_clear(deck *decks, size_t *count);

/* ---- measure.c ---- */

int cell_measure(study *s, eda_timing_cell *c, opc_error *error);

/* Errors of the tables at random points with changed sizes: delay and slew, %
   of the value. */
typedef struct verdict {
  size_t points;
  double delay_rms, delay_max, slew_rms, slew_max, change_rms;
} verdict;
int cells_check(study *s, verdict *out, opc_error *error);

/* ---- pairs.c: inputs that change together ---- */

/* List the input pairs of a cell whose arcs are known. */
void pairs_list(study *s, eda_timing_cell *c);
/* Simulate the pairs and the pin capacitances for each pattern of the other
   inputs, or load the values stored with `key`. Requires the arcs. */
int pairs_find(study *s, eda_timing_cell *c, const char *key, opc_error *error);

/* ---- key.c: cells that were simulated before ---- */

/* Return the key of a cell (caller frees): a hash of all data that determine
   its values. Returns NULL and sets `error` on failure. */
char *keep_key(const study *s, const eda_timing_cell *c, opc_error *error);
/* Read the values stored with a key. Return 1 if they were in the store. */
int keep_load(const study *s, const char *key, double *figure, size_t figures);
void keep_save(const study *s, const char *key, const double *figure,
               size_t figures);

/* ---- liberty.c ---- */

int liberty_write(const study *s, const char *path, opc_error *error);
