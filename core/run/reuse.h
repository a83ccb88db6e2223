/* SPDX-License-Identifier: BSD-3-Clause */
/* Reuse of step results from the store. */
#pragma once

#include "core/run/run.h"

/* Compute the keys of the steps that are not left out. */
void opc_reuse_begin(opc_run *run);

/* Publish the stored result of a step. Returns FALSE if no result is stored, so
   that the step must run; TRUE with a problem if publishing failed. */
gboolean opc_reuse_take(opc_run *run, const opc_flow_step *step,
                        opc_problems *problems);

/* Log the steps of a run that were reused and that did not run again to make
   their outputs. */
void opc_reuse_report(const opc_run *run);

/* Store the result of a step that ran, with the tables from index `tables`. */
void opc_reuse_keep(opc_run *run, const opc_flow_step *step, guint tables);

/* Load the outputs of a step from the store, or run the step again. `whom` is
   the name of the step that needs the outputs. Returns FALSE and adds a problem
   on failure. */
gboolean opc_reuse_provide(opc_run *run, const opc_flow_step *step,
                           const char *whom, opc_problems *problems);
