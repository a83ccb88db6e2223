/* SPDX-License-Identifier: BSD-3-Clause */
/* Steps whose results are in the store. */
#pragma once

#include "core/run/run.h"

/* Find the keys of the steps that are not left out. */
void opc_reuse_begin(opc_run *run);

/* Return whether the step need not run: its result was found and published.
   TRUE and a problem, too, if publishing failed. */
gboolean opc_reuse_take(opc_run *run, const opc_flow_step *step,
                        opc_problems *problems);

/* Keep the result of a step that ran, with its tables from number `tables`. */
void opc_reuse_keep(opc_run *run, const opc_flow_step *step, guint tables);

/* Make the outputs of a step available, which may run for that; `whom`: the
   step that takes them. */
gboolean opc_reuse_provide(opc_run *run, const opc_flow_step *step,
                           const char *whom, opc_problems *problems);
