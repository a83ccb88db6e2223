/* SPDX-License-Identifier: BSD-3-Clause */
/* The circuit that netlist.match hands on. */
#ifndef OPCFLOW_NETLIST_OUTPUT_H
#define OPCFLOW_NETLIST_OUTPUT_H

#include "match.h"

/* From the flat netlist and the owners of the gates; names of supply and ground
   nets are lists with blanks between. NULL and an error on failure. */
opc_circuit *output_circuit(const job *j, const char *name, const char *supply,
                            const char *ground);
void output_release(void *object);

/* The table of devices, and the metrics. */
int output_publish(job *j, const opc_circuit *circuit);

#endif
