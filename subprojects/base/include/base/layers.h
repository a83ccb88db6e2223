/* SPDX-License-Identifier: BSD-3-Clause */
/* Layers: one tree laid over another. What extends a flow, a variant, --set, a
   point of a sweep and what is given of a slot's default plugin all are. */
#pragma once

#include <base/node.h>

/* Lay a map over the map `under`. Maps merge key by key; a map that names
   another plugin with `use`, a list or a text takes the place of what is there;
   `~` removes it. What is taken over is copied; its source outlives `under`. */
void opc_lay(opc_node *under, const opc_node *over, opc_problems *problems);

/* The same for maps of steps, where one that is not there needs `use`. */
void opc_lay_steps(opc_node *steps, const opc_node *over,
                   opc_problems *problems);

/* The same for one value, at `path`: "step", "step.parameter" or deeper. `key`
   is where the path was written. */
void opc_lay_at(opc_node *steps, const char *path, const opc_place *key,
                const opc_node *value, opc_problems *problems);

/* The same for what is required, "require" or "require.step.metric", in the map
   whose key "require" has it all, without dots. */
void opc_lay_demands(opc_node *demands, const char *path, const opc_place *key,
                     const opc_node *value, opc_problems *problems);

/* A copy of a map in which keys with dots are maps in maps, `deep`: also in the
   maps in it. What is given in both forms is a problem. */
opc_node *opc_undot(const opc_node *map, gboolean deep, opc_problems *problems);

/* "path=value" of a command line: its value, which belongs to the new
 *source, and its path (g_free). NULL and a problem if it is not sound;
 *source, which is named "OPTION PATH", is there all the same. */
opc_node *opc_argument_parse(const char *option, const char *text, char **path,
                             opc_source **source, opc_problems *problems);
