/* SPDX-License-Identifier: BSD-3-Clause */
/* Axes whose points are layers of changes to a flow (opcflow/inner.h): expands
   the value of a parameter with OPC_INNER_AXIS (variants, maps with lists,
   patterns and files; docs/reference/flow.md) into a list of layers. */
#pragma once

#include "core/binding/flow.h"

/* Add the axis `name` with the layers described by `node` to `sweep`. List
   files are added to the sources of `recipe`, which outlives the sweep. */
void opc_expand(opc_sweep *sweep, const char *name, const opc_node *node,
                opc_recipe *recipe, const opc_choice *choice,
                opc_registry *registry, opc_problems *problems);
