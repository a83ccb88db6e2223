/* SPDX-License-Identifier: BSD-3-Clause */
/* Files that the steps of a flow and the run itself write. */
#pragma once

#include "core/binding/flow.h"

/* The files that parameters name: name -> path of the instance that writes it
   (freed with the table). With `problems`, add those that two write, that lie
   in another, or that the run itself writes. */
GHashTable *opc_flow_outputs(const opc_flow *flow, opc_problems *problems);

/* The files that a run itself writes. */
enum { OPC_RESERVED = 4 };
extern const char *const opc_reserved[OPC_RESERVED];
