/* SPDX-License-Identifier: BSD-3-Clause */
/* Asks steps how much work and memory they will need. */
#include "core/run/forecast.h"

#include <base/unit.h>

#include "core/run/call.h"

char *opc_forecast_text(const opc_forecast *forecast) {
  g_autofree char *memory =
      forecast->memory > 0 ? opc_bytes_text(forecast->memory) : g_strdup("");
  return g_strconcat(forecast->work, *forecast->work && *memory ? ", " : "",
                     memory, NULL);
}

static gboolean has_inputs(const opc_run *run, const opc_flow_step *step) {
  for (guint i = 0; i < step->inputs->len; i++)
    if (!run->objects[g_array_index(step->inputs, opc_flow_input, i)
                          .from->number])
      return FALSE;
  return TRUE;
}

static gboolean forecast_step(opc_run *run, const opc_flow_step *step,
                              GArray *outlooks, opc_problems *problems) {
  const opc_step *functions = step->binding->plugin->functions;
  if (!has_inputs(run, step)) return TRUE;
  opc_error error = {0};
  opc_outlook outlook;
  int code = opc_call_forecast(run, step, &outlook.forecast, &error);
  if (*outlook.forecast.work || outlook.forecast.memory > 0) {
    outlook.step = g_strdup(step->name);
    g_array_append_val(outlooks, outlook);
  }
  gboolean light = functions->flags & OPC_STEP_LIGHT;
  if (!code && (light || functions->sketch))
    code = opc_call_run(run, step, !light, &error);
  return !code || opc_binding_fail(step->binding, TRUE, code, &error, problems);
}

/* Append the forecasts in the order of execution. The outputs of a failed step
   are released, so that all dependent steps are skipped. */
static void forecast_steps(opc_run *run, GArray *outlooks,
                           opc_problems *problems) {
  const GPtrArray *order = run->flow->order;
  for (guint i = 0; i < order->len; i++)
    if (!forecast_step(run, order->pdata[i], outlooks, problems))
      opc_run_release(run, order->pdata[i]);
}

void opc_run_forecast(const opc_recipe *recipe, const opc_choice *choice,
                      opc_registry *registry, const opc_watch *watch,
                      GArray *outlooks, opc_problems *problems) {
  static const opc_run_options nowhere = {.output = NULL};
  g_autoptr(opc_problems) found = opc_problems_new();
  g_autoptr(opc_flow) flow = opc_flow_make(recipe, choice, registry, found);
  if (!found->list->len && opc_flow_create(flow, NULL, watch, NULL, found)) {
    g_autoptr(opc_run) run = opc_run_new(flow, registry, &nowhere, watch, NULL);
    forecast_steps(run, outlooks, found);
  }
  g_autofree char *note =
      choice->variant ? g_strdup_printf(" (variant '%s')", choice->variant)
                      : NULL;
  opc_problems_merge(problems, found, note);
}
