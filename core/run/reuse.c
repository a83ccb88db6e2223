/* SPDX-License-Identifier: BSD-3-Clause */
/* Steps whose results are in the store do not run. What they wrote and said is
   there again; their outputs come to be when a step that runs wants them: from
   the store, or by running them after all. */
#include <errno.h>
#include <glib/gstdio.h>
#include <string.h>

#include <store/files.h>
#include "core/run/run.h"

/* ---- telling ---- */

static void history_free(gpointer item) {
  opc_history *h = item;
  g_free(h->path);
  g_free(h->key);
  g_free(h->reason);
  g_free(h);
}

GPtrArray *opc_histories_new(void) {
  return g_ptr_array_new_with_free_func(history_free);
}

void opc_run_take_histories(opc_run *run, const opc_run *from) {
  run->steps_done += from->steps_done;
  run->steps_reused += from->steps_reused;
  for (guint i = 0; i < from->histories->len; i++) {
    opc_history *h = g_memdup2(from->histories->pdata[i], sizeof *h);
    h->path = g_strdup(h->path);
    h->key = g_strdup(h->key);
    h->reason = g_strdup(h->reason);
    if (run->histories->len < OPC_MOST_HISTORIES)
      g_ptr_array_insert(run->histories, (gint)i, h);
    else
      history_free(h);
  }
}

static void tell_complaint(opc_run *run) {
  opc_store *store = run->options->store;
  g_autofree char *text = store ? opc_store_complaint(store) : NULL;
  if (text) run->watch.log(run, "store", OPC_LOG_WARNING, text);
}

/* Behind the name of the step whose flow it is in, if it is in one. */
static void climb(opc_run **run, char **path) {
  *run = (*run)->main;
  if (!*run || !(*run)->at) return;
  char *longer = g_strconcat((*run)->at->name, ".", *path, NULL);
  g_free(*path);
  *path = longer;
}

/* To the run, and to all that it is a part of. */
static void tell(opc_run *run, const opc_flow_step *step, gboolean reused,
                 const char *reason) {
  char *path = g_strdup(step->name);
  for (opc_run *to = run; to; climb(&to, &path)) {
    to->steps_done++;
    to->steps_reused += reused;
    if (to->histories->len >= OPC_MOST_HISTORIES) continue;
    opc_history *h = g_new(opc_history, 1);
    *h = (opc_history){to->point,        g_strdup(path),
                       reused,           g_strdup(run->keys[step->number].sum),
                       g_strdup(reason), run->seconds[step->number]};
    g_ptr_array_add(to->histories, h);
  }
  g_free(path);
}

/* What was reused has run after all. */
static void tell_again(opc_run *run, const opc_flow_step *step,
                       const char *whom) {
  char *path = g_strdup(step->name);
  g_autofree char *why =
      g_strdup_printf("its output was wanted by step '%s'", whom);
  if (!run->main) {
    g_autofree char *text = g_strconcat("ran after all: ", why, NULL);
    run->watch.log(run, step->name, OPC_LOG_INFO, text);
  }
  for (opc_run *to = run; to; climb(&to, &path)) {
    guint i = to->histories->len;
    opc_history *h = NULL;
    to->steps_reused--;
    while (i-- > 0 && !h) {
      h = to->histories->pdata[i];
      if (strcmp(h->path, path) || !h->reused) h = NULL;
    }
    if (!h) continue;
    h->reused = FALSE;
    h->reason = g_strdup(why);
    h->seconds = run->seconds[step->number];
  }
  g_free(path);
}

/* ---- why ---- */

/* What steps of a name and plugin depended on the last times. */
enum { MOST_EARLIER = 32 };
#define EARLIER_TYPE G_VARIANT_TYPE("aa(ysss)")

static char *earlier_key(const opc_flow_step *step) {
  g_autofree char *name =
      g_strdup_printf("%s %s", step->name, step->binding->plugin->id);
  g_autofree char *sum =
      g_compute_checksum_for_string(G_CHECKSUM_SHA256, name, -1);
  return g_strconcat(sum, ".facts", NULL);
}

/* Against the one that is most like it. */
static char *find_reason(opc_store *store, const opc_flow_step *step,
                         GVariant *facts) {
  g_autofree char *key = earlier_key(step);
  g_autoptr(GVariant) all = opc_store_get(store, key, EARLIER_TYPE);
  char *best = NULL;
  guint least = G_MAXUINT;
  for (gsize i = 0; all && i < g_variant_n_children(all); i++) {
    g_autoptr(GVariant) before = g_variant_get_child_value(all, i);
    guint count;
    char *text = opc_facts_difference(step->name, before, facts, &count);
    if (!count) {
      g_free(text);
      text = g_strdup("its result is no longer kept");
    }
    if (count < least) {
      g_free(best);
      best = g_steal_pointer(&text);
      least = count;
    }
    g_free(text);
  }
  return best ? best : g_strdup("not seen before");
}

static void keep_facts(opc_store *store, const opc_flow_step *step,
                       GVariant *facts) {
  g_autofree char *key = earlier_key(step);
  g_autoptr(GVariant) all = opc_store_get(store, key, EARLIER_TYPE);
  GVariantBuilder out;
  g_variant_builder_init(&out, EARLIER_TYPE);
  g_variant_builder_add_value(&out, facts);
  gsize n = all ? g_variant_n_children(all) : 0, kept = 1;
  for (gsize i = 0; i < n && kept < MOST_EARLIER; i++) {
    g_autoptr(GVariant) one = g_variant_get_child_value(all, i);
    if (g_variant_equal(one, facts)) continue;
    g_variant_builder_add_value(&out, one);
    kept++;
  }
  (void)opc_store_put(store, key, g_variant_builder_end(&out));
}

/* ---- keys ---- */

/* The same step of the run that this one borrows from; NULL: it has none. */
static const opc_flow_step *step_of_base(const opc_run *run,
                                         const opc_flow_step *step) {
  return run->base ? opc_flow_find(run->base->flow, step->name) : NULL;
}

/* Steps of a flow inside of a step whose places its own inputs take: what these
   are depends on the steps of the outer flow. */
static void take_given(opc_run *run) {
  const opc_flow_step *outer = run->main ? run->main->at : NULL;
  for (guint i = 0; outer && i < outer->inputs->len; i++) {
    const opc_flow_input *in = &g_array_index(outer->inputs, opc_flow_input, i);
    const opc_plugin *plugin = in->binding->plugin;
    const opc_flow_step *step =
        opc_flow_find(run->flow, plugin->parameters[in->parameter].name);
    const opc_key *known = &run->main->keys[in->from->number];
    if (in->binding != outer->binding || !step || !run->objects[step->number])
      continue;
    opc_key *key = &run->keys[step->number];
    if (known->sum)
      key->sum = g_strdup_printf("%s %zu", known->sum, in->port);
    else
      key->why = g_strdup(known->why);
  }
}

void opc_reuse_begin(opc_run *run) {
  if (!run->options->store) return;
  if (!run->base) take_given(run);
  for (guint i = 0; run->base && i < run->flow->steps->len; i++) {
    const opc_flow_step *its = step_of_base(run, run->flow->steps->pdata[i]);
    if (!run->left_out[i] || !its) continue;
    const opc_key *known = &run->base->keys[its->number];
    run->keys[i].sum = g_strdup(known->sum);
    run->keys[i].why = g_strdup(known->why);
  }
  opc_flow_keys(run->flow, run->options->store, run->keys);
}

static char *name_of(const opc_key *key, const char *ending) {
  return g_strconcat(key->sum, ending, NULL);
}

/* ---- taking and keeping ---- */

/* A step with a flow of its own always runs: it is the steps of that flow that
   are reused. */
static GVariant *find_result(const opc_run *run, const opc_flow_step *step) {
  const opc_key *key = &run->keys[step->number];
  if (!key->sum || step->binding->inner) return NULL;
  g_autofree char *name = name_of(key, ".result");
  return opc_store_get(run->options->store, name,
                       G_VARIANT_TYPE(opc_result_type));
}

gboolean opc_reuse_take(opc_run *run, const opc_flow_step *step,
                        opc_problems *problems) {
  const ranks_group *ranks = opc_run_ranks(run);
  opc_error error = {0};
  g_autoptr(GVariant) result =
      opc_run_is_first(run) ? find_result(run, step) : NULL;
  char found = result != NULL;
  tell_complaint(run);
  if (ranks && ranks->spread(&found, 1, 0, &error))
    return opc_problem_add(problems, error.code, NULL, "%s", error.message);
  if (!found || !result) return found;
  int code = opc_result_publish(run, step, result, &error);
  if (code)
    opc_binding_fail(step->binding, TRUE, code, &error, problems);
  else
    tell(run, step, TRUE, NULL);
  if (!code && !run->main)
    run->watch.log(run, step->name, OPC_LOG_INFO, "reused");
  return TRUE;
}

/* A folder for a moment, in the run's. */
static char *open_scratch(const opc_run *run) {
  g_autofree char *name = g_build_filename(run->work, ".opcflow-XXXXXX", NULL);
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
  opc_run_set_inputs(run, step, TRUE);
  const char *before = opc_binding_enter(b);
  int code = folder
                 ? functions->save(b->module.self, run->objects[step->number],
                                   folder, &error)
                 : OPC_IO;
  opc_binding_leave(before);
  opc_run_set_inputs(run, step, FALSE);
  GVariant *all = code ? NULL : opc_files_pack(folder, opc_store_most(store));
  g_autofree char *name = name_of(&run->keys[step->number], ".outputs");
  gboolean kept = all && opc_store_put(store, name, all);
  close_scratch(folder);
  return kept;
}

/* Files that changed while it ran are not what it read. */
gboolean opc_reuse_is_unchanged(const opc_run *run, const opc_key *key) {
  for (guint i = 0; i + 1 < key->files->len; i += 2)
    if (!opc_store_same(run->options->store, key->files->pdata[i],
                        key->files->pdata[i + 1]))
      return FALSE;
  return TRUE;
}

void opc_reuse_keep(opc_run *run, const opc_flow_step *step, guint tables) {
  opc_store *store = run->options->store;
  const opc_key *key = &run->keys[step->number];
  if (!store || !opc_run_is_first(run)) return;
  g_autofree char *reason =
      key->facts ? find_reason(store, step, key->facts) : g_strdup(key->why);
  if (step->binding->inner && key->facts) {
    g_free(reason);
    reason = g_strdup("runs a flow, whose steps are reused one by one");
  }
  tell(run, step, FALSE, reason);
  GVariant *result =
      key->sum && !step->binding->inner && opc_reuse_is_unchanged(run, key)
          ? opc_result_new(run, step, tables)
          : NULL;
  if (result) {
    g_autofree char *name = name_of(key, ".result");
    gboolean outputs = keep_outputs(run, step);
    gboolean kept = opc_store_put(store, name, result);
    if (kept) keep_facts(store, step, key->facts);
    if (kept && outputs) opc_pieces_drop(run);
  }
  tell_complaint(run);
}

/* ---- outputs of steps that did not run ---- */

/* From the store. */
static gboolean restore(opc_run *run, const opc_flow_step *step) {
  const opc_binding *b = step->binding;
  const opc_step *functions = b->plugin->functions;
  if (!functions->restore || !run->keys[step->number].sum) return FALSE;
  g_autofree char *name = name_of(&run->keys[step->number], ".outputs");
  g_autoptr(GVariant) kept =
      opc_store_get(run->options->store, name, G_VARIANT_TYPE("a(ayay)"));
  char *folder = kept ? open_scratch(run) : NULL;
  opc_error error = {0};
  int code = folder ? opc_files_unpack(kept, folder, &error) : OPC_IO;
  if (!code) {
    run->objects[step->number] = g_new0(void *, functions->n_outputs + 1);
    opc_run_set_inputs(run, step, TRUE);
    const char *before = opc_binding_enter(b);
    code = functions->restore(b->module.self, folder,
                              run->objects[step->number], &error);
    opc_binding_leave(before);
    opc_run_set_inputs(run, step, FALSE);
    if (!code) code = opc_run_check(run, step, &error);
    if (code) opc_run_release(run, step);
  }
  close_scratch(folder);
  tell_complaint(run);
  return !code;
}

/* Once more, into a folder that is thrown away, and without a word. */
static gboolean run_again(opc_run *run, const opc_flow_step *step,
                          const char *whom, opc_problems *problems) {
  char *work = run->work;
  GHashTable *claims = run->claims;
  run->work = open_scratch(run);
  run->claims = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  run->silent = TRUE;
  run->at = step;
  gboolean good = opc_run_step(run, step, problems);
  run->at = NULL;
  run->silent = FALSE;
  close_scratch(run->work);
  g_hash_table_destroy(run->claims);
  run->work = work;
  run->claims = claims;
  tell_again(run, step, whom);
  return good;
}

/* Whether all ranks say yes, and in *any whether one does. */
static gboolean do_all(const ranks_group *ranks, gboolean yes, gboolean *any) {
  gint64 least[2] = {yes, -yes};
  opc_error stopped;
  *any = yes;
  if (!ranks || ranks->least(least, 2, &stopped)) return yes;
  *any = least[1] < 0;
  return least[0] > 0;
}

/* From the store if all ranks have it there, so that none is missed by those
   that work. */
static gboolean restore_all(opc_run *run, const opc_flow_step *step) {
  gboolean any, here = restore(run, step);
  gboolean all = do_all(opc_run_ranks(run), here, &any);
  if (here && !all) opc_run_release(run, step);
  return all;
}

static gboolean provide(opc_run *run, const opc_flow_step *step,
                        const char *whom, opc_problems *problems) {
  if (run->objects[step->number]) return TRUE;
  for (guint i = 0; i < step->inputs->len; i++)
    if (!opc_run_provide(run,
                         g_array_index(step->inputs, opc_flow_input, i).from,
                         step->name, problems))
      return FALSE;
  return restore_all(run, step) || run_again(run, step, whom, problems);
}

gboolean opc_run_provide(opc_run *run, const opc_flow_step *step,
                         const char *whom, opc_problems *problems) {
  guint n = step->number;
  const opc_flow_step *its = step_of_base(run, step);
  if (run->left_out[n] && its) {
    gboolean good = opc_run_provide(run->base, its, whom, problems);
    run->objects[n] = run->base->objects[its->number];
    return good;
  }
  /* One that had them for a step of its own leaves the others to themselves. */
  gboolean any, before = run->apart;
  if (do_all(opc_run_ranks(run), run->objects[n] != NULL, &any)) return TRUE;
  run->apart = before || any;
  gboolean good = provide(run, step, whom, problems);
  run->apart = before;
  return good;
}
