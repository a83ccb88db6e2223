/* SPDX-License-Identifier: BSD-3-Clause */
/* Required ranges of the metrics of a flow. */
#pragma once

#include "core/binding/flow.h"

/* Read the requirements of a flow whose steps are valid. */
void opc_flow_require(opc_flow *flow, opc_problems *problems);
