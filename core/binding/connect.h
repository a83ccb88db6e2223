/* SPDX-License-Identifier: BSD-3-Clause */
/* Dependencies between the steps of a flow. */
#pragma once

#include "core/binding/flow.h"

/* Resolve the references between the steps of `flow` and determine the order of
   execution. */
void opc_flow_connect(opc_flow *flow, opc_problems *problems);

/* Return, by step number, whether a step must run (g_free). A step must run if
   the step is not `given`, and the step or a dependent step is `wanted`. */
gboolean *opc_flow_needed(const opc_flow *flow, const gboolean *wanted,
                          const gboolean *given);
