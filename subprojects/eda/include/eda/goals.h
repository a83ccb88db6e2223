/* SPDX-License-Identifier: BSD-3-Clause */
/* Reading goals (eda_goal): from the notes of a layout and from CSV files. */
#pragma once

#include <eda/gates.h>

OPC_C_BEGIN

/* Parse a note into *out: words with blanks or commas between them, weight=...,
   ion=..., ioff=..., area=.... Words with a dot in their name are left to other
   programs; a note that begins with # is a remark and sets nothing. Return
   NULL, or the fault of the note, which the caller frees with g_free. [any] */
OPC_EXPORT char *eda_goal_parse(const char *note, eda_goal *out);

/* Return NULL if all values are within their bounds, else the noun of the value
   that is not, for example "weight". [any] */
OPC_EXPORT const char *eda_goal_fault(const eda_goal *goal);

/* Read the CSV file `path` into out[gates->count], which holds the values of
   transistors and columns that the file does not name. The first line names the
   columns: transistor (as in gates.csv), and some of weight, ion, ioff, area.
   Errors name the line and column, and the parameter 'wishes'. [any] */
OPC_EXPORT int eda_goals_read(const char *path, const eda_gates *gates,
                              eda_goal *out, opc_error *error);

OPC_C_END
