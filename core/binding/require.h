/* SPDX-License-Identifier: BSD-3-Clause */
/* What a flow requires of its metrics. */
#pragma once

#include "core/binding/flow.h"

/* Read what a flow with sound steps requires. */
void opc_flow_require(opc_flow *flow, opc_problems *problems);
