/* SPDX-License-Identifier: BSD-3-Clause */
/* The parameters of a resolved flow. */
#pragma once

#include <glib.h>

#include "runs/text.h"

/* Add all to `out` (eda_run_parameter); their texts belong to `texts`
   (char *). */
int runs_parameters(runs_tree *flow, GArray *out, GPtrArray *texts,
                    opc_error *error);
