/* SPDX-License-Identifier: BSD-3-Clause */
/* What steps will want, and whether there is that much. */
#include <guard/memory.h>
#include <string.h>

#include "core/run/run.h"

/* ---- one step ---- */

/* A plugin's text, ended before what cannot be shown. */
static void make_sound(char *text, size_t size) {
  const char *end;
  text[size - 1] = 0;
  g_utf8_validate(text, -1, &end);
  text[end - text] = 0;
  g_strdelimit(text, "\n\r\t\033", ' ');
}

static char *bytes_text(double bytes) {
  if (bytes < 1e6) return g_strdup("less than 1 MB");
  return g_strdup_printf(bytes < 1e9 ? "%.0f MB" : "%.1f GB",
                         bytes < 1e9 ? bytes * 1e-6 : bytes * 1e-9);
}

static int check_memory(const opc_forecast *wanted, opc_error *error) {
  const char *source;
  double bytes = memory_free(&source);
  if (!(wanted->memory > bytes)) return OPC_OK;
  g_autofree char *most = bytes_text(wanted->memory);
  g_autofree char *left = bytes_text(bytes);
  return opc_fail(error, OPC_FAILED, NULL,
                  "wants %s of memory%s%s, but %s has only %s left%s%s", most,
                  *wanted->work ? " for " : "", wanted->work, source, left,
                  *wanted->help ? "; less with " : "", wanted->help);
}

int opc_run_ask(const opc_run *run, const opc_flow_step *step,
                opc_forecast *out, opc_error *error) {
  const opc_binding *b = step->binding;
  const opc_step *functions = b->plugin->functions;
  memset(out, 0, sizeof *out);
  if (!functions->forecast) return OPC_OK;
  opc_run_set_inputs(run, step, TRUE);
  const char *before = opc_binding_enter(b);
  int code = functions->forecast(b->module.self, out, error);
  opc_binding_leave(before);
  opc_run_set_inputs(run, step, FALSE);
  make_sound(out->work, sizeof out->work);
  make_sound(out->help, sizeof out->help);
  if (!(out->memory > 0)) out->memory = 0;
  return code ? code : check_memory(out, error);
}

char *opc_forecast_text(const opc_forecast *forecast) {
  g_autofree char *memory =
      forecast->memory > 0 ? bytes_text(forecast->memory) : g_strdup("");
  return g_strconcat(forecast->work, *forecast->work && *memory ? ", " : "",
                     memory, NULL);
}

/* ---- a flow ---- */

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
  int code = opc_run_ask(run, step, &outlook.forecast, &error);
  if (*outlook.forecast.work || outlook.forecast.memory > 0) {
    outlook.step = g_strdup(step->name);
    g_array_append_val(outlooks, outlook);
  }
  if (!code && functions->flags & OPC_STEP_LIGHT)
    code = opc_run_call(run, step, &error);
  return !code || opc_binding_fail(step->binding, TRUE, code, &error, problems);
}

/* Of what needs a step that failed, nothing is told. */
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
    g_autoptr(opc_run) run = opc_run_new(flow, registry, &nowhere, watch);
    forecast_steps(run, outlooks, found);
  }
  g_autofree char *note =
      choice->variant ? g_strdup_printf(" (variant '%s')", choice->variant)
                      : NULL;
  opc_problems_merge(problems, found, note);
}
