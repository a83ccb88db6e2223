/* SPDX-License-Identifier: BSD-3-Clause */
/* Layers of changes (not of a layout): trees that are merged over another tree.
   Examples: a flow that extends another flow, a variant, --set, a point of a
   sweep, and a map that changes the default plugin of a slot. */
#pragma once

#include <base/node.h>

/* Apply the map `over` to the map `under`. Maps merge key by key. Other values
   of `over`, and maps that select another plugin by `use`, replace the value in
   `under`; `~` removes the value. Nodes are copied; their sources must outlive
   `under`. */
void opc_lay(opc_node *under, const opc_node *over, opc_problems *problems);

/* Apply the map `over` of steps to the map `steps`. Unless `steps` is empty, a
   step that is not in `steps` needs `use`. */
void opc_lay_steps(opc_node *steps, const opc_node *over,
                   opc_problems *problems);

/* Set a copy of `value` at `path` in the map `steps`: "step", "step.parameter"
   or deeper. Problems are reported at `key`, the place of the path in the
   source. */
void opc_lay_at(opc_node *steps, const char *path, const opc_place *key,
                const opc_node *value, opc_problems *problems);

/* Set a copy of a requirement in the map `demands`, which has the form
   { require: { step: { metric: ... } } }. `path` is "require" or
   "require.step.metric"; `key` as for opc_lay_at. */
void opc_lay_demands(opc_node *demands, const char *path, const opc_place *key,
                     const opc_node *value, opc_problems *problems);

/* Return a copy of a map with nested maps in place of keys with dots; if `deep`
   is TRUE, also inside nested maps. Add a problem for a value that is set in
   both forms. The caller frees the copy with opc_node_free(). */
opc_node *opc_undot(const opc_node *map, gboolean deep, opc_problems *problems);

/* Parse "path=value" on a command line: return the value (opc_node_free), and
   the path in *path (g_free, also on failure). Return NULL and a problem if the
   text is invalid. *source receives a new source named "OPTION PATH", also on
   failure; free the source with opc_source_free() after the value. */
opc_node *opc_argument_parse(const char *option, const char *text, char **path,
                             opc_source **source, opc_problems *problems);
