/* SPDX-License-Identifier: BSD-3-Clause */
/* A SPICE netlist: its lines, as it is written (subcircuits of elements), and
   flat. Lines and values are read here, for all of the family; the rest is that
   of netlist.match. */
#ifndef OPCFLOW_NETLIST_H
#define OPCFLOW_NETLIST_H

#include <opcflow/opcflow.h>

#include "pool.h"

/* Where something is written. */
typedef struct place {
  uint32_t file, line, column;
} place;

/* NAME=VALUE; the value is a number or an expression, not yet looked at. */
typedef struct setting {
  const char *name, *value;
  place at;
} setting;

typedef struct element {
  int is_transistor; /* else a subcircuit's instance */
  const char *name;  /* as written, with its letter */
  place at;
  size_t nodes;
  const char **node;
  uint32_t *local;   /* of each node: its number in the subcircuit */
  const char *model; /* or the subcircuit's name */
  place model_at;
  uint32_t child; /* the subcircuit's number */
  uint8_t type;   /* OPC_NMOS, OPC_PMOS */
  size_t settings;
  setting *setting;
  double x, y; /* the centre of its gate, nm, if the comment says so; or NAN */
} element;

typedef struct subcircuit {
  const char *name;
  place at;
  size_t ports;
  const char **port;
  size_t settings; /* what its parameters are by default */
  setting *setting;
  size_t elements, room;
  element *element;

  /* After netlist_prepare. Ports are its first nodes. */
  int state; /* 0 not yet, 1 on the way, 2 done */
  size_t nodes, room_nodes;
  const char **node;
  uint64_t devices; /* with those below */
} subcircuit;

typedef struct netlist {
  const opc_host *host;
  opc_error *error;
  pool pool;
  double scale; /* a factor on sizes, that of the flow */
  const char *n_models, *p_models;

  size_t files, room_files;
  const char **file;
  size_t subcircuits, room_subcircuits;
  subcircuit *subcircuit;
  name_map subcircuit_of;
  name_map type_of;   /* models that a .model card names */
  name_map global_of; /* .global nets */
  size_t globals, room_globals;
  const char **global;
  size_t settings, room_settings; /* .param */
  setting *setting;
  name_map setting_of;
  double unit;     /* .option scale */
  size_t outside;  /* elements outside of subcircuits */
  size_t left_out; /* capacitors and diodes in them */
} netlist;

/* In which subcircuit an expression is meant, and who called it. */
typedef struct scope {
  const struct scope *caller; /* NULL: the top */
  const subcircuit *of;
  const element *call;
} scope;

/* Refuse what stands at a place: OPC_INVALID, "FILE:LINE:COLUMN: WHAT". */
int netlist_refuse(netlist *n, place at, const char *format, ...)
    OPC_PRINTF(3, 4);
int netlist_no_memory(netlist *n);

/* ---- lines.c: files to lines of words ---- */

typedef struct word {
  const char *text;
  place at;
  int quoted; /* an expression */
} word;

typedef struct line {
  size_t words, room;
  word *word;
  double x, y; /* of a comment, nm; or NAN */
} line;

/* What is known from line to line. */
typedef struct parser {
  uint32_t current; /* subcircuit, UINT32_MAX outside */
  int control;      /* between .control and .endc */
  int ended;        /* after .end */
  int depth;        /* of .include */
} parser;

/* Read a file, and call netlist_line with each line that is not empty. */
int netlist_read(netlist *n, const char *path);
/* .include: read another file, beside the one that the line stands in. */
int netlist_include(netlist *n, parser *p, const line *l);

/* What to do with a line: parse.c of netlist.match, card.c for models. */
int netlist_line(netlist *n, parser *p, line *l);

/* ---- parse.c ---- */

/* OPC_NMOS or OPC_PMOS, -1 if nothing tells. */
int netlist_type(const netlist *n, const char *model);

/* ---- value.c ---- */

int netlist_value(netlist *n, const scope *in, const setting *s, double *out);
/* A plain SPICE number ("0.21u", "1meg"); the place behind it, NULL if there is
   none. */
const char *netlist_number(const char *text, double *out);

/* ---- flatten.c ---- */

typedef struct transistor {
  const char *name; /* with its path */
  const element *from;
  uint32_t drain, gate, source, bulk;
  double length, width; /* nm */
  uint32_t fingers;     /* 0: the netlist does not say */
} transistor;

typedef struct flat_netlist {
  pool *pool;
  size_t devices, room_devices;
  transistor *device;
  size_t nets, room_nets;
  const char **net;
  size_t ports;
  uint32_t *port;
} flat_netlist;

/* Number of a subcircuit, -1 and an error with those that are there. */
int64_t netlist_find(netlist *n, const char *name);
/* Number the nodes of a subcircuit and of all below it, find what they call,
   count. */
int netlist_prepare(netlist *n, uint32_t top);
/* Everything below a subcircuit. Names begin at it. Global nets that occur are
   further ports. */
int netlist_flatten(netlist *n, const scope *top, flat_netlist *out);

/* "FILE:LINE" of an element, in a buffer that is valid until the next call. */
const char *netlist_where(const netlist *n, const element *e, char *buffer,
                          size_t room);

#endif
