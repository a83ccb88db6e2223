/* SPDX-License-Identifier: BSD-3-Clause */
/* Quantities in trees, such as "65 nm", and ranges of quantities. */
#pragma once

#include <base/node.h>

enum { OPC_RANGE_MOST = 100000 }; /* largest number of values in a range */

/* Convert the text of a node, a number with a unit, to a number in the unit
   `to`. If `to` is NULL, the text must be a number without a unit. If `given`
   is not NULL, the text must also have no unit and is a number in the unit
   `given`. A 0 needs no unit, except for temperatures. `name` is the name of
   the value in problems. Return FALSE and a problem on failure, also if the
   number is not finite. */
gboolean opc_quantity_read(const opc_node *node, const char *given,
                           const char *to, const char *name, double *number,
                           opc_problems *problems);

/* Return the values of "{ from: A, to: B, step: C }" in the unit of A, as texts
   of `source` with 12 digits (opc_node *, freed with the array; the caller
   frees the array). If the range is not valid or does not end at B, add
   problems and return an empty list. */
GPtrArray *opc_range_values(const opc_node *range, const opc_source *source,
                            opc_problems *problems);

/* Return the numbers in nodes (opc_node *), one for each (g_free). *unit
   receives their unit, a part of the first node's text, or NULL for plain
   numbers. Return NULL if a node has no number or an unknown unit, or if the
   units differ. */
double *opc_range_numbers(const GPtrArray *nodes, const char **unit);
