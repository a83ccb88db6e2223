/* SPDX-License-Identifier: BSD-3-Clause */
/* Comparability of two runs. */
#pragma once

#include "field.h"

/* Add to `why` (char *) each reason why the runs are not comparable: another
   layout or device table by content, other optics or resist, other transistors,
   a failed run. Returns 0, or an error code if a table cannot be read. */
int same_check(const pair *p, GPtrArray *why, opc_error *error);

/* Return whether both runs must have the same value of a parameter: parameters
   of steps that read or segment the layout, and of a litho, resist or
   extractor. */
int same_is_shared(const eda_run *run, const char *name);

/* Return the SHA-256 of the file named by a parameter; NULL if the parameter
   names no input file of the run. */
const char *same_content(const eda_run *run, const eda_run_parameter *p);
