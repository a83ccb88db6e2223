/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a flow into a run folder. */
#pragma once

#include "core/run/run.h"

/* Run a good flow: `flow` is the first point of the sweep of `choice`. Steps
   that no swept parameter touches, nor any step they depend on, run once, the
   others for each point; a point that fails is reported in the table only.
   Never NULL; the run failed if a problem was added, and `out.folder` then
   holds what was finished, if anything. */
opc_run *opc_run_flow(opc_flow *flow, const opc_choice *choice,
                      opc_registry *registry, const opc_run_options *options,
                      const opc_watch *watch, opc_problems *problems);
