/* SPDX-License-Identifier: BSD-3-Clause */
/* Read goals (eda_goal, gates.h) from notes (texts in the layout) and from CSV
   files. [any]: see opcflow/plugin.h. */
#pragma once

#include <eda/gates.h>

OPC_C_BEGIN

/* Parse a note into *out: words with blanks or commas between them, weight=...,
   ion=..., ioff=..., area=.... Words with a dot in their name are for other
   programs and ignored; a note that begins with # is a comment. Values that the
   note does not set are those of eda_goal_none. out->given is 0 for an empty
   note and for a comment, otherwise 1. Return NULL, or a description of the
   fault, which the caller frees with g_free. [any] */
OPC_EXPORT char *eda_goal_parse(const char *note, eda_goal *out);

/* Return NULL if all values are within their bounds, otherwise the noun of the
   first invalid value, for example "weight". [any] */
OPC_EXPORT const char *eda_goal_fault(const eda_goal *goal);

/* Read the CSV file `path` into out[gates->count]. Values of transistors and
   columns that the file does not name stay unchanged. The first line names the
   columns: transistor (OWNER:NUMBER, as in gates.csv), and any of weight, ion,
   ioff, area. Return OPC_OK, or an error code and *error with the parameter
   "wishes", the line and the column. [any] */
OPC_EXPORT int eda_goals_read(const char *path, const eda_gates *gates,
                              eda_goal *out, opc_error *error);

OPC_C_END
