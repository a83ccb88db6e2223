/* SPDX-License-Identifier: BSD-3-Clause */
/* Dependencies between the steps of a flow. */
#pragma once

#include "core/binding/flow.h"

/* Resolve the references between the steps of `flow` and determine the order of
   execution. */
void opc_flow_connect(opc_flow *flow, opc_problems *problems);

/* Return, by step number, whether a step must run (g_free): the step, or a step
   that depends on it, is wanted, and the step is not given. */
gboolean *opc_flow_needed(const opc_flow *flow, const gboolean *wanted,
                          const gboolean *given);
