/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs the steps of a flow one after another, from the sums of what they read
   to the folder with what they gave. */
#include "core/run/run.h"

#include <errno.h>
#include <guard/guard.h>
#include <math.h>
#include <string.h>

#include <store/files.h>
#include "core/binding/inner.h"
#include "core/plugin/declaration.h"
#include "core/report/contents.h"

/* ---- state ---- */

opc_run *opc_run_new(opc_flow *flow, opc_registry *registry,
                     const opc_run_options *options, const opc_watch *watch) {
  opc_run *run = g_new0(opc_run, 1);
  guint n = flow->steps->len;
  run->flow = flow;
  run->registry = registry;
  opc_run_listen(run, watch);
  run->verdicts = opc_verdicts_new();
  run->options = options;
  run->like = opc_run_publisher;
  run->like.data = run;
  run->tables = g_ptr_array_new_with_free_func((GDestroyNotify)opc_table_free);
  run->metrics = g_array_new(FALSE, TRUE, sizeof(opc_inner_metric));
  run->claims = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  run->outputs = opc_flow_outputs(flow, NULL);
  run->given = g_ptr_array_new_with_free_func(g_free);
  run->pieces = g_ptr_array_new_with_free_func(g_free);
  run->inputs = g_ptr_array_new_with_free_func(g_free);
  run->summed = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  run->seconds = g_new(double, n);
  for (guint i = 0; i < n; i++) run->seconds[i] = NAN;
  run->objects = g_new0(void **, n);
  run->left_out = g_new0(gboolean, n);
  run->keys = g_new0(opc_key, n);
  run->histories = opc_histories_new();
  run->started = g_date_time_new_now_local();
  return run;
}

void opc_run_release(opc_run *run, const opc_flow_step *step) {
  const opc_plugin *plugin = step->binding->plugin;
  void **objects = run->objects[step->number];
  const char *before = guard_enter(plugin->id);
  for (size_t i = opc_port_count(plugin); objects && i-- > 0;)
    if (objects[i]) opc_port_at(plugin, i)->release(objects[i]);
  guard_leave(before);
  g_free(objects);
  run->objects[step->number] = NULL;
}

/* Later steps may point into the outputs of earlier ones. */
static void release_all(opc_run *run) {
  for (guint i = run->flow->order->len; i-- > 0;) {
    const opc_flow_step *step = run->flow->order->pdata[i];
    if (!run->left_out[step->number]) opc_run_release(run, step);
  }
}

void opc_run_free(opc_run *run) {
  if (!run) return;
  release_all(run);
  opc_run_listen_end(run);
  for (guint i = 0; i < run->flow->steps->len; i++)
    opc_key_clear(&run->keys[i]);
  g_free(run->keys);
  g_ptr_array_free(run->histories, TRUE);
  g_ptr_array_free(run->verdicts, TRUE);
  g_free(run->folder);
  g_free(run->work);
  g_free(run->failure);
  g_ptr_array_free(run->tables, TRUE);
  g_array_free(run->metrics, TRUE);
  g_hash_table_destroy(run->claims);
  g_hash_table_destroy(run->outputs);
  g_ptr_array_free(run->given, TRUE);
  g_ptr_array_free(run->pieces, TRUE);
  g_ptr_array_free(run->inputs, TRUE);
  g_hash_table_destroy(run->summed);
  g_free(run->seconds);
  g_free(run->objects);
  g_free(run->left_out);
  opc_table_free(run->points);
  g_date_time_unref(run->started);
  opc_flow_free(run->own);
  g_free(run);
}

/* ---- inputs ---- */

/* That of any of its instances: all look at the same signals. */
static const opc_context *run_context(const opc_run *run) {
  const opc_flow_step *first = run->flow->order->pdata[0];
  return first->binding->host ? first->binding->host->context : NULL;
}

static void add_input(opc_run *run, const char *file, const opc_place *at,
                      opc_problems *problems) {
  g_autofree char *path = g_canonicalize_filename(file, NULL);
  if (g_hash_table_contains(run->summed, path)) return;
  opc_error error;
  char *sum =
      run->known ? g_strdup(g_hash_table_lookup(run->known, path)) : NULL;
  if (!sum)
    sum = opc_store_sum(run->options->store, path, run_context(run), &error);
  g_hash_table_insert(run->summed, g_strdup(path), sum);
  if (!sum) {
    opc_problem_add(problems, error.code, at, "%s", error.message);
    return;
  }
  g_ptr_array_add(run->inputs, g_steal_pointer(&path));
  g_ptr_array_add(run->inputs, sum);
}

/* Add the sums of all files that `flow` reads, before any step may change one.
 */
static gboolean sum_inputs(opc_run *run, const opc_flow *flow,
                           opc_problems *problems) {
  guint before = problems->list->len;
  const GPtrArray *files = flow->recipe->sources;
  g_autoptr(GPtrArray) all = opc_flow_bindings(flow);
  for (guint i = 0; i < files->len; i++)
    add_input(run, ((const opc_source *)files->pdata[i])->name, NULL, problems);
  for (guint k = 0; k < all->len; k++) {
    const opc_binding *b = all->pdata[k];
    for (size_t i = 0; i < b->plugin->n_parameters; i++)
      if (b->plugin->parameters[i].type == OPC_FILE && b->values[i].field.text)
        add_input(run, b->values[i].field.text, opc_binding_origin(b, i),
                  problems);
    if (b->inner) sum_inputs(run, opc_inner_flow(b->inner), problems);
  }
  return problems->list->len == before;
}

void opc_run_take_inputs(opc_run *run, const opc_run *from,
                         opc_problems *problems) {
  run->known = from->summed;
  sum_inputs(run, run->flow, problems);
}

/* ---- steps ---- */

void opc_run_set_inputs(const opc_run *run, const opc_flow_step *step,
                        gboolean present) {
  for (guint i = 0; i < step->inputs->len; i++) {
    const opc_flow_input *input =
        &g_array_index(step->inputs, opc_flow_input, i);
    opc_binding_set(
        input->binding, input->parameter,
        present ? run->objects[input->from->number][input->port] : NULL);
  }
}

/* Each kind of data brings its own check. */
int opc_run_check(const opc_run *run, const opc_flow_step *step,
                  opc_error *error) {
  const opc_plugin *plugin = step->binding->plugin;
  for (size_t i = 0; i < opc_port_count(plugin); i++) {
    const opc_port *port = opc_port_at(plugin, i);
    const void *object = run->objects[step->number][i];
    opc_error fault = {0};
    if (!object)
      return opc_fail(error, OPC_FAILED, NULL, "gave no output '%s'",
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

int opc_run_call(opc_run *run, const opc_flow_step *step, opc_error *error) {
  const opc_binding *b = step->binding;
  const opc_step *functions = b->plugin->functions;
  void **objects = g_new0(void *, functions->n_outputs + 1);
  run->objects[step->number] = objects;
  g_ptr_array_set_size(run->pieces, 0);
  opc_run_set_inputs(run, step, TRUE);
  gint64 start = g_get_monotonic_time();
  const char *before = opc_binding_enter(b);
  int code = functions->run(b->module.self, objects, error);
  opc_binding_leave(before);
  if (b->inner) opc_inner_end(b->inner);
  run->seconds[step->number] = (double)(g_get_monotonic_time() - start) * 1e-6;
  opc_run_set_inputs(run, step, FALSE);
  if (!code && run->refusal.code) {
    *error = run->refusal;
    code = error->code;
  }
  return code ? code : opc_run_check(run, step, error);
}

/* What a step could not write to its end is not left as if it were whole. */
static void remove_given(const opc_run *run) {
  for (guint i = 0; i < run->given->len; i++)
    (void)remove(run->given->pdata[i]);
}

gboolean opc_run_step(opc_run *run, const opc_flow_step *step,
                      opc_problems *problems) {
  const opc_binding *b = step->binding;
  opc_error error = {0};
  opc_forecast wanted;
  g_ptr_array_set_size(run->given, 0);
  int code = opc_run_ask(run, step, &wanted, &error);
  if (!code) code = opc_run_call(run, step, &error);
  if (!code) return TRUE;
  if (code == OPC_IO) remove_given(run);
  /* Only the user stops a run. */
  if (code == OPC_CANCELLED && !opc_cancelled(b->host->context))
    code = OPC_FAILED;
  opc_binding_fail(b, TRUE, code, &error, problems);
  run->failure = g_strdup(error.message);
  return FALSE;
}

/* ---- ranks ---- */

/* A flow inside of a step is each rank's own. */
const ranks_group *opc_run_ranks(const opc_run *run) {
  for (const opc_run *r = run; r; r = r->main)
    if (r->apart || (r->main && r->main->at)) return NULL;
  return run->options->ranks;
}

gboolean opc_run_is_first(const opc_run *run) {
  return !run->options->ranks || !run->options->ranks->rank;
}

/* Of each step (g_free): whether every rank runs it, as it shares its pieces
   out or gives something to one that does. */
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

/* Whether all may begin: same bits are to be had only from the same files,
   builds and processors. */
static gboolean are_alike(opc_run *run, opc_problems *problems) {
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

/* ---- the folder ---- */

gboolean opc_run_write(const opc_run *run, const char *name, char *text,
                       opc_problems *problems) {
  g_autofree char *path = g_build_filename(run->work, name, NULL);
  opc_error error;
  int code = opc_write_file(path, text, &error);
  if (code) opc_problem_add(problems, code, NULL, "%s", error.message);
  g_free(text);
  return !code;
}

/* The files of the folder, which are all there. */
static gboolean list_files(const opc_run *run, JsonNode *manifest,
                           opc_problems *problems) {
  opc_error error;
  JsonArray *files = opc_contents_json(run->work, &error);
  if (!files)
    return opc_problem_add(problems, error.code, NULL, "%s", error.message);
  json_object_set_array_member(json_node_get_object(manifest), "files", files);
  return TRUE;
}

gboolean opc_run_write_reports(const opc_run *run, gboolean last,
                               opc_problems *problems) {
  char *metrics = opc_run_metrics_text(run);
  JsonNode *manifest = opc_run_manifest_json(run);
  char *flow = opc_flow_resolved(run->flow, run->sweep);
  gboolean good = opc_run_write(run, "flow.yaml", flow, problems);
  good &= opc_run_write(run, "metrics.json", metrics, problems);
  if (last) good &= list_files(run, manifest, problems);
  good &=
      opc_run_write(run, "manifest.json", opc_json_text(manifest), problems);
  return good;
}

static void reserve_names(opc_run *run) {
  for (size_t i = 0; i < OPC_RESERVED; i++)
    g_hash_table_insert(run->claims, g_strdup(opc_reserved[i]),
                        g_strdup("opcflow"));
}

/* What other ranks than the first one write goes nowhere. */
static gboolean open_scratch(opc_run *run, opc_problems *problems) {
  g_autoptr(GError) fault = NULL;
  run->work = g_dir_make_tmp("opcflow-XXXXXX", &fault);
  reserve_names(run);
  return run->work ||
         opc_problem_add(problems, OPC_IO, NULL, "%s", fault->message);
}

static gboolean open_folder(opc_run *run, const char *target,
                            opc_problems *problems) {
  opc_error error;
  if (!opc_run_is_first(run)) return open_scratch(run, problems);
  gboolean given = run->options->output != NULL;
  run->slot = opc_folder_open(target, given, &error);
  int code = !run->slot ? error.code
             : given ? opc_folder_allowed(target, run->options->force, &error)
                     : OPC_OK;
  if (code) return opc_problem_add(problems, code, NULL, "%s", error.message);
  g_autofree char *failed = g_strconcat(target, ".failed", NULL);
  run->work = g_strdup(run->slot->work);
  guard_folder(run->work, failed, run->slot->lock);
  run->guarded = TRUE;
  reserve_names(run);
  return TRUE;
}

/* Before a step that may crash: what the folder says if it does. An empty
   folder stays so, as nothing is kept of it. */
static void prepare_for_crash(opc_run *run, const opc_flow_step *step) {
  if (!run->guarded || g_hash_table_size(run->claims) <= OPC_RESERVED) return;
  g_autoptr(opc_problems) problems = opc_problems_new();
  run->failure = g_strdup_printf("ended while step '%s' ran", step->name);
  opc_run_write_reports(run, FALSE, problems);
  g_clear_pointer(&run->failure, g_free);
}

/* Let it run with what it takes, or take what it gave before. */
static gboolean do_step(opc_run *run, const opc_flow_step *step,
                        opc_problems *problems) {
  if (opc_reuse_take(run, step, problems)) return !problems->list->len;
  if (problems->list->len) return FALSE;
  for (guint i = 0; i < step->inputs->len; i++)
    if (!opc_run_provide(run,
                         g_array_index(step->inputs, opc_flow_input, i).from,
                         step->name, problems))
      return FALSE;
  guint tables = run->tables->len;
  prepare_for_crash(run, step);
  opc_result_begin(run);
  run->at = step;
  gboolean good = opc_run_step(run, step, problems);
  run->at = NULL;
  if (good) opc_reuse_keep(run, step, tables);
  return good;
}

/* The same where several ranks run the flow: of what they do not share, the
   first one does all. */
static gboolean do_step_together(opc_run *run, const opc_flow_step *step,
                                 gboolean shared, opc_problems *problems) {
  const ranks_group *ranks = opc_run_ranks(run);
  if (!ranks) return do_step(run, step, problems);
  run->apart = !shared;
  if (shared || opc_run_is_first(run)) do_step(run, step, problems);
  run->apart = FALSE;
  return opc_ranks_agree(ranks, step->name, problems);
}

static gboolean run_steps(opc_run *run, opc_problems *problems) {
  g_autofree gboolean *shared = find_shared(run);
  if (!are_alike(run, problems)) return FALSE;
  opc_reuse_begin(run);
  const GPtrArray *order = run->flow->order;
  for (guint i = 0; i < order->len; i++) {
    const opc_flow_step *step = order->pdata[i];
    if (run->left_out[step->number]) continue;
    if (opc_cancelled(step->binding->host->context)) {
      run->failure = g_strdup("stopped");
      return opc_problem_add(problems, OPC_CANCELLED, &step->binding->at,
                             "stopped");
    }
    run->watch.step(run, step->name, i + 1, order->len);
    if (!do_step_together(run, step, shared[step->number], problems))
      return FALSE;
  }
  return TRUE;
}

void opc_run_in(opc_run *run, opc_run *main_run, const char *path,
                opc_problems *problems) {
  gboolean good = opc_flow_create(run->flow, run->left_out, &run->watch,
                                  &run->like, problems) &&
                  sum_inputs(main_run, run->flow, problems) &&
                  (!g_mkdir_with_parents(path, 0777) ||
                   opc_problem_add(problems, OPC_IO, NULL, "'%s': %s", path,
                                   g_strerror(errno)));
  run->main = main_run;
  if (good) {
    run->work = g_strdup(path);
    reserve_names(run);
  }
  run_steps(run, problems);
}

/* What a run that failed has written is kept as TARGET.failed; that is nothing
   if only the reserved names are claimed. What cannot get its name keeps the
   one it has. */
static void close_folder(opc_run *run, const char *target,
                         opc_problems *problems) {
  guard_folder(NULL, NULL, NULL);
  if (!opc_run_is_first(run)) {
    if (run->work) opc_remove_tree(run->work);
    return;
  }
  gboolean stopped = opc_problems_code(problems) == OPC_CANCELLED;
  gboolean failed = problems->list->len > 0;
  if (stopped || (failed && g_hash_table_size(run->claims) <= OPC_RESERVED))
    return;
  opc_error error;
  failed |= !opc_run_write_reports(run, TRUE, problems);
  if (opc_sync_tree(run->work, &error))
    failed = !opc_problem_add(problems, error.code, NULL, "%s", error.message);
  g_autofree char *name =
      failed ? g_strconcat(target, ".failed", NULL) : g_strdup(target);
  gboolean given = run->options->output && !failed;
  int code = opc_folder_close(run->slot, name, given && run->options->force,
                              !given, &run->folder, &error);
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
  opc_run *run = opc_run_new(flow, registry, options, watch);
  gint64 start = g_get_monotonic_time();
  g_autofree char *target = target_of(run);
  if (choice->sweep->axes->len) run->sweep = choice->sweep;
  if (run->sweep) opc_run_find_swept(flow, run->sweep, run->left_out);
  if (opc_flow_create(flow, run->left_out, &run->watch, &run->like, problems) &&
      sum_inputs(run, flow, problems))
    open_folder(run, target, problems);
  if (run_steps(run, problems) && run->sweep)
    opc_run_points(run, choice, problems);
  if (!problems->list->len) opc_run_judge(run);
  release_all(run);
  run->total = (double)(g_get_monotonic_time() - start) * 1e-6;
  if (run->work) close_folder(run, target, problems);
  g_clear_pointer(&run->slot, opc_folder_free);
  return run;
}
