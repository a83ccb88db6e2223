/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of a step's functions. */
#pragma once

#include "core/run/run.h"

/* Put the outputs it needs into the instances of a step, or take them away. */
void opc_call_set_inputs(const opc_run *run, const opc_flow_step *step,
                         gboolean present);

/* Check outputs by the functions of their kinds. */
int opc_call_check(const opc_run *run, const opc_flow_step *step,
                   opc_error *error);

/* Ask a step whose inputs are there for its forecast; fails, too, if it needs
   more memory than there is. All is 0 if the step has no forecast. */
int opc_call_forecast(const opc_run *run, const opc_flow_step *step,
                      opc_forecast *out, opc_error *error);

/* Run a step and check its outputs, which `run` then holds. */
int opc_call_run(opc_run *run, const opc_flow_step *step, opc_error *error);

/* The same after its forecast; FALSE and a problem if it fails. */
gboolean opc_call_step(opc_run *run, const opc_flow_step *step,
                       opc_problems *problems);
