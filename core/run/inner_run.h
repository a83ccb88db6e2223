/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the flow of a step at points of its axes. */
#pragma once

#include <opcflow/inner.h>

/* For the host of an instance with an inner flow in a run; its `data` is the
   binding. */
extern const opc_inner_service opc_inner_functions;
