/* SPDX-License-Identifier: BSD-3-Clause */
/* Dependencies between the steps of a flow. */
#pragma once

#include "core/binding/flow.h"

/* Resolve the references between the steps of `flow` and determine the order of
   execution. */
void opc_flow_connect(opc_flow *flow, opc_problems *problems);

/* Return, by step number, whether each step must run (g_free). A `wanted` step
   must run, and so must every step that provides an input of a step that must
   run. The outputs of `given` steps exist already, so these steps do not run.
 */
gboolean *opc_flow_needed(const opc_flow *flow, const gboolean *wanted,
                          const gboolean *given);
