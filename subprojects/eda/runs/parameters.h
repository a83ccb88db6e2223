/* SPDX-License-Identifier: BSD-3-Clause */
/* Parameters of a resolved flow. */
#pragma once

#include <glib.h>

#include "runs/text.h"

/* Add all parameters to `out` (eda_run_parameter); `texts` (char *) owns their
   texts. Return an OPC_* code. */
int runs_parameters(const runs_tree *flow, GArray *out, GPtrArray *texts,
                    opc_error *error);
