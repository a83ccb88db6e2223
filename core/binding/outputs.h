/* SPDX-License-Identifier: BSD-3-Clause */
/* Files written by the steps of a flow and by the run itself. */
#pragma once

#include "core/binding/flow.h"

/* Return the output files named by parameters: name -> path of the instance
   that writes the file (freed with the table). Unless `problems` is NULL, adds
   a problem for each file that two instances write or that is reserved for the
   run. A file inside a folder with the name of another output file also is a
   problem (a/b and a/b/c). */
GHashTable *opc_flow_outputs(const opc_flow *flow, opc_problems *problems);

/* Number of files that a run itself writes. */
enum { OPC_RESERVED = 4 };
extern const char *const opc_reserved[OPC_RESERVED];
