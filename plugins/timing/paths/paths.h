/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of timing.paths. Times in s, capacitances in F; in waves.c
   times in ps. */
#pragma once

#include <eda/experiment.h>
#include <opcflow/step.h>

#include "../graph.h"

/* Values of the parameters 'delays' and 'changes'. */
enum { BY_SLEWS, ONE_AN_ARC };
enum { SINGLE, SEVERAL };

/* Transition of a net. The transitions of a net alternate between both levels,
   starting from waves.level. */
typedef struct event {
  double time, slew; /* time and slew, ps */
  uint64_t path;     /* hash of the nets on the path of the event */
} event;

typedef struct paths {
  const opc_host *host;

  /* Parameters. */
  const eda_timing *timing;
  const eda_circuit *circuit;
  const eda_mask *mask;
  const char *label;
  opc_map prints;
  const eda_experiment *experiment;
  const char *file, *top;
  int64_t transitions, seed, events, spice;
  int changes, delays;
  conditions at;
  const char *picture, *verilog;
  const char *models[2], *model[2];
  double limit;

  /* State of a run. */
  eda_pool pool;
  graph graph;
  size_t states;
  state *state; /* sets of sizes; [0] as drawn */
  size_t patterns;
  int all; /* 1: all transitions; 0: random transitions */
} paths;

/* ---- sizes.c ---- */

/* Set p->state: the drawn sizes, then the printed sizes of `mask`, of the
   methods of `experiment`, and of the tables `prints`. The tables of the states
   are not computed. */
int states_find(paths *p, opc_error *error);

/* ---- patterns.c ---- */

/* Set the input levels before and after pattern `index`, one byte per input.
   [any] */
void pattern_at(const paths *p, size_t index, uint8_t *before, uint8_t *after);
/* Set p->patterns, the number of patterns, and p->all. */
void patterns_count(paths *p);

/* ---- waves.c: events ---- */

/* With one delay per arc: change of the value of a node's logic function at the
   time `at`, which causes an output event at the time `fires`. Times in fs. */
typedef struct flip {
  double at, fires;
  uint8_t value;
} flip;

typedef struct waves {
  const paths *p;
  size_t count, capacity;
  event *event;
  uint32_t *first, *last; /* events of net n: event[first[n]] ..
                             event[last[n] - 1] */
  uint8_t *level;         /* level of each net before the pattern */
  uint8_t *before, *after;
  size_t capacity_changes;
  flip *change;
  uint32_t *pins; /* input patterns of the instances that load a net */
} waves;

void waves_init(waves *w, const paths *p);
void waves_clear(waves *w);
/* Compute the events of all nets for one input pattern (w->before,
   w->after). */
void waves_run(waves *w, const state *s);

/* State of a traversal of the input events of a node, in order of time. */
typedef struct merge {
  const waves *w;
  const node *n;
  uint32_t now;                     /* current levels of the inputs */
  uint32_t next[EDA_TIMING_INPUTS]; /* index of the next event */
  uint32_t end[EDA_TIMING_INPUTS];
} merge;

/* Start a traversal. Return 1 if any input changes. */
int merge_init(merge *m, const waves *w, const node *n);
/* Return the input that changes next and set *time to the time of the change.
   If several change at once, return the input with the smallest number. Return
   -1 if no input changes any more. */
int merge_next(const merge *m, double *time);
/* Return the hash of a path extended by a net (FNV-1a over the net numbers). */
uint64_t path_on(uint64_t path, uint32_t net);
/* Append an event to the events of the net that is being evaluated. */
void waves_push(waves *w, double time, double slew, uint64_t path);

/* ---- slews.c: the events of a node, by slews ---- */

/* Append the events of the net that the node drives (delays: slews). */
void waves_by_slews(waves *w, const node *n, const state *s);

/* Final transition of an output after a pattern. */
typedef struct arrival {
  double time; /* time of the last transition, ps; NAN if the final level equals
                  the initial level */
  uint64_t path; /* path hash of that transition; 0 with one delay per arc */
} arrival;
arrival waves_arrival(const waves *w, size_t output);

/* ---- deviations.c: all patterns ---- */

typedef struct delays {
  size_t count;      /* delays: pairs of pattern and output with a final
                        transition */
  arrival **arrival; /* [state][count] */
} delays;

int delays_find(paths *p, delays *out, opc_error *error);
void delays_clear(delays *d, size_t states);

/* Deviations of the delays of a state from the delays at drawn sizes, % (thesis
   eq. 3.15). Delays whose last event takes another path than at drawn sizes are
   not compared. The paths differ if a pulse passes in only one of the states,
   or if a different input arrives last. */
typedef struct spread {
  size_t compared;
  double mean, stdv, lowest, highest; /* mean and stdv of absolute values */
  double longest, shortest;           /* deviation of the longest and of the
                                         shortest delay */
} spread;
/* Return the latest arrival of static timing analysis at an output, ps. */
double worst_path(const paths *p, const state *s);
int delays_report(paths *p, const delays *d, opc_error *error);
int draw_histogram(const paths *p, const delays *d, const char *path,
                   opc_error *error);

/* ---- formats.c ---- */
/* Return the name of a node's instance without the leading letter of SPICE. */
const char *sdf_instance(const graph *g, const node *n);
int write_sdf(const paths *p, const state *s, const char *path,
              opc_error *error);
int write_verilog(const paths *p, const char *path, opc_error *error);
int events_report(const paths *p, opc_error *error);

/* ---- reference.c ---- */

/* Simulate the first p->spice transitions with the whole circuit in ngspice and
   report the differences as a table and metrics. */
int compare_with_spice(paths *p, opc_error *error);
