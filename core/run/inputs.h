/* SPDX-License-Identifier: BSD-3-Clause */
/* Sums of the files that a run reads. */
#pragma once

#include "core/run/run.h"

/* Add the sums of all files that `flow` reads, before any step may change one.
   FALSE and problems. */
gboolean opc_inputs_sum(opc_run *run, const opc_flow *flow,
                        opc_problems *problems);

/* List the files of the run's flow; another run has their sums. */
void opc_inputs_take(opc_run *run, const opc_run *from, opc_problems *problems);
