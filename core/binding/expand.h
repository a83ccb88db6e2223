/* SPDX-License-Identifier: BSD-3-Clause */
/* An axis of layers: from what a step says of its inner flow (variants, maps
   with lists, patterns and files; docs/reference/flow.md) to one layer after
   another. */
#pragma once

#include "core/binding/flow.h"

/* Add to the sweep of `choice` an axis called `name` of what `node` says.
   Files that it takes lists from are added to the sources of `recipe`, which
   outlives the sweep. */
void opc_expand(opc_sweep *sweep, const char *name, const opc_node *node,
                opc_recipe *recipe, const opc_choice *choice,
                opc_registry *registry, opc_problems *problems);
