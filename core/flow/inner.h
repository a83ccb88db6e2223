/* SPDX-License-Identifier: BSD-3-Clause */
/* The flow that a step runs inside of it (opcflow/inner.h): read and checked
   with the flow that the step stands in. */
#ifndef OPCFLOW_CORE_INNER_H
#define OPCFLOW_CORE_INNER_H

#include "core/flow/flow.h"

/* Make the binding's inner flow if its plugin declares one, and check it at
   each value that is swept. File names that the binding gives become absolute,
   so that its resolved flow may lie anywhere. `flags` are those of the
   binding. */
void opc_inner_open(opc_binding *binding, opc_registry *registry,
                    unsigned flags, opc_problems *problems);
void opc_inner_free(opc_inner *inner);

/* What only its instances refuse. NULL has none. */
int opc_inner_check(const opc_inner *inner, opc_error *error);

/* At the first point of its sweep. */
const opc_flow *opc_inner_flow(const opc_inner *inner);

/* Call `visit` with it there and at each value of each axis. */
void opc_inner_visit(const opc_inner *inner,
                     void (*visit)(void *data, const opc_flow *flow),
                     void *data);

/* For the host of an instance with an inner flow; its `data` is the binding. */
extern const opc_inner_service opc_inner_functions;

#endif
