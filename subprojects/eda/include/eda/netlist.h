/* SPDX-License-Identifier: BSD-3-Clause */
/* SPICE and CDL netlists: readers, flattening, and a writer of netlists with
   the printed sizes of transistors. Errors in a file have the code OPC_INVALID
   and name file:line:column. A file that cannot be read has the code OPC_IO; if
   another file includes it, the code is OPC_INVALID and the place is that of
   .include. Thesis: see docs/background/physics.md. [any], [main]: see
   opcflow/plugin.h. */
#pragma once

#include <eda/circuit.h>
#include <eda/pool.h>

OPC_C_BEGIN

/* ---- hierarchical netlist: subcircuits of elements --------------------- */

/* A position in a file. */
typedef struct eda_place {
  uint32_t file, line, column;
} eda_place;

/* NAME=VALUE; the value is the text of a number or of an expression. */
typedef struct eda_assignment {
  const char *name, *value;
  eda_place at;
} eda_assignment;

/* An element of a subcircuit: a transistor, or an instance of another
   subcircuit. */
typedef struct eda_element {
  int is_transistor; /* 0: instance of a subcircuit; 1: MOS transistor.
                        eda_netlist_prepare changes 0 to 1 for an X element that
                        is a transistor of a process design kit. */
  const char *name;  /* as in the file, with the letter of the element */
  eda_place at;
  size_t nodes;
  const char **node;
  uint32_t *local;   /* index of each node in eda_subcircuit.node; set, like
                        `child`, by eda_netlist_prepare */
  const char *model; /* name of the model or of the subcircuit */
  eda_place model_at;
  uint32_t child; /* number of the instantiated subcircuit */
  uint8_t type;   /* EDA_NMOS, EDA_PMOS */
  size_t settings;
  eda_assignment *setting;
  double x, y; /* centre of the gate, nm, from a comment; NAN: unknown */
} eda_element;

/* A subcircuit. */
typedef struct eda_subcircuit {
  const char *name;
  eda_place at;
  size_t ports;
  const char **port;
  size_t settings; /* number of parameters with default values */
  eda_assignment *setting;
  size_t elements, capacity;
  eda_element *element;

  /* Set by eda_netlist_prepare. The first nodes are the ports. */
  int state; /* 0 not prepared, 1 in progress, 2 prepared */
  size_t nodes, capacity_nodes;
  const char **node;
  uint64_t devices; /* number of transistors, with those of all subcircuits
                       below */
} eda_subcircuit;

/* A netlist, and the state of its reader. */
typedef struct eda_netlist {
  /* Set by the caller, who sets all other fields to zero. *error receives the
     errors of all functions. */
  opc_error *error;
  double scale;                    /* factor that multiplies all sizes */
  const char *n_models, *p_models; /* model names with blanks between, or
                                      NULL */

  eda_pool pool;
  struct eda_lines *lines; /* state of the reader */
  uint32_t current;        /* reader: number of the current subcircuit,
                              UINT32_MAX outside of subcircuits */
  int control;             /* reader: 1 between .control and .endc */
  size_t subcircuits, capacity_subcircuits;
  eda_subcircuit *subcircuit;
  eda_names subcircuit_of;
  eda_names type_of;   /* models named by .model cards */
  eda_names global_of; /* .global nets */
  size_t globals, capacity_globals;
  const char **global;
  size_t settings, capacity_settings; /* number of parameters set by .param */
  eda_assignment *setting;
  eda_names setting_of;
  double unit;     /* value of .option scale, m */
  size_t left_out; /* number of omitted capacitors and diodes of subcircuits */
} eda_netlist;

/* Scope in which an expression is evaluated: an instance of a subcircuit. */
typedef struct eda_scope {
  const struct eda_scope *caller; /* scope that contains the instance; NULL for
                                     the top subcircuit */
  const eda_subcircuit *of;       /* the subcircuit */
  const eda_element *call;        /* the instance; NULL for the top */
} eda_scope;

/* Read the subcircuits and parameters of a file and its included files.
   Elements outside of subcircuits are ignored. The netlist must not move in
   memory. The caller clears the netlist, also after a failure. [main] */
OPC_EXPORT int eda_netlist_read(eda_netlist *n, const char *path);
/* Free the memory of a netlist. */
OPC_EXPORT void eda_netlist_clear(eda_netlist *n);

/* Return the number of a subcircuit; -1 and an error of the parameter "top"
   that lists the existing subcircuits. */
OPC_EXPORT int64_t eda_netlist_find(eda_netlist *n, const char *name);

/* Number the nodes, find the subcircuits of instances and count the transistors
   of subcircuit `top` and all below. An X element with four nodes, W and L
   becomes a transistor if no subcircuit has the name of its model. More than
   2^24 transistors are an error. Call this before eda_netlist_flatten. */
OPC_EXPORT int eda_netlist_prepare(eda_netlist *n, uint32_t top);

/* Write "FILE:LINE" of an element to the buffer and return the buffer. */
OPC_EXPORT const char *eda_netlist_where(const eda_netlist *n,
                                         const eda_element *e, char *buffer,
                                         size_t capacity);

/* ---- flat netlist ------------------------------------------------------ */

/* A transistor of a flat netlist; its nets are indices in eda_flat_netlist.net.
 */
typedef struct eda_transistor {
  const char *name; /* full path */
  const eda_element *from;
  uint32_t drain, gate, source, bulk;
  double length, width; /* size, nm */
  uint32_t fingers; /* product of nf and all m, at most 10^6; 0: not given by
                       the netlist */
} eda_transistor;

/* All transistors of a subcircuit and of the subcircuits below. */
typedef struct eda_flat_netlist {
  eda_pool *pool; /* from the caller; owns all arrays */
  size_t devices, capacity_devices;
  eda_transistor *device;
  size_t nets, capacity_nets;
  const char **net;
  size_t ports;
  uint32_t *port; /* net of each port */
} eda_flat_netlist;

/* Flatten a prepared subcircuit. Names are paths below the subcircuit. Global
   nets that are used become further ports. Subcircuits without transistors are
   left out. Two nets of the same name are an error. */
OPC_EXPORT int eda_netlist_flatten(eda_netlist *n, const eda_scope *top,
                                   eda_flat_netlist *out);

/* ---- netlist with printed sizes (thesis 3.3.3) ------------------------- */

/* A .model card, for copies with other DLC (BSIM channel length offset of
   capacitances). The pool passed to eda_card_read owns the texts. */
typedef struct eda_card {
  const char *name, *kind; /* "nmos", "pmos" */
  size_t count;
  const char **key, **value; /* all parameters except DLC, with CGSO and CGDO
                                added if the card lacks them */
  double dlc; /* dlc of the card, or else its lint, or else 0; nm */
} eda_card;

/* Read the model `name` of type EDA_NMOS or EDA_PMOS from a file and its
   included files, which must be in the folder of the file or below. A card
   without DLC (levels other than 8, 49, 14 and 54) is an error, and so is a
   card in which DLC would change more than the gate capacitance. */
OPC_EXPORT int eda_card_read(eda_pool *pool, const char *path, const char *name,
                             int type, eda_card *out, opc_error *error);

/* Set paths[2] to the absolute paths of files[2]; a path is NULL if the file is
   NULL. If `read` is 1,
   read the models names[2] from these files into card[2]; files[EDA_NMOS] must
   then exist. If files[EDA_PMOS] is NULL, both models are in files[EDA_NMOS].
   Errors of paths name the parameter "models" or "pmos_models"; errors in a
   file name no parameter. */
OPC_EXPORT int eda_cards_read(eda_pool *pool, const char *const files[2],
                              const char *const names[2], int read,
                              const char *paths[2], eda_card card[2],
                              opc_error *error);

/* Write a copy of a .model card with another name and DLC (nm). [any] */
OPC_EXPORT void eda_card_write(FILE *out, const eda_card *card,
                               const char *name, double dlc);

/* Sizes of transistors: drawn, printed before, printed after correction. */
enum { EDA_DRAWN = 0, EDA_BEFORE = 1, EDA_AFTER = 2, EDA_STATES = 3 };

/* Input of eda_annotate. */
typedef struct eda_annotation {
  const eda_circuit *circuit;
  const eda_mask *mask; /* may be NULL for EDA_DRAWN */
  int state;            /* EDA_DRAWN ...: sizes that are written */
  /* Names of the models, [EDA_NMOS] and [EDA_PMOS]. NULL, allowed only if
     card[] of the type is NULL: each device has its own model
     (eda_device.model). */
  const char *model[2];
  const eda_card *card[2]; /* cards that are copied with a corrected DLC; NULL:
                              DLC is not corrected */
  /* 1: models are subcircuits, so transistors are written as instances X, not
     as M. `unit`: unit of the written sizes, nm (for 1000, 150 nm is "l=0.15");
     0: sizes are written in m ("l=150e-9"). */
  int subcircuits;
  double unit;
} eda_annotation;

/* Numbers of written lines. */
typedef struct eda_annotated {
  size_t transistors; /* number of transistor lines, one for each finger */
  size_t models;      /* number of model cards with changed DLC */
} eda_annotated;

/* Return a netlist with printed sizes: a .model card for each changed DLC, and
   a .subckt with the circuit's name, ports and transistors. In names, '.'
   replaces '/'; names of fingers after the first end in _f2, _f3 ... Free the
   text with free(). Return NULL and *error (OPC_FAILED) if a gate does not
   print or has no valid size. `counts` may be NULL. [any] */
OPC_EXPORT char *eda_annotate(const eda_annotation *a, eda_annotated *counts,
                              opc_error *error);

OPC_C_END
