/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the steps of a flow one after another. */
#pragma once

#include "core/run/run.h"

/* Run or reuse the steps, except run->left_out. Returns FALSE and adds problems
   on failure. */
gboolean opc_steps_run(opc_run *run, opc_problems *problems);

/* Create the instances of the steps, except run->left_out, and run the steps in
   the folder `path` as a part of `main_run`. The checksums of the files read
   are added to `main_run`. */
void opc_steps_run_in(opc_run *run, opc_run *main_run, const char *path,
                      opc_problems *problems);
