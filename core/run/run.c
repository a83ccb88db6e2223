/* SPDX-License-Identifier: BSD-3-Clause */
/* Creates and frees runs. */
#include "core/run/run.h"

#include <guard/guard.h>

#include "core/binding/outputs.h"
#include "core/plugin/declaration.h"
#include "core/run/listen.h"

opc_run *opc_run_new(opc_flow *flow, opc_registry *registry,
                     const opc_run_options *options, const opc_watch *watch,
                     const opc_host *like) {
  opc_run *run = g_new0(opc_run, 1);
  guint n = flow->steps->len;
  run->flow = flow;
  run->registry = registry;
  run->options = options;
  if (like) run->like = *like;
  run->like.data = run;
  run->objects = g_new0(void **, n);
  run->left_out = g_new0(gboolean, n);
  opc_outcome_init(&run->out, n);
  opc_listen(run, watch);
  run->written.claims =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, g_free);
  run->written.outputs = opc_flow_outputs(flow, NULL);
  run->written.given = g_ptr_array_new_with_free_func(g_free);
  run->sums.summed =
      g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
  run->kept.keys = g_new0(opc_key, n);
  run->kept.pieces = g_ptr_array_new_with_free_func(g_free);
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

/* The order is reversed, because outputs of later steps may point into outputs
   of earlier steps. */
void opc_run_release_all(opc_run *run) {
  for (guint i = run->flow->order->len; i-- > 0;) {
    const opc_flow_step *step = run->flow->order->pdata[i];
    if (!run->left_out[step->number]) opc_run_release(run, step);
  }
}

void opc_run_free(opc_run *run) {
  if (!run) return;
  opc_run_release_all(run);
  opc_listen_end(run);
  for (guint i = 0; i < run->flow->steps->len; i++)
    opc_key_clear(&run->kept.keys[i]);
  g_free(run->kept.keys);
  g_ptr_array_free(run->kept.pieces, TRUE);
  g_hash_table_destroy(run->sums.summed);
  g_free(run->written.work);
  g_hash_table_destroy(run->written.claims);
  g_hash_table_destroy(run->written.outputs);
  g_ptr_array_free(run->written.given, TRUE);
  opc_outcome_clear(&run->out);
  g_free(run->objects);
  g_free(run->left_out);
  opc_flow_free(run->own);
  g_free(run);
}

/* ---- ranks ---- */

/* Steps of inner flows are not distributed: each rank runs all of them. */
const ranks_group *opc_run_ranks(const opc_run *run) {
  for (const opc_run *r = run; r; r = r->main)
    if (r->apart || (r->main && r->main->at)) return NULL;
  return run->options->ranks;
}

gboolean opc_run_is_first(const opc_run *run) {
  return !run->options->ranks || !run->options->ranks->rank;
}
