/* SPDX-License-Identifier: BSD-3-Clause */
/* Derivatives of delays with respect to the sizes of transistors, at the slews
   and loads of static timing analysis. Internal to timing.paths. */
#pragma once

#include <eda/delays.h>

#include "paths.h"

/* Delay and output slew of an arc, ps, and their derivatives by the input
   slew. */
typedef struct arc_slope {
  double delay, out, delay_by, out_by;
} arc_slope;

/* The arcs of a node, and their derivatives by the changes of sizes of the
   node's instance and of the instances that load its net. */
typedef struct node_slopes {
  arc_slope *arc; /* [arcs of the cell]; zero for arcs to other outputs and for
                     arcs from transitions that do not occur */
  size_t columns;
  uint32_t *column; /* positions in a vector of all changes */
  double *by;       /* [(arc * columns + column) * 2 + (0: delay, 1: slew)] */
} node_slopes;

typedef struct gradients {
  const graph *graph;
  state state; /* own sizes, equal to those of the reference */
  arrivals arrivals;
  uint32_t *slowest; /* arc with the largest output slew to each transition;
                        UINT32_MAX at inputs */
  size_t *base;      /* position of each instance in a vector of changes */
  size_t length;     /* of such a vector */
  node_slopes *node;
  eda_pool memory;
} gradients;

/* An arc and its weight in a sum of delays. */
typedef struct weighted_arc {
  uint32_t node, arc;
  double weight;
} weighted_arc;

/* Compute the slopes of all arcs at the sizes of `reference`. */
void gradients_init(gradients *z, const paths *p, const state *reference);
void gradients_clear(gradients *z);

/* Return the transition (net * 2 + rises) from which an arc starts. */
uint32_t arc_from(const node *n, size_t arc);

/* Compute the gradient of the sum of n arcs' delays, ordered by falling node,
   by all changes of sizes. The slews follow the changes. `vector`: [length],
   zeros at the call. [any] */
void gradients_of(const gradients *z, const weighted_arc *arc, size_t n,
                  double *vector);

/* ---- critical.c ---- */

/* A path, from the output to the input. */
typedef struct critical_path {
  uint64_t id; /* hash of the arcs */
  uint32_t to; /* transition of the output */
  size_t count, arcs;
  weighted_arc *arc;
  double time; /* ps */
} critical_path;

/* Find paths: the longest to each transition of an output, and those that are
   the longest of the circuit if the delays of the gates vary at random. Set
   *count, and *coverage to the share of the random circuits whose longest path
   is among these. The longest path is first. Memory: z->memory. */
critical_path *critical_find(gradients *z, uint64_t seed, size_t *count,
                             double *coverage);

/* ---- sensitivities.c ---- */

/* Make the output `delays`: paths and arcs with their derivatives. Return
   OPC_OK or an error code. */
int delays_differentiate(paths *p, eda_delays **out, opc_error *error);
