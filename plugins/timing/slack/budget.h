/* SPDX-License-Identifier: BSD-3-Clause */
/* How much longer each transistor of a circuit may be for the least leakage,
   so that no path takes longer than a limit. */
#pragma once

#include "../graph.h"

/* Steps from the drawn to the greatest length. One is less than a nanometre for
   lengths that are 10 % more at 65 nm, below the mask's own step. */
enum { LEVELS = 10 };

/* The transistors of a cell that are in parallel: one length for all. */
typedef struct choice {
  uint32_t instance, bundle;
  uint32_t level, most;      /* of LEVELS; most is 0 where it has to stay */
  double length[LEVELS + 1]; /* ln of the length over that drawn */
  double leak[LEVELS + 1];   /* A, mean over the circuit's input patterns */
} choice;

/* An input of an instance on a net. */
typedef struct pin {
  uint32_t node, input;
} pin;

typedef struct budget {
  const graph *g;
  conditions at;
  double limit; /* ps: the latest arrival that is allowed */
  size_t count;
  choice *choice; /* that of (instance, bundle) is first[instance] + bundle */
  size_t *first;

  /* Of a run; see budget_init. */
  eda_pool pool;
  state sizes;
  int64_t *driver;   /* of each net: its node, -1 */
  uint32_t *pins_of; /* of each net: its pins are pin[pins_of[net]] ... */
  pin *pin;
  uint32_t *node_of; /* of each instance: its nodes are
                        node[node_of[instance]] ... */
  uint32_t *node;
} budget;

/* Tables and lists, with each choice at its level. `choice` and `first` are
   filled in by the caller, who frees them. */
void budget_init(budget *b);
void budget_clear(budget *b);

/* The latest arrival at an output, ps. */
double budget_worst(const budget *b);

/* By how much each net may be later, ps: [net * 2 + rises], INFINITY where it
   leads nowhere or does not come. To be freed. */
double *budget_slack(const budget *b);

/* What all leak, A, in the mean over input patterns. */
double budget_leak(const budget *b);

/* Set the levels. All begin at their most; while the latest path takes longer
   than the limit, whoever is on it and gives the most delay for the least
   leakage goes down a level (Fishburn and Dunlop, TILOS, ICCAD 1985, the other
   way round); then each goes up again as far as the limit lets it. 0 if the
   limit cannot be kept even as drawn. */
int budget_spend(budget *b);

/* ---- rest.c ---- */

/* Of each choice, the share of the input patterns at rest in which its
   transistors leak; to be freed. Asks `g`, `first` and `count` alone. */
double *rest_shares(const budget *b);
