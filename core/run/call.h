/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls of a step's functions. */
#pragma once

#include "core/run/run.h"

/* Set the inputs in the instances of a step to the outputs that the step
   depends on, or to NULL (`present` FALSE). */
void opc_call_set_inputs(const opc_run *run, const opc_flow_step *step,
                         gboolean present);

/* Check the outputs of a step by the functions of their kinds. Returns OPC_OK
   or a code and *error. */
int opc_call_check(const opc_run *run, const opc_flow_step *step,
                   opc_error *error);

/* Store the forecast of a step in *out; zeros if the step has no forecast. The
   inputs of the step must be present. Returns OPC_OK, or a code and *error,
   also if the step needs more memory than is free. */
int opc_call_forecast(const opc_run *run, const opc_flow_step *step,
                      opc_forecast *out, opc_error *error);

/* Run a step, or make substitutes (`sketch`), and check the outputs, which
   `run` then owns. Returns OPC_OK or a code and *error. */
int opc_call_run(opc_run *run, const opc_flow_step *step, gboolean sketch,
                 opc_error *error);

/* Call forecast and run of a step. FALSE and a problem on failure. */
gboolean opc_call_step(opc_run *run, const opc_flow_step *step,
                       opc_problems *problems);
