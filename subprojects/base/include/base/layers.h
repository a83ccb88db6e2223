/* SPDX-License-Identifier: BSD-3-Clause */
/* Layers: one tree applied over another. A flow that extends another, a
   variant, --set, a point of a sweep, and the parameters of the default plugin
   of a slot are all layers. */
#pragma once

#include <base/node.h>

/* Apply a map over the map `under`. Maps merge key by key. A map that names
   another plugin with `use`, a list or a text replaces the existing value; `~`
   removes it. Nodes are copied; their source must outlive `under`. */
void opc_lay(opc_node *under, const opc_node *over, opc_problems *problems);

/* Apply a map of steps; a new step needs `use`. */
void opc_lay_steps(opc_node *steps, const opc_node *over,
                   opc_problems *problems);

/* Apply one value at `path`: "step", "step.parameter" or deeper. `key` is the
   place of the path in its source. */
void opc_lay_at(opc_node *steps, const char *path, const opc_place *key,
                const opc_node *value, opc_problems *problems);

/* Apply a requirement, "require" or "require.step.metric", to the map that
   holds all of them under "require", without dots. */
void opc_lay_demands(opc_node *demands, const char *path, const opc_place *key,
                     const opc_node *value, opc_problems *problems);

/* Return a copy of a map in which keys with dots are nested maps; `deep`: also
   in nested maps. A value given in both forms is a problem. */
opc_node *opc_undot(const opc_node *map, gboolean deep, opc_problems *problems);

/* Return the value of "path=value" on a command line, owned by the new *source,
   and its path (g_free). NULL and a problem if the text is invalid; *source,
   named "OPTION PATH", is set in any case. */
opc_node *opc_argument_parse(const char *option, const char *text, char **path,
                             opc_source **source, opc_problems *problems);
