/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs steps, each in one process or distributed over ranks. */
#include "core/run/steps.h"

#include <errno.h>

#include "core/run/call.h"
#include "core/run/inputs.h"
#include "core/run/listen.h"
#include "core/run/pieces.h"
#include "core/run/reports.h"
#include "core/run/reuse.h"

/* Return, by step number, whether every rank runs the step (g_free): a step
   that distributes pieces, or that provides inputs of such a step. */
static gboolean *find_shared(const opc_run *run) {
  const GPtrArray *order = run->flow->order;
  gboolean *shared = g_new0(gboolean, run->flow->steps->len);
  for (guint i = order->len; i-- > 0;) {
    const opc_flow_step *step = order->pdata[i];
    const opc_step *functions = step->binding->plugin->functions;
    if (functions->flags & OPC_STEP_PIECES) shared[step->number] = TRUE;
    for (guint k = 0; shared[step->number] && k < step->inputs->len; k++)
      shared[g_array_index(step->inputs, opc_flow_input, k).from->number] =
          TRUE;
  }
  return shared;
}

/* Return whether all ranks have the same files, builds and processors;
   otherwise results would not be bit-identical. */
static gboolean are_equal(opc_run *run, opc_problems *problems) {
  const ranks_group *ranks = opc_run_ranks(run);
  guint n = run->flow->steps->len;
  if (!ranks) return !problems->list->len;
  g_autoptr(GString) text = g_string_new(run->flow->name);
  g_autofree opc_key *keys = g_new0(opc_key, n);
  if (!problems->list->len) opc_flow_keys(run->flow, run->options->store, keys);
  for (guint i = 0; i < n; i++) {
    g_string_append_printf(text, " %s", keys[i].sum ? keys[i].sum : "-");
    opc_key_clear(&keys[i]);
  }
  return opc_ranks_agree(ranks, text->str, problems);
}

/* Write the reports that remain if the step crashes. Write no report into an
   empty run folder, because the guard removes empty folders after a crash. */
static void prepare_for_crash(opc_run *run, const opc_flow_step *step) {
  if (!run->written.guarded || !opc_reports_has_others(run)) return;
  g_autoptr(opc_problems) problems = opc_problems_new();
  run->out.failure =
      g_strdup_printf("the process ended while step '%s' ran", step->name);
  opc_reports_write(run, FALSE, problems);
  g_clear_pointer(&run->out.failure, g_free);
}

/* Reuse the result of a step, or run the step. */
static gboolean do_step(opc_run *run, const opc_flow_step *step,
                        opc_problems *problems) {
  if (opc_reuse_take(run, step, problems)) return !problems->list->len;
  if (problems->list->len) return FALSE;
  for (guint i = 0; i < step->inputs->len; i++)
    if (!opc_reuse_provide(run,
                           g_array_index(step->inputs, opc_flow_input, i).from,
                           step->name, problems))
      return FALSE;
  guint tables = run->out.tables->len;
  prepare_for_crash(run, step);
  opc_listen_step(run);
  run->at = step;
  gboolean good = opc_call_step(run, step, problems);
  run->at = NULL;
  if (good) opc_reuse_keep(run, step, tables);
  return good;
}

/* Run a step of a flow that several ranks run. A step that is not shared runs
   only in the first rank. */
static gboolean do_step_together(opc_run *run, const opc_flow_step *step,
                                 gboolean shared, opc_problems *problems) {
  const ranks_group *ranks = opc_run_ranks(run);
  if (!ranks) return do_step(run, step, problems);
  run->apart = !shared;
  if (shared || opc_run_is_first(run)) do_step(run, step, problems);
  run->apart = FALSE;
  return opc_ranks_agree(ranks, step->name, problems);
}

gboolean opc_steps_run(opc_run *run, opc_problems *problems) {
  g_autofree gboolean *shared = find_shared(run);
  if (!are_equal(run, problems)) return FALSE;
  opc_reuse_begin(run);
  const GPtrArray *order = run->flow->order;
  for (guint i = 0; i < order->len; i++) {
    const opc_flow_step *step = order->pdata[i];
    if (run->left_out[step->number]) continue;
    if (opc_cancelled(step->binding->host->context)) {
      run->out.failure = g_strdup("stopped");
      return opc_problem_add(problems, OPC_CANCELLED, &step->binding->at,
                             "stopped");
    }
    run->listener.watch.step(run, step->name, i + 1, order->len);
    if (!do_step_together(run, step, shared[step->number], problems))
      return FALSE;
  }
  opc_reuse_report(run);
  return TRUE;
}

void opc_steps_run_in(opc_run *run, opc_run *main_run, const char *path,
                      opc_problems *problems) {
  gboolean good = opc_flow_create(run->flow, run->left_out,
                                  &run->listener.watch, &run->like, problems) &&
                  opc_inputs_sum(main_run, run->flow, problems) &&
                  (!g_mkdir_with_parents(path, 0777) ||
                   opc_problem_add(problems, OPC_IO, NULL, "'%s': %s", path,
                                   g_strerror(errno)));
  run->main = main_run;
  if (good) {
    run->written.work = g_strdup(path);
    opc_reports_reserve(run);
  }
  opc_steps_run(run, problems);
}
