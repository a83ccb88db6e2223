/* SPDX-License-Identifier: BSD-3-Clause */
/* Reuses steps whose results are in the store. Files and messages of a reused
   step are replayed. The outputs are provided only if a step that runs needs
   them: loaded from the store, or computed by running the reused step again. */
#include <glib/gstdio.h>
#include <unistd.h>

#include <store/files.h>
#include <store/pack.h>
#include "core/binding/lookup.h"
#include "core/run/call.h"
#include "core/run/pieces.h"
#include "core/run/result.h"
#include "core/run/reuse.h"

/* ---- histories and messages ---- */

static void store_warn(opc_run *run) {
  opc_store *store = run->options->store;
  g_autofree char *text = store ? opc_store_complaint(store) : NULL;
  if (text) run->listener.watch.log(run, "store", OPC_LOG_WARNING, text);
}

/* Replace *run by the run that contains *run, and prefix the path with the name
   of the step that runs the inner flow. */
static void run_go_up(opc_run **run, char **path) {
  *run = (*run)->main;
  if (!*run || !(*run)->at) return;
  char *longer = g_strconcat((*run)->at->name, ".", *path, NULL);
  g_free(*path);
  *path = longer;
}

/* Record in the run, and in all containing runs, whether a step was reused. */
static void reuse_record(opc_run *run, const opc_flow_step *step,
                         gboolean reused, const char *reason) {
  char *path = g_strdup(step->name);
  for (opc_run *to = run; to; run_go_up(&to, &path)) {
    const opc_history h = {to->listener.point,
                           path,
                           reused,
                           run->kept.keys[step->number].sum,
                           (char *)reason,
                           run->out.seconds[step->number]};
    opc_histories_add(&to->out.histories, &h);
  }
  g_free(path);
}

void opc_reuse_report(const opc_run *run) {
  const GPtrArray *list = run->out.histories.list;
  for (guint i = 0; i < list->len && !run->main; i++) {
    const opc_history *h = list->pdata[i];
    if (h->reused)
      run->listener.watch.log((void *)run, h->path, OPC_LOG_INFO, "reused");
  }
}

/* Record that a reused step ran again for its outputs, needed by `whom`. */
static void rerun_record(opc_run *run, const opc_flow_step *step,
                         const char *whom) {
  char *path = g_strdup(step->name);
  g_autofree char *why = g_strdup_printf("step '%s' requires the output", whom);
  if (!run->main) {
    g_autofree char *text = g_strconcat("ran again: ", why, NULL);
    run->listener.watch.log(run, step->name, OPC_LOG_INFO, text);
  }
  for (opc_run *to = run; to; run_go_up(&to, &path))
    opc_histories_rerun(&to->out.histories, path, why,
                        run->out.seconds[step->number]);
  g_free(path);
}

/* ---- reasons ---- */

/* Return the key in the store for the facts of a step, by step name and plugin
   (g_free). */
static char *facts_name(const opc_flow_step *step) {
  return g_strdup_printf("%s %s", step->name, step->binding->plugin->id);
}

/* Return why a step ran (g_free). */
static char *find_reason(opc_store *store, const opc_flow_step *step,
                         const opc_key *key) {
  if (!key->facts) return g_strdup(key->why);
  if (step->binding->inner)
    return g_strdup("runs an inner flow, whose steps are reused individually");
  g_autofree char *name = facts_name(step);
  return opc_facts_reason(store, name, key->facts, opc_key_difference,
                          step->name);
}

static void keep_facts(opc_store *store, const opc_flow_step *step,
                       GVariant *facts) {
  g_autofree char *name = facts_name(step);
  opc_facts_keep(store, name, facts);
}

/* ---- keys ---- */

/* Return the step of the same name in the run whose outputs this run uses
   (`kept.base`); NULL without such a step. */
static const opc_flow_step *step_of_base(const opc_run *run,
                                         const opc_flow_step *step) {
  return run->kept.base ? opc_flow_find(run->kept.base->flow, step->name)
                        : NULL;
}

/* Set the keys of those steps of an inner flow that inputs of the calling step
   replace (OPC_INNER_STEP). The key is that of the step of the outer flow that
   provides the input. */
static void take_given(opc_run *run) {
  const opc_flow_step *outer = run->main ? run->main->at : NULL;
  for (guint i = 0; outer && i < outer->inputs->len; i++) {
    const opc_flow_input *in = &g_array_index(outer->inputs, opc_flow_input, i);
    const opc_plugin *plugin = in->binding->plugin;
    const opc_flow_step *step =
        opc_flow_find(run->flow, plugin->parameters[in->parameter].name);
    const opc_key *known = &run->main->kept.keys[in->from->number];
    if (in->binding != outer->binding || !step || !run->objects[step->number])
      continue;
    opc_key *key = &run->kept.keys[step->number];
    if (known->sum)
      key->sum = g_strdup_printf("%s %zu", known->sum, in->port);
    else
      key->why = g_strdup(known->why);
  }
}

void opc_reuse_begin(opc_run *run) {
  if (!run->options->store) return;
  if (!run->kept.base) take_given(run);
  for (guint i = 0; run->kept.base && i < run->flow->steps->len; i++) {
    const opc_flow_step *its = step_of_base(run, run->flow->steps->pdata[i]);
    if (!run->left_out[i] || !its) continue;
    const opc_key *known = &run->kept.base->kept.keys[its->number];
    run->kept.keys[i].sum = g_strdup(known->sum);
    run->kept.keys[i].why = g_strdup(known->why);
  }
  opc_flow_keys(run->flow, run->options->store, run->kept.keys);
}

static char *name_of(const opc_key *key, const char *ending) {
  return g_strconcat(key->sum, ending, NULL);
}

/* ---- loading and storing results ---- */

/* Return the stored result of a step, and a descriptor of its files; NULL if
   none is stored. A step with an inner flow always runs; only the steps of the
   inner flow are reused. */
static GVariant *find_result(const opc_run *run, const opc_flow_step *step,
                             int *contents) {
  const opc_key *key = &run->kept.keys[step->number];
  if (!key->sum || step->binding->inner) return NULL;
  g_autofree char *name = name_of(key, ".result");
  opc_store *store = run->options->store;
  opc_store_join(store, key->sum); /* until opc_reuse_keep */
  GVariant *result = opc_store_get_files(
      store, name, G_VARIANT_TYPE(opc_result_type), contents);
  if (result) opc_store_leave(store, key->sum);
  return result;
}

gboolean opc_reuse_take(opc_run *run, const opc_flow_step *step,
                        opc_problems *problems) {
  const ranks_group *ranks = opc_run_ranks(run);
  opc_error error = {0};
  int contents = -1, code = OPC_OK;
  g_autoptr(GVariant) result =
      opc_run_is_first(run) ? find_result(run, step, &contents) : NULL;
  char found = result != NULL;
  store_warn(run);
  gboolean lost = ranks && ranks->spread(&found, 1, 0, &error);
  if (result && !lost)
    code = opc_result_publish(run, step, result, contents, &error);
  if (contents >= 0) close(contents);
  if (lost)
    return opc_problem_add(problems, error.code, NULL, "%s", error.message);
  if (!found || !result) return found;
  if (code)
    opc_binding_fail(step->binding, TRUE, code, &error, problems);
  else
    reuse_record(run, step, TRUE, NULL);
  return TRUE;
}

/* Return a new temporary folder inside the run's folder (g_free). */
static char *open_scratch(const opc_run *run) {
  g_autofree char *name =
      g_build_filename(run->written.work, ".opcflow-XXXXXX", NULL);
  return g_mkdtemp(name) ? g_steal_pointer(&name) : NULL;
}

static void close_scratch(char *folder) {
  if (folder) opc_remove_tree(folder);
  g_free(folder);
}

static gboolean keep_outputs(opc_run *run, const opc_flow_step *step) {
  const opc_binding *b = step->binding;
  const opc_step *functions = b->plugin->functions;
  opc_store *store = run->options->store;
  if (!functions->save) return !functions->n_outputs;
  char *folder = open_scratch(run);
  opc_error error = {0};
  opc_call_set_inputs(run, step, TRUE);
  const char *before = opc_binding_enter(b);
  int code = folder
                 ? functions->save(b->module.self, run->objects[step->number],
                                   folder, &error)
                 : OPC_IO;
  opc_binding_leave(before);
  opc_call_set_inputs(run, step, FALSE);
  GVariant *all = code ? NULL : opc_files_list(folder);
  g_autofree char *name = name_of(&run->kept.keys[step->number], ".outputs");
  gboolean kept = all && opc_store_put_files(store, name, all, all, folder);
  close_scratch(folder);
  return kept;
}

void opc_reuse_keep(opc_run *run, const opc_flow_step *step, guint tables) {
  opc_store *store = run->options->store;
  const opc_key *key = &run->kept.keys[step->number];
  if (!store || !opc_run_is_first(run)) return;
  g_autofree char *reason = find_reason(store, step, key);
  reuse_record(run, step, FALSE, reason);
  GVariant *result =
      key->sum && !step->binding->inner && opc_key_is_unchanged(key, store)
          ? opc_result_new(run, step, tables)
          : NULL;
  if (result) {
    g_autofree char *name = name_of(key, ".result");
    gboolean outputs = keep_outputs(run, step);
    g_autoptr(GVariant) files = g_variant_get_child_value(result, 5);
    gboolean kept =
        opc_store_put_files(store, name, result, files, run->written.work);
    if (kept) keep_facts(store, step, key->facts);
    /* Another process that runs this step still needs its pieces. */
    if (kept && outputs && opc_store_claim(store, key->sum))
      opc_pieces_drop(run);
  }
  if (key->sum) opc_store_leave(store, key->sum);
  store_warn(run);
}

/* ---- outputs of steps that did not run ---- */

/* Load the outputs of a step from the store. */
static gboolean step_restore(opc_run *run, const opc_flow_step *step) {
  const opc_binding *b = step->binding;
  const opc_step *functions = b->plugin->functions;
  if (!functions->restore || !run->kept.keys[step->number].sum) return FALSE;
  g_autofree char *name = name_of(&run->kept.keys[step->number], ".outputs");
  int contents;
  g_autoptr(GVariant) kept =
      opc_store_get_files(run->options->store, name, OPC_FILES_TYPE, &contents);
  char *folder = kept ? open_scratch(run) : NULL;
  opc_error error = {0};
  int code = folder ? opc_files_unpack(kept, contents, folder, &error) : OPC_IO;
  if (contents >= 0) close(contents);
  if (!code) {
    run->objects[step->number] = g_new0(void *, functions->n_outputs + 1);
    opc_call_set_inputs(run, step, TRUE);
    const char *before = opc_binding_enter(b);
    code = functions->restore(b->module.self, folder,
                              run->objects[step->number], &error);
    opc_binding_leave(before);
    opc_call_set_inputs(run, step, FALSE);
    if (!code) code = opc_call_check(run, step, &error);
    if (code) opc_run_release(run, step);
  }
  close_scratch(folder);
  store_warn(run);
  return !code;
}

/* Run a step again to make the outputs, without messages, in a temporary
   folder. */
static gboolean run_again(opc_run *run, const opc_flow_step *step,
                          const char *whom, opc_problems *problems) {
  char *work = run->written.work;
  GHashTable *claims = run->written.claims;
  run->written.work = open_scratch(run);
  run->written.claims =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  run->listener.silent = TRUE;
  run->at = step;
  gboolean good = opc_call_step(run, step, problems);
  run->at = NULL;
  run->listener.silent = FALSE;
  close_scratch(run->written.work);
  g_hash_table_destroy(run->written.claims);
  run->written.work = work;
  run->written.claims = claims;
  rerun_record(run, step, whom);
  return good;
}

/* Return whether `yes` is TRUE in all ranks. *any receives whether `yes` is
   TRUE in at least one rank. */
static gboolean do_all(const ranks_group *ranks, gboolean yes, gboolean *any) {
  gint64 least[2] = {yes, -yes};
  opc_error stopped;
  *any = yes;
  if (!ranks || ranks->least(least, 2, &stopped)) return yes;
  *any = least[1] < 0;
  return least[0] > 0;
}

/* Load the outputs from the store. Returns FALSE unless all ranks succeed; all
   ranks must then run the step together. */
static gboolean restore_all(opc_run *run, const opc_flow_step *step) {
  gboolean any, here = step_restore(run, step);
  gboolean all = do_all(opc_run_ranks(run), here, &any);
  if (here && !all) opc_run_release(run, step);
  return all;
}

static gboolean step_provide(opc_run *run, const opc_flow_step *step,
                             const char *whom, opc_problems *problems) {
  if (run->objects[step->number]) return TRUE;
  for (guint i = 0; i < step->inputs->len; i++)
    if (!opc_reuse_provide(run,
                           g_array_index(step->inputs, opc_flow_input, i).from,
                           step->name, problems))
      return FALSE;
  return restore_all(run, step) || run_again(run, step, whom, problems);
}

gboolean opc_reuse_provide(opc_run *run, const opc_flow_step *step,
                           const char *whom, opc_problems *problems) {
  guint n = step->number;
  const opc_flow_step *its = step_of_base(run, step);
  if (run->left_out[n] && its) {
    gboolean good = opc_reuse_provide(run->kept.base, its, whom, problems);
    run->objects[n] = run->kept.base->objects[its->number];
    return good;
  }
  /* If only some ranks hold the outputs, the other ranks proceed alone. */
  gboolean any, before = run->apart;
  if (do_all(opc_run_ranks(run), run->objects[n] != NULL, &any)) return TRUE;
  run->apart = before || any;
  gboolean good = step_provide(run, step, whom, problems);
  run->apart = before;
  return good;
}
