/* SPDX-License-Identifier: BSD-3-Clause */
/* Opens the folder of a run, runs steps and points, and closes the folder. */
#include "core/run/whole.h"

#include <guard/guard.h>
#include <store/files.h>
#include <string.h>

#include <store/folder.h>
#include "core/run/inputs.h"
#include "core/run/points.h"
#include "core/run/publish.h"
#include "core/run/reports.h"
#include "core/run/steps.h"

/* Create a temporary folder, removed by the run, for a rank above 0. */
static void open_scratch(opc_run *run, opc_problems *problems) {
  g_autoptr(GError) fault = NULL;
  run->written.work = g_dir_make_tmp("opcflow-XXXXXX", &fault);
  opc_reports_reserve(run);
  if (!run->written.work)
    opc_problem_add(problems, OPC_IO, NULL, "%s", fault->message);
}

/* Open the folder of a run. Return NULL for ranks other than the first, and if
   no folder could be opened. Each failure is added to `problems`. */
static opc_folder *open_folder(opc_run *run, const char *target,
                               opc_problems *problems) {
  opc_error error;
  if (!opc_run_is_first(run)) {
    open_scratch(run, problems);
    return NULL;
  }
  gboolean given = run->options->output != NULL;
  opc_folder *slot = opc_folder_open(target, given, &error);
  int code = !slot   ? error.code
             : given ? opc_folder_allowed(target, run->options->force, &error)
                     : OPC_OK;
  if (code) {
    opc_problem_add(problems, code, NULL, "%s", error.message);
    return slot;
  }
  g_autofree char *failed = g_strconcat(target, ".failed", NULL);
  run->written.work = g_strdup(slot->work);
  guard_folder(run->written.work, failed, slot->lock);
  run->written.guarded = TRUE;
  opc_reports_reserve(run);
  return slot;
}

/* Close the folder. A stopped run is discarded. The files of a failed run are
   kept as TARGET.failed, unless the folder has only reports. A folder that
   cannot be renamed keeps the temporary name. */
static void close_folder(opc_run *run, opc_folder *slot, const char *target,
                         opc_problems *problems) {
  guard_folder(NULL, NULL, NULL);
  if (!opc_run_is_first(run)) {
    if (run->written.work) opc_remove_tree(run->written.work);
    return;
  }
  gboolean stopped = opc_problems_code(problems) == OPC_CANCELLED;
  gboolean failed = problems->list->len > 0;
  if (stopped || (failed && !opc_reports_has_others(run))) return;
  opc_error error;
  failed |= !opc_reports_write(run, TRUE, problems);
  if (opc_sync_tree(run->written.work, &error))
    failed = !opc_problem_add(problems, error.code, NULL, "%s", error.message);
  g_autofree char *name =
      failed ? g_strconcat(target, ".failed", NULL) : g_strdup(target);
  gboolean given = run->options->output && !failed;
  int code = opc_folder_close(slot, name, given && run->options->force, !given,
                              &run->out.folder, &error);
  if (code) opc_problem_add(problems, code, NULL, "%s", error.message);
}

static char *target_of(const opc_run *run) {
  const char *output = run->options->output;
  if (!output) return g_build_filename("runs", run->flow->name, NULL);
  char *target = g_strdup(output);
  for (size_t n = strlen(target); n > 1 && target[n - 1] == '/';)
    target[--n] = 0;
  return target;
}

opc_run *opc_run_flow(opc_flow *flow, const opc_choice *choice,
                      opc_registry *registry, const opc_run_options *options,
                      const opc_watch *watch, opc_problems *problems) {
  opc_run *run =
      opc_run_new(flow, registry, options, watch, &opc_run_publisher);
  gint64 start = g_get_monotonic_time();
  g_autofree char *target = target_of(run);
  opc_folder *slot = NULL;
  if (choice->sweep->axes->len) run->out.sweep = choice->sweep;
  opc_points points;
  if (run->out.sweep) opc_points_begin(&points, run, choice);
  if (opc_flow_create(flow, run->left_out, &run->listener.watch, &run->like,
                      problems) &&
      opc_inputs_sum(run, flow, problems))
    slot = open_folder(run, target, problems);
  if (opc_steps_run(run, problems) && run->out.sweep)
    opc_points_run(&points, problems);
  if (run->out.sweep) opc_points_clear(&points);
  if (!problems->list->len)
    opc_verdicts_judge(run->out.verdicts, flow, run->out.metrics,
                       run->left_out);
  opc_run_release_all(run);
  run->out.total = (double)(g_get_monotonic_time() - start) * 1e-6;
  if (run->written.work) close_folder(run, slot, target, problems);
  opc_folder_free(slot);
  return run;
}
