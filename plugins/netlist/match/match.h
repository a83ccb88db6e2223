/* SPDX-License-Identifier: BSD-3-Clause */
/* Internal interface of netlist.match. Coordinates: units of the gates'
   grid. */
#pragma once

#include <eda/layout.h>
#include <eda/netlist.h>
#include <opcflow/step.h>

/* Conducting layers: poly, active, then metals. A cut layer joins two
   conducting layers: layer 2 + 2 k (contact, metal1, via1 ...) is the cut below
   metal k + 1. */
enum { POLY, ACTIVE, CONTACT, METAL1, METALS = 10, LAYERS = 2 + 2 * METALS };

/* Text that names a net of a group. During extraction, `net` is the number of a
   rectangle of the net. */
typedef struct label {
  uint32_t net, group;
  size_t number; /* position in the order of reading */
  const char *text;
} label;

/* A group: a subcircuit of the netlist and the corresponding part of the
   layout, which are matched without the other groups. */
typedef struct region {
  const eda_scope *scope;
  int32_t cell;
  const char *path;      /* instance in the layout; "" at the top */
  uint64_t first_device; /* index of the first device in the flat netlist */
  const uint32_t *gate;  /* gates of the group, in increasing order */
  size_t gates;
  const label *label; /* labels of the nets of the group */
  size_t labels;
} region;

/* Nets of a transistor: gate, and source or drain on the side of smaller (low)
   and of larger coordinates (high). */
typedef struct terminals {
  uint32_t gate, low, high;
} terminals;

/* State of a comparison of netlist and layout. */
typedef struct match_task {
  const opc_host *host;
  opc_error *error;
  eda_pool pool;
  eda_netlist netlist;
  const eda_layout *layout;
  int32_t top;
  const eda_gates *gates;
  int ignore_hierarchy;
  double tolerance; /* largest relative deviation of sizes */
  int32_t layer[LAYERS], text_layer[LAYERS]; /* layers of the layout, or -1 */

  size_t groups, capacity_groups;
  region *group;
  eda_names group_of; /* path of an instance -> group */
  uint32_t *of_group; /* group of each gate, or UINT32_MAX */

  terminals *terminals; /* nets of each gate; groups do not share nets */
  size_t nets;
  uint32_t *known; /* number of each net in the graph of its group, or
                      UINT32_MAX */
  size_t labels, capacity_labels;
  label *label;
  size_t loose; /* labels that are not on a shape */

  eda_flat_netlist flat; /* the whole netlist */
  uint32_t *owner;       /* device of each gate, or UINT32_MAX: none */
  size_t by_order; /* number of devices that were assigned to one of several
                      equivalent gates, by order */
} match_task;

/* Return an array of `n` numbers, all UINT32_MAX, owned by the pool. */
uint32_t *match_unknown(match_task *j, size_t n);

/* Return "NAME:NUMBER" of a gate, for messages, in `buffer`. */
const char *match_gate_name(const match_task *j, size_t gate, char *buffer,
                            size_t capacity);

/* assign.c: return the allowed deviation from a size of the netlist, nm. */
double match_slack(const match_task *j, double nominal);

/* pairing.c: assign subcircuits to parts of the layout. */
int match_pair(match_task *j, const eda_scope *top);
/* Return the group that contains an instance path, or UINT32_MAX. */
uint32_t match_group_of(const match_task *j, const char *path);

/* extract.c: extract the connectivity of the layout. */
int match_extract(match_task *j);

/* solve.c: assign the devices of all groups to gates. Sets j->owner. */
int match_solve(match_task *j);

/* places.c: assign each device to the gate at its place in the netlist. Sets
   j->owner. */
int match_places(match_task *j);

/* match_circuit: return the circuit of the flat netlist with the assigned
   gates; `supply` and `ground` are lists of net names separated by blanks.
   match_publish: write the table of devices and the metrics. */
eda_circuit *match_circuit(const match_task *j, const char *name,
                           const char *supply, const char *ground);
int match_publish(match_task *j, const eda_circuit *circuit);
