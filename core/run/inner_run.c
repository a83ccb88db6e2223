/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the flow that a step has inside of it at points of its axes. Steps are
   run on levels: those that no axis touches once, those that the first axis is
   the last one to touch once for each of its values, and so on. */
#include <errno.h>
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#include <store/files.h>
#include "core/binding/inner.h"
#include "core/plugin/declaration.h"
#include "core/run/run.h"

/* ---- which steps ---- */

/* Of a flow at some point, by the numbers of its steps: which have what others
   gave, and which have to run for what was asked for (g_free). */
static gboolean *find_given(const opc_inner *in, const opc_flow *flow) {
  gboolean *given = g_new0(gboolean, flow->steps->len);
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    given[i] = g_hash_table_contains(in->given, step->name);
  }
  return given;
}

gboolean *opc_inner_needed(const opc_inner *in, const opc_flow *flow) {
  g_autofree gboolean *given = find_given(in, flow);
  g_autofree gboolean *wanted = g_new0(gboolean, flow->steps->len);
  gboolean all = !g_hash_table_size(in->wanted);
  for (guint i = 0; i < flow->steps->len; i++) {
    const opc_flow_step *step = flow->steps->pdata[i];
    wanted[i] = all || g_hash_table_contains(in->wanted, step->name);
  }
  return opc_flow_needed(flow, wanted, given);
}

/* Leave out what is not of this level, and what nobody asked for. */
static void choose_steps(const opc_inner *in, opc_run *run, unsigned level) {
  g_autofree unsigned *levels = opc_sweep_levels(in->sweep, run->flow);
  g_autofree gboolean *needed = opc_inner_needed(in, run->flow);
  for (guint i = 0; i < run->flow->steps->len; i++)
    run->left_out[i] = levels[i] != level || !needed[i];
}

/* What the outer flow's steps gave. */
static void put_given(const opc_inner *in, opc_run *run) {
  const opc_binding *b = in->binding;
  for (size_t i = 0; i < b->plugin->n_parameters; i++) {
    const char *name = b->plugin->parameters[i].name;
    void **objects = g_hash_table_lookup(in->given, name);
    if (!objects) continue;
    objects[0] = (void *)b->values[i].field.object;
    run->objects[opc_flow_find(run->flow, name)->number] = objects;
  }
}

/* ---- running: who looks on ---- */

/* Each point has the same to say: the last one says it. */
static void take_log(void *data, const char *path, int level,
                     const char *message) {
  const opc_inner *in = data;
  const opc_watch *watch = &((const opc_run *)in->binding->run)->watch;
  if (!in->telling && level >= OPC_LOG_INFO) return;
  g_autofree char *whole = g_strdup_printf("%s.%s", in->binding->path, path);
  watch->log(watch->data, whole, level, message);
}

/* Points that are done, with the part that is of those of this run. */
static void tell_progress(const opc_inner *in, double part) {
  const opc_progress progress = {
      .done = (double)in->done + floor(part * (double)in->share),
      .total = (double)in->sweep->points,
      .worst = NAN};
  in->binding->host->progress(in->binding->host, &progress);
}

static void take_progress(void *data, const char *path,
                          const opc_progress *at) {
  const opc_inner *in = data;
  (void)path;
  gboolean known = at->total > 0 && at->done >= 0 && at->done < at->total;
  if (in->share) tell_progress(in, known ? at->done / at->total : 0);
}

static int is_cancelled(void *data) {
  const opc_inner *in = data;
  return opc_cancelled(in->binding->host->context);
}

/* ---- running: levels ---- */

/* The run whose steps the next level's take over. */
static opc_run *parent_of(const opc_inner *in, unsigned level) {
  while (!in->levels[--level]) continue;
  return in->levels[level];
}

/* Files are called as in a run of the whole flow. */
static void copy_claim(gpointer name, gpointer owner, gpointer claims) {
  g_hash_table_insert(claims, g_strdup(name), g_strdup(owner));
}

/* A run of a level at a point; NULL and problems. */
static opc_run *make_run(const opc_inner *in, unsigned level, size_t point,
                         opc_problems *problems) {
  opc_run *outer = in->binding->run, *parent = parent_of(in, level);
  opc_choice choice = in->choice;
  choice.point = point;
  opc_flow *flow = opc_flow_make(in->recipe, &choice, in->registry, problems);
  if (problems->list->len) {
    opc_flow_free(flow);
    return NULL;
  }
  opc_run *run = opc_run_new(flow, in->registry, outer->options, &in->watch);
  run->own = flow;
  opc_run_borrow(run, parent);
  choose_steps(in, run, level);
  g_hash_table_foreach(parent->claims, copy_claim, run->claims);
  return run;
}

static char *level_folder(const opc_inner *in, unsigned level) {
  return g_strdup_printf("%s/.%u", in->folder, level);
}

static void drop_level(opc_inner *in, unsigned level) {
  g_autofree char *folder = level_folder(in, level);
  opc_run_free(in->levels[level]);
  in->levels[level] = NULL;
  g_clear_pointer(&in->failures[level], opc_problems_free);
  if (in->folder) opc_remove_tree(folder);
}

static gboolean has_steps(const opc_run *run) {
  for (guint i = 0; i < run->flow->steps->len; i++)
    if (!run->left_out[i]) return TRUE;
  return FALSE;
}

/* Run the steps of a level between the first and the last, at a point. What is
   wrong with it is kept: it holds for all points that share it. */
static void open_level(opc_inner *in, unsigned level, size_t point) {
  opc_problems *problems = in->failures[level] = opc_problems_new();
  g_autofree char *folder = level_folder(in, level);
  opc_run *run = make_run(in, level, point, problems);
  if (run && has_steps(run))
    opc_run_in(run, in->binding->run, folder, problems);
  if (run && has_steps(run))
    in->levels[level] = run;
  else
    opc_run_free(run);
}

/* Have all levels but the last one as they are at a point; problems of them. */
static void enter_point(opc_inner *in, size_t point, opc_problems *problems) {
  opc_run_free(in->run);
  in->run = NULL;
  gboolean same = TRUE;
  for (unsigned level = 1; level < in->depth; level++) {
    guint value = opc_sweep_index(in->sweep, level - 1, point);
    same &= in->failures[level] && in->at[level] == value;
    if (!same) drop_level(in, level);
    in->at[level] = value;
    if (!same && !problems->list->len) open_level(in, level, point);
    if (in->failures[level])
      opc_problems_merge(problems, in->failures[level], NULL);
  }
}

/* What was stopped has not failed. */
static void forget_stopped(opc_inner *in) {
  for (unsigned level = 1; level < in->depth; level++)
    if (in->failures[level] &&
        opc_problems_code(in->failures[level]) == OPC_CANCELLED)
      drop_level(in, level);
}

void opc_inner_release(opc_inner *in) {
  opc_run_free(in->run);
  for (unsigned level = in->levels ? in->depth : 0; level-- > 0;)
    drop_level(in, level);
  g_free(in->levels);
  g_free(in->failures);
  g_free(in->at);
}

void opc_inner_end(opc_inner *in) {
  for (unsigned level = 0; in->folder && level < in->depth; level++) {
    g_autofree char *folder = level_folder(in, level);
    opc_remove_tree(folder);
  }
}

/* Steps that no axis touches lie in a folder of their own, as those of the
   other levels: what they write is copied to each run that is kept. */
int opc_inner_begin(const opc_host *host, opc_error *error) {
  const opc_binding *b = host->data;
  opc_inner *in = b->inner;
  opc_run *outer = b->run;
  if (!outer)
    return opc_fail(error, OPC_FAILED, NULL, "a %s runs in a flow only",
                    b->plugin->id);
  in->watch = (opc_watch){.data = in,
                          .log = take_log,
                          .progress = take_progress,
                          .cancelled = is_cancelled};
  g_autofree char *name = g_build_filename(b->path, "flow.yaml", NULL);
  const char *path = host->output_path(host, name, error);
  if (!path) return error->code;
  in->folder = g_path_get_dirname(path);
  in->depth = opc_sweep_depth(in->sweep);
  in->levels = g_new0(opc_run *, in->depth + 1);
  in->failures = g_new0(opc_problems *, in->depth + 1);
  in->at = g_new0(guint, in->depth + 1);
  opc_run *trunk = in->levels[0] =
      opc_run_new(in->flow, in->registry, outer->options, &in->watch);
  choose_steps(in, trunk, 0);
  put_given(in, trunk);
  g_autofree char *folder = level_folder(in, 0);
  g_autoptr(opc_problems) problems = opc_problems_new();
  in->telling = TRUE;
  opc_run_in(trunk, outer, folder, problems);
  tell_progress(in, 0);
  return opc_problems_error(problems, error);
}

/* ---- running: a point ---- */

static int copy_file(void *data, const char *path, const char *name,
                     const struct stat *about, opc_error *error) {
  g_autofree char *target = g_build_filename(data, name, NULL);
  g_autofree char *folder = g_path_get_dirname(target);
  g_autoptr(GFile) from = g_file_new_for_path(path);
  g_autoptr(GFile) to = g_file_new_for_path(target);
  g_autoptr(GError) why = NULL;
  if (S_ISDIR(about->st_mode)) return OPC_OK;
  if (g_mkdir_with_parents(folder, 0777))
    return opc_fail(error, OPC_IO, NULL, "'%s': %s", folder, g_strerror(errno));
  if (g_file_copy(from, to, G_FILE_COPY_NONE, NULL, NULL, NULL, &why))
    return OPC_OK;
  return opc_fail(error, OPC_IO, NULL, "%s", why->message);
}

/* By where their steps come. */
static gint compare_metrics(gconstpointer a, gconstpointer b, gpointer data) {
  const opc_run *run = data;
  const opc_inner_metric *one = a, *other = b;
  guint at[2] = {0, 0};
  g_ptr_array_find(run->flow->order, opc_flow_find(run->flow, one->path),
                   &at[0]);
  g_ptr_array_find(run->flow->order, opc_flow_find(run->flow, other->path),
                   &at[1]);
  return at[0] < at[1] ? -1 : at[0] > at[1];
}

/* Make a run whole by what those it shares steps with gave. */
static void take_shared(opc_inner *in, opc_run *run, opc_problems *problems) {
  opc_error error;
  g_autoptr(GArray) own = run->metrics;
  run->metrics = g_array_new(FALSE, TRUE, sizeof(opc_inner_metric));
  for (unsigned level = 0; level < in->depth; level++) {
    const opc_run *from = in->levels[level];
    if (!from) continue;
    g_array_append_vals(run->metrics, from->metrics->data, from->metrics->len);
    opc_run_take_findings(run, from);
    opc_run_take_histories(run, from);
    for (guint i = 0; i < from->flow->steps->len; i++) {
      const opc_flow_step *step = from->flow->steps->pdata[i];
      const opc_flow_step *its = opc_flow_find(run->flow, step->name);
      if (its && !from->left_out[i])
        run->seconds[its->number] = from->seconds[i];
    }
    if (opc_walk(from->work, copy_file, run->work, &error))
      opc_problem_add(problems, error.code, NULL, "%s", error.message);
  }
  g_array_append_vals(run->metrics, own->data, own->len);
  g_array_sort_with_data(run->metrics, compare_metrics, run);
  run->total = 0;
  for (guint i = 0; i < run->flow->steps->len; i++)
    if (!isnan(run->seconds[i])) run->total += run->seconds[i];
}

/* All that is required, whichever level it is of. */
static void judge_whole(opc_run *run) {
  gboolean *left_out = run->left_out;
  run->left_out = g_new0(gboolean, run->flow->steps->len);
  opc_run_judge(run);
  g_free(run->left_out);
  run->left_out = left_out;
}

/* What is handed on must keep what its flow requires; other points are there to
   be worse. */
static void keep_run(opc_inner *in, const char *prefix,
                     opc_problems *problems) {
  opc_run *run = in->run;
  take_shared(in, run, problems);
  opc_run_take_inputs(run, in->binding->run, problems);
  judge_whole(run);
  opc_run_take_verdicts(in->binding->run, run, 0, prefix);
  opc_run_write_reports(run, TRUE, problems);
}

/* Run a point in a folder; in->run is there if it was begun. */
static void run_at(opc_inner *in, size_t point, const char *folder,
                   opc_problems *problems) {
  enter_point(in, point, problems);
  if (!problems->list->len) in->run = make_run(in, in->depth, point, problems);
  if (in->run) opc_run_in(in->run, in->binding->run, folder, problems);
}

/* The points of a run are done; what is wrong with it. */
static int end_point(opc_inner *in, size_t share, opc_problems *problems,
                     opc_error *error) {
  int code = opc_problems_code(problems);
  if (code == OPC_CANCELLED) {
    forget_stopped(in);
    return opc_fail(error, code, NULL, "stopped");
  }
  in->done += share;
  in->share = 0;
  if (share) tell_progress(in, 0);
  g_autofree char *text = opc_problems_text(problems);
  return code ? opc_fail(error, code, NULL, "%s", text) : OPC_OK;
}

int opc_inner_run_point(const opc_host *host, size_t point, int keep,
                        size_t share, opc_error *error) {
  opc_inner *in = opc_inner_of(host);
  in->share = share;
  in->telling = keep;
  g_autofree char *name = g_strdup_printf("%04zu", ++in->runs);
  g_autofree char *folder =
      keep ? g_strdup(in->folder) : g_build_filename(in->folder, name, NULL);
  g_autofree char *prefix = g_strconcat(in->binding->path, ".", NULL);
  g_autoptr(opc_problems) problems = opc_problems_new();
  run_at(in, point, folder, problems);
  if (in->run && keep && !problems->list->len)
    keep_run(in, prefix, problems);
  else if (in->run)
    opc_run_branch_close(in->run, in->run->options->keep, problems);
  return end_point(in, share, problems, error);
}

/* As a point of a sweep that failed. */
static void count_failure(opc_run *outer, int code) {
  gboolean differs = outer->failed_points && outer->points_code != code;
  outer->points_code = differs || code != OPC_LIMIT ? OPC_FAILED : code;
  outer->failed_points++;
}

int opc_inner_run_whole(const opc_host *host, size_t point, const char *name,
                        size_t share, const opc_inner_run **out,
                        opc_error *error) {
  opc_inner *in = opc_inner_of(host);
  in->share = share;
  in->telling = FALSE;
  g_autofree char *folder = g_build_filename(in->folder, name, NULL);
  g_autofree char *prefix = g_strdup_printf("%s/%s: ", in->binding->path, name);
  g_autoptr(opc_problems) problems = opc_problems_new();
  *out = NULL;
  run_at(in, point, folder, problems);
  if (!problems->list->len) keep_run(in, prefix, problems);
  if (problems->list->len) {
    if (in->run && in->run->work) opc_remove_tree(folder);
  } else {
    in->whole = (opc_inner_run){
        .folder = in->run->work,
        .seconds = in->run->total,
        .findings = in->run->findings->len + in->run->more_findings};
    *out = &in->whole;
    opc_run_add_broken(in->run, problems);
  }
  int code = end_point(in, share, problems, error);
  if (code && code != OPC_CANCELLED) count_failure(in->binding->run, code);
  return code;
}
