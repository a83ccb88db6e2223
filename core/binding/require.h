/* SPDX-License-Identifier: BSD-3-Clause */
/* What a flow requires of its metrics. */
#ifndef OPCFLOW_CORE_REQUIRE_H
#define OPCFLOW_CORE_REQUIRE_H

#include "core/binding/flow.h"

/* Read what a flow with sound steps requires. */
void opc_flow_require(opc_flow *flow, opc_problems *problems);

#endif
