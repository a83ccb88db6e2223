/* SPDX-License-Identifier: BSD-3-Clause */
/* Writes a flow with all its parameters. */
#pragma once

#include "core/binding/flow.h"

/* Return a flow file (g_free) with every parameter of every step and the origin
   of each value. File names are absolute, so that the file can be moved. The
   axes of `sweep`, unless NULL, are appended; `flow` is the flow at the first
   point. */
char *opc_flow_resolved(const opc_flow *flow, const opc_sweep *sweep);
