/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of timing.characterize. Times in s, voltages in V,
   capacitances in F. */
#pragma once

#include <eda/netlist.h>
#include <eda/simulator.h>
#include <eda/timing.h>
#include <opcflow/step.h>

/* A bundle: equivalent transistors of a cell, merged into one. drain, gate,
   source and bulk are net numbers; merged nets have the smallest of their
   numbers. Part i is bundle i of the cell (eda_timing_device.bundle). */
typedef struct part {
  uint8_t type;
  uint32_t drain, gate, source, bulk;
  double length, width; /* size of one of the merged transistors, nm */
  uint32_t count;  /* number of merged transistors, divided by circuit.times */
  uint32_t place;  /* position before sorting; used by sort_parts only */
  uint64_t colour; /* hash of the position in the circuit, independent of the
                      netlist's order */
} part;

/* Simulated circuit of a cell. The cell equals `times` such circuits in
   parallel. */
typedef struct circuit {
  size_t parts;
  part *part;
  double times;
} circuit;

/* Line edges of transistors: standard deviation of an edge (nm), correlation
   length (nm) and Hurst exponent. The covariance of an edge at a distance r is
   sigma^2 exp(-(r / length)^(2 hurst)). */
typedef struct line_edges {
  double sigma, length, hurst;
} line_edges;

typedef struct study {
  const opc_host *host;

  /* Parameters. */
  const char *file, *top, *cells;
  double scale;
  const char *models[2], *model[2]; /* files and names of the n- and p-model; if
                                       models[1] is NULL, models[0] has both */
  const char *n_models, *p_models;  /* model names in the netlist that do not
                                       show the type */
  const char *supplies, *grounds;
  int dlc;
  double supply, temperature;
  opc_reals slews, loads, edges;
  int64_t checks, seed;
  const char *liberty;
  line_edges rough; /* sigma 0: no standard deviations */
  double limit;

  /* State of a run. */
  eda_timing *timing;
  circuit *circuit; /* of each cell */
  eda_pool pool;
  const char *cards[2]; /* absolute paths of models[] */
  eda_card card[2];
  size_t simulated; /* number of simulated transitions */
} study;

/* ---- cells.c: pins, logic and arcs ---- */

/* Fill in the cell `c` and its simulated circuit `r` from subcircuit `number`:
   pins, logic, arcs, pairs and the grid. Sets c->trouble to the reason if the
   cell cannot be characterized, which is no error. */
int cell_build(study *s, eda_netlist *n, uint32_t number, eda_timing_cell *c,
               circuit *r, opc_error *error);

/* Level of a net: certainly low, certainly high, or not determined. */
enum { LOW, HIGH, UNKNOWN };

/* Compute the levels of all nets for an input pattern, value[nets]. Set
   fixed[net] for supplies and inputs. */
void cell_levels(const eda_timing_cell *c, size_t pattern, uint8_t *fixed,
                 uint8_t *value);

static inline const circuit *circuit_of(const study *s,
                                        const eda_timing_cell *c) {
  return &s->circuit[c - s->timing->cell];
}

/* Set sizes[part] to the sizes of each part that affect an arc. */
enum { NO_SIZE, WIDTH_ONLY, ALL_SIZES };
void arc_sizes(const eda_timing_cell *c, const circuit *r,
               const eda_timing_arc *a, uint8_t *sizes);

/* ---- symmetry.c: equivalent transistors and nets ---- */

/* Build the reduced circuit of a cell and the bundles of its transistors. */
void cell_join(eda_pool *pool, eda_timing_cell *c, circuit *r);

/* ---- decks.c: many copies of a cell in one run of the simulator ---- */

/* One instance of a cell in a simulation: an input changes, and the delay and
   slew of an output, or the capacitance of the input, is measured. */
typedef struct copy {
  const eda_timing_cell *cell;
  uint32_t from; /* input levels before the change; bit i is input i */
  uint8_t input, output;
  int of_pin;           /* 1: measure the capacitance of the pin, not a delay */
  double load;          /* at each output of the cell, F */
  const double *change; /* ln(size / drawn size), [bundle * EDA_SIZES + size];
                           NULL if all sizes are as drawn */
  double delay, slew;   /* before the run: estimates, 0 if unknown; after the
                           run: measured values */
  double capacitance[EDA_CAPS];
  /* If `two`, a second input changes; its number, its slew, s, and the time by
     which it follows the first input, s. */
  int two;
  uint8_t other;
  double other_slew, other_after;
  /* Destination of the results: arc, grid point or point of size changes, and
     the changed size (SIZE_MAX: none). Used by measure.c and pairs.c. */
  eda_timing_arc *arc;
  size_t point, size;
} copy;

/* Accuracy of time steps. PILOT: delays unknown; GRID: delays estimated;
   CHANGES: delays known; JUDGE: most accurate, for verification. */
typedef enum care { PILOT, GRID, CHANGES, JUDGE } care;

/* A simulation of copies whose input has the same slew and direction. */
typedef struct deck {
  study *s;
  double slew;
  int rises; /* 1 if the input rises */
  care care;
  double early; /* delay of the main input, s, so that the ramps of second
                   inputs that change earlier begin after time 0 */
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

/* Simulate the arcs of a cell, their derivatives with respect to sizes, and the
   pin capacitances. Stores the values in c->figure. */
int cell_measure(study *s, eda_timing_cell *c, opc_error *error);

/* Errors of the tables at random points with changed sizes. delay, slew: % of
   the simulated value; change: error of the delay change by the sizes, in % of
   the delay as drawn. */
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
/* Read the values stored with a key. Return 1 if the store has `figures`
   values. */
int keep_load(const study *s, const char *key, double *figure, size_t figures);
/* Store values with a key, if the host keeps results. */
void keep_save(const study *s, const char *key, const double *figure,
               size_t figures);

/* ---- sigma.c ---- */

/* Return the standard deviation of ln of the mean length of a transistor. */
double edges_sigma(const line_edges *e, double length, double width);
/* Compute the standard deviations of delay and slew of an arc, s, at the grid,
   [slew * loads + load]. The transistors of a cell are independent. */
void arc_sigma(const line_edges *e, const eda_timing_cell *c,
               const eda_timing_arc *a, double *delay, double *slew);

/* ---- liberty.c ---- */

int liberty_write(const study *s, const char *path, opc_error *error);
