/* SPDX-License-Identifier: BSD-3-Clause */
/* Quantities in trees: "65 nm", and ranges of them. */
#pragma once

#include <base/node.h>

enum { OPC_RANGE_MOST = 100000 }; /* limit on the values of a range */

/* Convert the text of a node, with the unit `given` appended unless NULL, to
   the unit `to`; a plain number if `to` is NULL. `name` names the value in
   problems. Return FALSE and a problem on failure. */
gboolean opc_quantity_read(const opc_node *node, const char *given,
                           const char *to, const char *name, double *number,
                           opc_problems *problems);

/* Return the values of "{ from: A, to: B, step: C }" in the unit of A, as texts
   of `source` (opc_node *, freed with the array). Return none and add problems
   if the range is not sound. */
GPtrArray *opc_range_values(const opc_node *range, const opc_source *source,
                            opc_problems *problems);

/* Return the numbers of nodes that all are numbers with the same unit, or all
   without one (g_free), and the unit or NULL in *unit. Return NULL otherwise.
 */
double *opc_range_numbers(const GPtrArray *nodes, const char **unit);
