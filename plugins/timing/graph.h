/* SPDX-License-Identifier: BSD-3-Clause */
/* Shared by the timing steps: circuits of cells in topological order, delay
   tables at given loads and sizes, and static timing analysis. Times in s
   unless a comment states ps or fs; capacitances in F. */
#pragma once

#include <eda/netlist.h>
#include <eda/timing.h>
#include <opcflow/plugin.h>

/* Output of a cell instance. */
typedef struct node {
  const eda_timing_cell *cell;
  uint32_t instance;
  uint32_t output;    /* output of the cell */
  uint32_t net;       /* net driven by the output */
  const uint32_t *in; /* nets of the cell's inputs, then of its outputs */
  size_t table;       /* offset of the node's arcs in state.table */
} node;

/* Input pin of an instance. */
typedef struct plug {
  uint32_t node; /* first node of the instance */
  uint32_t input;
} plug;

/* Circuit of cell instances. Each node follows the nodes that drive its
   inputs. */
typedef struct graph {
  const char *name;
  size_t nets, instances, nodes;
  const char **net;      /* names */
  const char **instance; /* names, including the leading letter */
  node *node;
  size_t inputs, outputs;
  uint32_t *input, *output; /* nets, in the order of the ports */
  uint32_t *fanout;         /* number of input pins on each net */
  plug *pin;                /* all input pins, ordered by net */
  uint32_t *first_pin;      /* [nets + 1]; the pins of net n are
                               pin[first_pin[n]] .. pin[first_pin[n + 1] - 1] */
} graph;

/* Electrical conditions at the boundary of the circuit. */
typedef struct conditions {
  double load; /* at each output of the circuit, F */
  double wire; /* wire capacitance for each pin of a net, F */
  double slew; /* of the inputs of the circuit, s */
} conditions;

/* ---- graph.c ---- */

/* Read the subcircuit `top` of the netlist `file` into `g`. Return OPC_OK or an
   error code. `pool` owns all memory of `g`. */
int graph_read(graph *g, eda_pool *pool, const eda_timing *timing,
               const char *file, const char *top, opc_error *error);

/* Instance and cell device of a device of the placed circuit. */
typedef struct place {
  uint32_t instance;
  const eda_timing_device *device;
} place;

/* Return the place of each device of the circuit (caller frees). Returns NULL
   and sets `error` if a device is in no cell of the graph, or its size differs
   from the size in the cell. */
place *graph_places(const graph *g, const eda_circuit *circuit,
                    opc_error *error);

/* Set of transistor sizes, drawn or printed, with the resulting tables. */
typedef struct state {
  const char *name;
  double **change; /* ln(printed / drawn size), [instance][bundle * EDA_SIZES +
                      size]; NULL for drawn sizes */
  double *table;   /* cubic coefficients of the arcs of all nodes, ps; see
                      tables.c */
  double *one;     /* one delay per arc, fs, for SDF files (see the enumeration
                      below) */
  const node *nodes;
  /* Loads of each net, F, [(net * 2 + rises) * EDA_CAPS + cap]. `load` is the
     mean over the input patterns of the instances that the net drives; `least`
     and `largest` are the bounds over these patterns. `fixed` is the part of
     wires and output loads. `mean` is the position of `load` between the
     bounds, 0 to 1. */
  double *load, *fixed, *least, *largest, *mean;
  /* Ratio of printed to drawn pin capacitance, [(pin * 2 + rises) * EDA_CAPS +
     cap], pins as in graph.pin. */
  double *pins;
} state;

/* ---- tables.c: delays at the loads and sizes of a state ---- */

/* Values per arc: delay and slew, each at the least and the largest load. */
enum { ARC_PARTS = 2 * EDA_CAPS };

/* Allocate and compute the loads, tables and single delays of a state from
   s->change. */
void state_tables(const graph *g, conditions at, state *s);
/* Recompute the tables of one node after a change of sizes or loads. */
void node_tables(const node *n, const state *s);
void state_clear(state *s);

/* Recompute the loads of a net after a change of the sizes connected to the
   net. */
void net_loads(const graph *g, conditions at, state *s, uint32_t net);

/* Return the number of doubles that hold the cubics of one arc. */
size_t arc_doubles(const eda_timing_cell *cell);

/* Compute delay and output slew (ps) of an arc of a node at input slew `slew`
   (ps) and mean load. */
void arc_at(const node *n, const state *s, size_t arc, double slew,
            double *delay, double *out);

/* Compute delay and output slew (ps) at a load between the least and the
   largest load of the net. load[cap] is the position between both, 0 to 1. */
void arc_loaded(const node *n, const state *s, size_t arc, double slew,
                const double load[EDA_CAPS], double *delay, double *out);

/* Return the position of the mean load between the bounds, [EDA_CAPS], for a
   net that rises or falls. */
const double *mean_load(const state *s, uint32_t net, int rises);

/* Compute the load for arc_loaded from the input levels of the instances that
   the net drives; from[k] is the input pattern of the instance of the net's pin
   k. */
void load_at(const graph *g, const state *s, uint32_t net, int rises,
             const uint32_t *from, double load[EDA_CAPS]);

/* Return the least, mean and largest delay (fs, [KINDS]) from a cell input to
   the output of a node that rises or falls. The delays are taken over the
   levels of the other inputs, at the slews of static timing analysis. NAN if
   there is no such arc. */
enum { LEAST, MEAN, LARGEST, KINDS };
const double *one_delay(const node *n, const state *s, size_t input, int rises);

/* Result of static timing analysis for each transition, [net * 2 + rises]:
   latest arrival (ps; -INFINITY if the transition does not occur), slew (ps),
   and the index of the preceding transition on the latest path (UINT32_MAX at
   inputs). */
typedef struct arrivals {
  double *time, *slew;
  uint32_t *from;
} arrivals;
arrivals static_arrivals(const graph *g, const state *s, double slew,
                         eda_pool *pool);

/* Log a finding if a slew at the inputs of a gate, or a load, exceeds the
   timing tables of the cell so far that the extrapolated delay is inaccurate.
   `slew`: slew at the inputs of the circuit, s. */
void log_extrapolated(const opc_host *host, const graph *g, const state *s,
                      double slew);
