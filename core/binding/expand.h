/* SPDX-License-Identifier: BSD-3-Clause */
/* Axes of layers: expansion of a step's description of its inner flow's cases
   (variants, maps with lists, patterns and files; docs/reference/flow.md) into
   a list of layers. */
#pragma once

#include "core/binding/flow.h"

/* Add to the sweep of `choice` an axis called `name` with the layers that
   `node` describes. List files that are read are added to the sources of
   `recipe`, which outlives the sweep. */
void opc_expand(opc_sweep *sweep, const char *name, const opc_node *node,
                opc_recipe *recipe, const opc_choice *choice,
                opc_registry *registry, opc_problems *problems);
