/* SPDX-License-Identifier: BSD-3-Clause */
/* SPICE and CDL netlists: reading, flattening, and writing a netlist with the
   printed sizes of its transistors. Faults of a file are OPC_INVALID and carry
   file:line:column. */
#pragma once

#include <eda/circuit.h>
#include <eda/pool.h>

OPC_C_BEGIN

/* ---- as it is written: subcircuits of elements ------------------------- */

/* A position in a file. */
typedef struct eda_place {
  uint32_t file, line, column;
} eda_place;

/* NAME=VALUE; the value is a number or an expression, not yet evaluated. */
typedef struct eda_assignment {
  const char *name, *value;
  eda_place at;
} eda_assignment;

typedef struct eda_element {
  int is_transistor; /* 0: instance of a subcircuit */
  const char *name;  /* as written, with its letter */
  eda_place at;
  size_t nodes;
  const char **node;
  uint32_t *local;   /* number of each node in the subcircuit */
  const char *model; /* model, or name of the subcircuit */
  eda_place model_at;
  uint32_t child; /* number of the subcircuit */
  uint8_t type;   /* EDA_NMOS, EDA_PMOS */
  size_t settings;
  eda_assignment *setting;
  double x, y; /* centre of its gate, nm, if a comment has it; otherwise NAN */
} eda_element;

typedef struct eda_subcircuit {
  const char *name;
  eda_place at;
  size_t ports;
  const char **port;
  size_t settings; /* defaults of its parameters */
  eda_assignment *setting;
  size_t elements, room;
  eda_element *element;

  /* Set by eda_netlist_prepare. Ports are the first nodes. */
  int state; /* 0 not prepared, 1 in progress, 2 prepared */
  size_t nodes, room_nodes;
  const char **node;
  uint64_t devices; /* devices, including those of subcircuits */
} eda_subcircuit;

typedef struct eda_netlist {
  /* Set by the caller, the rest zero. *error receives all faults. */
  opc_error *error;
  double scale;                    /* factor on sizes */
  const char *n_models, *p_models; /* names separated by blanks, or NULL */

  eda_pool pool;
  struct eda_lines *lines; /* the reader, which knows positions */
  uint32_t current;        /* while reading: the current subcircuit, UINT32_MAX
                              outside */
  int control;             /* between .control and .endc */
  size_t subcircuits, room_subcircuits;
  eda_subcircuit *subcircuit;
  eda_names subcircuit_of;
  eda_names type_of;   /* models named by .model cards */
  eda_names global_of; /* .global nets */
  size_t globals, room_globals;
  const char **global;
  size_t settings, room_settings; /* .param */
  eda_assignment *setting;
  eda_names setting_of;
  double unit;     /* .option scale */
  size_t left_out; /* omitted capacitors and diodes of subcircuits */
} eda_netlist;

/* Scope of an expression: its subcircuit and the caller. */
typedef struct eda_scope {
  const struct eda_scope *caller; /* NULL: the top */
  const eda_subcircuit *of;
  const eda_element *call;
} eda_scope;

/* Read a file and its includes. The netlist must not move in memory and is
   cleared by the caller, also after a failure. [main] */
OPC_EXPORT int eda_netlist_read(eda_netlist *n, const char *path);
OPC_EXPORT void eda_netlist_clear(eda_netlist *n);

/* Return the number of a subcircuit; -1 and an error of the parameter "top"
   that lists the existing ones. */
OPC_EXPORT int64_t eda_netlist_find(eda_netlist *n, const char *name);

/* Number the nodes of a subcircuit and of all below, resolve calls, and count
   devices. Call before flattening. */
OPC_EXPORT int eda_netlist_prepare(eda_netlist *n, uint32_t top);

/* Write "FILE:LINE" of an element to the buffer and return the buffer. */
OPC_EXPORT const char *eda_netlist_where(const eda_netlist *n,
                                         const eda_element *e, char *buffer,
                                         size_t room);

/* ---- flat -------------------------------------------------------------- */

typedef struct eda_transistor {
  const char *name; /* full path */
  const eda_element *from;
  uint32_t drain, gate, source, bulk;
  double length, width; /* nm */
  uint32_t fingers;     /* 0: not given by the netlist */
} eda_transistor;

typedef struct eda_flat_netlist {
  eda_pool *pool; /* the caller's; owns all arrays */
  size_t devices, room_devices;
  eda_transistor *device;
  size_t nets, room_nets;
  const char **net;
  size_t ports;
  uint32_t *port;
} eda_flat_netlist;

/* Flatten a prepared subcircuit. Names are relative to the subcircuit. Global
   nets in use become further ports. */
OPC_EXPORT int eda_netlist_flatten(eda_netlist *n, const eda_scope *top,
                                   eda_flat_netlist *out);

/* ---- with printed sizes (thesis 3.3.3) --------------------------------- */

/* A .model card, to be written again with another DLC. Text belongs to the pool
   it was read with. */
typedef struct eda_card {
  const char *name, *kind; /* "nmos", "pmos" */
  size_t count;
  const char **key, **value; /* all parameters except dlc */
  double dlc;                /* nm: the card's dlc, or else its lint */
} eda_card;

/* Read the model of this name, EDA_NMOS or EDA_PMOS, from a file and its
   includes, which must be in its folder. */
OPC_EXPORT int eda_card_read(eda_pool *pool, const char *path, const char *name,
                             int type, eda_card *out, opc_error *error);

/* Set paths[2] to the whole paths of `files` and, if `read`, *card to the
   models `names` in them. [EDA_PMOS] of `files` may be NULL: both models are in
   the first file, and paths[EDA_PMOS] is NULL. Errors name the parameters
   "models" and "pmos_models". */
OPC_EXPORT int eda_cards_read(eda_pool *pool, const char *const files[2],
                              const char *const names[2], int read,
                              const char *paths[2], eda_card card[2],
                              opc_error *error);

/* Write a .model card of this name, with another DLC (nm). [any] */
OPC_EXPORT void eda_card_write(FILE *out, const eda_card *card,
                               const char *name, double dlc);

/* Sizes of transistors: as drawn, as printed before and after correction. */
enum { EDA_DRAWN = 0, EDA_BEFORE = 1, EDA_AFTER = 2, EDA_STATES = 3 };

typedef struct eda_annotation {
  const eda_circuit *circuit;
  const eda_mask *mask; /* may be NULL for EDA_DRAWN */
  int state;
  const char *model[2];    /* names: [EDA_NMOS], [EDA_PMOS]; NULL: the model of
                              each device in the netlist, if it has no card */
  const eda_card *card[2]; /* for DLC; NULL: DLC is not corrected */
  /* Style of a kit whose models are subcircuits: instances X, not M; and the
     size in nm of the number 1, "l=0.15"; 0: "l=150e-9". */
  int subcircuits;
  double unit;
} eda_annotation;

/* Number of transistors written, and of changes. */
typedef struct eda_annotated {
  size_t transistors; /* lines: one for each finger */
  size_t models;      /* cards with their own DLC */
} eda_annotated;

/* Return the text of one .subckt with the circuit's name and ports, after a
   .model card for each DLC that differs from that of the card. Names of nets
   and devices have '.' for '/'; fingers after the first end in _f2, _f3 ...
   Free the text with free(). Return NULL and *error (OPC_FAILED) if a gate has
   no size. `counts` may be NULL. [any] */
OPC_EXPORT char *eda_annotate(const eda_annotation *a, eda_annotated *counts,
                              opc_error *error);

OPC_C_END
