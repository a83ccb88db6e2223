/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the flow of a step at points of its axes. */
#pragma once

#include <opcflow/inner.h>

/* Functions for hosts of instances with an inner flow in a run; the host's
   `data` is the binding. */
extern const opc_inner_service opc_inner_functions;
