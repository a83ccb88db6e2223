/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs a flow into a run folder. */
#pragma once

#include "core/run/run.h"

/* Run a valid flow; `flow` is the first point of the sweep of `choice`. Steps
   that no swept parameter changes, directly or through a dependency, run once;
   the other steps run for each point. The failure of a point does not end the
   run; the table of the sweep reports the failure. Returns a run (never NULL),
   failed if a problem was added; `out.folder` then holds the finished files, if
   any. */
opc_run *opc_run_flow(opc_flow *flow, const opc_choice *choice,
                      opc_registry *registry, const opc_run_options *options,
                      const opc_watch *watch, opc_problems *problems);
