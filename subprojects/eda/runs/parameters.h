/* SPDX-License-Identifier: BSD-3-Clause */
/* Parameters of a resolved flow. */
#pragma once

#include <glib.h>

#include "runs/text.h"

/* Append all parameters (eda_run_parameter) to `out`. Strings of the parameters
   are appended to `texts`, which owns them. Return an OPC_* code. */
int runs_parameters(const runs_tree *flow, GArray *out, GPtrArray *texts,
                    opc_error *error);
