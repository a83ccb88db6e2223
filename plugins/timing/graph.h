/* SPDX-License-Identifier: BSD-3-Clause */
/* What the steps of timing share: a circuit of cells in the order of signals,
   its cells' tables at their loads and sizes, and static analysis. Times s,
   capacitances F, unless they say ps. */
#pragma once

#include <eda/netlist.h>
#include <eda/timing.h>

/* An output of an instance of a cell. */
typedef struct node {
  const eda_timing_cell *cell;
  uint32_t instance;
  uint32_t output;    /* of the cell */
  uint32_t net;       /* that it drives */
  const uint32_t *in; /* nets of the cell's inputs */
  size_t table;       /* where its tables begin */
} node;

/* An input of an instance. */
typedef struct plug {
  uint32_t node; /* the instance's first */
  uint32_t input;
} plug;

/* The circuit: instances of cells, in an order in which each comes after those
   that drive it. */
typedef struct graph {
  const char *name;
  size_t nets, instances, nodes;
  const char **net;      /* names */
  const char **instance; /* names, with their letter */
  node *node;
  size_t inputs, outputs;
  uint32_t *input, *output; /* nets, in the order of the ports */
  size_t arrivals;          /* of outputs that a node drives */
  uint32_t *fanout;         /* pins on each net */
  plug *pin;                /* all of them, net by net */
  uint32_t *first_pin;      /* [nets + 1] */
} graph;

/* What is around the cells. */
typedef struct conditions {
  double load; /* at each output of the circuit */
  double wire; /* for each pin on a net */
  double slew; /* of the circuit's inputs */
} conditions;

/* ---- graph.c ---- */

/* Read the subcircuit `top` of a netlist; all memory is the pool's. */
int graph_read(graph *g, eda_pool *pool, const eda_timing *timing,
               const char *file, const char *top, opc_error *error);

/* Where a device of the placed circuit is in its cell. */
typedef struct place {
  uint32_t instance;
  const eda_timing_device *device;
} place;

/* Of each of the circuit's devices (to be freed); NULL, with an error, if one
   is in no cell of the graph, or of another size there. */
place *graph_places(const graph *g, const eda_circuit *circuit,
                    opc_error *error);

/* A set of sizes: as drawn, or as a method printed them. */
typedef struct state {
  const char *name;
  double **change; /* of each instance, [bundle * EDA_SIZES + size]; or NULL */
  double *table;   /* cubics of all nodes' arcs, ps; see tables.c */
  double *one;     /* one delay an arc; see one_delay */
  const node *nodes;
  /* Of each net, [(net * 2 + rises) * EDA_CAPS + cap]: the mean load over what
     the inputs are that share cells with its pins, and what of it does not
     depend on that; the least and the largest, and where the mean lies between
     these. */
  double *load, *fixed, *least, *largest, *mean;
  /* By how much printed pins are larger, [that of the net's place, by pin]. */
  double *pins;
} state;

/* ---- tables.c: delays at the loads and sizes of a state ---- */

/* Delay and slew, at the least and at the largest load of the net. */
enum { ARC_PARTS = 2 * EDA_CAPS };

void state_tables(const graph *g, conditions at, state *s);
/* Those of one node again, once its sizes or loads have changed. */
void node_tables(const node *n, const state *s);
void state_clear(state *s);

/* The loads of a net again, when the sizes of what is on it have changed. */
void net_loads(const graph *g, conditions at, state *s, uint32_t net);

/* Doubles of the cubics of an arc. */
size_t arc_room(const eda_timing_cell *cell);

/* Delay (ps) and slew of an arc of a node at a slew of its input, at the mean
   load. */
void arc_at(const node *n, const state *s, size_t arc, double slew,
            double *delay, double *out);

/* The same at another load: 0 the least, 1 the largest, of each capacitance. */
void arc_loaded(const node *n, const state *s, size_t arc, double slew,
                const double load[EDA_CAPS], double *delay, double *out);

/* Where the mean load lies of what drives a net that rises or falls. */
const double *mean_load(const state *s, uint32_t net, int rises);

/* The load for arc_loaded when the pins on the net stand so: `from` has the
   inputs of each pin's instance, net's pins in turn. */
void load_at(const graph *g, const state *s, uint32_t net, int rises,
             const uint32_t *from, double load[EDA_CAPS]);

/* One delay an arc, fs: from an input to a node's output that rises or falls;
   the least, the mean and the largest over what the other inputs are, at the
   slews of static analysis. NAN: there is no such arc. */
enum { LEAST, MEAN, LARGEST, KINDS };
const double *one_delay(const node *n, const state *s, size_t input, int rises);

/* Static analysis: the latest arrival at each net, [net * 2 + rises], ps, and
   through which [net] it came: net * 2 + rises, or UINT32_MAX. */
typedef struct arrivals {
  double *time, *slew;
  uint32_t *from;
} arrivals;
arrivals static_arrivals(const graph *g, const state *s, double slew,
                         eda_pool *pool);
