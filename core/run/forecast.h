/* SPDX-License-Identifier: BSD-3-Clause */
/* What the steps of a flow will need. */
#pragma once

#include "core/run/run.h"

typedef struct opc_outlook {
  char *step; /* its name (g_free) */
  opc_forecast forecast;
} opc_outlook;

/* Make the flow, run its light steps, which write nothing, and add the
   forecasts (opc_outlook) of the steps that then have their inputs. Problems
   are added as by opc_flow_check. */
void opc_run_forecast(const opc_recipe *recipe, const opc_choice *choice,
                      opc_registry *registry, const opc_watch *watch,
                      GArray *outlooks, opc_problems *problems);

/* "work, 1.2 GB" (g_free) */
char *opc_forecast_text(const opc_forecast *forecast);
