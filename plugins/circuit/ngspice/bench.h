/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of circuit.ngspice. Times in s, voltages in V, currents in
   A. A `state` is a set of transistor sizes: EDA_DRAWN, EDA_BEFORE or EDA_AFTER
   (printed before or after the correction). */
#pragma once

#include <eda/netlist.h>
#include <eda/samples.h>
#include <eda/simulator.h>
#include <glib.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdio.h>

/* Values of the parameter 'sizes'. */
enum { SIZES_BOTH, SIZES_LENGTH };

/* Instance of the step: parameters and state of a run. */
typedef struct bench {
  const opc_host *host;

  /* Parameters. */
  const eda_circuit *circuit; /* parameter `circuit` */
  const eda_mask *mask;       /* NULL: simulate only drawn sizes */
  const eda_samples *chips;   /* NULL: none */
  const char *models[2]; /* model files of the n- and p-transistors; [1] NULL:
                            same file as [0] */
  const char *model[2];
  const char *library, *corner, *osdi; /* used instead of `models` */
  const char *stand_ins;
  int dlc;   /* 1: adjust DLC */
  int sizes; /* SIZES_BOTH, SIZES_LENGTH */
  const char *devices;
  double supply, temperature, load, slew;
  opc_reals edges;
  int measure;
  const char *inputs_list;
  int several;
  int64_t most, seed;
  const char *cell;
  int reads;
  const char *picture;
  double limit;

  /* The members below are the state of a run. */
  eda_pool pool;           /* owner of most of the following */
  eda_circuit own;         /* copy of `circuit` with substituted models */
  eda_circuit plain;       /* copy of `circuit` with net names n0, n1 ... */
  const eda_mask *printed; /* `mask` or `sized` */
  eda_mask sized;       /* copy of the mask with sizes from sizes_by_length or
                           of a chip */
  int has[EDA_STATES];  /* 1: this set of sizes is available */
  const char *cards[2]; /* absolute paths; [1] NULL: same as [0] */
  char *statements;     /* model statements of the library; NULL with `cards` */
  int subcircuits;      /* 1: the models of the library are subcircuits */
  double unit;          /* unit of sizes in the library, nm */
  eda_card card[2];
  double low, high; /* start and end levels of a slope, relative to the
                       supply */
  size_t inputs, outputs;
  uint32_t *input, *output; /* nets of the inputs and outputs */
} bench;

/* ---- sizes.c ---- */

/* Replace the printed sizes: drawn widths, and lengths that yield the printed
   currents. */
int sizes_by_length(bench *b, opc_error *error);

/* ---- bench.c ---- */

/* Find the inputs and outputs among the ports. */
int bench_ports(bench *b, opc_error *error);

/* Return OPC_OK, or an error code if the circuit has no inputs or no
   outputs. */
int bench_drives(const bench *b, opc_error *error);

/* Sizes to simulate: with the printed on current, with the printed off current,
   and with the printed on current and the capacitance of the printed area. */
enum { SIZE_ON, SIZE_OFF, SIZE_TIMED };

/* Return the circuit `c`, with nets n0, n1 ..., as a .subckt (caller frees).
   Return NULL and set `error` on failure. [any] */
char *bench_netlist(const bench *b, const eda_circuit *c, int state, int sizes,
                    opc_error *error);

/* Handle the result `code` of a simulation at the set of sizes `state`. If the
   sizes before correction failed, warn, discard this set and return OPC_OK;
   otherwise return `code`. */
int bench_forgive(bench *b, int state, int code, const opc_error *error);

/* Return the name of a net at the top level: "n12", "0" for ground. */
typedef char node_name[16];
const char *bench_node(const bench *b, uint32_t net, node_name out);

/* Return 1 if a port is a rail, that is a supply or ground. */
int is_rail(int role);

/* Return the time at which the input ramps start, s. */
double bench_start(const bench *b);

/* ---- jobs.c: processes ---- */

/* Work unit of one process: a range of items at one set of sizes. */
typedef struct bench_task {
  const bench *b;
  const void *of; /* data of the caller */
  int state;
  size_t from, to; /* range of items */
  int code;        /* error code; OPC_OK on success */
  opc_error error;
} bench_task;

/* Process `count` items at one set of sizes in parallel jobs of `some`
   items. */
int jobs_run_at(bench *b, int state, size_t count, size_t some,
                void (*work)(bench_task *j), const void *of, opc_error *error);

/* Process `count` items at each available set of sizes. A failure at the sizes
   before correction is only a warning. */
int jobs_run(bench *b, size_t count, size_t some, void (*work)(bench_task *j),
             const void *of, opc_error *error);

/* Return the text written by `write` (caller frees); NULL after a failure. */
char *job_text(bench_task *j,
               void (*write)(bench_task *j, FILE *out, const void *how),
               const void *how);

/* Run the simulator. Set j->code on failure. `deck` and `commands` may be NULL
   if the job has already failed. The caller clears the result. */
void job_simulate(bench_task *j, const char *deck, const char *commands,
                  eda_spice_result *out);

/* Current tolerance of transients, A: 1e-5 of the switching currents. At the
   shortest steps, rounding of voltages limits the accuracy of capacitive
   currents to this value. With 1e-15 A, ngspice failed in 7 of 52 cells of
   sky130. */
#define SWITCHING_CURRENT 1e-9

/* Write parts of a deck. job_begin: title, cards, and options with the relative
   tolerance and the current tolerance (A). job_circuit: the circuit and its
   loads. job_sources: supplies, and inputs at 0 V. */
void job_begin(const bench_task *j, FILE *out, double reltol, double abstol);
void job_circuit(bench_task *j, FILE *out, int sizes);
void job_sources(const bench_task *j, FILE *out);

/* ---- patterns.c: input patterns ---- */

typedef struct transition {
  uint32_t from, to; /* numbers of patterns */
} transition;

typedef struct patterns {
  size_t count;
  uint8_t *bit; /* input levels, [pattern * inputs + input] */
  size_t transitions;
  transition *transition;
  int sampled; /* 1: a random sample of all transitions */
} patterns;

/* List all transitions, or a random sample of b->most transitions. */
int patterns_make(bench *b, patterns *out, opc_error *error);

/* Return a text such as "A 0>1, B 1". For a single pattern, t.from equals
   t.to. */
const char *patterns_say(bench *b, const patterns *p, transition t);

/* ---- logic.c: operating points ---- */

typedef struct logic {
  int *level; /* level with drawn sizes, [pattern * outputs + output]: 0, 1; -1:
                 neither */
  double *current[EDA_STATES], *power[EDA_STATES]; /* per pattern */
} logic;

int logic_find(bench *b, const patterns *p, logic *out, opc_error *error);

/* ---- states.c: circuits that keep a state ---- */

/* Result of an input change: not yet known, or not unique. */
#define STATE_UNKNOWN UINT32_MAX
#define STATE_LOST (UINT32_MAX - 1)

/* Finite-state machine of a circuit. One input changes per transition. */
typedef struct machine {
  size_t watched; /* number of observed nets: nets of transistor gates, and
                     outputs */
  uint32_t *net;
  size_t states;
  uint8_t *bit;   /* input levels, [state * inputs + input] */
  int8_t *level;  /* net levels, [state * watched + net]; -1: neither 0 nor 1 */
  uint32_t *next; /* next state, [state * inputs + input] */
  double phase;   /* time between two changes, s */
  size_t leads;   /* number of changes in `lead` */
  uint32_t *lead; /* changes that lead from power-up with all inputs at 0 V to
                     `first` */
  uint32_t first;
} machine;

/* Find the recurrent states of a circuit. A recurrent state can be reached
   again from each of its successors. Return these states as patterns with all
   transitions of single inputs, and the levels of the outputs. */
int states_find(bench *b, machine *m, patterns *p, logic *l, opc_error *error);

/* Write the .save statements of the observed nets. */
void states_save(const bench *b, const machine *m, FILE *out);

/* Return the levels of the observed nets at a time. */
void states_levels(const bench *b, const machine *m, const eda_spice_plot *plot,
                   double time, int8_t *level);

/* ---- traversal.c: paths through the states ---- */

/* Sequence of input changes, one per phase, after an initial phase. */
typedef struct traversal {
  GArray *input; /* uint32_t */
  uint32_t at;   /* state after the last change */
} traversal;

traversal traversal_new(const machine *m);
void traversal_clear(traversal *w);
void traversal_step(const bench *b, const machine *m, traversal *w,
                    uint32_t input);
/* Extend a traversal to a state by the fewest changes. Return 0 if no path is
   known. */
int traversal_to(const bench *b, const machine *m, traversal *w,
                 uint32_t state);
/* Write the voltage sources. The supplies rise from 0 V before any input
   changes. */
void traversal_sources(const bench *b, const machine *m, const traversal *w,
                       FILE *out);
/* Write the command of the transient analysis. */
void traversal_command(const machine *m, const traversal *w, FILE *out);

/* Mark the set of recurrent states (states_find) that is reached first from
   power-up. */
void states_leading_to(const bench *b, const machine *m, uint8_t *mark);

/* Extend an empty traversal by changes that lead to the same state from all
   states with all inputs at 0. Return 0 if no such changes are known. */
int traversal_synchronise(const bench *b, const machine *m, traversal *w);

/* ---- delays.c: transients ---- */

/* Response of an output to a transition; NAN if the output did not settle. */
typedef struct arrival {
  uint32_t flip, output; /* indices in delays.flip and bench.output */
  int rises;
  double delay[EDA_STATES], slope[EDA_STATES];
} arrival;

typedef struct delays {
  size_t flips;    /* number of transitions that change an output */
  uint32_t *flip;  /* indices in patterns.transition */
  uint32_t *first; /* first arrival of each flip, [flips + 1] */
  size_t count;
  arrival *arrival;
  double *window;         /* simulated time of each flip, s */
  const machine *machine; /* NULL: transitions begin at operating points */
} delays;

int delays_find(bench *b, const machine *m, const patterns *p, const logic *l,
                delays *out, opc_error *error);

/* Measure delay and slope in a transient from the input change at `begin` to
   `end`. Return the time at which the output has settled, or NAN if the output
   does not settle. */
double arrival_measure(const bench *b, arrival *a, int state,
                       const eda_spice_plot *plot, double begin, double end);

/* Voltage of an output in one transition. */
typedef struct wave {
  size_t count;
  double *time, *value;
} wave;

int delays_wave(bench *b, const patterns *p, const delays *d, size_t arrival,
                int state, wave *out, opc_error *error);

/* Store the output waveform of an arrival, with time shifted so that the input
   changes at bench_start. */
void wave_keep(bench *b, const arrival *a, const eda_spice_plot *plot,
               double begin, double end, wave *out);

/* ---- sequential.c: transients of sequential circuits ---- */

int sequential_run(bench *b, const patterns *p, const delays *d,
                   opc_error *error);
int sequential_wave(bench *b, const patterns *p, const delays *d,
                    size_t arrival, int state, wave *out, opc_error *error);

/* ---- cells.c: memory ---- */

enum { CELL_DEVICES = 16 };

typedef struct cell {
  uint32_t q, qb;   /* storage nodes; q has the smaller number */
  uint32_t devices; /* number of devices with a channel on either node */
  uint32_t device[CELL_DEVICES];
  uint32_t accesses; /* number of access transistors; they are last in
                        `device` */
  int on_ports;      /* 1: the bit lines are ports */
} cell;

/* Find the pairs of cross-coupled inverters. */
int cells_find(bench *b, cell **out, size_t *count, opc_error *error);

/* Return a net on a feedback loop, or -1 if the circuit has no loop. */
int64_t feedback_find(bench *b);

/* ---- margin.c: static noise margins ---- */

enum { SWEEP = 241 };

/* Butterfly curves of a memory cell, at equal voltage steps from 0 to the
   supply, and the largest square in each of the two eyes. */
typedef struct butterfly {
  double right[SWEEP], up[SWEEP]; /* voltages QB(Q) and Q(QB) */
  double margin[2];               /* left and right margin; 0 if the cell is not
                                     bistable */
  double corner[2][4];            /* x0, y0, x1, y1 of each square */
} butterfly;

/* Butterflies of all cells, [state][cell]. */
typedef struct margins {
  butterfly *of[EDA_STATES];
} margins;

/* A cell as a subcircuit: name, and nets of the ports. */
typedef struct cell_netlist {
  char name[32];
  size_t ports;
  uint32_t port[4 * CELL_DEVICES];
} cell_netlist;

/* Write a cell as a subcircuit with the given sizes (SIZE_ON ...), all nets
   being ports. Set j->code on failure, and return it. */
int cell_put(bench_task *j, FILE *out, const cell *m, const char *name,
             int sizes, cell_netlist *c);

/* Return the connection of a net of a cell, without storage nodes. Rails are
   unchanged. Bit lines connect to the supply. Word lines take the level at
   which the access transistors conduct (b->reads), or do not. */
const char *cell_connection(const bench *b, const cell *m, uint32_t net);

/* Fill *out, which is zeroed before the first call; later calls with as many
   cells overwrite the arrays. */
int margins_find(bench *b, const cell *cells, size_t count, margins *out,
                 opc_error *error);

/* ---- access.c: cells that are read and written ---- */

/* Figures of both sides of a cell: [0] Q, [1] QB. NAN: the cell does not keep
   its value. */
typedef struct access_figures {
  double read[2];    /* current from the bit line of a node that is low, A */
  double write[2];   /* voltage at which a falling bit line flips a node that is
                        high, V; 0: the cell does not flip */
  double leakage[2]; /* current of supply and bit lines while the node is
                        high, A */
} access_figures;

/* Figures of all cells, [state][cell]. */
typedef struct accesses {
  access_figures *of[EDA_STATES];
} accesses;

/* Fill *out, as margins_find. */
int accesses_find(bench *b, const cell *cells, size_t count, accesses *out,
                  opc_error *error);

/* Find the margins of cells that hold [0] and that are read [1], and the
   figures of access; all as margins_find. */
int cells_measure(bench *b, const cell *cells, size_t count, margins m[2],
                  accesses *a, opc_error *error);

/* ---- chips.c: memory cells of sampled chips ---- */

/* Simulate the cells of all chips, and report the distributions. `m`, `a`: from
   cells_measure with the sizes of the mask; overwritten. */
int chips_find(bench *b, const cell *cells, size_t count, margins m[2],
               accesses *a, opc_error *error);

/* ---- tables.c ---- */

int delays_report(bench *b, const patterns *p, const delays *d,
                  opc_error *error);
int leakage_report(bench *b, const patterns *p, const logic *l,
                   opc_error *error);
int margins_report(bench *b, const cell *cells, size_t count, const margins *m,
                   opc_error *error);

/* Write the noise margins of cells that hold [0] and that are read [1], and the
   figures of access. */
int accesses_report(bench *b, const cell *cells, size_t count,
                    const margins m[2], const accesses *a, opc_error *error);

/* Return the index of the arrival with the largest delay deviation, rising or
   falling; with drawn sizes only, with the largest delay. Return -1 if no
   arrival was measured. */
int64_t worst_arrival(const delays *d, const bench *b, int rises);
/* Return the cell with the largest deviation, or, with drawn sizes only, the
   smallest margin. */
size_t worst_cell(const bench *b, size_t count, const margins *m);

/* ---- pictures.c ---- */

int draw_delays(bench *b, const patterns *p, const delays *d, const char *path,
                opc_error *error);
int draw_margins(bench *b, const cell *cells, size_t count, const margins *m,
                 const char *path, opc_error *error);
