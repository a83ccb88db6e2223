/* SPDX-License-Identifier: BSD-3-Clause */
/* Checksums of the files that a run reads. */
#pragma once

#include "core/run/run.h"

/* Compute the checksums of all files that `flow` reads. Call before any step
   runs, because a step may change a file. Returns FALSE and adds problems on
   failure. */
gboolean opc_inputs_sum(opc_run *run, const opc_flow *flow,
                        opc_problems *problems);

/* List the files that the run's flow reads; reuse the checksums that `from`
   has. */
void opc_inputs_take(opc_run *run, const opc_run *from, opc_problems *problems);
