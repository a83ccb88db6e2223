/* SPDX-License-Identifier: BSD-3-Clause */
/* Search for gate lengths: increases the lengths to reduce leakage while no
   path exceeds a limit. */
#pragma once

#include "../graph.h"

/* Steps from the drawn to the largest length. For an increase of 10 % at 65 nm,
   one step is less than 1 nm, below the grid of the mask. */
enum { LEVELS = 10 };

/* The transistors of a bundle of an instance, which share one length. A bundle
   contains equivalent transistors of a cell (eda/timing.h). */
typedef struct choice {
  uint32_t instance, bundle;
  uint32_t level, most;      /* current and largest level, 0 (drawn length) to
                                LEVELS; most is 0 if the length is fixed */
  double length[LEVELS + 1]; /* ln(length / drawn length) at each level */
  double leak[LEVELS + 1];   /* leakage at each level, A, mean over the input
                                patterns of the circuit */
} choice;

/* Input of an instance on a net. */
typedef struct pin {
  uint32_t node, input;
} pin;

typedef struct budget {
  const graph *g;
  conditions at;
  double limit; /* largest allowed arrival, ps */
  size_t count;
  choice *choice; /* choice of (instance, bundle): first[instance] + bundle */
  size_t *first;

  /* The members below are the state of a run, set by budget_init. */
  eda_pool pool;
  state sizes;
  int64_t *driver;   /* node that drives each net, or -1 */
  uint32_t *pins_of; /* pins of net n begin at pin[pins_of[n]] */
  pin *pin;
  uint32_t *node_of; /* nodes of instance i begin at node[node_of[i]] */
  uint32_t *node;
} budget;

/* Build tables and lists with each choice at its current level. The caller
   fills in and frees `choice` and `first`. */
void budget_init(budget *b);
void budget_clear(budget *b);

/* Return the latest arrival at an output, ps. */
double budget_worst(const budget *b);

/* Return the slack of each transition, ps, [net * 2 + rises] (caller frees).
   The slack is INFINITY if no path leads from the net to an output, or if the
   transition does not occur. */
double *budget_slack(const budget *b);

/* Return the total leakage, A, mean over the input patterns. */
double budget_leak(const budget *b);

/* Set the levels. Start with all choices at their largest level. While the
   latest path exceeds the limit, lower the choice on this path with the largest
   delay reduction per added leakage (the inverse of Fishburn and Dunlop, TILOS,
   ICCAD 1985). Then raise each choice as far as the limit allows. Return 0 if
   even the drawn lengths exceed the limit. */
int budget_spend(budget *b);

/* ---- static_leakage.c ---- */

/* Return, for each choice, the leakage of its transistors relative to their
   Ioff, averaged over the static input patterns and over the transistors of the
   choice (caller frees). Uses only `g`, `first` and `count`. */
double *static_leakage_shares(const budget *b);
