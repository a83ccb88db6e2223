/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of circuit.ngspice. Times in s, voltages in V, currents in A. */
#pragma once

#include <eda/netlist.h>
#include <eda/simulator.h>
#include <glib.h>
#include <opcflow/step.h>
#include <opcflow/table.h>
#include <stdio.h>

/* The choices of 'sizes'. */
enum { SIZES_BOTH, SIZES_LENGTH };

/* The step: a circuit, and what it is simulated under. */
typedef struct bench {
  const opc_host *host;

  /* Parameters. */
  const eda_circuit *circuit; /* as it came */
  const eda_mask *mask;       /* NULL: as drawn only */
  const char *models[2];      /* files; [1] NULL: the same */
  const char *model[2];
  const char *library, *corner, *osdi; /* in place of `models` */
  const char *stand_ins;
  int dlc;   /* whether DLC is corrected */
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

  /* Of a run. */
  eda_pool pool;           /* of most of what follows */
  eda_circuit own;         /* with other names of models */
  eda_circuit plain;       /* with the nets n0, n1 ... */
  const eda_mask *printed; /* the mask, or `sized` */
  eda_mask sized;          /* sizes.c: the mask, with other sizes */
  int has[EDA_STATES];     /* which sizes there are */
  const char *cards[2];    /* whole paths; [1] NULL: the same */
  char *statements;        /* of the library; NULL: cards */
  int subcircuits;         /* its models are */
  double unit;             /* its, nm */
  eda_card card[2];
  double low, high; /* where a slope begins and ends, of 1 */
  size_t inputs, outputs;
  uint32_t *input, *output; /* their nets */
} bench;

/* ---- sizes.c ---- */

/* Have the printed currents told by L alone, by the table of devices. */
int sizes_by_length(bench *b, opc_error *error);

/* ---- bench.c ---- */

/* Find the ports. */
int bench_ports(bench *b, opc_error *error);

/* Fails without inputs or without outputs. */
int bench_drives(const bench *b, opc_error *error);

/* Which sizes are meant: those with the current of the on state, of the off
   state, and the first with the capacitance of the printed area. */
enum { SIZE_ON, SIZE_OFF, SIZE_TIMED };

/* The circuit `c`, whose nets are n0, n1 ..., as a .subckt; to be freed. NULL
   and *error on failure. [any] */
char *bench_netlist(const bench *b, const eda_circuit *c, int state, int sizes,
                    opc_error *error);

/* Leave out the sizes before correction if they cannot be simulated, with a
   warning; other failures stay what they are. */
int bench_forgive(bench *b, int state, int code, const opc_error *error);

/* The name of a net at the top: "n12", "0" for ground. */
typedef char node_name[16];
const char *bench_node(const bench *b, uint32_t net, node_name out);

/* Whether a port is a rail: supply or ground. */
int is_rail(int role);

/* When the inputs begin to change. */
double bench_start(const bench *b);

/* ---- jobs.c: processes ---- */

/* What one process simulates: some of many things, at one set of sizes. */
typedef struct job {
  const bench *b;
  const void *of; /* what the caller gave */
  int state;
  size_t from, to; /* of the things */
  int code;        /* of what failed */
  opc_error error;
} job;

/* Have `count` things done, `some` to a job and many jobs at once, at one set
   of sizes. */
int jobs_run_at(bench *b, int state, size_t count, size_t some,
                void (*work)(job *j), const void *of, opc_error *error);

/* The same at each set of sizes that there is; those before correction may
   fail. */
int jobs_run(bench *b, size_t count, size_t some, void (*work)(job *j),
             const void *of, opc_error *error);

/* The text that `write` writes, to be freed; NULL if the job has failed. */
char *job_text(job *j, void (*write)(job *j, FILE *out, const void *how),
               const void *how);

/* Simulate; the job's code tells if that fails. Texts are not looked at if it
   has. The result is to be cleared. */
void job_simulate(job *j, const char *deck, const char *commands,
                  eda_spice_result *out);

/* Of transients, A: 1e-5 of what switches. In the shortest steps the currents
   of capacitances, of which each digit of a voltage counts, are no more
   certain: with 1e-15 A ngspice gave up in 7 of 52 cells of sky130. */
#define SWITCHING_CURRENT 1e-9

/* For decks: title, cards and options, with the bounds of errors of all, as a
   share, and of currents, A; then the circuit with its loads; then
   its supplies and its inputs, which are at 0 V. */
void job_begin(const job *j, FILE *out, double reltol, double abstol);
void job_circuit(job *j, FILE *out, int sizes);
void job_sources(const job *j, FILE *out);

/* ---- patterns.c: what is applied ---- */

typedef struct transition {
  uint32_t from, to; /* patterns */
} transition;

typedef struct patterns {
  size_t count;
  uint8_t *bit; /* of pattern p, input i: [p * inputs + i] */
  size_t transitions;
  transition *transition;
  int sampled; /* not all that there are */
} patterns;

/* All, or `most` transitions drawn by the seed. */
int patterns_make(bench *b, patterns *out, opc_error *error);

/* "A 0>1, B 1"; for a pattern alone, from and to are the same. */
const char *patterns_say(bench *b, const patterns *p, transition t);

/* ---- logic.c: operating points ---- */

typedef struct logic {
  int *level; /* of pattern p, output o as drawn: 0, 1, -1 for neither */
  double *current[EDA_STATES], *power[EDA_STATES]; /* of each pattern */
} logic;

int logic_find(bench *b, const patterns *p, logic *out, opc_error *error);

/* ---- states.c: circuits that keep a state ---- */

/* What a change of an input leads to, where that is not known yet; where it is
   not always the same. */
#define STATE_UNKNOWN UINT32_MAX
#define STATE_LOST (UINT32_MAX - 1)

/* A circuit as a machine: in each state one input may change, and another state
   follows, in which all is at rest. */
typedef struct machine {
  size_t watched; /* nets that are looked at: gates' and outputs' */
  uint32_t *net;
  size_t states;
  uint8_t *bit;   /* of state s, input i: [s * inputs + i] */
  int8_t *level;  /* of state s, net k: [s * watched + k]; -1: neither */
  uint32_t *next; /* after a change in state s of input i: [s * inputs + i] */
  double phase;   /* s from one change to the next */
  size_t leads;   /* changes that lead from all inputs at 0 V, where it wakes */
  uint32_t *lead; /* up, to the state `first` */
  uint32_t first;
} machine;

/* What states there are that there is always a way back to, whatever state the
   circuit wakes up in; as patterns, with all transitions of one input, and the
   levels of the outputs. */
int states_find(bench *b, machine *m, patterns *p, logic *l, opc_error *error);

/* For decks: what is to be looked at. */
void states_save(const bench *b, const machine *m, FILE *out);

/* The levels at some time. */
void states_levels(const bench *b, const machine *m, const eda_spice_plot *plot,
                   double time, int8_t *level);

/* ---- ways.c: through its states ---- */

/* Changes of inputs, one a phase after a first one. */
typedef struct walk {
  GArray *input; /* uint32_t */
  uint32_t at;   /* the state that it has come to */
} walk;

walk walk_new(const machine *m);
void walk_clear(walk *w);
void walk_step(const bench *b, const machine *m, walk *w, uint32_t input);
/* By the fewest changes; 0 if no way is known. */
int walk_to(const bench *b, const machine *m, walk *w, uint32_t state);
/* For decks: the inputs, and the supplies, which rise from 0 V first. */
void walk_sources(const bench *b, const machine *m, const walk *w, FILE *out);
/* For commands: the transient. */
void walk_command(const machine *m, const walk *w, FILE *out);

/* Mark the states that lead to each other and to no others, the first such set
   on the way from the state in which the circuit woke up. */
void ways_back(const bench *b, const machine *m, uint8_t *mark);

/* Extend a walk that has not begun by changes that lead to the same state from
   all that have all inputs at 0; 0 if none are known. */
int ways_synchronise(const bench *b, const machine *m, walk *w);

/* ---- delays.c: transients ---- */

/* An output that follows a transition. NAN: it did not get there. */
typedef struct arrival {
  uint32_t flip, output; /* numbers in the delays, in the bench */
  int rises;
  double delay[EDA_STATES], slope[EDA_STATES];
} arrival;

typedef struct delays {
  size_t flips;    /* transitions that an output follows */
  uint32_t *flip;  /* their numbers */
  uint32_t *first; /* of each flip: its first arrival; flips + 1 */
  size_t count;
  arrival *arrival;
  double *window;         /* of each flip: how long it was simulated */
  const machine *machine; /* NULL: transitions begin at operating points */
} delays;

int delays_find(bench *b, const machine *m, const patterns *p, const logic *l,
                delays *out, opc_error *error);

/* Measure it in a transient where its input begins to change at one time, and
   which counts up to another. Returns when the output is there; NAN if it does
   not get there. */
double arrival_measure(const bench *b, arrival *a, int state,
                       const eda_spice_plot *plot, double begin, double end);

/* One transition again: the voltage of an output. */
typedef struct wave {
  size_t count;
  double *time, *value;
} wave;

int delays_wave(bench *b, const patterns *p, const delays *d, size_t arrival,
                int state, wave *out, opc_error *error);

/* The wave of an arrival from a transient, as if its input began to change at
   bench_start. */
void wave_keep(bench *b, const arrival *a, const eda_spice_plot *plot,
               double begin, double end, wave *out);

/* ---- walks.c: transients of circuits that keep a state ---- */

int walks_run(bench *b, const patterns *p, const delays *d, opc_error *error);
int walks_wave(bench *b, const patterns *p, const delays *d, size_t arrival,
               int state, wave *out, opc_error *error);

/* ---- cells.c: memory ---- */

enum { CELL_DEVICES = 16 };

typedef struct cell {
  uint32_t q, qb;   /* the first is that of the smaller number */
  uint32_t devices; /* those with a channel on either */
  uint32_t device[CELL_DEVICES];
  uint32_t accesses; /* of them, at the end: those to bit lines */
  int on_ports;      /* whether the bit lines are ports */
} cell;

/* Cross-coupled inverters. */
int cells_find(bench *b, cell **out, size_t *count, opc_error *error);

/* A net on the way around a loop; -1: there is none. */
int64_t feedback_find(bench *b);

/* ---- margin.c: static noise margins ---- */

enum { SWEEP = 241 };

/* Q over QB and QB over Q, at equal steps from 0 to the supply; the largest
   squares between them. */
typedef struct butterfly {
  double right[SWEEP], up[SWEEP]; /* QB of Q, Q of QB */
  double margin[2];               /* left, right; 0 if it is not bistable */
  double corner[2][4];            /* x0, y0, x1, y1 of each square */
} butterfly;

/* [state][cell] */
typedef struct margins {
  butterfly *of[EDA_STATES];
} margins;

int margins_find(bench *b, const cell *cells, size_t count, margins *out,
                 opc_error *error);

/* ---- tables.c ---- */

int tell_delays(bench *b, const patterns *p, const delays *d, opc_error *error);
int tell_leakage(bench *b, const patterns *p, const logic *l, opc_error *error);
int tell_margins(bench *b, const cell *cells, size_t count, const margins *m,
                 opc_error *error);

/* The arrival with the largest deviation of its delay, rising or falling; -1:
   none. */
int64_t worst_arrival(const delays *d, const bench *b, int rises);
/* The cell with the largest deviation, or the smallest margin if there is
   only the drawing. */
size_t worst_cell(const bench *b, size_t count, const margins *m);

/* ---- pictures.c ---- */

int draw_delays(bench *b, const patterns *p, const delays *d, const char *path,
                opc_error *error);
int draw_margins(bench *b, const cell *cells, size_t count, const margins *m,
                 const char *path, opc_error *error);
