/* SPDX-License-Identifier: BSD-3-Clause */
/* The cells of a sheet, one by one, as gates of their own. */
#ifndef CORRECT_LIBRARY_CUT_H
#define CORRECT_LIBRARY_CUT_H

#include <eda/gates.h>
#include <eda/layout.h>

/* Instance i of the sheet's top: its cell, and in *out its transistors with all
   its shapes, in coordinates of its own; *out is NULL if it has none.
   OPC_INVALID if the gates are no sheet's. */
int cut_cell(const eda_gates *sheet, const eda_layout *layout, int32_t top,
             size_t i, int32_t *cell, eda_gates **out, opc_error *error);

/* The sum of how its edges were cut into fragments (g_free). */
char *cut_sum(const eda_gates *cell);

#endif
