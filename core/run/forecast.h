/* SPDX-License-Identifier: BSD-3-Clause */
/* Forecasts of work and memory for the steps of a flow. */
#pragma once

#include "core/run/run.h"

/* Forecast of a step. */
typedef struct opc_outlook {
  char *step; /* name (g_free) */
  opc_forecast forecast;
} opc_outlook;

/* Build the flow and add to `outlooks` the forecasts (opc_outlook) of all steps
   whose inputs can be made: light steps run (OPC_STEP_LIGHT), other steps make
   substitutes of their outputs (opc_step.sketch). Adds problems as
   opc_flow_check does. */
void opc_run_forecast(const opc_recipe *recipe, const opc_choice *choice,
                      opc_registry *registry, const opc_watch *watch,
                      GArray *outlooks, opc_problems *problems);

/* Return a forecast as text, such as "work, 1.2 GB" (g_free). */
char *opc_forecast_text(const opc_forecast *forecast);
