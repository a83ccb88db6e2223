/* SPDX-License-Identifier: BSD-3-Clause */
/* A circuit as a SPICE netlist with the sizes that its transistors print with
   (thesis 3.3.3). For netlist.annotate and what simulates circuits; compile
   annotate_text.c, card.c, lines.c, value.c and pool.c. */
#ifndef OPCFLOW_ANNOTATE_TEXT_H
#define OPCFLOW_ANNOTATE_TEXT_H

#include <opcflow/circuit.h>

#include "card.h"

enum { NETLIST_DRAWN = 0, NETLIST_BEFORE = 1, NETLIST_AFTER = 2 };

typedef struct netlist_annotation {
  const opc_circuit *circuit;
  const opc_mask *mask; /* may be NULL for NETLIST_DRAWN */
  int state;
  const char *model[2];         /* names: [OPC_NMOS], [OPC_PMOS] */
  const netlist_model *card[2]; /* for DLC; NULL: no correction of it */
} netlist_annotation;

/* How many of the transistors were written, and what changed. */
typedef struct netlist_counts {
  size_t transistors; /* lines: one for each finger */
  size_t models;      /* cards with a DLC of their own */
} netlist_counts;

/* One .subckt with the circuit's name and ports; before it a .model card for
   each DLC that differs from that of the card. Nets and devices have their
   names with '.' for '/'; fingers after the first end in _f2, _f3 ... The
   text is freed with host->free. NULL and *error on failure. [any] */
char *netlist_annotate(const opc_host *host, const netlist_annotation *a,
                       netlist_counts *counts, opc_error *error);

#endif
