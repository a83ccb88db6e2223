/* SPDX-License-Identifier: BSD-3-Clause */
/* What the steps of a flow need of each other. */
#pragma once

#include "core/binding/flow.h"

/* Find out what the steps of `flow` need of each other, and the order in which
   they run. */
void opc_flow_connect(opc_flow *flow, opc_problems *problems);

/* Of each step: whether it is wanted, or one that is wanted needs it, and it is
   not given (g_free); all by their numbers. */
gboolean *opc_flow_needed(const opc_flow *flow, const gboolean *wanted,
                          const gboolean *given);
