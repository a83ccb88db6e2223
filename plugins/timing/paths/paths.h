/* SPDX-License-Identifier: BSD-3-Clause */
/* The pieces of timing.paths. Times s, capacitances F; in waves.c ps. */
#pragma once

#include <eda/experiment.h>
#include <opcflow/step.h>

#include "../graph.h"

/* The choices of 'delays' and of 'changes'. */
enum { BY_SLEWS, ONE_AN_ARC };
enum { SINGLE, SEVERAL };

/* What a pattern of the inputs does at a net: changes in turn from `level`. */
typedef struct event {
  double time, slew; /* ps */
  uint64_t path;     /* a hash of the nets through which it came */
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

  /* Of a run. */
  eda_pool pool;
  graph graph;
  size_t states;
  state *state; /* [0] as drawn */
  size_t patterns;
  int all; /* of them, not drawn at random */
} paths;

/* ---- sizes.c ---- */
int states_find(paths *p, opc_error *error);

/* ---- patterns.c ---- */

/* The inputs before and after pattern `index`, a byte each. [any] */
void pattern_at(const paths *p, size_t index, uint8_t *before, uint8_t *after);
void patterns_count(paths *p);

/* ---- waves.c: events ---- */

/* With one delay an arc: when a function's value changes, and when its output
   is set. */
typedef struct flip {
  double at, fires;
  uint8_t value;
} flip;

typedef struct waves {
  const paths *p;
  size_t count, room;
  event *event;
  uint32_t *first, *last; /* of each net */
  uint8_t *level;         /* before */
  uint8_t *before, *after;
  size_t room_changes;
  flip *change;
  uint32_t *pins; /* levels of the inputs of what a net drives */
} waves;

void waves_init(waves *w, const paths *p);
void waves_clear(waves *w);
/* All nets' events for one pattern of the inputs (w->before, w->after). */
void waves_run(waves *w, const state *s);

/* The inputs of a node, in the order of time. */
typedef struct merge {
  const waves *w;
  const node *n;
  uint32_t now;                     /* their levels */
  uint32_t next[EDA_TIMING_INPUTS]; /* events */
  uint32_t end[EDA_TIMING_INPUTS];
} merge;

/* Whether any input changes. */
int merge_init(merge *m, const waves *w, const node *n);
/* The input that changes next, -1: none. Of equals the first. */
int merge_next(const merge *m, double *time);
/* A path goes on through a net: FNV-1a over the numbers of nets. */
uint64_t path_on(uint64_t path, uint32_t net);
void waves_push(waves *w, double time, double slew, uint64_t path);

/* ---- slews.c: the events of a node, by slews ---- */
void waves_by_slews(waves *w, const node *n, const state *s);

/* What an output does after a pattern. */
typedef struct arrival {
  double time;   /* ps, when it gets where it ends; NAN: it ends as it began */
  uint64_t path; /* of that event; with one delay an arc 0 */
} arrival;
arrival waves_arrival(const waves *w, size_t output);

/* ---- deviations.c: all patterns ---- */

typedef struct delays {
  size_t count;      /* of outputs that follow a pattern */
  arrival **arrival; /* [state][count] */
} delays;

int delays_find(paths *p, delays *out, opc_error *error);
void delays_clear(delays *d, size_t states);

/* What deviates, in %, of the delays of state s (thesis eq. 3.15). Where
   the output's last change comes through other nets than as drawn, as a pulse
   passes in one of both or another of two inputs is the later, it is not the
   same transition, and is not compared. */
typedef struct spread {
  size_t compared;
  double mean, stdv, lowest, highest; /* mean and stdv of absolute values */
  double longest, shortest;           /* of all delays, their deviation */
} spread;
spread spread_of(const delays *d, size_t s);
int tell_delays(paths *p, const delays *d, opc_error *error);
int draw_histogram(const paths *p, const delays *d, const char *path,
                   opc_error *error);

/* ---- formats.c ---- */
int write_sdf(const paths *p, const state *s, const char *path,
              opc_error *error);
int write_verilog(const paths *p, const char *path, opc_error *error);
int tell_events(const paths *p, opc_error *error);

/* ---- referee.c ---- */
int compare_with_spice(paths *p, opc_error *error);
