/* SPDX-License-Identifier: BSD-3-Clause */
/* A flow that a step runs inside of it, at points of a sweep: read and checked
   with the flow that the step stands in. */
#ifndef OPCFLOW_CORE_INNER_H
#define OPCFLOW_CORE_INNER_H

#include "core/flow/flow.h"

/* get_extension(OPC_INNER_FLOW) of such a step gives an opc_inner_step; only
   the core's own are asked. */
#define OPC_INNER_FLOW "opcflow.inner-flow/1"

/* Numbers of its parameters. */
typedef struct opc_inner_step {
  size_t flow;    /* OPC_FILE */
  size_t variant; /* OPC_TEXT: one of the flow; absent: none */
  size_t set;     /* OPC_MAP of paths and values, laid over everything */
  size_t sweep;   /* OPC_MAP of paths and values, over the flow's own sweep */
  /* What else to check, with the inner flow there. */
  void (*check)(const opc_binding *binding, opc_problems *problems);
} opc_inner_step;

struct opc_inner {
  opc_recipe *recipe;
  opc_sweep *sweep;
  opc_choice choice; /* of the first point */
  opc_flow *flow;    /* there */
  opc_registry *registry;
};

/* Make the binding's inner flow if its plugin has one, and check it at each
   value that is swept. File names that the binding gives become absolute, so
   that its resolved flow may lie anywhere. `flags` are those of the binding;
   a step in an inner flow has none itself. */
void opc_inner_open(opc_binding *binding, opc_registry *registry,
                    unsigned flags, opc_problems *problems);
void opc_inner_free(opc_inner *inner);

#endif
