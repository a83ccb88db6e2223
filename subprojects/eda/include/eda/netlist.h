/* SPDX-License-Identifier: BSD-3-Clause */
/* SPICE and CDL netlists: reading them, making them flat, and writing one with
   the sizes that its transistors print with. Faults of a file are OPC_INVALID
   and carry file:line:column. */
#ifndef EDA_NETLIST_H
#define EDA_NETLIST_H

#include <eda/circuit.h>
#include <eda/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- as it is written: subcircuits of elements ------------------------- */

/* Where something is written. */
typedef struct eda_place {
  uint32_t file, line, column;
} eda_place;

/* NAME=VALUE; the value is a number or an expression, not yet looked at. */
typedef struct eda_assignment {
  const char *name, *value;
  eda_place at;
} eda_assignment;

typedef struct eda_element {
  int is_transistor; /* else a subcircuit's instance */
  const char *name;  /* as written, with its letter */
  eda_place at;
  size_t nodes;
  const char **node;
  uint32_t *local;   /* of each node: its number in the subcircuit */
  const char *model; /* or the subcircuit's name */
  eda_place model_at;
  uint32_t child; /* the subcircuit's number */
  uint8_t type;   /* EDA_NMOS, EDA_PMOS */
  size_t settings;
  eda_assignment *setting;
  double x, y; /* the centre of its gate, nm, if the comment says so; or NAN */
} eda_element;

typedef struct eda_subcircuit {
  const char *name;
  eda_place at;
  size_t ports;
  const char **port;
  size_t settings; /* what its parameters are by default */
  eda_assignment *setting;
  size_t elements, room;
  eda_element *element;

  /* After eda_netlist_prepare. Ports are its first nodes. */
  int state; /* 0 not yet, 1 on the way, 2 done */
  size_t nodes, room_nodes;
  const char **node;
  uint64_t devices; /* with those below */
} eda_subcircuit;

typedef struct eda_netlist {
  /* What the caller sets, the rest being zero. All faults go to *error. */
  opc_error *error;
  double scale;                    /* a factor on sizes */
  const char *n_models, *p_models; /* names with blanks between, or NULL */

  eda_pool pool;
  struct eda_lines *lines; /* the reader, for what is told of places */
  uint32_t current; /* while it is read: the subcircuit, UINT32_MAX outside */
  int control;      /* between .control and .endc */
  size_t subcircuits, room_subcircuits;
  eda_subcircuit *subcircuit;
  eda_names subcircuit_of;
  eda_names type_of;   /* models that a .model card names */
  eda_names global_of; /* .global nets */
  size_t globals, room_globals;
  const char **global;
  size_t settings, room_settings; /* .param */
  eda_assignment *setting;
  eda_names setting_of;
  double unit;     /* .option scale */
  size_t left_out; /* capacitors and diodes of subcircuits */
} eda_netlist;

/* In which subcircuit an expression is meant, and who called it. */
typedef struct eda_scope {
  const struct eda_scope *caller; /* NULL: the top */
  const eda_subcircuit *of;
  const eda_element *call;
} eda_scope;

/* Read a file and those that it includes. The netlist stays where it is made
   and is cleared also after a failure. [main] */
OPC_EXPORT int eda_netlist_read(eda_netlist *n, const char *path);
OPC_EXPORT void eda_netlist_clear(eda_netlist *n);

/* The number of a subcircuit; -1 and an error of the parameter "top" that names
   those that are there. */
OPC_EXPORT int64_t eda_netlist_find(eda_netlist *n, const char *name);

/* Number the nodes of a subcircuit and of all below it, find what they call,
   count. Before anything of it is made flat. */
OPC_EXPORT int eda_netlist_prepare(eda_netlist *n, uint32_t top);

/* "FILE:LINE" of an element, in the buffer. */
OPC_EXPORT const char *eda_netlist_where(const eda_netlist *n,
                                         const eda_element *e, char *buffer,
                                         size_t room);

/* ---- flat -------------------------------------------------------------- */

typedef struct eda_transistor {
  const char *name; /* with its path */
  const eda_element *from;
  uint32_t drain, gate, source, bulk;
  double length, width; /* nm */
  uint32_t fingers;     /* 0: the netlist does not say */
} eda_transistor;

typedef struct eda_flat_netlist {
  eda_pool *pool; /* the caller's, which all arrays are of */
  size_t devices, room_devices;
  eda_transistor *device;
  size_t nets, room_nets;
  const char **net;
  size_t ports;
  uint32_t *port;
} eda_flat_netlist;

/* Everything below a subcircuit that is prepared. Names begin at it. Global
   nets that occur are further ports. */
OPC_EXPORT int eda_netlist_flatten(eda_netlist *n, const eda_scope *top,
                                   eda_flat_netlist *out);

/* ---- with printed sizes (thesis 3.3.3) --------------------------------- */

/* A .model card, to be written again with another DLC. Text belongs to the pool
   that it was read with. */
typedef struct eda_card {
  const char *name, *kind; /* "nmos", "pmos" */
  size_t count;
  const char **key, **value; /* all parameters but dlc */
  double dlc;                /* nm: the card's, or else its lint */
} eda_card;

/* Read the model of that name, EDA_NMOS or EDA_PMOS, from a file and those that
   it includes, which must lie in its folder. */
OPC_EXPORT int eda_card_read(eda_pool *pool, const char *path, const char *name,
                             int type, eda_card *out, opc_error *error);

/* Write it as a .model card of that name, with another DLC (nm). [any] */
OPC_EXPORT void eda_card_write(FILE *out, const eda_card *card,
                               const char *name, double dlc);

/* Which sizes: as drawn, as printed before and after the correction. */
enum { EDA_DRAWN = 0, EDA_BEFORE = 1, EDA_AFTER = 2, EDA_STATES = 3 };

typedef struct eda_annotation {
  const eda_circuit *circuit;
  const eda_mask *mask; /* may be NULL for EDA_DRAWN */
  int state;
  const char *model[2]; /* names: [EDA_NMOS], [EDA_PMOS]; NULL: the netlist's of
                           each device, if it has no card */
  const eda_card *card[2]; /* for DLC; NULL: no correction of it */
  /* As a kit has it: X, not M, where its models are subcircuits; and how many
     nm the number 1 means as a size, "l=0.15"; 0: "l=150e-9". */
  int subcircuits;
  double unit;
} eda_annotation;

/* How many of the transistors were written, and what changed. */
typedef struct eda_annotated {
  size_t transistors; /* lines: one for each finger */
  size_t models;      /* cards with a DLC of their own */
} eda_annotated;

/* One .subckt with the circuit's name and ports; before it a .model card for
   each DLC that differs from that of the card. Nets and devices have their
   names with '.' for '/'; fingers after the first end in _f2, _f3 ... The
   text is freed with free(). NULL and *error (OPC_FAILED) where a gate has no
   size. `counts` may be NULL. [any] */
OPC_EXPORT char *eda_annotate(const eda_annotation *a, eda_annotated *counts,
                              opc_error *error);

#ifdef __cplusplus
}
#endif
#endif
