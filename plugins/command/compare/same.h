/* SPDX-License-Identifier: BSD-3-Clause */
/* Whether two runs can be held against each other. */
#pragma once

#include "field.h"

/* Add to `why` (char *) what keeps them from it: another layout or device table
   by content, other optics or resist, other transistors, a run that failed.
   *error of a table that cannot be read. */
int same_check(const pair *p, GPtrArray *why, opc_error *error);

/* Whether a parameter says what both have to share: one of a step that reads or
   cuts the layout, or of a litho, resist or extractor. */
int same_is_shared(const eda_run *run, const char *name);

/* The SHA-256 of the file that a parameter names; NULL: it names none that the
   run read. */
const char *same_content(const eda_run *run, const eda_run_parameter *p);
