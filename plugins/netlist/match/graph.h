/* SPDX-License-Identifier: BSD-3-Clause */
/* Netlist and layout as one graph of nets and bundles, and its partition into
   classes that look alike. A bundle is all transistors of one type with the
   same net at the gate and the same two at source and drain: fingers of a
   device, and devices in parallel. */
#pragma once

#include "match.h"

enum { NETLIST, LAYOUT, SIDES };

typedef struct nm_point {
  double x, y;
} nm_point;

typedef struct bundle {
  uint32_t gate, a, b; /* nets of its side; a <= b */
  uint8_t type;
  uint32_t first, count; /* in the members of its side */
  double length, width;  /* of the first; of all together */
  nm_point middle;       /* of all, nm; NAN if not known */
} bundle;

typedef struct side {
  uint32_t nets;
  uint32_t bundles;
  bundle *bundle;
  uint32_t *member;  /* devices of the flat netlist, or gates */
  const char **seed; /* of each net: the port it is, on both sides; or NULL */
  const char **name; /* of each net: the label on both sides, or NULL */
} side;

typedef struct arc {
  uint32_t node;
  uint32_t role; /* 1 gate, 2 source or drain */
} arc;

/* Nodes: nets of both sides, then bundles of both. */
typedef struct graph {
  job *j;
  const region *group;
  eda_flat_netlist flat;
  side side[SIDES];
  uint32_t nodes;
  uint32_t net0[SIDES], bundle0[SIDES];
  uint32_t *start; /* of each node, in links */
  arc *links;
} graph;

static inline int graph_side(const graph *g, uint32_t node) {
  return node < g->bundle0[NETLIST] ? node >= g->net0[LAYOUT]
                                    : node >= g->bundle0[LAYOUT];
}

static inline const bundle *graph_bundle(const graph *g, uint32_t node) {
  int s = node >= g->bundle0[LAYOUT];
  return &g->side[s].bundle[node - g->bundle0[s]];
}

static inline uint64_t graph_mix(uint64_t a, uint64_t b) {
  uint64_t h = (a + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u + b;
  h = (h ^ h >> 30) * 0x94d049bb133111ebu;
  return h ^ h >> 31;
}

/* Where a device's gate is said to be, nm; NAN where nothing is. Only devices
   of the top itself are at a place of the layout. */
nm_point graph_place(const graph *g, const eda_transistor *d);

/* The middle of a gate, nm. */
nm_point graph_middle(const job *j, uint32_t gate);

/* From a place to another, nm; 0 if one is not known. */
double graph_distance(nm_point a, nm_point b);

/* A name's, in any case; 0 for NULL. */
uint64_t graph_hash(const char *name);

/* Sort nodes by a mark that each has, then by number. */
void graph_sort(uint32_t *nodes, size_t n, const uint64_t *mark);

/* graph.c: the graph of a group. */
int graph_make(job *j, const region *group, graph *out);

/* faults.c: tell which bundles have no counterpart. Returns the code. */
int graph_tell(graph *g);

/* assign.c: the devices of a bundle to the gates of its counterpart, with their
   sizes checked. */
int graph_assign(graph *g, const bundle *devices, const bundle *gates);

/* ---- partition.c ---- */

typedef struct partition {
  const graph *g;
  uint32_t classes;
  uint32_t *class_of;    /* of each node */
  uint32_t *order;       /* nodes, class by class */
  uint32_t *begin, *end; /* of each class, in order */
  uint32_t *parent;      /* of each class: which it was split off */
  uint8_t *touched;
  uint64_t *mark; /* of each node: what it is told apart by */
  uint32_t *list, *changed, *spare;
  uint32_t n_changed;
  int odd; /* a class has not as many nodes of the one side as of the other */
} partition;

void partition_make(const graph *g, partition *out);
/* Tell apart what is connected differently. 0 if the sides differ. */
int partition_refine(partition *p);
/* Split a class by the marks of its nodes. */
void partition_split(partition *p, uint32_t class);
/* Take two nodes as counterparts, one of each side. */
void partition_pick(partition *p, uint32_t a, uint32_t b);
/* Take back all splits beyond that number of classes. */
void partition_undo(partition *p, uint32_t classes);
