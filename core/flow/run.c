/* SPDX-License-Identifier: BSD-3-Clause */
#include "core/flow/run.h"

#include <errno.h>
#include <string.h>

#include "core/flow/files.h"
#include "core/flow/folder.h"
#include "core/plugin/declaration.h"

/* ---- state ---- */

static void table_free(gpointer item) {
  opc_run_table *t = item;
  g_free(t->step);
  g_free(t->file);
  opc_table_free(t->table);
  g_free(t);
}

static opc_run *run_new(opc_flow *flow, const opc_registry *registry,
                        const opc_run_options *options,
                        const opc_watch *watch) {
  opc_run *run = g_new0(opc_run, 1);
  run->flow = flow;
  run->registry = registry;
  run->watch = watch;
  run->options = options;
  run->tables = g_ptr_array_new_with_free_func(table_free);
  run->metrics = g_array_new(FALSE, TRUE, sizeof(opc_run_metric));
  run->claims = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  run->paths = g_ptr_array_new_with_free_func(g_free);
  run->inputs = g_ptr_array_new_with_free_func(g_free);
  run->seconds = g_hash_table_new_full(g_str_hash, g_str_equal, NULL, g_free);
  run->objects = g_new0(void **, MAX(flow->steps->len, 1));
  run->started = g_date_time_new_now_local();
  return run;
}

void opc_run_free(opc_run *run) {
  if (!run) return;
  g_free(run->folder);
  g_free(run->work);
  g_free(run->failure);
  g_ptr_array_free(run->tables, TRUE);
  g_array_free(run->metrics, TRUE);
  g_hash_table_destroy(run->claims);
  g_ptr_array_free(run->paths, TRUE);
  g_ptr_array_free(run->inputs, TRUE);
  g_hash_table_destroy(run->seconds);
  g_free(run->objects);
  g_date_time_unref(run->started);
  g_free(run);
}

/* ---- inputs ---- */

/* What a visit of all bindings needs. */
typedef struct summer {
  opc_run *run;
  GHashTable *seen;
  opc_problems *problems;
} summer;

static void add_input(summer *s, const char *file, const opc_place *at) {
  g_autofree char *path = g_canonicalize_filename(file, NULL);
  if (!g_hash_table_add(s->seen, g_strdup(path))) return;
  opc_error error;
  char *sum = opc_file_sha256(path, &error);
  if (!sum) {
    opc_problem_add(s->problems, error.code, at, "%s", error.message);
    return;
  }
  g_ptr_array_add(s->run->inputs, g_steal_pointer(&path));
  g_ptr_array_add(s->run->inputs, sum);
}

static void sum_files(opc_binding *b, void *data) {
  for (size_t i = 0; i < b->plugin->n_parameters; i++)
    if (b->values[i].type == OPC_FILE && b->values[i].text)
      add_input(data, b->values[i].text,
                b->origin[i] ? &b->origin[i]->at : &b->at);
}

/* The sums of all files, before any step may change one. */
static gboolean sum_inputs(opc_run *run, opc_problems *problems) {
  summer s = {run, g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL),
              problems};
  guint before = problems->list->len;
  const opc_place at = {NULL, 0, 0};
  add_input(&s, run->flow->path, &at);
  for (guint i = 0; i < run->flow->order->len; i++) {
    const opc_flow_step *step = run->flow->order->pdata[i];
    opc_binding_visit(step->binding, sum_files, &s);
  }
  g_hash_table_destroy(s.seen);
  return problems->list->len == before;
}

/* ---- steps ---- */

static void set_inputs(const opc_run *run, const opc_flow_step *step,
                       gboolean present) {
  for (guint i = 0; i < step->inputs->len; i++) {
    const opc_flow_input *input =
        &g_array_index(step->inputs, opc_flow_input, i);
    input->binding->values[input->parameter].object =
        present ? run->objects[input->from->number][input->port] : NULL;
  }
}

static void release_outputs(const opc_run *run, const opc_flow_step *step) {
  const opc_plugin *plugin = step->binding->plugin;
  void **objects = run->objects[step->number];
  for (size_t i = opc_port_count(plugin); objects && i-- > 0;)
    if (objects[i]) opc_port_at(plugin, i)->release(objects[i]);
  g_free(objects);
  run->objects[step->number] = NULL;
}

/* Later steps may point into the outputs of earlier ones. */
static void release_all(const opc_run *run) {
  for (guint i = run->flow->order->len; i-- > 0;)
    release_outputs(run, run->flow->order->pdata[i]);
}

static int check_outputs(const opc_run *run, const opc_flow_step *step,
                         opc_error *error) {
  const opc_plugin *plugin = step->binding->plugin;
  for (size_t i = 0; i < opc_port_count(plugin); i++)
    if (!run->objects[step->number][i])
      return opc_fail(error, OPC_FAILED, NULL, "gave no output '%s'",
                      opc_port_at(plugin, i)->name);
  return OPC_OK;
}

static int call_step(opc_run *run, const opc_flow_step *step,
                     opc_error *error) {
  const opc_step *operations = step->binding->plugin->operations;
  run->objects[step->number] = g_new0(void *, operations->n_outputs + 1);
  set_inputs(run, step, TRUE);
  gint64 start = g_get_monotonic_time();
  int code = operations->run(step->binding->module.self,
                             run->objects[step->number], error);
  double seconds = (double)(g_get_monotonic_time() - start) * 1e-6;
  set_inputs(run, step, FALSE);
  g_hash_table_insert(run->seconds, (char *)step->name,
                      g_memdup2(&seconds, sizeof seconds));
  if (!code && run->refusal.code) {
    *error = run->refusal;
    code = error->code;
  }
  return code ? code : check_outputs(run, step, error);
}

static gboolean run_step(opc_run *run, const opc_flow_step *step,
                         opc_problems *problems) {
  opc_error error = {0};
  int code = call_step(run, step, &error);
  if (!code) return TRUE;
  error.message[sizeof error.message - 1] = 0;
  error.parameter[sizeof error.parameter - 1] = 0;
  g_autofree char *label = opc_binding_label(step->binding);
  run->failed = step->name;
  run->failure = g_strdup(*error.message ? error.message : "gave no reason");
  opc_problem_add(problems, code,
                  opc_binding_place(step->binding, error.parameter), "%s: %s",
                  label, run->failure);
  return FALSE;
}

static gboolean run_steps(opc_run *run, opc_problems *problems) {
  const GPtrArray *order = run->flow->order;
  const opc_watch *watch = run->watch;
  for (guint i = 0; i < order->len; i++) {
    const opc_flow_step *step = order->pdata[i];
    if (watch->cancelled && watch->cancelled(watch->data)) {
      opc_problem_add(problems, OPC_CANCELLED, &step->binding->at, "stopped");
      run->failure = g_strdup("stopped");
      return FALSE;
    }
    if (watch->step) watch->step(watch->data, step->name, i + 1, order->len);
    if (!run_step(run, step, problems)) return FALSE;
  }
  return TRUE;
}

/* ---- the folder ---- */

static gboolean write_into(const opc_run *run, const char *name, char *text,
                           opc_problems *problems) {
  g_autofree char *path = g_build_filename(run->work, name, NULL);
  opc_error error;
  int code = opc_write_file(path, text, &error);
  if (code) opc_problem_add(problems, code, NULL, "%s", error.message);
  g_free(text);
  return !code;
}

static gboolean write_reports(const opc_run *run, opc_problems *problems) {
  JsonNode *metrics = opc_run_metrics_json(run);
  JsonNode *manifest = opc_run_manifest_json(run);
  gboolean good =
      write_into(run, "flow.yaml", opc_flow_resolved(run->flow), problems);
  good &= write_into(run, "metrics.json", opc_json_text(metrics), problems);
  good &= write_into(run, "manifest.json", opc_json_text(manifest), problems);
  return good;
}

/* Names that steps cannot have. */
static void reserve_names(opc_run *run) {
  static const char *const names[] = {"flow.yaml", "manifest.json",
                                      "metrics.json"};
  for (size_t i = 0; i < G_N_ELEMENTS(names); i++)
    g_hash_table_insert(run->claims, g_strdup(names[i]), g_strdup("opcflow"));
}

static gboolean open_folder(opc_run *run, const char *target,
                            opc_problems *problems) {
  opc_error error;
  int code = run->options->output
                 ? opc_folder_allowed(target, run->options->force, &error)
                 : OPC_OK;
  if (!code) run->work = opc_folder_open(target, &error);
  if (run->work) {
    reserve_names(run);
    return TRUE;
  }
  opc_problem_add(problems, error.code, NULL, "%s", error.message);
  return FALSE;
}

/* What a run that failed has written is kept as TARGET.failed; that is nothing
   if only the reserved names are claimed. What cannot get its name keeps the
   one it has. */
static void close_folder(opc_run *run, const char *target,
                         opc_problems *problems) {
  gboolean stopped = opc_problems_code(problems) == OPC_CANCELLED;
  gboolean failed = problems->list->len > 0;
  if (stopped || (failed && g_hash_table_size(run->claims) <= 3)) {
    opc_remove_tree(run->work);
    return;
  }
  failed |= !write_reports(run, problems);
  g_autofree char *name =
      failed ? g_strconcat(target, ".failed", NULL) : g_strdup(target);
  gboolean given = run->options->output && !failed;
  opc_error error;
  run->folder = opc_folder_close(run->work, name, given && run->options->force,
                                 !given, &error);
  if (run->folder) return;
  opc_problem_add(problems, error.code, NULL, "%s", error.message);
  run->folder = g_strdup(run->work);
}

static char *target_folder(const opc_run *run) {
  const char *output = run->options->output;
  if (!output) return g_build_filename("runs", run->flow->name, NULL);
  char *target = g_strdup(output);
  for (size_t n = strlen(target); n > 1 && target[n - 1] == '/';)
    target[--n] = 0;
  return target;
}

opc_run *opc_run_flow(opc_flow *flow, const opc_registry *registry,
                      const opc_run_options *options, const opc_watch *watch,
                      opc_problems *problems) {
  opc_run *run = run_new(flow, registry, options, watch);
  gint64 start = g_get_monotonic_time();
  g_autofree char *target = target_folder(run);
  if (opc_flow_create(flow, &opc_run_sink, run, problems) &&
      sum_inputs(run, problems) && open_folder(run, target, problems)) {
    run_steps(run, problems);
    release_all(run);
    run->total = (double)(g_get_monotonic_time() - start) * 1e-6;
    close_folder(run, target, problems);
  }
  return run;
}
