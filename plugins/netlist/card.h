/* SPDX-License-Identifier: BSD-3-Clause */
/* Transistor models of SPICE files, to be written again with another DLC. What
   writes netlists compiles it, with lines.c, value.c and pool.c. */
#ifndef OPCFLOW_NETLIST_CARD_H
#define OPCFLOW_NETLIST_CARD_H

#include <opcflow/opcflow.h>

#include "pool.h"

/* A .model card. Text belongs to the pool that it was read with. */
typedef struct netlist_model {
  const char *name, *kind; /* "nmos", "pmos" */
  size_t count;
  const char **key, **value; /* all parameters but dlc */
  double dlc;                /* nm: the card's, or else its lint */
} netlist_model;

/* Read the model of that name, OPC_NMOS or OPC_PMOS, from a file and those that
   it includes. Errors carry file:line:column. */
int netlist_model_read(const opc_host *host, pool *p, const char *path,
                       const char *name, int type, netlist_model *out,
                       opc_error *error);

#endif
