/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the levels of a sweep (levels.h), each in an opc_run of its own, which
   uses the outputs of the lower levels. */
#include "core/run/levels.h"

#include <store/files.h>

#include "core/binding/lookup.h"
#include "core/binding/resolve.h"
#include "core/run/reports.h"
#include "core/run/steps.h"

/* ---- one run ---- */

/* Use the outputs of `from`, including those that `from` uses from lower
   levels. Steps match by name, because a layer may add or remove steps. */
static void run_borrow(opc_run *run, opc_run *from) {
  run->kept.base = from;
  for (guint i = 0; i < run->flow->steps->len; i++) {
    const opc_flow_step *step = run->flow->steps->pdata[i];
    const opc_flow_step *its = opc_flow_find(from->flow, step->name);
    run->objects[i] = its ? from->objects[its->number] : NULL;
  }
}

/* Leave out the steps of other levels and the steps that are not needed. */
static void run_choose_steps(const opc_levels *l, opc_run *run,
                             unsigned level) {
  g_autofree unsigned *levels = opc_sweep_levels(l->choice.sweep, run->flow);
  g_autofree gboolean *needed =
      l->needed ? l->needed(l->data, run->flow) : NULL;
  for (guint i = 0; i < run->flow->steps->len; i++)
    run->left_out[i] = levels[i] != level || (needed && !needed[i]);
}

static gboolean run_has_steps(const opc_run *run) {
  for (guint i = 0; i < run->flow->steps->len; i++)
    if (!run->left_out[i]) return TRUE;
  return FALSE;
}

static void claim_copy(gpointer name, gpointer owner, gpointer claims) {
  g_hash_table_insert(claims, g_strdup(name), g_strdup(owner));
}

/* Return a new run of a level at a point of the sweep. Returns NULL and adds
   problems on failure. */
static opc_run *run_make(const opc_levels *l, unsigned level, size_t point,
                         opc_problems *problems) {
  unsigned below = level ? level - 1 : 0;
  while (!l->runs[below]) below--;
  opc_run *parent = l->runs[below];
  opc_choice choice = l->choice;
  choice.point = point;
  opc_flow *flow = opc_flow_make(l->recipe, &choice, l->registry, problems);
  if (problems->list->len) {
    opc_flow_free(flow);
    return NULL;
  }
  opc_run *run = opc_run_new(flow, l->registry, l->outer->options, l->watch,
                             &l->outer->like);
  run->own = flow;
  run_borrow(run, parent);
  run_choose_steps(l, run, level);
  if (l->one_folder)
    g_hash_table_foreach(parent->written.claims, claim_copy,
                         run->written.claims);
  return run;
}

/* ---- levels ---- */

char *opc_levels_folder(const opc_levels *l, unsigned level) {
  return g_strdup_printf("%s/.%u", l->folder, level);
}

static void level_drop(opc_levels *l, unsigned level) {
  g_autofree char *folder = opc_levels_folder(l, level);
  opc_run_free(l->runs[level]);
  l->runs[level] = NULL;
  g_clear_pointer(&l->failures[level], opc_problems_free);
  opc_remove_tree(folder);
}

/* Run a level between the trunk and the last level at a point of the sweep. The
   problems of the level apply to all points that share the level. */
static void level_open(opc_levels *l, unsigned level, size_t point) {
  opc_problems *problems = l->failures[level] = opc_problems_new();
  g_autofree char *folder = opc_levels_folder(l, level);
  opc_run *run = run_make(l, level, point, problems);
  gboolean any = run && run_has_steps(run);
  if (any) opc_steps_run_in(run, l->outer, folder, problems);
  if (any)
    l->runs[level] = run;
  else
    opc_run_free(run);
}

/* Prepare all intermediate levels for a point of the sweep: run each level
   that depends on a changed value, and add the problems of all these levels. */
static void levels_enter(opc_levels *l, size_t point, opc_problems *problems) {
  gboolean same = TRUE;
  for (unsigned level = 1; level < l->depth; level++) {
    guint value = opc_sweep_index(l->choice.sweep, level - 1, point);
    same &= l->failures[level] && l->at[level] == value;
    if (!same) level_drop(l, level);
    l->at[level] = value;
    if (!same && !problems->list->len) level_open(l, level, point);
    if (l->failures[level])
      opc_problems_merge(problems, l->failures[level], NULL);
  }
}

void opc_levels_begin(opc_levels *l, opc_run *trunk) {
  l->depth = opc_sweep_depth(l->choice.sweep);
  l->runs = g_new0(opc_run *, l->depth + 1);
  l->failures = g_new0(opc_problems *, l->depth + 1);
  l->at = g_new0(guint, l->depth + 1);
  l->runs[0] = trunk;
  run_choose_steps(l, trunk, 0);
}

void opc_levels_clear(opc_levels *l) {
  opc_run_free(l->last);
  for (unsigned level = 1; l->runs && level < l->depth; level++)
    level_drop(l, l->depth - level);
  g_free(l->runs);
  g_free(l->failures);
  g_free(l->at);
}

void opc_levels_forget_stopped(opc_levels *l) {
  for (unsigned level = 1; level < l->depth; level++)
    if (l->failures[level] &&
        opc_problems_code(l->failures[level]) == OPC_CANCELLED)
      level_drop(l, level);
}

void opc_levels_run(opc_levels *l, size_t point, const char *folder,
                    opc_problems *problems) {
  opc_run_free(l->last);
  l->last = NULL;
  levels_enter(l, point, problems);
  if (!problems->list->len) l->last = run_make(l, l->depth, point, problems);
  if (l->last) opc_steps_run_in(l->last, l->outer, folder, problems);
}

void opc_levels_close(const opc_run *run, gboolean keep,
                      opc_problems *problems) {
  if (!run->written.work) return;
  if (!keep) {
    opc_remove_tree(run->written.work);
    return;
  }
  opc_reports_write_file(run, "flow.yaml", opc_flow_resolved(run->flow, NULL),
                         problems);
  opc_reports_write_file(run, "metrics.json",
                         opc_outcome_metrics_text(&run->out), problems);
}
