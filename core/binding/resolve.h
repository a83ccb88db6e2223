/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow as a file, with all its parameters. */
#pragma once

#include "core/binding/flow.h"

/* The flow with every parameter of every step and where its value came from,
   as a flow file that may lie in any folder; behind it the sweep (NULL: none)
   whose first point it is. */
char *opc_flow_resolved(const opc_flow *flow, const opc_sweep *sweep);
