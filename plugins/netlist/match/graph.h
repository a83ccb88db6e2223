/* SPDX-License-Identifier: BSD-3-Clause */
/* Graph of the nets and bundles of netlist and layout, and its partition into
   classes of equivalent nodes. A bundle consists of all transistors of one type
   with the same gate net and the same pair of source and drain nets: fingers of
   a device, and parallel devices. */
#pragma once

#include "match.h"

/* Sides of the comparison. */
enum { NETLIST, LAYOUT, SIDES };

/* A position, nm. */
typedef struct nm_point {
  double x, y;
} nm_point;

/* A bundle. */
typedef struct bundle {
  uint32_t gate, a, b; /* nets; a <= b, both at source or drain */
  uint8_t type;
  uint32_t first, count; /* range in side.member */
  double length, width;  /* length of the first transistor; total width, nm */
  nm_point middle;       /* mean of the centres of the gates, nm; NAN if not
                            known */
} bundle;

/* The nets and bundles of one side. */
typedef struct side {
  uint32_t nets;
  uint32_t bundles;
  bundle *bundle;
  uint32_t *member;  /* transistors of all bundles: devices of the flat netlist,
                        or gates of the layout */
  const char **seed; /* for each net, the name of the port if both sides have
                        this port, or NULL */
  const char **name; /* for each other net, the label if both sides have this
                        label, or NULL */
} side;

/* Link from a node to a neighbour. */
typedef struct arc {
  uint32_t node;
  uint32_t role; /* 1 gate, 2 source or drain */
} arc;

/* Nodes: nets of both sides, then bundles of both sides. */
typedef struct graph {
  match_task *j;
  const region *group;
  eda_flat_netlist flat;
  side side[SIDES];
  uint32_t nodes;
  uint32_t net0[SIDES], bundle0[SIDES]; /* first node of the nets and of the
                                           bundles of each side */
  uint32_t *start; /* [nodes + 1]: first link of each node */
  arc *links;
} graph;

/* Return the side of a node. */
static inline int graph_side(const graph *g, uint32_t node) {
  return node < g->bundle0[NETLIST] ? node >= g->net0[LAYOUT]
                                    : node >= g->bundle0[LAYOUT];
}

/* Return the bundle of a node that is no net. */
static inline const bundle *graph_bundle(const graph *g, uint32_t node) {
  int s = node >= g->bundle0[LAYOUT];
  return &g->side[s].bundle[node - g->bundle0[s]];
}

/* Return a hash of two numbers. */
static inline uint64_t graph_mix(uint64_t a, uint64_t b) {
  uint64_t h = (a + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u + b;
  h = (h ^ h >> 30) * 0x94d049bb133111ebu;
  return h ^ h >> 31;
}

/* Return the centre of a device's gate according to the comment in the netlist,
   nm, or NAN. Only devices of the top circuit have a position. */
nm_point graph_place(const graph *g, const eda_transistor *d);

/* Return the centre of a gate, nm. */
nm_point graph_middle(const match_task *j, uint32_t gate);

/* Return the distance of two positions, nm; 0 if one is unknown. */
double graph_distance(nm_point a, nm_point b);

/* Return a hash of a name that ignores case; 0 for NULL. */
uint64_t graph_hash(const char *name);

/* Sort nodes by mark, then by number. */
void graph_sort(uint32_t *nodes, size_t n, const uint64_t *mark);

/* graph.c: build the graph of a group. */
int graph_make(match_task *j, const region *group, graph *out);

/* faults.c: fail with a message that names the bundles without a counterpart.
   Return the code. */
int graph_report(graph *g);

/* assign.c: assign the devices of a bundle to the gates of its counterpart and
   check their sizes. */
int graph_assign(graph *g, const bundle *devices, const bundle *gates);

/* ---- partition.c ---- */

/* The partition of all nodes into classes. */
typedef struct partition {
  const graph *g;
  uint32_t classes;
  uint32_t *class_of;     /* class of each node */
  uint32_t *order;        /* nodes sorted by class */
  uint32_t *begin, *end;  /* range of each class in `order` */
  uint32_t *parent;       /* class from which each class was split */
  uint8_t *touched;       /* 1: the class is in `list` */
  uint64_t *mark;         /* key of each node for the next split */
  uint32_t *list, *spare; /* classes to split; buffer */
  uint32_t *changed;      /* nodes whose class changed since the last round */
  uint32_t n_changed;
  int odd; /* 1: in some class, the numbers of nodes of both sides differ */
} partition;

/* Make a partition with one class. */
void partition_make(const graph *g, partition *out);
/* Split classes until all nodes of a class have neighbours of the same classes.
   Returns 0 if the two sides differ. */
int partition_refine(partition *p);
/* Split a class by the marks of its nodes. */
void partition_split(partition *p, uint32_t class);
/* Make counterparts of two nodes, one of each side: put both into a class of
   their own. */
void partition_pick(partition *p, uint32_t a, uint32_t b);
/* Revert splits until `classes` classes remain. */
void partition_undo(partition *p, uint32_t classes);
