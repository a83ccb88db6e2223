/* SPDX-License-Identifier: BSD-3-Clause */
/* Calls the functions of steps, with the step's name set for crash reports. */
#include "core/run/call.h"

#include <base/shown.h>
#include <base/unit.h>
#include <guard/memory.h>
#include <guard/stop.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>

#include "core/binding/inner.h"
#include "core/plugin/declaration.h"

void opc_call_set_inputs(const opc_run *run, const opc_flow_step *step,
                         gboolean present) {
  for (guint i = 0; i < step->inputs->len; i++) {
    const opc_flow_input *input =
        &g_array_index(step->inputs, opc_flow_input, i);
    opc_binding_set(
        input->binding, input->parameter,
        present ? run->objects[input->from->number][input->port] : NULL);
  }
}

/* Implements the call of `check` for each output. */
int opc_call_check(const opc_run *run, const opc_flow_step *step,
                   opc_error *error) {
  const opc_plugin *plugin = step->binding->plugin;
  for (size_t i = 0; i < opc_port_count(plugin); i++) {
    const opc_port *port = opc_port_at(plugin, i);
    const void *object = run->objects[step->number][i];
    opc_error fault = {0};
    if (!object)
      return opc_fail(error, OPC_FAILED, NULL, "returned no output '%s'",
                      port->name);
    const char *before = opc_binding_enter(step->binding);
    int code = port->check(object, &fault);
    opc_binding_leave(before);
    if (code)
      return opc_fail(error, code, NULL, "output '%s': %s", port->name,
                      fault.message);
  }
  return OPC_OK;
}

static int check_memory(const opc_forecast *wanted, opc_error *error) {
  const char *source;
  double bytes = memory_free(&source);
  if (!(wanted->memory > bytes)) return OPC_OK;
  g_autofree char *most = opc_bytes_text(wanted->memory);
  g_autofree char *left = opc_bytes_text(bytes);
  return opc_fail(error, OPC_FAILED, NULL,
                  "requires %s of memory%s%s, but %s has only %s left, enough "
                  "for %.2g %%%s%s",
                  most, *wanted->work ? " for " : "", wanted->work, source,
                  left, 100 * bytes / wanted->memory,
                  *wanted->help ? "; less with " : "", wanted->help);
}

int opc_call_forecast(const opc_run *run, const opc_flow_step *step,
                      opc_forecast *out, opc_error *error) {
  const opc_binding *b = step->binding;
  const opc_step *functions = b->plugin->functions;
  memset(out, 0, sizeof *out);
  if (!functions->forecast) return OPC_OK;
  opc_call_set_inputs(run, step, TRUE);
  const char *before = opc_binding_enter(b);
  int code = functions->forecast(b->module.self, out, error);
  opc_binding_leave(before);
  opc_call_set_inputs(run, step, FALSE);
  opc_show_in_place(out->work, sizeof out->work);
  opc_show_in_place(out->help, sizeof out->help);
  if (!(out->memory > 0)) out->memory = 0;
  return code ? code : check_memory(out, error);
}

/* Start the time limit of a step. If the step still runs `patience` seconds
   after the limit, the process ends. */
static void limit_begin(opc_run *run, const opc_flow_step *step,
                        stop_limit *hard) {
  static const double patience = 5, most = 1e9;
  const opc_binding *b = step->binding;
  int i = opc_timeout_find(b->plugin);
  if (i < 0 || !b->values[i].present) return;
  double limit = MIN(b->values[i].field.real, most);
  run->deadline = g_get_monotonic_time() + (gint64)(limit * 1e6);
  g_autofree char *place = opc_place_text(opc_binding_origin(b, (size_t)i));
  g_autofree char *where =
      g_strdup_printf("%s: step '%s': exceeded the time limit of %g s", place,
                      step->name, limit);
  stop_limit_begin(hard, limit + patience, where);
}

/* End the time limit of a step that returned `code`; return `code`, or
   OPC_FAILED if the step exceeded the limit. */
static int limit_end(opc_run *run, const opc_flow_step *step, stop_limit *hard,
                     int code, opc_error *error) {
  const opc_binding *b = step->binding;
  gboolean late = run->deadline && g_get_monotonic_time() >= run->deadline;
  if (run->deadline) stop_limit_end(hard);
  run->deadline = 0;
  if (!late || (code && code != OPC_CANCELLED) ||
      opc_cancelled(b->host->context))
    return code;
  int i = opc_timeout_find(b->plugin);
  return opc_fail(error, OPC_FAILED, "timeout",
                  "exceeded the time limit of %g s", b->values[i].field.real);
}

/* Return the processor seconds of this process and of its finished children. */
static double processor_now(void) {
  struct rusage own, children;
  getrusage(RUSAGE_SELF, &own);
  getrusage(RUSAGE_CHILDREN, &children);
  return (double)(own.ru_utime.tv_sec + own.ru_stime.tv_sec +
                  children.ru_utime.tv_sec + children.ru_stime.tv_sec) +
         1e-6 * (double)(own.ru_utime.tv_usec + own.ru_stime.tv_usec +
                         children.ru_utime.tv_usec + children.ru_stime.tv_usec);
}

int opc_call_run(opc_run *run, const opc_flow_step *step, gboolean sketch,
                 opc_error *error) {
  const opc_binding *b = step->binding;
  const opc_step *functions = b->plugin->functions;
  void **objects = g_new0(void *, functions->n_outputs + 1);
  run->objects[step->number] = objects;
  g_ptr_array_set_size(run->kept.pieces, 0);
  opc_call_set_inputs(run, step, TRUE);
  gint64 start = g_get_monotonic_time();
  double processor = processor_now();
  stop_limit hard;
  limit_begin(run, step, &hard);
  const char *before = opc_binding_enter(b);
  int code = (sketch ? functions->sketch : functions->run)(b->module.self,
                                                           objects, error);
  opc_binding_leave(before);
  opc_inner_end(b->inner);
  code = limit_end(run, step, &hard, code, error);
  run->out.seconds[step->number] =
      (double)(g_get_monotonic_time() - start) * 1e-6;
  run->out.processor[step->number] = processor_now() - processor;
  opc_call_set_inputs(run, step, FALSE);
  if (!code && run->written.refusal.code) {
    *error = run->written.refusal;
    code = error->code;
  }
  return code ? code : opc_call_check(run, step, error);
}

/* Remove the output files of a failed step, which may be incomplete. */
static void remove_given(const opc_run *run) {
  for (guint i = 0; i < run->written.given->len; i++)
    (void)remove(run->written.given->pdata[i]);
}

gboolean opc_call_step(opc_run *run, const opc_flow_step *step,
                       opc_problems *problems) {
  const opc_binding *b = step->binding;
  opc_error error = {0};
  opc_forecast wanted;
  g_ptr_array_set_size(run->written.given, 0);
  int code = opc_call_forecast(run, step, &wanted, &error);
  if (!code) code = opc_call_run(run, step, FALSE, &error);
  if (!code) return TRUE;
  if (code == OPC_IO) remove_given(run);
  /* A plugin may return OPC_CANCELLED only if the user stopped the run. */
  if (code == OPC_CANCELLED && !opc_cancelled(b->host->context))
    code = OPC_FAILED;
  opc_binding_fail(b, TRUE, code, &error, problems);
  run->out.failure = g_strdup(error.message);
  return FALSE;
}
