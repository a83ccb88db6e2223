/* SPDX-License-Identifier: BSD-3-Clause */
/* What the files of netlist.match share. Coordinates are in units of the
   gates' grid. */
#pragma once

#include <eda/layout.h>
#include <eda/netlist.h>
#include <opcflow/step.h>

/* Layers that conduct: poly, active, then metals; cuts join two of them.
   Number 2 + 2 k is metal k + 1 less one's cut: contact, metal1, via1 ... */
enum { POLY, ACTIVE, CONTACT, METAL1, METALS = 10, LAYERS = 2 + 2 * METALS };

/* A text on a net; while nets are sought, `net` is a rectangle. */
typedef struct label {
  uint32_t net, group;
  size_t number; /* in the order of reading */
  const char *text;
} label;

/* A subcircuit of the netlist and the part of the layout that is it. */
typedef struct region {
  const eda_scope *scope;
  int32_t cell;
  const char *path;      /* of the instance in the layout; "" at the top */
  uint64_t first_device; /* of the flat netlist */
  const uint32_t *gate;  /* those that lie in it, in order */
  size_t gates;
  const label *label; /* those of its nets, in order */
  size_t labels;
} region;

/* A net has two terminals at most on a gate's sides and one on the gate. */
typedef struct terminals {
  uint32_t gate, low, high;
} terminals;

typedef struct job {
  const opc_host *host;
  opc_error *error;
  eda_pool pool;
  eda_netlist netlist;
  const eda_layout *layout;
  int32_t top;
  const eda_gates *gates;
  int ignore_hierarchy;
  double tolerance;                          /* of sizes, as a fraction */
  int32_t layer[LAYERS], text_layer[LAYERS]; /* -1: none */

  size_t groups, room_groups;
  region *group;
  eda_names group_of; /* paths to groups */
  uint32_t *of_group; /* of each gate; UINT32_MAX: of none */

  terminals *terminals; /* of each gate: nets; those of a group are its own */
  size_t nets;
  uint32_t *known; /* of each net: its number in its group; UINT32_MAX */
  size_t labels, room_labels;
  label *label;
  size_t loose; /* labels that lie on nothing */

  eda_flat_netlist flat; /* the whole netlist */
  uint32_t *owner;       /* of each gate: its device; UINT32_MAX none */
  size_t by_order;       /* choices that nothing but the order settled */
} job;

/* `n` numbers, all UINT32_MAX. */
uint32_t *match_unknown(job *j, size_t n);

/* "NAME:NUMBER", as it is told in messages. */
const char *match_gate_name(const job *j, size_t gate, char *buffer,
                            size_t room);

/* pairing.c: which subcircuit is which part of the layout. */
int match_pair(job *j, const eda_scope *top);
/* The group that an instance lies in, by its path; UINT32_MAX: in none. */
uint32_t match_group_of(const job *j, const char *path);

/* extract.c: what is connected in the layout. */
int match_extract(job *j);

/* solve.c: the devices of all groups to their gates: j->owner. */
int match_solve(job *j);

/* output.c: the circuit, from the flat netlist and the owners of the gates;
   names of supply and ground nets are lists with blanks between. Then the table
   of devices, and the metrics. */
eda_circuit *match_circuit(const job *j, const char *name, const char *supply,
                           const char *ground);
int match_publish(job *j, const eda_circuit *circuit);
